//! Products of vectors, whatever their parts are.

use std::ops::{Add, Mul, Sub};

use super::double_double::DoubleDouble;
use super::residue::Residue;

/// What vectors are made of: `f64`, twice its precision, or numbers modulo a prime.
pub(super) trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl Number for f64 {}
impl Number for DoubleDouble {}
impl Number for Residue {}

#[inline]
pub(super) fn difference<T: Number>(to: &[T; 3], from: &[T; 3]) -> [T; 3] {
    std::array::from_fn(|k| to[k] - from[k])
}

#[inline]
pub(super) fn dot<T: Number>(x: &[T; 3], y: &[T; 3]) -> T {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

#[inline]
pub(super) fn cross<T: Number>(x: &[T; 3], y: &[T; 3]) -> [T; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        x[i] * y[j] - x[j] * y[i]
    })
}

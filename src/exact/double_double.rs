//! Unevaluated sums of two `f64`: about 106 bits, for constructions that are rounded afterwards. Results carry a relative
//! error of a few times 2^-104 while nothing under- or overflows; callers bound it and fall back to exact integers.
//! (Dekker 1971; Shewchuk 1997, section 2.)

use std::ops::{Add, Div, Mul, Sub};

/// `high + low` with `|low|` at most half an ulp of `high`.
#[derive(Clone, Copy, Debug)]
pub(super) struct DoubleDouble {
    pub(super) high: f64,
    pub(super) low: f64,
}

impl DoubleDouble {
    /// `a - b`, exactly.
    #[inline]
    pub(super) fn difference(a: f64, b: f64) -> Self {
        let high = a - b;
        let virtual_b = a - high;
        let virtual_a = high + virtual_b;
        Self { high, low: (virtual_b - b) + (a - virtual_a) }
    }

    #[inline]
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let virtual_b = high - a;
        let virtual_a = high - virtual_b;
        Self { high, low: (b - virtual_b) + (a - virtual_a) }
    }

    /// `a + b` for `|a| >= |b|`.
    #[inline]
    fn quick_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// `a * b`, exactly (while nothing under- or overflows).
    #[inline]
    fn product(a: f64, b: f64) -> Self {
        const SPLITTER: f64 = (1u64 << 27) as f64 + 1.0;
        let split = |x: f64| {
            let scaled = SPLITTER * x;
            let high = scaled - (scaled - x);
            (high, x - high)
        };
        let high = a * b;
        let (a_high, a_low) = split(a);
        let (b_high, b_low) = split(b);
        let error = ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low;
        Self { high, low: error }
    }
}

impl From<f64> for DoubleDouble {
    #[inline]
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.high, other.high);
        let low = Self::sum(self.low, other.low);
        let partial = Self::quick_sum(high.high, high.low + low.high);
        Self::quick_sum(partial.high, partial.low + low.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        Self::quick_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        let third = rest.high / other.high;
        let sum = Self::quick_sum(first, second);
        sum + Self::from(third)
    }
}

/// A power of two near `x`, which is positive, or 1.
pub(super) fn power_of_two(x: f64) -> f64 {
    let power = f64::from_bits(x.to_bits() & (0x7ff << 52));
    // Its inverse must be a number as well.
    if power.is_normal() && (1.0 / power).is_normal() { power } else { 1.0 }
}

/// `(x - y) / power`, exactly, for a power of two.
pub(super) fn scaled_difference(x: &[f64; 3], y: &[f64; 3], power: f64) -> [DoubleDouble; 3] {
    std::array::from_fn(|k| {
        let difference = DoubleDouble::difference(x[k], y[k]);
        DoubleDouble { high: difference.high / power, low: difference.low / power }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn exact(value: DoubleDouble) -> RBig {
        RBig::try_from(value.high).expect("finite") + RBig::try_from(value.low).expect("finite")
    }

    #[test]
    fn relative_error_stays_below_the_stated_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let bound = RBig::from_parts(1.into(), dashu::integer::UBig::ONE << 102);
        let close = |result: DoubleDouble, expected: RBig| {
            let error = exact(result) - &expected;
            let (error, size) = (error.clone().max(-error), expected.clone().max(-expected));
            assert!(error <= size * &bound);
        };
        for _ in 0..5_000 {
            let mut random = || {
                DoubleDouble::difference(rng.random_range(-1.0..1.0), rng.random_range(-1e-3..1e-3))
                    * DoubleDouble::difference(rng.random_range(0.5..1.0), rng.random_range(-1e-17..1e-17))
            };
            let (a, b) = (random(), random());
            close(a * b, exact(a) * exact(b));
            close(a / b, exact(a) / exact(b));
            close(a + b, exact(a) + exact(b));
            close(a - b, exact(a) - exact(b));
        }
    }
}

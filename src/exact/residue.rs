//! Whole numbers modulo a prime, to tell quickly that something is not zero.
//!
//! A sum of products of coordinates that is not zero modulo a prime is not zero. The other way round this need not hold, but 2^61 - 1 is
//! so large a prime that what is zero modulo it nearly always is zero: then whole numbers decide. Unlike a floating-point filter this
//! costs the same however near to zero the value is; it does not tell the sign.
//!
//! Every finite `f64` is a whole number times a power of two, and two has an inverse modulo an odd prime: so coordinates need no common
//! unit here. Modulo 2^61 - 1 a product with a power of two is a rotation of bits.

use std::ops::{Add, Mul, Sub};

use super::lattice::mantissa_and_exponent;

/// The prime.
const PRIME: u64 = (1 << BITS) - 1;
const BITS: u32 = 61;

/// A number modulo 2^61 - 1, below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Residue(u64);

impl Residue {
    pub(super) const ZERO: Self = Self(0);
    pub(super) const ONE: Self = Self(1);

    /// A finite number.
    #[inline]
    pub(super) fn of(value: f64) -> Self {
        let (mantissa, exponent) = mantissa_and_exponent(value);
        let turn = exponent.rem_euclid(BITS as i32) as u32;
        let magnitude = Self(((mantissa << turn) & PRIME) | mantissa >> (BITS - turn));
        if value.is_sign_negative() { Self::ZERO - magnitude } else { magnitude }
    }

    #[inline]
    pub(super) fn is_zero(self) -> bool {
        self == Self::ZERO
    }

    /// A number up to twice the prime.
    #[inline]
    fn of_sum(sum: u64) -> Self {
        Self(if sum >= PRIME { sum - PRIME } else { sum })
    }
}

impl Add for Residue {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::of_sum(self.0 + other.0)
    }
}

impl Sub for Residue {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::of_sum(self.0 + (PRIME - other.0))
    }
}

impl Mul for Residue {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let product = u128::from(self.0) * u128::from(other.0);
        Self::of_sum((product as u64 & PRIME) + (product >> BITS) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::integer::IBig;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn modulo(value: &IBig) -> u64 {
        let rest: IBig = ((value % IBig::from(PRIME)) + IBig::from(PRIME)) % IBig::from(PRIME);
        u64::try_from(rest).unwrap()
    }

    #[test]
    fn sums_and_products_agree_with_whole_numbers() {
        let mut rng = ChaCha8Rng::seed_from_u64(41);
        for _ in 0..10_000 {
            let mut number = || match rng.random_range(0..4) {
                0 => [0, 1, 2, PRIME - 1, PRIME - 2, PRIME / 2][rng.random_range(0..6)],
                _ => rng.random_range(0..PRIME),
            };
            let (x, y) = (number(), number());
            let (big_x, big_y) = (IBig::from(x), IBig::from(y));
            assert_eq!((Residue(x) + Residue(y)).0, modulo(&(&big_x + &big_y)));
            assert_eq!((Residue(x) - Residue(y)).0, modulo(&(&big_x - &big_y)));
            assert_eq!((Residue(x) * Residue(y)).0, modulo(&(&big_x * &big_y)));
        }
    }

    #[test]
    fn coordinates_are_whole_numbers_times_powers_of_two() {
        let mut rng = ChaCha8Rng::seed_from_u64(42);
        let half = Residue::of(0.5);
        assert_eq!(half * Residue::of(2.0), Residue::ONE);
        let extremes = [0.0, -0.0, 1.0, -1.0, f64::MAX, f64::MIN, f64::from_bits(1), f64::MIN_POSITIVE];
        for value in extremes {
            assert_eq!(Residue::of(value).is_zero(), value == 0.0, "{value}");
        }
        for _ in 0..10_000 {
            let bits: u64 = rng.random();
            let value = f64::from_bits(bits);
            if !value.is_finite() || value.abs() < 1e-300 || value.abs() > 1e300 {
                continue;
            }
            // Doubling and halving is exact here.
            assert_eq!(Residue::of(0.5 * value), Residue::of(value) * half);
            let whole = (rng.random::<i64>() >> 11) as f64;
            assert_eq!(Residue::of(whole).0, modulo(&IBig::from(whole as i64)));
        }
    }
}

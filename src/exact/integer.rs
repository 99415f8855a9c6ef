//! Signed integers of any size, held on the stack while they are small.

use std::cmp::Ordering;

use smallvec::SmallVec;

/// Words that fit without allocation: enough for every predicate on coordinates that share some 100 bits.
const INLINE_WORDS: usize = 12;

/// A signed integer of any size: sign and magnitude, least significant word first, no leading zero words.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Integer {
    negative: bool,
    words: SmallVec<[u64; INLINE_WORDS]>,
}

impl Integer {
    /// Zero.
    #[must_use]
    pub(super) fn zero() -> Self {
        Self::default()
    }

    /// `value * 2^shift`.
    #[must_use]
    pub(super) fn from_shifted(value: i64, shift: u32) -> Self {
        let mut result = Self { negative: value < 0, words: SmallVec::new() };
        result.words.resize((shift / 64) as usize, 0);
        let wide = u128::from(value.unsigned_abs()) << (shift % 64);
        result.words.push(wide as u64);
        result.words.push((wide >> 64) as u64);
        result.trim();
        result
    }

    /// -1, 0 or 1.
    #[must_use]
    pub(super) fn signum(&self) -> i32 {
        match (self.words.is_empty(), self.negative) {
            (true, _) => 0,
            (false, true) => -1,
            (false, false) => 1,
        }
    }

    /// Whether this is zero.
    #[must_use]
    pub(super) fn is_zero(&self) -> bool {
        self.words.is_empty()
    }

    /// The number of bits of the magnitude; 0 for zero.
    #[must_use]
    pub(super) fn bits(&self) -> u64 {
        match self.words.last() {
            Some(top) => self.words.len() as u64 * 64 - u64::from(top.leading_zeros()),
            None => 0,
        }
    }

    /// `self + other`.
    #[must_use]
    pub(super) fn plus(&self, other: &Self) -> Self {
        self.combined(other, other.negative)
    }

    /// `self - other`.
    #[must_use]
    pub(super) fn minus(&self, other: &Self) -> Self {
        self.combined(other, !other.negative)
    }

    /// `self * other`, by the school method: the operands are a few dozen words at most.
    #[must_use]
    pub(super) fn times(&self, other: &Self) -> Self {
        let mut words: SmallVec<[u64; INLINE_WORDS]> = SmallVec::new();
        words.resize(self.words.len() + other.words.len(), 0);
        for (i, &x) in self.words.iter().enumerate() {
            let mut carry = 0u128;
            for (j, &y) in other.words.iter().enumerate() {
                let sum = u128::from(x) * u128::from(y) + u128::from(words[i + j]) + carry;
                words[i + j] = sum as u64;
                carry = sum >> 64;
            }
            words[i + other.words.len()] = carry as u64;
        }
        let mut result = Self { negative: self.negative != other.negative, words };
        result.trim();
        result
    }

    /// `self * 2^shift`.
    #[must_use]
    pub(super) fn shifted_left(&self, shift: u64) -> Self {
        if self.is_zero() {
            return Self::zero();
        }
        let mut words: SmallVec<[u64; INLINE_WORDS]> = SmallVec::new();
        words.resize((shift / 64) as usize, 0);
        let low_bits = shift % 64;
        let mut carry = 0u64;
        for &word in &self.words {
            words.push(word << low_bits | carry);
            carry = if low_bits == 0 { 0 } else { word >> (64 - low_bits) };
        }
        words.push(carry);
        let mut result = Self { negative: self.negative, words };
        result.trim();
        result
    }

    /// The `f64` nearest to `self / divisor * 2^exponent`, ties to even, subnormal and infinite results included.
    ///
    /// # Panics
    /// If `divisor` is zero.
    #[must_use]
    pub(super) fn quotient(&self, divisor: &Self, exponent: i64) -> f64 {
        assert!(!divisor.is_zero(), "division by zero");
        if self.is_zero() {
            return 0.0;
        }
        // Scale so that the integer quotient has 64 or 65 bits; 53 of them and a sticky bit decide the rounding.
        let shift = 64 + divisor.bits() as i64 - self.bits() as i64;
        let (dividend, divisor_magnitude) = if shift >= 0 {
            (self.shifted_left(shift as u64), divisor.clone())
        } else {
            (self.clone(), divisor.shifted_left((-shift) as u64))
        };
        let (quotient, exact) = divide_magnitudes(&dividend, &divisor_magnitude);
        let magnitude = round_to_f64(quotient, exact, exponent - shift);
        if self.negative == divisor.negative { magnitude } else { -magnitude }
    }

    fn combined(&self, other: &Self, other_negative: bool) -> Self {
        let mut result = if self.negative == other_negative {
            Self { negative: self.negative, words: add_magnitudes(&self.words, &other.words) }
        } else {
            match compare_magnitudes(&self.words, &other.words) {
                Ordering::Equal => Self::zero(),
                Ordering::Greater => {
                    Self { negative: self.negative, words: subtract_magnitudes(&self.words, &other.words) }
                }
                Ordering::Less => {
                    Self { negative: other_negative, words: subtract_magnitudes(&other.words, &self.words) }
                }
            }
        };
        result.trim();
        result
    }

    fn trim(&mut self) {
        while self.words.last() == Some(&0) {
            self.words.pop();
        }
        self.negative &= !self.words.is_empty();
    }
}

impl From<i64> for Integer {
    fn from(value: i64) -> Self {
        Self::from_shifted(value, 0)
    }
}

fn compare_magnitudes(a: &[u64], b: &[u64]) -> Ordering {
    a.len().cmp(&b.len()).then_with(|| a.iter().rev().cmp(b.iter().rev()))
}

fn add_magnitudes(a: &[u64], b: &[u64]) -> SmallVec<[u64; INLINE_WORDS]> {
    let (long, short) = if a.len() >= b.len() { (a, b) } else { (b, a) };
    let mut words = SmallVec::with_capacity(long.len() + 1);
    let mut carry = 0u128;
    for (i, &word) in long.iter().enumerate() {
        let sum = u128::from(word) + u128::from(short.get(i).copied().unwrap_or(0)) + carry;
        words.push(sum as u64);
        carry = sum >> 64;
    }
    words.push(carry as u64);
    words
}

/// `a - b` for `a >= b`.
fn subtract_magnitudes(a: &[u64], b: &[u64]) -> SmallVec<[u64; INLINE_WORDS]> {
    let mut words = SmallVec::with_capacity(a.len());
    let mut borrow = false;
    for (i, &word) in a.iter().enumerate() {
        let (difference, under) = word.overflowing_sub(b.get(i).copied().unwrap_or(0));
        let (difference, under_again) = difference.overflowing_sub(u64::from(borrow));
        words.push(difference);
        borrow = under || under_again;
    }
    words
}

/// `|a| / |b|` rounded down, and whether nothing was left over. The quotient must have at most 66 bits. Some 30 bits of it
/// are estimated from the leading words at a time, never too many.
fn divide_magnitudes(a: &Integer, b: &Integer) -> (u128, bool) {
    let divisor = Integer { negative: false, words: b.words.clone() };
    let mut remainder = Integer { negative: false, words: a.words.clone() };
    let mut quotient = 0u128;
    while compare_magnitudes(&remainder.words, &divisor.words) != Ordering::Less {
        // The leading 64 bits of the remainder over the leading 32 of the divisor, rounded up.
        let (leading, remainder_shift) = leading_bits(&remainder, 64);
        let (divisor_leading, divisor_shift) = leading_bits(&divisor, 32);
        let digit = leading / (divisor_leading + 1);
        let shift = remainder_shift - divisor_shift;
        let (digit, shift) = if shift >= 0 { (digit, shift) } else { (digit >> -shift, 0) };
        let digit = digit.max(1);
        // At most 33 bits.
        let step = divisor.times(&Integer::from(digit as i64));
        remainder = remainder.minus(&step.shifted_left(shift as u64));
        quotient += u128::from(digit) << shift;
    }
    (quotient, remainder.is_zero())
}

/// The leading `count` bits (at most 64) of a magnitude and by how much they were shifted down (negative: up).
fn leading_bits(value: &Integer, count: i64) -> (u64, i64) {
    let shift = value.bits() as i64 - count;
    let n = value.words.len();
    let high = value.words[n - 1];
    let low = if n >= 2 { value.words[n - 2] } else { 0 };
    let zeros = high.leading_zeros();
    let aligned = if zeros == 0 { high } else { high << zeros | low >> (64 - zeros) };
    (aligned >> (64 - count), shift)
}

/// The `f64` nearest to `(quotient + rest) * 2^exponent`, where the rest is zero if `exact`, else inside (0, 1), ties to
/// even. `quotient` has at least 60 bits.
fn round_to_f64(quotient: u128, exact: bool, exponent: i64) -> f64 {
    const MANTISSA_BITS: i64 = 53;
    const MINIMUM_EXPONENT: i64 = -1074;
    let bits = i64::from(128 - quotient.leading_zeros());
    // Weight of the last kept bit: 53 bits below the leading one, but no finer than the smallest subnormal.
    let unit = (exponent + bits - MANTISSA_BITS).max(MINIMUM_EXPONENT);
    let drop = unit - exponent;
    if drop > 127 {
        return 0.0;
    }
    let kept = (quotient >> drop) as u64;
    let dropped = quotient & ((1u128 << drop) - 1);
    let half = 1u128 << (drop - 1);
    let up = match dropped.cmp(&half) {
        Ordering::Greater => true,
        Ordering::Less => false,
        Ordering::Equal => !exact || kept & 1 == 1,
    };
    scale_by_power_of_two((kept + u64::from(up)) as f64, unit)
}

/// `value * 2^exponent` where the result is exact or overflows to infinity.
fn scale_by_power_of_two(mut value: f64, mut exponent: i64) -> f64 {
    while exponent > 1000 {
        value *= f64::from_bits((1000 + 1023) << 52);
        exponent -= 1000;
        if value.is_infinite() {
            return value;
        }
    }
    // Two exact steps downwards: the value has at most 54 bits and its last bit is representable.
    while exponent < -1000 {
        value *= f64::from_bits((1023 - 500) << 52);
        exponent += 500;
    }
    value * f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::integer::IBig;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn to_reference(value: &Integer) -> IBig {
        let magnitude =
            value.words.iter().rev().fold(IBig::ZERO, |sum, &word| (sum << 64) + IBig::from(word));
        if value.negative { -magnitude } else { magnitude }
    }

    fn random(rng: &mut ChaCha8Rng) -> Integer {
        let value = rng.random::<i64>() >> rng.random_range(0..64);
        let other = Integer::from_shifted(rng.random::<i64>(), rng.random_range(0..400));
        Integer::from_shifted(value, rng.random_range(0..300)).plus(&other)
    }

    #[test]
    fn agrees_with_reference_integers() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..5_000 {
            let (a, b) = (random(&mut rng), random(&mut rng));
            let (x, y) = (to_reference(&a), to_reference(&b));
            assert_eq!(to_reference(&a.plus(&b)), &x + &y);
            assert_eq!(to_reference(&a.minus(&b)), &x - &y);
            assert_eq!(to_reference(&a.times(&b)), &x * &y);
            let shift = rng.random_range(0..200);
            assert_eq!(to_reference(&a.shifted_left(shift)), &x << shift as usize);
            assert_eq!(a.minus(&a), Integer::zero());
            assert_eq!(
                a.signum(),
                if x == IBig::ZERO {
                    0
                } else if x < IBig::ZERO {
                    -1
                } else {
                    1
                }
            );
        }
    }

    #[test]
    fn quotients_are_correctly_rounded() {
        // Products of 53-bit numbers over one factor give the other back; halves of units in the last place are ties.
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..5_000 {
            let x = rng.random::<i64>() >> rng.random_range(11..60);
            let y = (rng.random::<i64>() >> 11) | 1;
            let product = Integer::from(x).times(&Integer::from(y));
            let exponent = rng.random_range(-900..900);
            let expected = x as f64 * 2f64.powi(exponent);
            assert_eq!(product.quotient(&Integer::from(y), i64::from(exponent)), expected);
        }
        let one = Integer::from(1);
        let odd = Integer::from((1 << 53) + 1);
        assert_eq!(odd.quotient(&one, 0), (1i64 << 53) as f64, "tie to even");
        let above = Integer::from_shifted((1 << 53) + 1, 100).plus(&one);
        assert_eq!(above.quotient(&one, -100), ((1i64 << 53) + 2) as f64, "just above a tie");
        assert_eq!(Integer::from(1).quotient(&Integer::from(3), 0), 1.0 / 3.0);
        assert_eq!(Integer::from(-2).quotient(&Integer::from(3), 0), -2.0 / 3.0);
    }

    #[test]
    fn quotients_at_the_ends_of_the_range() {
        let one = Integer::from(1);
        assert_eq!(one.quotient(&one, -1074), f64::from_bits(1));
        assert_eq!(one.quotient(&one, -1075), 0.0, "tie between zero and the smallest: to even");
        assert_eq!(Integer::from(3).quotient(&one, -1076), f64::from_bits(1));
        assert_eq!(Integer::from(3).quotient(&one, -1075), f64::from_bits(2), "tie to even");
        assert_eq!(one.quotient(&one, 1023), 2f64.powi(1023));
        assert_eq!(one.quotient(&one, 1024), f64::INFINITY);
        assert_eq!(Integer::from(5).quotient(&Integer::from(2), -1074), f64::from_bits(2), "2.5 to even");
        assert_eq!(one.quotient(&one, -5000), 0.0);
    }
}

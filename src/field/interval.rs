//! Interval arithmetic with outward rounding: every result contains all values the operation can take.

use super::number::Number;
use super::rfunction::{RFunctions, System, combine_by_formula};

/// A closed interval, perhaps unbounded. An operation that may be undefined gives the whole line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// Every number.
    pub const ENTIRE: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// The interval from `low` to `high`; the whole line if they are out of order or not numbers.
    #[must_use]
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high { Self { low, high } } else { Self::ENTIRE }
    }

    /// Whether `value` lies inside.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// The smallest interval around both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The part in both; `self` if there is none (rounding apart, that does not happen to bounds of one value).
    #[must_use]
    pub fn meet(self, other: Self) -> Self {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        if low <= high { Self { low, high } } else { self }
    }

    /// Half-way between the ends.
    #[must_use]
    pub fn middle(self) -> f64 {
        self.low * 0.5 + self.high * 0.5
    }

    /// The interval one rounding step wider at both ends.
    fn widened(low: f64, high: f64) -> Self {
        Self::new(low.next_down(), high.next_up())
    }

    /// Wider by two units in the last place, for library functions that are not correctly rounded.
    fn widened_twice(low: f64, high: f64) -> Self {
        Self::widened(low.next_down(), high.next_up())
    }

    /// Bounds of a function that is non-decreasing.
    fn increasing(self, f: impl Fn(f64) -> f64) -> Self {
        Self::widened_twice(f(self.low), f(self.high))
    }

    /// Whether there is an integer `k` with `offset + k * period` inside.
    fn meets(self, offset: f64, period: f64) -> bool {
        // A little wider, since the period is rounded: at worst the bounds get wider.
        let slack = 1e-9 + 1e-15 * self.low.abs().max(self.high.abs());
        ((self.low - offset - slack) / period).ceil() <= ((self.high - offset + slack) / period).floor()
    }
}

impl Number for Interval {
    fn constant(value: f64) -> Self {
        Self { low: value, high: value }
    }

    fn add(self, other: Self) -> Self {
        Self::widened(self.low + other.low, self.high + other.high)
    }

    fn sub(self, other: Self) -> Self {
        Self::widened(self.low - other.high, self.high - other.low)
    }

    fn mul(self, other: Self) -> Self {
        // Zero times infinity is zero here: the infinity stands for arbitrarily large numbers.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let all = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        Self::widened(
            all.iter().copied().fold(f64::INFINITY, f64::min),
            all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        )
    }

    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::ENTIRE;
        }
        self.mul(Self::widened(1.0 / other.high, 1.0 / other.low))
    }

    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }

    fn scale(self, factor: f64) -> Self {
        if factor == -1.0 { self.neg() } else { self.mul(Self::constant(factor)) }
    }

    fn square(self) -> Self {
        let size = self.abs();
        let bounds = Self::widened(size.low * size.low, size.high * size.high);
        Self { low: bounds.low.max(0.0), high: bounds.high }
    }

    fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            self.neg()
        } else {
            Self { low: 0.0, high: self.high.max(-self.low) }
        }
    }

    fn sqrt(self) -> Self {
        if self.high < 0.0 {
            return Self::ENTIRE;
        }
        let bounds = Self::widened(self.low.max(0.0).sqrt(), self.high.sqrt());
        Self { low: bounds.low.max(0.0), high: bounds.high }
    }

    fn non_negative(self) -> Self {
        Self { low: self.low.max(0.0), high: self.high.max(0.0) }
    }

    fn powi(self, exponent: i32) -> Self {
        if exponent < 0 {
            return Self::constant(1.0).div(self.powi(exponent.saturating_neg()));
        }
        if exponent == 0 {
            return Self::constant(1.0);
        }
        let base = if exponent % 2 == 0 { self.abs() } else { self };
        // powi may round at every one of its multiplications.
        let wider = |value: f64, sign: f64| {
            value + sign * (value.abs() * 4.0 * f64::EPSILON * f64::from(exponent) + f64::MIN_POSITIVE)
        };
        let bounds = Self::new(wider(base.low.powi(exponent), -1.0), wider(base.high.powi(exponent), 1.0));
        if exponent % 2 == 0 { bounds.non_negative() } else { bounds }
    }

    fn powf(self, exponent: f64) -> Self {
        if self.low < 0.0 {
            return Self::ENTIRE;
        }
        let (a, b) = (self.low.powf(exponent), self.high.powf(exponent));
        Self::widened_twice(a.min(b), a.max(b)).non_negative()
    }

    fn sin(self) -> Self {
        let half_turn = std::f64::consts::FRAC_PI_2;
        if !(self.high - self.low < 4.0 * half_turn) {
            return Self { low: -1.0, high: 1.0 };
        }
        let (a, b) = (self.low.sin(), self.high.sin());
        let bounds = Self::widened_twice(a.min(b), a.max(b));
        Self {
            low: if self.meets(-half_turn, 4.0 * half_turn) { -1.0 } else { bounds.low.max(-1.0) },
            high: if self.meets(half_turn, 4.0 * half_turn) { 1.0 } else { bounds.high.min(1.0) },
        }
    }

    fn cos(self) -> Self {
        self.add(Self::constant(std::f64::consts::FRAC_PI_2)).sin()
    }

    fn exp(self) -> Self {
        self.increasing(f64::exp).non_negative()
    }

    fn ln(self) -> Self {
        if self.low < 0.0 { Self::ENTIRE } else { self.increasing(f64::ln) }
    }

    fn round(self) -> Self {
        Self::new(self.low.round(), self.high.round())
    }

    fn minimum(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    fn maximum(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.max(other.high) }
    }
}

impl RFunctions for Interval {
    fn combine(self, system: System, side: f64, other: Self) -> Self {
        if matches!(system, System::R0m(_)) {
            return combine_by_formula(system, side, self, other);
        }
        // Both partial derivatives are never negative, so the ends give the ends; the naive formula would be far
        // wider. Rounding is relative to the arguments, not to the result, in which they cancel.
        let end = |x: f64, y: f64, outward: f64| {
            let value = x.combine(system, side, y);
            value + outward * 16.0 * f64::EPSILON * (x.abs() + y.abs())
        };
        Self::widened(end(self.low, other.low, -1.0), end(self.high, other.high, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn part() -> impl Strategy<Value = (Interval, f64)> {
        (-4.0f64..4.0, 0.0f64..3.0, 0.0f64..=1.0)
            .prop_map(|(low, width, at)| (Interval::new(low, low + width), low + width * at))
            .prop_filter("rounding", |(interval, value)| interval.contains(*value))
    }

    proptest! {
        #[test]
        fn results_contain_the_values(((a, x), (b, y)) in (part(), part()), exponent in -4i32..6) {
            prop_assert!(a.add(b).contains(x + y));
            prop_assert!(a.sub(b).contains(x - y));
            prop_assert!(a.mul(b).contains(x * y));
            prop_assert!(y == 0.0 || a.div(b).contains(x / y));
            prop_assert!(a.square().contains(x * x));
            prop_assert!(a.abs().contains(x.abs()));
            prop_assert!(x < 0.0 || a.sqrt().contains(x.sqrt()));
            prop_assert!(x == 0.0 || a.powi(exponent).contains(x.powi(exponent)));
            prop_assert!(x < 0.0 || a.powf(1.7).contains(x.powf(1.7)));
            prop_assert!(a.scale(5.0).sin().contains((5.0 * x).sin()));
            prop_assert!(a.scale(5.0).cos().contains((5.0 * x).cos()));
            prop_assert!(a.exp().contains(x.exp()));
            prop_assert!(x <= 0.0 || a.ln().contains(x.ln()));
            prop_assert!(a.round().contains(x.round()));
            prop_assert!(a.minimum(b).contains(x.min(y)));
            prop_assert!(a.maximum(b).contains(x.max(y)));
            for system in [System::R0, System::Alpha(0.6), System::Alpha(-0.7), System::R0m(1), System::R0m(2)] {
                for side in [-1.0, 1.0] {
                    prop_assert!(a.combine(system, side, b).contains(x.combine(system, side, y)));
                }
            }
        }
    }

    #[test]
    fn unbounded_intervals_stay_right() {
        let right = Interval::new(2.0, f64::INFINITY);
        assert_eq!(Interval::constant(1.0).sub(right.square()).high, (-3.0f64).next_up().next_up());
        assert_eq!(right.sub(right), Interval::ENTIRE);
        assert_eq!(Interval::ENTIRE.mul(Interval::constant(0.0)).middle(), 0.0);
        assert_eq!(Interval::ENTIRE.sin(), Interval::new(-1.0, 1.0));
    }
}

//! Numbers with gradients (forward differentiation), over plain values and over intervals.

use glam::DVec3;

use super::interval::Interval;
use super::number::Number;
use super::rfunction::RFunctions;

/// Numbers that derivatives are taken in: the components of gradients.
pub(crate) trait Slope: Copy {
    type Value: Number;
    const ZERO: Self;
    fn plus(self, other: Self) -> Self;
    /// Every component times `factor`; a zero component stays zero whatever the factor.
    fn times(self, factor: Self::Value) -> Self;
    fn either(self, other: Self) -> Self;
    /// Whether the value may be zero, so that a division by it is to be avoided.
    fn vanishes(value: Self::Value) -> bool;
    /// The sign of the value, as bounds of the slope of its absolute value.
    fn sign(value: Self::Value) -> Self::Value;
}

impl Slope for DVec3 {
    type Value = f64;
    const ZERO: Self = DVec3::ZERO;
    fn plus(self, other: Self) -> Self {
        self + other
    }
    fn times(self, factor: f64) -> Self {
        // The chain rule at a kink: the inner derivative vanishes and decides.
        DVec3::from_array(self.to_array().map(|x| if x == 0.0 { 0.0 } else { x * factor }))
    }
    fn either(self, _: Self) -> Self {
        self
    }
    fn vanishes(value: f64) -> bool {
        value == 0.0
    }
    fn sign(value: f64) -> f64 {
        if value < 0.0 { -1.0 } else { 1.0 }
    }
}

impl Slope for [Interval; 3] {
    type Value = Interval;
    const ZERO: Self = [Interval { low: 0.0, high: 0.0 }; 3];
    fn plus(self, other: Self) -> Self {
        std::array::from_fn(|axis| self[axis].add(other[axis]))
    }
    fn times(self, factor: Interval) -> Self {
        self.map(|x| if x.low == 0.0 && x.high == 0.0 { x } else { x.mul(factor) })
    }
    fn either(self, other: Self) -> Self {
        std::array::from_fn(|axis| self[axis].hull(other[axis]))
    }
    fn vanishes(value: Interval) -> bool {
        // Handled by the interval operations, which give the whole line.
        value.low == 0.0 && value.high == 0.0
    }
    fn sign(value: Interval) -> Interval {
        Interval::new(if value.low < 0.0 { -1.0 } else { 1.0 }, if value.high > 0.0 { 1.0 } else { -1.0 })
    }
}

/// A value with its gradient in space (forward differentiation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dual<S: Slope> {
    pub(crate) value: S::Value,
    pub(crate) slope: S,
}

impl<S: Slope> Dual<S> {
    /// `value`, with the slope of `self` times `factor`.
    fn chain(self, value: S::Value, factor: S::Value) -> Self {
        Self { value, slope: self.slope.times(factor) }
    }
}

impl<S: Slope> Number for Dual<S> {
    fn constant(value: f64) -> Self {
        Self { value: S::Value::constant(value), slope: S::ZERO }
    }
    fn add(self, other: Self) -> Self {
        Self { value: self.value.add(other.value), slope: self.slope.plus(other.slope) }
    }
    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }
    fn mul(self, other: Self) -> Self {
        let slope = self.slope.times(other.value).plus(other.slope.times(self.value));
        Self { value: self.value.mul(other.value), slope }
    }
    fn div(self, other: Self) -> Self {
        let value = self.value.div(other.value);
        let reciprocal = S::Value::constant(1.0).div(other.value);
        let slope = self.slope.times(reciprocal).plus(other.slope.times(value.mul(reciprocal).neg()));
        Self { value, slope }
    }
    fn neg(self) -> Self {
        self.chain(self.value.neg(), S::Value::constant(-1.0))
    }
    fn scale(self, factor: f64) -> Self {
        self.chain(self.value.scale(factor), S::Value::constant(factor))
    }
    fn square(self) -> Self {
        self.chain(self.value.square(), self.value.scale(2.0))
    }
    fn abs(self) -> Self {
        self.chain(self.value.abs(), S::sign(self.value))
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        if S::vanishes(value) {
            // The root's slope is unbounded there; the functions it is used in (norms) have the slope zero as a
            // generalised gradient.
            return Self { value, slope: S::ZERO };
        }
        self.chain(value, S::Value::constant(0.5).div(value))
    }
    fn non_negative(self) -> Self {
        Self { value: self.value.non_negative(), slope: self.slope }
    }
    fn powi(self, exponent: i32) -> Self {
        if exponent == 0 {
            return Self::constant(1.0);
        }
        let factor = self.value.powi(exponent - 1).scale(f64::from(exponent));
        self.chain(self.value.powi(exponent), factor)
    }
    fn powf(self, exponent: f64) -> Self {
        self.chain(self.value.powf(exponent), self.value.powf(exponent - 1.0).scale(exponent))
    }
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.value.cos(), self.value.sin().neg())
    }
    fn exp(self) -> Self {
        self.chain(self.value.exp(), self.value.exp())
    }
    fn ln(self) -> Self {
        self.chain(self.value.ln(), S::Value::constant(1.0).div(self.value))
    }
    fn round(self) -> Self {
        Self { value: self.value.round(), slope: S::ZERO }
    }
    fn minimum(self, other: Self) -> Self {
        // Reached only where no branch has been chosen.
        Self { value: self.value.minimum(other.value), slope: self.slope.either(other.slope) }
    }
    fn maximum(self, other: Self) -> Self {
        Self { value: self.value.maximum(other.value), slope: self.slope.either(other.slope) }
    }
}

impl<S: Slope> RFunctions for Dual<S> {}

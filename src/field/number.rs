//! What a number must be able to do for an expression to be evaluated over it. Plain values are here; intervals, and
//! both with gradients, have their own files.

/// What the instructions of an expression need of a number.
pub(crate) trait Number: Copy {
    fn constant(value: f64) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn neg(self) -> Self;
    fn scale(self, factor: f64) -> Self;
    fn square(self) -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    /// The number, or 0 where rounding made it negative.
    fn non_negative(self) -> Self;
    fn powi(self, exponent: i32) -> Self;
    fn powf(self, exponent: f64) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    /// To the nearest integer, halves away from zero.
    fn round(self) -> Self;
    fn minimum(self, other: Self) -> Self;
    fn maximum(self, other: Self) -> Self;
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        self / other
    }
    fn neg(self) -> Self {
        -self
    }
    fn scale(self, factor: f64) -> Self {
        self * factor
    }
    fn square(self) -> Self {
        self * self
    }
    fn abs(self) -> Self {
        f64::abs(self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn non_negative(self) -> Self {
        // Not `max`, which would hide a NaN.
        if self < 0.0 { 0.0 } else { self }
    }
    fn powi(self, exponent: i32) -> Self {
        f64::powi(self, exponent)
    }
    fn powf(self, exponent: f64) -> Self {
        f64::powf(self, exponent)
    }
    fn sin(self) -> Self {
        f64::sin(self)
    }
    fn cos(self) -> Self {
        f64::cos(self)
    }
    fn exp(self) -> Self {
        f64::exp(self)
    }
    fn ln(self) -> Self {
        f64::ln(self)
    }
    fn round(self) -> Self {
        f64::round(self)
    }
    fn minimum(self, other: Self) -> Self {
        // A NaN on either side stays one, unlike in `f64::min`.
        if self <= other || self.is_nan() { self } else { other }
    }
    fn maximum(self, other: Self) -> Self {
        if self >= other || self.is_nan() { self } else { other }
    }
}

//! R-functions (Rvachev): real functions whose sign is a logical function of the signs of their arguments, so that
//! solids given by inequalities combine into one inequality. Formulas as in Choporov 2010; positive is true.

use std::fmt;

use super::number::Number;

/// A system of R-functions: the pair of a conjunction and a disjunction. Negation is `-x` in all of them.
///
/// All systems have the same sign everywhere and so describe the same solids; they differ in smoothness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum System {
    /// `(x + y -+ sqrt(x^2 + y^2 - 2 alpha x y)) / (1 + alpha)` for a constant `-1 < alpha <= 1`.
    Alpha(f64),
    /// `min(x, y)`, `max(x, y)`: the limit `alpha = 1`, not differentiable where `x = y`. Keeps distances: of two
    /// signed distances it is exact on one side and a bound on the other.
    R1,
    /// `x + y -+ sqrt(x^2 + y^2)`: `alpha = 0`, differentiable except where both are zero. The usual choice.
    #[default]
    R0,
    /// `(x + y -+ sqrt(x^2 + y^2)) (x^2 + y^2)^(m/2)`: of class C^m everywhere, at the price of a gradient that
    /// vanishes where both are zero.
    R0m(u32),
}

/// The largest `m` of [`System::R0m`].
pub(crate) const LARGEST_ORDER: u32 = 64;

impl System {
    /// Whether the parameter is in its range.
    #[must_use]
    pub fn is_valid(self) -> bool {
        match self {
            Self::Alpha(alpha) => alpha > -1.0 && alpha <= 1.0,
            Self::R0m(order) => order <= LARGEST_ORDER,
            Self::R1 | Self::R0 => true,
        }
    }

    /// The conjunction: positive where both are.
    #[must_use]
    pub fn and(self, x: f64, y: f64) -> f64 {
        match self {
            Self::R1 => x.min(y),
            _ => x.combine(self, -1.0, y),
        }
    }

    /// The disjunction: positive where at least one is.
    #[must_use]
    pub fn or(self, x: f64, y: f64) -> f64 {
        match self {
            Self::R1 => x.max(y),
            _ => x.combine(self, 1.0, y),
        }
    }
}

/// The pair of R-functions over a kind of number.
pub(crate) trait RFunctions: Number {
    /// The conjunction (`side` -1) or disjunction (+1).
    fn combine(self, system: System, side: f64, other: Self) -> Self {
        combine_by_formula(system, side, self, other)
    }
}

/// The conjunction (`side` -1) or disjunction (+1) as its formula is written.
pub(crate) fn combine_by_formula<N: Number>(system: System, side: f64, x: N, y: N) -> N {
    let squares = x.square().add(y.square());
    let root = |radicand: N| radicand.sqrt().scale(side);
    match system {
        System::R1 => x.add(y).add(x.sub(y).abs().scale(side)).scale(0.5),
        System::Alpha(alpha) => {
            let radicand = squares.sub(x.mul(y).scale(2.0 * alpha));
            x.add(y).add(root(radicand.non_negative())).scale(1.0 / (1.0 + alpha))
        }
        System::R0 => x.add(y).add(root(squares)),
        System::R0m(order) => {
            let factor = if order % 2 == 0 {
                squares.powi(order as i32 / 2)
            } else {
                squares.sqrt().mul(squares.powi(order as i32 / 2))
            };
            x.add(y).add(root(squares)).mul(factor)
        }
    }
}

impl RFunctions for f64 {}

impl fmt::Display for System {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alpha(alpha) => write!(f, "R_alpha({alpha})"),
            Self::R1 => f.write_str("R1"),
            Self::R0 => f.write_str("R0"),
            Self::R0m(order) => write!(f, "R0^{order}"),
        }
    }
}

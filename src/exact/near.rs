//! Numbers in double-double arithmetic that are known up to an error, and points of them.

use super::double_double::DoubleDouble;

/// A number known up to an error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) value: DoubleDouble,
    pub(super) error: f64,
}

impl Near {
    pub(super) fn exactly(value: f64) -> Self {
        Self { value: DoubleDouble::from(value), error: 0.0 }
    }
}

/// A point, each coordinate rounded to nearest, if the errors leave no doubt.
#[inline]
pub(super) fn round(near: &[Near; 3]) -> Option<[f64; 3]> {
    let mut position = [0.0; 3];
    for (rounded, Near { value: x, error }) in position.iter_mut().zip(near) {
        let error = error + x.low.abs() * 4.0 * f64::EPSILON;
        let (from_above, from_below) = (x.high + (x.low + error), x.high + (x.low - error));
        if from_above != from_below {
            return None;
        }
        *rounded = from_above + 0.0;
    }
    Some(position)
}

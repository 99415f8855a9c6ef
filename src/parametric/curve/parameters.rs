//! Parameter values for curves through given points.

use crate::parametric::error::{GeometryError, Result};
use crate::parametric::numeric::vector::{self, Point};

/// How the parameter runs along the points a curve goes through.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum Spacing {
    /// `t_i = i`.
    Uniform,
    /// `t_i` grows by the distance between consecutive points.
    #[default]
    ChordLength,
    /// `t_i` grows by the square root of that distance: no loops at sharp turns (Lee 1989).
    Centripetal,
    /// Given values, one per point (closed curves: one more, for the return to the first point).
    Given(Vec<f64>),
}

impl Spacing {
    /// Ascending parameters of `points`; for a closed curve one more, of the return to the first point.
    pub(crate) fn parameters<const D: usize>(
        &self,
        what: &'static str,
        points: &[Point<D>],
        closed: bool,
    ) -> Result<Vec<f64>> {
        let count = points.len();
        let steps = if closed { count } else { count - 1 };
        for step in 0..steps {
            let next = (step + 1) % count;
            if points[step] == points[next] {
                return Err(GeometryError::CoincidentPoints { what, first: step, second: next });
            }
        }
        let power = match self {
            Self::Uniform => return Ok((0..=steps).map(|i| i as f64).collect()),
            Self::Given(values) => return check_increasing(what, values, steps + 1).map(|()| values.clone()),
            Self::ChordLength => 1.0,
            Self::Centripetal => 0.5,
        };
        let mut parameters = vec![0.0];
        let mut sum = 0.0;
        for step in 0..steps {
            let length = vector::distance(points[step], points[(step + 1) % count]);
            let before = sum;
            sum += length.powf(power);
            // Points so close that the running sum does not grow are the same for this purpose.
            if sum <= before || !sum.is_finite() {
                let second = (step + 1) % count;
                return Err(GeometryError::CoincidentPoints { what, first: step, second });
            }
            parameters.push(sum);
        }
        Ok(parameters)
    }
}

/// Refuses parameters that are too few, not finite or not increasing.
pub(crate) fn check_increasing(of: &'static str, values: &[f64], expected: usize) -> Result<()> {
    if values.len() != expected {
        return Err(GeometryError::CountMismatch { what: "parameters", expected, found: values.len() });
    }
    if let Some(index) = values.iter().position(|t| !t.is_finite()) {
        return Err(GeometryError::NotFinite { what: "parameter", index, of });
    }
    match values.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(index) => Err(GeometryError::ParametersNotIncreasing { index: index + 1 }),
        None => Ok(()),
    }
}

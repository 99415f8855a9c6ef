//! Half-spaces as nodes: all that is below a plane.

use serde::Deserialize;
use serde_json::Value;

use crate::exact::{Plane, PlaneFault};
use crate::field::Formula;

/// A node's own keys: one of them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    /// `[a, b, c, d]`: a x + b y + c z = d.
    plane: Option<[f64; 4]>,
    /// Three points, counter-clockwise seen from above.
    points: Option<[[f64; 3]; 3]>,
}

/// All that is below a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub(super) plane: Plane,
}

impl HalfSpace {
    /// From a node's own keys, or what is wrong with them.
    pub(super) fn parse(keys: Value) -> Result<Self, String> {
        let keys: Keys = serde_json::from_value(keys).map_err(|error| error.to_string())?;
        let told = |fault: PlaneFault| fault.to_string();
        let plane = match (keys.plane, keys.points) {
            (Some([a, b, c, d]), None) => Plane::new([a, b, c], d).map_err(told)?,
            (None, Some([p, q, r])) => Plane::through(p, q, r).map_err(told)?,
            _ => {
                return Err(
                    "a half-space has `plane`: [a, b, c, d] (a x + b y + c z <= d), or `points`: three"
                        .into(),
                );
            }
        };
        Ok(Self { plane })
    }

    /// The distance from the plane, positive below it, as a formula.
    pub(super) fn formula(&self) -> Result<Formula, crate::field::FormulaError> {
        let (normal, point) = (self.plane.normal(), self.plane.point());
        let [a, b, c] = normal;
        let offset: f64 = (0..3).map(|k| normal[k] * point[k]).sum();
        Formula::parse(&format!("({offset:?}) - ({a:?}) * x - ({b:?}) * y - ({c:?}) * z"))
    }
}

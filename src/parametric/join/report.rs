//! What joining two curves has come to.

use super::metric::JoinMetric;
use crate::parametric::curve::nurbs::NurbsCurve;
use crate::parametric::curve::param_curve::Curve;
use crate::parametric::numeric::vector;

/// How near a joined curve is to the two it replaces, and what became of the constraints.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct JoinReport {
    /// Parameter of the joint on the joined curve.
    pub joint: f64,
    /// The discrete metric: the sum of the squared changes of the control points.
    pub discrete: f64,
    /// The integral metric: the integral of the squared change of both curves over 0..1.
    pub integral: f64,
    /// Greatest distance between the first curve and its replacement at the same parameter, and the same for the second.
    pub largest_deviation: [f64; 2],
    /// Control points' worth of freedom that the constraints left.
    pub freedom: usize,
    /// The constraints in the order given: what is kept whole, the ends, then single parameters.
    pub constraints: Vec<ConstraintReport>,
}

impl JoinReport {
    /// The value of one of the metrics.
    #[must_use]
    pub fn metric(&self, metric: JoinMetric) -> f64 {
        match metric {
            JoinMetric::Discrete => self.discrete,
            JoinMetric::Integral => self.integral,
        }
    }
}

/// One constraint.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConstraintReport {
    /// What it keeps: "start of P fixed", "derivative 1 of P at 0.4".
    pub name: String,
    /// How far it is missed, in units of the curves' size; its equation scaled to coefficients of length 1.
    pub residual: f64,
    /// The constraints it follows from; empty if it counts by itself.
    pub follows_from: Vec<String>,
}

/// Greatest distance of a curve from the origin, to nine digits: hulls bound it from above, points from below.
pub(crate) fn largest_norm<const D: usize>(curve: &NurbsCurve<D>) -> f64 {
    let mut best = curve.domain().map(|t| vector::norm(curve.point(t))).into_iter().fold(0.0, f64::max);
    let mut pending: Vec<[f64; 2]> = curve.breaks().windows(2).map(|piece| [piece[0], piece[1]]).collect();
    let mut polygon = Vec::new();
    while let Some([a, b]) = pending.pop() {
        polygon.clear();
        curve.control_polygon(a, b, &mut polygon);
        let middle = 0.5 * (a + b);
        best = best.max(vector::norm(curve.point(middle)));
        let bound = polygon.iter().map(|p| vector::norm(*p)).fold(0.0, f64::max);
        if bound > best * (1.0 + 1e-9) + 1e-300 && a < middle && middle < b {
            pending.extend([[a, middle], [middle, b]]);
        }
    }
    best
}

//! Writing.

use serde_json::{Value, json};

use crate::parametric::{Bezier, NurbsCurve, Patch, Polygons};

fn points<const D: usize>(points: &[[f64; D]]) -> Vec<Vec<f64>> {
    points.iter().map(|p| p.to_vec()).collect()
}

/// A Bezier curve as [`curve`](super::curve()) reads it. Numbers keep all their digits.
#[must_use]
pub fn bezier_to_json<const D: usize>(curve: &Bezier<D>) -> Value {
    json!({ "type": "bezier", "points": points(curve.control()) })
}

/// A B-spline or NURBS curve as [`curve`](super::curve()) reads it.
#[must_use]
pub fn bspline_to_json<const D: usize>(curve: &NurbsCurve<D>) -> Value {
    let mut value = json!({
        "type": "bspline",
        "degree": curve.degree(),
        "knots": curve.knots(),
        "points": points(curve.control()),
    });
    if let Some(weights) = curve.weights() {
        value["weights"] = json!(weights);
    }
    value
}

/// A region as [`region`](super::region()) reads it: one polygon per contour.
#[must_use]
pub fn region_to_json(region: &Polygons) -> Value {
    let contour = |c: &[[f64; 2]]| json!({ "type": "polyline", "closed": true, "points": points(c) });
    json!({ "type": "region", "contours": region.contours().map(contour).collect::<Vec<_>>() })
}

/// A patch as [`patch`](super::patch()) reads it.
#[must_use]
pub fn patch_to_json(patch: &Patch) -> Value {
    let rows: Vec<_> = patch.rows().map(points).collect();
    let mut value = json!({
        "type": "bspline",
        "degrees": patch.degrees(),
        "knots": patch.knots(),
        "points": rows,
    });
    if let Some(weights) = patch.weights() {
        value["weights"] = json!(weights.collect::<Vec<_>>());
    }
    value
}

//! Contours in a model file: polygons, or Bezier curves made into polygons.

use serde::Deserialize;

use crate::field::Contours;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    /// Closed polygons.
    polygons: Option<Vec<Vec<[f64; 2]>>>,
    /// Closed contours, each of Bezier curves end to end, each curve a list of control points.
    bezier: Option<Vec<Vec<Vec<[f64; 2]>>>>,
    /// Nodes on each contour to begin with.
    initial_nodes: Option<usize>,
    /// The largest deviation of an edge from the curve.
    tolerance: Option<f64>,
}

pub(super) fn parse(fields: serde_json::Value) -> Result<Contours, String> {
    let fields: Fields = serde_json::from_value(fields).map_err(|error| error.to_string())?;
    let loops = match (fields.polygons, fields.bezier) {
        (Some(polygons), None) => polygons.into_iter().map(opened).collect(),
        (None, Some(contours)) => {
            let tolerance = fields.tolerance.unwrap_or(1e-3);
            if !(tolerance > 0.0 && tolerance.is_finite()) {
                return Err("the tolerance must be positive".to_owned());
            }
            let nodes = fields.initial_nodes.unwrap_or(16);
            if !(2..=1_000_000).contains(&nodes) {
                return Err("`initial_nodes` must be from 2 to a million".to_owned());
            }
            contours.iter().map(|curves| polygon(curves, nodes, tolerance)).collect::<Result<_, _>>()?
        }
        _ => return Err("a contour needs `polygons` or `bezier`, and not both".to_owned()),
    };
    let contours = Contours { loops };
    crate::field::ContourDistance::new(&contours).map_err(|error| error.to_string())?;
    Ok(contours)
}

/// A polygon that repeats its first point at the end, without the repetition.
fn opened(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    points
}

/// The algorithm nonuniform-curve-mesh of Choporov 2017: uniform edges in the parameter, halved where they deviate.
fn polygon(curves: &[Vec<[f64; 2]>], nodes: usize, tolerance: f64) -> Result<Vec<[f64; 2]>, String> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for (number, curve) in curves.iter().enumerate() {
        let next = &curves[(number + 1) % curves.len()];
        if curve.len() < 2 {
            return Err(format!("curve {} needs at least two control points", number + 1));
        }
        if curve.last() != next.first() {
            return Err(format!("curve {} does not end where the next one begins", number + 1));
        }
        let pieces = (nodes - 1).div_ceil(curves.len());
        let mut edges: Vec<(f64, f64)> =
            (0..pieces).map(|k| (k as f64 / pieces as f64, (k + 1) as f64 / pieces as f64)).rev().collect();
        while let Some((from, to)) = edges.pop() {
            let middle = (from + to) * 0.5;
            if to - from > 1e-6 && deviates(curve, from, to, tolerance) {
                edges.push((middle, to));
                edges.push((from, middle));
            } else {
                points.push(at(curve, from));
            }
        }
    }
    points.dedup();
    Ok(opened(points))
}

/// Whether the curve leaves its chord by more than `tolerance` between two parameters.
fn deviates(curve: &[[f64; 2]], from: f64, to: f64, tolerance: f64) -> bool {
    let [a, b] = [at(curve, from), at(curve, to)].map(|[x, y]| [x, y, 0.0]);
    [0.25, 0.5, 0.75].iter().any(|part| {
        let [x, y] = at(curve, from + (to - from) * part);
        let (foot, _) = crate::spatial::closest_on_segment([x, y, 0.0], a, b);
        (x - foot[0]).hypot(y - foot[1]) > tolerance
    })
}

/// De Casteljau.
fn at(curve: &[[f64; 2]], parameter: f64) -> [f64; 2] {
    let mut points = curve.to_vec();
    while points.len() > 1 {
        for k in 0..points.len() - 1 {
            for axis in 0..2 {
                points[k][axis] += (points[k + 1][axis] - points[k][axis]) * parameter;
            }
        }
        points.pop();
    }
    points[0]
}

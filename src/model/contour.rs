//! Plane regions in a model file: polygons, or curves made into polygons when the model is evaluated.

use serde::Deserialize;
use serde_json::Value;

use crate::Error;
use crate::field::{ContourDistance, Contours};

/// The outline of a plane region.
#[derive(Clone, Debug)]
pub(super) enum PlaneRegion {
    Polygons(Contours),
    #[cfg(feature = "parametric")]
    Curves(super::parametric::Curves),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ContourFields {
    /// Closed polygons.
    polygons: Option<Vec<Vec<[f64; 2]>>>,
    /// Closed contours, each of Bezier curves end to end, each curve a list of control points.
    bezier: Option<Vec<Vec<Vec<[f64; 2]>>>>,
    /// Nodes on each contour to begin with.
    initial_nodes: Option<usize>,
}

/// Reads a node of the kind `contour`.
pub(super) fn contour(fields: Value) -> Result<PlaneRegion, Error> {
    let fault = |what: String| Error::Model(what);
    let fields: ContourFields = serde_json::from_value(fields).map_err(|error| fault(error.to_string()))?;
    match (fields.polygons, fields.bezier) {
        (Some(polygons), None) => {
            let contours = Contours { loops: polygons.into_iter().map(opened).collect() };
            ContourDistance::new(&contours)?;
            Ok(PlaneRegion::Polygons(contours))
        }
        (None, Some(contours)) => bezier(&contours, fields.initial_nodes),
        _ => Err(fault("a contour needs `polygons` or `bezier`, and not both".to_owned())),
    }
}

#[cfg(feature = "parametric")]
fn bezier(contours: &[Vec<Vec<[f64; 2]>>], nodes: Option<usize>) -> Result<PlaneRegion, Error> {
    Ok(PlaneRegion::Curves(super::parametric::Curves::bezier(contours, nodes)?))
}

#[cfg(not(feature = "parametric"))]
fn bezier(_: &[Vec<Vec<[f64; 2]>>], _: Option<usize>) -> Result<PlaneRegion, Error> {
    Err(super::without_parametric("bezier"))
}

impl PlaneRegion {
    /// The region's boundary, curves as polygons within `tolerance` (a thousandth of the region's size without).
    pub(super) fn contours(&self, tolerance: Option<f64>) -> Result<Contours, Error> {
        match self {
            Self::Polygons(contours) => {
                let _ = tolerance;
                Ok(contours.clone())
            }
            #[cfg(feature = "parametric")]
            Self::Curves(curves) => curves.contours(tolerance),
        }
    }
}

/// A polygon that repeats its first point at the end, without the repetition.
fn opened(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    points
}

//! Plane regions.

use std::sync::Arc;

use serde::Deserialize;
use serde_json::Value;

use super::{JsonNode, curve};
use crate::parametric::error::{GeometryError, Result};
use crate::parametric::file::svg::curves_of_path;
use crate::parametric::{Curve, CurveMeshing, FillRule, Polygons, Region, RegionOperation, SharedCurve};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RegionSpec {
    contours: Vec<Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RectangleSpec {
    low: [f64; 2],
    high: [f64; 2],
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "lowercase")]
enum RuleSpec {
    EvenOdd,
    #[default]
    NonZero,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SvgSpec {
    d: String,
    #[serde(default)]
    fill_rule: RuleSpec,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OperationSpec {
    regions: Vec<Value>,
}

const TYPES: [&str; 7] = ["region", "rectangle", "svg_path", "union", "intersection", "difference", "xor"];

/// Reads a region, its curves meshed by `meshing`; operations are carried out exactly on the polygons.
///
/// # Errors
/// As [`curve`](super::curve()); [`GeometryError::NotClosed`] for an open contour.
pub fn region(value: &Value, meshing: &CurveMeshing) -> Result<Polygons> {
    read(&JsonNode::root(value), meshing)
}

pub(crate) fn read(node: &JsonNode<'_>, meshing: &CurveMeshing) -> Result<Polygons> {
    let name = node.type_name()?;
    let operation = match name {
        "region" => {
            let spec: RegionSpec = node.members()?;
            let pointer = format!("{}/contours", node.pointer);
            let contours = spec.contours.iter().enumerate();
            let contours = contours
                .map(|(i, c)| curve::read_plane(&JsonNode::child(c, &pointer, i)))
                .collect::<Result<Vec<_>>>()?;
            return node.place(Region::new(&contours).and_then(|region| region.polygons(meshing)));
        }
        "rectangle" => {
            let spec: RectangleSpec = node.members()?;
            return node.place(Polygons::rectangle(spec.low, spec.high));
        }
        "svg_path" => {
            let spec: SvgSpec = node.members()?;
            return node.place(from_svg(&spec, meshing));
        }
        "union" => RegionOperation::Union,
        "intersection" => RegionOperation::Intersection,
        "difference" => RegionOperation::Difference,
        "xor" => RegionOperation::SymmetricDifference,
        // A closed curve is the region inside it.
        other if curve::read_plane(node).is_ok_and(|curve| curve.is_closed()) => {
            let _ = other;
            let contour: SharedCurve<2> = curve::read_plane(node)?;
            return node.place(Region::new(&[contour]).and_then(|region| region.polygons(meshing)));
        }
        other => return Err(node.unknown_type(other, "region", &TYPES)),
    };
    let spec: OperationSpec = node.members()?;
    let pointer = format!("{}/regions", node.pointer);
    let mut operands = Vec::new();
    for (i, operand) in spec.regions.iter().enumerate() {
        operands.push(read(&JsonNode::child(operand, &pointer, i), meshing)?);
    }
    let first =
        if operands.is_empty() { return Err(node.fault("\"regions\" is empty")) } else { operands.remove(0) };
    Ok(operands.iter().fold(first, |sum, operand| sum.combined(operation, operand)))
}

fn from_svg(spec: &SvgSpec, meshing: &CurveMeshing) -> Result<Polygons> {
    let found = curves_of_path(&spec.d)?;
    if let Some(open) = found.open.first() {
        let [start, end] = open.domain().map(|t| open.point(t));
        let distance = (start[0] - end[0]).hypot(start[1] - end[1]);
        return Err(GeometryError::NotClosed { distance, place: start.to_vec() });
    }
    let mut contours = Vec::new();
    for contour in found.closed {
        let contour: SharedCurve<2> = Arc::new(contour);
        let mut points = meshing.mesh(contour.as_ref())?.points;
        points.pop();
        contours.push(points);
    }
    let rule = match spec.fill_rule {
        RuleSpec::EvenOdd => FillRule::EvenOdd,
        RuleSpec::NonZero => FillRule::NonZero,
    };
    Polygons::new(&contours, rule)
}

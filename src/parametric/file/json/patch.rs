//! Surface patches.

use serde::Deserialize;
use serde_json::Value;

use super::{JsonNode, curve};
use crate::parametric::Patch;
use crate::parametric::error::Result;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BezierSpec {
    points: Vec<Vec<[f64; 3]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BsplineSpec {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    points: Vec<Vec<[f64; 3]>>,
    weights: Option<Vec<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaneSpec {
    origin: [f64; 3],
    a: [f64; 3],
    b: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoundSpec {
    center: [f64; 3],
    radius: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConeSpec {
    base: [f64; 3],
    radii: [f64; 2],
    height: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CylinderSpec {
    base: [f64; 3],
    radius: f64,
    height: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TorusSpec {
    center: [f64; 3],
    radii: [f64; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RuledSpec {
    first: Value,
    second: Value,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExtrudedSpec {
    curve: Value,
    vector: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RevolvedSpec {
    curve: Value,
    origin: [f64; 3],
    direction: [f64; 3],
    #[serde(default = "full_turn")]
    angle: f64,
}

fn full_turn() -> f64 {
    360.0
}

/// A list of patch descriptions.
#[derive(Deserialize)]
struct Listed {
    patches: Vec<Value>,
}

const TYPES: [&str; 11] = [
    "bezier", "bspline", "plane", "sphere", "cylinder", "cone", "disc", "torus", "ruled", "extruded",
    "revolved",
];

/// Reads a patch.
///
/// # Errors
/// As [`curve`](super::curve()).
pub fn patch(value: &Value) -> Result<Patch> {
    read(&JsonNode::root(value))
}

/// Reads the patches of an object with a member `"patches"`, each with its `"name"` (or its number).
///
/// # Errors
/// As [`curve`](super::curve()).
pub fn named_patches(value: &Value) -> Result<Vec<(String, Patch)>> {
    let root = JsonNode::root(value);
    let listed: Listed = root.members()?;
    list(&listed.patches, "/patches")
}

pub(crate) fn list(patches: &[Value], pointer: &str) -> Result<Vec<(String, Patch)>> {
    let named = |(i, value): (usize, &Value)| {
        let name =
            value.get("name").and_then(Value::as_str).map_or_else(|| format!("patch {i}"), str::to_owned);
        Ok((name, read(&JsonNode::child(value, pointer, i))?))
    };
    patches.iter().enumerate().map(named).collect()
}

fn read(node: &JsonNode<'_>) -> Result<Patch> {
    let inner = |value: &Value, name: &str| curve::read_space(&JsonNode::child(value, &node.pointer, name));
    match node.type_name()? {
        "bezier" => {
            let spec: BezierSpec = node.members()?;
            node.place(Patch::bezier(&spec.points))
        }
        "bspline" => {
            let spec: BsplineSpec = node.members()?;
            let knots = [spec.knots[0].as_slice(), spec.knots[1].as_slice()];
            node.place(match &spec.weights {
                None => Patch::bspline(spec.degrees, knots, &spec.points),
                Some(weights) => Patch::nurbs(spec.degrees, knots, &spec.points, weights),
            })
        }
        "plane" => {
            let spec: PlaneSpec = node.members()?;
            node.place(Patch::plane(spec.origin, spec.a, spec.b))
        }
        "sphere" => {
            let spec: RoundSpec = node.members()?;
            node.place(Patch::sphere(spec.center, spec.radius))
        }
        "disc" => {
            let spec: RoundSpec = node.members()?;
            node.place(Patch::disc(spec.center, spec.radius))
        }
        "cylinder" => {
            let spec: CylinderSpec = node.members()?;
            node.place(Patch::cylinder(spec.base, spec.radius, spec.height))
        }
        "cone" => {
            let spec: ConeSpec = node.members()?;
            node.place(Patch::cone(spec.base, spec.radii, spec.height))
        }
        "torus" => {
            let spec: TorusSpec = node.members()?;
            node.place(Patch::torus(spec.center, spec.radii[0], spec.radii[1]))
        }
        "ruled" => {
            let spec: RuledSpec = node.members()?;
            let (first, second) = (inner(&spec.first, "first")?, inner(&spec.second, "second")?);
            Ok(Patch::ruled(first.as_ref(), second.as_ref()))
        }
        "extruded" => {
            let spec: ExtrudedSpec = node.members()?;
            node.place(Patch::extruded(inner(&spec.curve, "curve")?.as_ref(), spec.vector))
        }
        "revolved" => {
            let spec: RevolvedSpec = node.members()?;
            let profile = inner(&spec.curve, "curve")?;
            let angle = spec.angle.to_radians();
            node.place(Patch::revolved(profile.as_ref(), spec.origin, spec.direction, angle))
        }
        other => Err(node.unknown_type(other, "patch", &TYPES)),
    }
}

//! Solids made of regions and patches: leaves of model files.

use serde::Deserialize;
use serde_json::Value;

use super::{JsonNode, curve, patch, region};
use crate::parametric::{CurveMeshing, Extrusion, PatchMeshing, Revolution, Sweep};
use crate::{Control, Error, Mesh};

/// The types of solids this module reads.
pub const SOLID_TYPES: [&str; 4] = ["extrusion", "revolution", "sweep", "patches"];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExtrusionSpec {
    region: Value,
    tolerance: f64,
    height: f64,
    #[serde(default)]
    twist: f64,
    #[serde(default = "one")]
    top_scale: f64,
    #[serde(default)]
    center: [f64; 2],
}

fn one() -> f64 {
    1.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RevolutionSpec {
    region: Value,
    tolerance: f64,
    #[serde(default = "full_turn")]
    angle: f64,
}

fn full_turn() -> f64 {
    360.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SweepSpec {
    region: Value,
    path: Value,
    tolerance: f64,
    up: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PatchesSpec {
    patches: Vec<Value>,
    tolerance: f64,
    join_tolerance: Option<f64>,
}

/// Reads a solid of one of [`SOLID_TYPES`] and makes its closed mesh.
///
/// # Errors
/// As [`curve`](super::curve()), and those of the construction; limits of `control`.
pub fn solid(value: &Value, control: &Control) -> Result<Mesh, Error> {
    let node = JsonNode::root(value);
    let child = |value, name| JsonNode { value, pointer: format!("/{name}") };
    Ok(match node.type_name()? {
        "extrusion" => {
            let spec: ExtrusionSpec = node.members()?;
            let section = region::read(&child(&spec.region, "region"), &CurveMeshing::new(spec.tolerance))?;
            let mut extrusion = Extrusion::new(spec.height).taper(spec.top_scale).about(spec.center);
            if spec.twist != 0.0 {
                extrusion = extrusion.twist(spec.twist.to_radians(), spec.tolerance);
            }
            node.place(extrusion.mesh(&section))?
        }
        "revolution" => {
            let spec: RevolutionSpec = node.members()?;
            let section = region::read(&child(&spec.region, "region"), &CurveMeshing::new(spec.tolerance))?;
            node.place(Revolution::new(spec.tolerance).angle(spec.angle.to_radians()).mesh(&section))?
        }
        "sweep" => {
            let spec: SweepSpec = node.members()?;
            let section = region::read(&child(&spec.region, "region"), &CurveMeshing::new(spec.tolerance))?;
            let path = curve::read_space(&child(&spec.path, "path"))?;
            let sweep = Sweep::new(spec.tolerance);
            let sweep = if let Some(up) = spec.up { sweep.up(up) } else { sweep };
            node.place(sweep.mesh(&section, path.as_ref()))?
        }
        "patches" => {
            let spec: PatchesSpec = node.members()?;
            let (names, patches): (Vec<_>, Vec<_>) =
                patch::list(&spec.patches, "/patches")?.into_iter().unzip();
            let mut meshing = PatchMeshing::new(spec.tolerance).control(control.clone());
            if let Some(distance) = spec.join_tolerance {
                meshing = meshing.join_tolerance(distance);
            }
            let mut mesh = meshing.closed(&patches)?.mesh;
            for (group, name) in mesh.groups.list.iter_mut().zip(names) {
                group.name = name;
            }
            mesh
        }
        other => Err(node.unknown_type(other, "solid", &SOLID_TYPES))?,
    })
}

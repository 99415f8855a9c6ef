//! Parametric leaves of model files: patches, extrusions, revolutions and sweeps as solids; regions bounded by curves
//! in the plane. What they say is read by [`crate::parametric::json`].

use std::path::Path;

use serde_json::{Map, Value, json};

use super::fault;
use crate::field::Contours;
use crate::parametric::json::{SOLID_TYPES, parse, region, solid};
use crate::parametric::{CurveMeshing, Refinement};
use crate::{Control, Error, Mesh};

/// Default tolerance, in units of the size of a description.
const DEFAULT_TOLERANCE: f64 = 1e-3;

/// A solid described by patches or by a moved region.
#[derive(Clone, Debug)]
pub(super) struct Parametric {
    /// As documented for [`solid`], except that the tolerance may be missing.
    description: Value,
}

/// A plane region bounded by curves.
#[derive(Clone, Debug)]
pub(super) struct Curves {
    /// As documented for [`region()`].
    description: Value,
    /// Nodes to begin with on every curve; the paper's rule then adds more.
    nodes: Option<usize>,
}

/// What a file describes.
pub(super) enum Described {
    Solid(Parametric),
    Region(Curves),
}

/// The solid or region in a JSON file.
pub(super) fn load(folder: &Path, file: &str) -> Result<Described, Error> {
    let path = folder.join(file);
    let text = std::fs::read_to_string(&path).map_err(|source| Error::File {
        action: "read",
        path: path.clone(),
        source,
    })?;
    let description = parse(&text).map_err(|error| fault(format!("{}: {error}", path.display())))?;
    let is_solid = description["type"].as_str().is_some_and(|name| SOLID_TYPES.contains(&name));
    if is_solid {
        Parametric::new(description).map(Described::Solid)
    } else {
        Ok(Described::Region(Curves::new(description)))
    }
}

impl Parametric {
    /// The solid of the type `name` that a node's own keys describe.
    pub(super) fn of_type(name: &str, mut object: Map<String, Value>) -> Result<Self, Error> {
        object.insert("type".to_owned(), name.into());
        Self::new(Value::Object(object))
    }

    fn new(description: Value) -> Result<Self, Error> {
        match &description["tolerance"] {
            Value::Null => {}
            given if given.as_f64().is_some_and(|value| value > 0.0 && value.is_finite()) => {}
            _ => return Err(fault("`tolerance` must be positive")),
        }
        Ok(Self { description })
    }

    /// The closed mesh, within `tolerance`, or else its own, or else a thousandth of its size.
    pub(super) fn mesh(&self, tolerance: Option<f64>, control: &Control) -> Result<Mesh, Error> {
        let mut description = self.description.clone();
        let own = description["tolerance"].as_f64();
        let tolerance = tolerance.or(own).unwrap_or_else(|| DEFAULT_TOLERANCE * size(&description));
        description["tolerance"] = tolerance.into();
        solid(&description, control)
    }
}

impl Curves {
    /// A region as [`region()`] takes it.
    pub(super) fn new(description: Value) -> Self {
        Self { description, nodes: None }
    }

    /// Closed contours, each of Bezier curves end to end.
    pub(super) fn bezier(contours: &[Vec<Vec<[f64; 2]>>], nodes: Option<usize>) -> Result<Self, Error> {
        if nodes.is_some_and(|nodes| !(2..=1_000_000).contains(&nodes)) {
            return Err(fault("`initial_nodes` must be from 2 to a million"));
        }
        let contour = |curves: &Vec<Vec<[f64; 2]>>| {
            let segments: Vec<Value> =
                curves.iter().map(|points| json!({ "type": "bezier", "points": points })).collect();
            json!({ "type": "composite", "closed": true, "segments": segments })
        };
        let contours: Vec<Value> = contours.iter().map(contour).collect();
        Ok(Self { description: json!({ "type": "region", "contours": contours }), nodes })
    }

    /// The boundary as polygons, outer ones counter-clockwise.
    pub(super) fn contours(&self, tolerance: Option<f64>) -> Result<Contours, Error> {
        let tolerance = tolerance.unwrap_or_else(|| DEFAULT_TOLERANCE * size(&self.description));
        let mut meshing = CurveMeshing::new(tolerance);
        if let Some(nodes) = self.nodes {
            meshing = meshing.initial_nodes(nodes).refinement(Refinement::Halving);
        }
        let polygons = region(&self.description, &meshing)?;
        Ok(Contours { loops: polygons.contours().map(<[_]>::to_vec).collect() })
    }
}

/// The largest difference of two coordinates of the points that a description lists, or its largest length.
fn size(description: &Value) -> f64 {
    fn walk(value: &Value, name: &str, low: &mut [f64; 3], high: &mut [f64; 3], length: &mut f64) {
        match value {
            Value::Array(items) if items.iter().all(Value::is_number) && items.len() <= 3 => {
                for (k, x) in items.iter().filter_map(Value::as_f64).enumerate() {
                    low[k] = low[k].min(x);
                    high[k] = high[k].max(x);
                }
            }
            Value::Array(items) => items.iter().for_each(|item| walk(item, name, low, high, length)),
            Value::Object(members) => {
                members.iter().for_each(|(name, member)| walk(member, name, low, high, length));
            }
            Value::Number(number) if matches!(name, "radius" | "height") => {
                *length = length.max(number.as_f64().unwrap_or(0.0));
            }
            _ => {}
        }
    }
    let (mut low, mut high, mut length) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0.0);
    walk(description, "", &mut low, &mut high, &mut length);
    (0..3).map(|k| high[k] - low[k]).fold(length, f64::max)
}

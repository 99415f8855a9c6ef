//! From JSON to a checked model.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use serde_json::{Map, Value};

#[cfg(feature = "parametric")]
use super::contour::PlaneRegion;
use super::cuts::{self, Cut, MeshFile};
use super::half_space::HalfSpace;
#[cfg(feature = "parametric")]
use super::parametric::{self, Curves, Described, Parametric};
use super::{
    Defaults, Kind, Mode, Model, Node, contour, fault, made, primitive, references, take, transform,
};
use crate::Error;
use crate::boolean::Operation;
use crate::field::{Formula, System, named_system};
use crate::io::Format;

/// How the names of kinds begin that a [`LeafKind`](super::LeafKind) evaluates.
const CUSTOM: &str = "x-";
/// Kinds of solids that are described as in `docs/parametric.md`.
const PARAMETRIC: [&str; 4] = ["patches", "extrusion", "revolution", "sweep"];
const KINDS: &str = "union, intersection, difference, xor, complement, mesh, box, sphere, cylinder, cone, torus, half_space, \
                     formula, contour, region, patches, extrusion, revolution, sweep, parametric, \
                     freeform, hull, minkowski, offset, hollow, pattern, text, solidify, split, trim";

struct ModelReader<'a> {
    nodes: Vec<Node>,
    names: BTreeMap<String, usize>,
    folder: &'a Path,
}

/// A node's keys that all kinds have; its kind is still to come.
fn common(object: &mut Map<String, Value>, label: &str) -> Result<Node, Error> {
    let _: (Option<String>, Option<Value>) = (take(object, "name")?, take(object, "about")?);
    let mode: Option<String> = take(object, "evaluate")?;
    let mode = match mode.as_deref() {
        None => None,
        Some("exact") => Some(Mode::Exact),
        Some("field") => Some(Mode::Field),
        Some("freeform") => Some(Mode::FreeForm),
        Some(other) => {
            return Err(fault(format!("`evaluate` is `exact`, `field` or `freeform`, not `{other}`")));
        }
    };
    let extrude = match take(object, "extrude")? {
        None => None,
        Some(Height::Upward(height)) => Some([0.0, height]),
        Some(Height::Between(between)) => Some(between),
    };
    if extrude.is_some_and(|[low, high]| !(low < high && (high - low).is_finite())) {
        return Err(fault("`extrude` needs a positive height, or two heights, the lower first"));
    }
    let steps: Vec<transform::Step> = take(object, "transform")?.unwrap_or_default();
    let system: Option<String> = take(object, "system")?;
    let node = Node {
        label: label.to_owned(),
        kind: Kind::Reference(String::new(), usize::MAX),
        extrude,
        transform: transform::of(&steps).map_err(fault)?,
        mode,
        system: system.map(|name| system_of(&name)).transpose()?,
        tolerance: take(object, "tolerance")?,
        smooth: take(object, "smooth")?,
        bounds: take(object, "bounds")?,
        clip: take(object, "clip")?.unwrap_or(false),
    };
    checked_tolerance(node.tolerance)?;
    checked_bounds(node.bounds)?;
    Ok(node)
}

/// The file that a node names.
fn file_of(object: &mut Map<String, Value>) -> Result<String, Error> {
    take(object, "file")?.ok_or_else(|| fault("`file` is missing"))
}

pub(super) fn model(text: &str, folder: &Path) -> Result<Model, Error> {
    let value: Value = serde_json::from_str(text).map_err(|error| fault(format!("not JSON: {error}")))?;
    let Value::Object(mut object) = value else {
        return Err(fault("a model is an object: a node, or { \"nodes\": {...}, \"result\": ... }"));
    };
    let mut reading = ModelReader { nodes: Vec::new(), names: BTreeMap::new(), folder };
    let mut defaults = Defaults::default();
    let result = if object.contains_key("result") || object.contains_key("nodes") {
        defaults = defaults_of(&mut object)?;
        let named: Map<String, Value> = take(&mut object, "nodes")?.unwrap_or_default();
        // Names first, so that nodes may refer to later ones.
        let mut pending = Vec::new();
        for (name, value) in named {
            let label = format!("`{name}` (/nodes/{name})");
            let index = reading.placeholder(&label);
            reading.names.insert(name, index);
            pending.push((index, label, value));
        }
        let result =
            object.remove("result").ok_or_else(|| fault("`result` is missing: the node to evaluate"))?;
        if let Some(key) = object.keys().next() {
            return Err(fault(format!(
                "unknown key `{key}`; known: nodes, result, tolerance, smooth, bounds, system, parameters, about"
            )));
        }
        for (index, label, value) in pending {
            let node = reading.node(value, &label, &format!("/nodes/{}", name_of(&label)))?;
            reading.nodes[index] = node;
        }
        reading.add(result, "/result")?
    } else {
        reading.add(Value::Object(object), "/")?
    };
    let mut model =
        Model { nodes: reading.nodes, names: reading.names, result, folder: folder.to_owned(), defaults };
    references::resolve(&mut model)?;
    references::check_order(&model)?;
    Ok(model)
}

/// The name in a label made of one.
fn name_of(label: &str) -> &str {
    label.split('`').nth(1).unwrap_or("")
}

fn defaults_of(object: &mut Map<String, Value>) -> Result<Defaults, Error> {
    let _: Option<Value> = take(object, "about")?;
    let tolerance = take(object, "tolerance")?;
    let smooth = take(object, "smooth")?;
    let bounds = take(object, "bounds")?;
    let system: Option<String> = take(object, "system")?;
    let parameters: BTreeMap<String, f64> = take(object, "parameters")?.unwrap_or_default();
    checked_tolerance(tolerance)?;
    checked_bounds(bounds)?;
    Ok(Defaults {
        tolerance,
        smooth,
        bounds,
        system: system.map(|name| system_of(&name)).transpose()?,
        parameters: parameters.into_iter().collect(),
    })
}

fn checked_tolerance(tolerance: Option<f64>) -> Result<(), Error> {
    match tolerance {
        Some(value) if !(value > 0.0 && value.is_finite()) => Err(fault("`tolerance` must be positive")),
        _ => Ok(()),
    }
}

fn checked_bounds(bounds: Option<[[f64; 3]; 2]>) -> Result<(), Error> {
    match bounds {
        Some([low, high]) if !(0..3).all(|k| low[k] < high[k] && (high[k] - low[k]).is_finite()) => {
            Err(fault("`bounds` must be two corners, the first below the second in every coordinate"))
        }
        _ => Ok(()),
    }
}

/// A system by its name, such as `R0` or `R0m(2)`.
fn system_of(text: &str) -> Result<System, Error> {
    let (name, number) = match text.split_once('(') {
        None => (text, None),
        Some((name, rest)) => {
            let number = rest.strip_suffix(')').and_then(|digits| digits.trim().parse().ok());
            (name, Some(number.ok_or_else(|| fault(format!("`system`: cannot read `{text}`")))?))
        }
    };
    named_system(name.trim(), number).map_err(|what| fault(format!("`system`: {what}")))
}

fn operation_of(name: &str) -> Option<Operation> {
    name.parse().ok()
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Height {
    Upward(f64),
    Between([f64; 2]),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Text {
    Line(String),
    Lines(Vec<String>),
}

impl ModelReader<'_> {
    fn placeholder(&mut self, label: &str) -> usize {
        self.nodes.push(Node::new(label.to_owned(), Kind::Reference(String::new(), usize::MAX)));
        self.nodes.len() - 1
    }

    /// Adds the node and returns its position.
    fn add(&mut self, value: Value, path: &str) -> Result<usize, Error> {
        let name = value.get("name").and_then(Value::as_str);
        let label = name.map_or_else(|| path.to_owned(), |name| format!("`{name}` ({path})"));
        let node = self.node(value, &label, path)?;
        self.nodes.push(node);
        Ok(self.nodes.len() - 1)
    }

    /// Adds the operands of the node at `path`, each with its place in it.
    fn add_all(&mut self, operands: Vec<(String, Value)>, path: &str) -> Result<Vec<usize>, Error> {
        let path = path.trim_end_matches('/');
        operands.into_iter().map(|(place, value)| self.add(value, &format!("{path}/{place}"))).collect()
    }

    /// A node; its errors, and those of nodes in it that have no label, say that they are of `label`.
    fn node(&mut self, value: Value, label: &str, path: &str) -> Result<Node, Error> {
        self.labelled(value, label, path).map_err(|error| error.in_node(label))
    }

    fn labelled(&mut self, value: Value, label: &str, path: &str) -> Result<Node, Error> {
        match value {
            Value::String(text) => {
                let kind = match extension(&text) {
                    _ if self.names.contains_key(&text) => Kind::Reference(text, usize::MAX),
                    Some("json") => self.described(&text)?,
                    Some(_) => Kind::Mesh(MeshFile::plain(text)),
                    None => Kind::Reference(text, usize::MAX),
                };
                Ok(Node::new(label.to_owned(), kind))
            }
            Value::Object(object) => self.object(object, label, path),
            _ => Err(fault("a node is an object, the name of a node, or the name of a mesh file")),
        }
    }

    fn object(&mut self, mut object: Map<String, Value>, label: &str, path: &str) -> Result<Node, Error> {
        let mut node = common(&mut object, label)?;
        let kind: Option<String> = take(&mut object, "kind")?;
        let operation: Option<String> = take(&mut object, "operation")?;
        let name = match (kind, operation) {
            (Some(kind), None) => kind,
            (None, Some(operation)) if operation_of(&operation).is_some() || operation == "complement" => {
                operation
            }
            (None, Some(operation)) => {
                let what = format!(
                    "unknown operation `{operation}`; known: union, intersection, difference, xor, complement"
                );
                return Err(fault(what));
            }
            (None, None) => {
                return Err(fault(format!("`kind` is missing; known kinds: {KINDS}")));
            }
            (Some(_), Some(_)) => {
                return Err(fault("a node has a `kind` or an `operation`, not both"));
            }
        };
        node.kind = self.kind(&name, object, path)?;
        Ok(node)
    }

    fn kind(&mut self, name: &str, mut object: Map<String, Value>, path: &str) -> Result<Kind, Error> {
        if operation_of(name).is_some() || name == "complement" {
            return self.operation(name, object, path);
        }
        if let Some(primitive) = primitive::parse(name, Value::Object(object.clone())) {
            return primitive.map(Kind::Primitive).map_err(fault);
        }
        let kind = match name {
            "mesh" => Kind::Mesh(MeshFile::take(&mut object)?),
            "half_space" => {
                let keys = Value::Object(std::mem::take(&mut object));
                Kind::HalfSpace(HalfSpace::parse(keys).map_err(fault)?)
            }
            "formula" => {
                let text: Option<Text> = take(&mut object, "formula")?;
                let text = match text.ok_or_else(|| fault("`formula` is missing"))? {
                    Text::Line(line) => line,
                    Text::Lines(lines) => lines.join("\n"),
                };
                let parameters: BTreeMap<String, f64> = take(&mut object, "parameters")?.unwrap_or_default();
                let formula = Formula::parse(&text)?;
                let parameters = parameters.into_iter().collect();
                Kind::Formula { formula: Box::new(formula), parameters, uses: Vec::new() }
            }
            "contour" => {
                let fields = Value::Object(std::mem::take(&mut object));
                Kind::Contour(contour::contour(fields)?)
            }
            "region" => {
                let region = object.remove("region");
                let region = region.ok_or_else(|| fault("`region` is missing"))?;
                region_of(region)?
            }
            "parametric" => {
                let file = file_of(&mut object)?;
                self.described(&file)?
            }
            kind if made::KINDS.contains(&kind) => self.made(kind, &mut object, path)?,
            kind if cuts::KINDS.contains(&kind) => {
                let (cut, operands) = Cut::parse(kind, &mut object)?;
                Kind::Cut(cut, self.add_all(operands, path)?)
            }
            "freeform" => self.cage(std::mem::take(&mut object))?,
            kind if PARAMETRIC.contains(&kind) => solid_of(kind, std::mem::take(&mut object))?,
            kind if kind.starts_with(CUSTOM) => {
                let value = Value::Object(std::mem::take(&mut object));
                Kind::Custom { kind: kind.to_owned(), value }
            }
            _ => return Err(fault(format!("unknown kind `{name}`; known: {KINDS}"))),
        };
        match object.keys().next() {
            Some(key) => Err(fault(format!("unknown key `{key}` for the kind `{name}`"))),
            None => Ok(kind),
        }
    }

    /// What is made of other nodes, or of text.
    fn made(&mut self, kind: &str, object: &mut Map<String, Value>, path: &str) -> Result<Kind, Error> {
        let (made, operands) = made::parse(kind, object)?;
        Ok(Kind::Made(made, self.add_all(operands, path)?))
    }

    /// The solid or region described by a JSON file.
    #[cfg(feature = "parametric")]
    fn described(&self, file: &str) -> Result<Kind, Error> {
        Ok(match parametric::load(self.folder, file)? {
            Described::Solid(solid) => Kind::Parametric(solid),
            Described::Region(curves) => Kind::Contour(PlaneRegion::Curves(curves)),
        })
    }

    #[cfg(not(feature = "parametric"))]
    fn described(&self, file: &str) -> Result<Kind, Error> {
        let _ = self.folder;
        Err(super::without_parametric(file))
    }

    /// A cage of the node's own keys, or of a file.
    #[cfg(feature = "subdivision")]
    fn cage(&self, object: Map<String, Value>) -> Result<Kind, Error> {
        super::cage::Cage::of_node(object, self.folder).map(Box::new).map(Kind::Cage)
    }

    #[cfg(not(feature = "subdivision"))]
    fn cage(&self, _: Map<String, Value>) -> Result<Kind, Error> {
        Err(fault("`freeform` needs a build with the feature `subdivision`"))
    }

    fn operation(&mut self, name: &str, mut object: Map<String, Value>, path: &str) -> Result<Kind, Error> {
        let mut operands: Vec<(String, Value)> = Vec::new();
        match object.remove("operands") {
            Some(Value::Array(list)) => {
                operands
                    .extend(list.into_iter().enumerate().map(|(k, value)| (format!("operands/{k}"), value)));
            }
            Some(_) => return Err(fault("`operands` is a list of nodes")),
            None => {
                for side in ["left", "right"] {
                    operands.extend(object.remove(side).map(|value| (side.to_owned(), value)));
                }
            }
        }
        if let Some(key) = object.keys().next() {
            let what = format!(
                "unknown key `{key}` for the operation `{name}`: it takes `operands`, or `left` and `right`"
            );
            return Err(fault(what));
        }
        let wanted = if name == "complement" { 1..=1 } else { 1..=usize::MAX };
        if !wanted.contains(&operands.len()) {
            let wanted = if name == "complement" { "exactly one operand" } else { "at least one operand" };
            return Err(fault(format!("`{name}` needs {wanted}, but has {}", operands.len())));
        }
        let operands = self.add_all(operands, path)?;
        Ok(match operation_of(name) {
            Some(operation) => Kind::Operation(operation, operands),
            None => Kind::Complement(operands[0]),
        })
    }
}

impl Node {
    fn new(label: String, kind: Kind) -> Self {
        Self {
            label,
            kind,
            extrude: None,
            transform: glam::DAffine3::IDENTITY,
            mode: None,
            system: None,
            tolerance: None,
            smooth: None,
            bounds: None,
            clip: false,
        }
    }
}

#[cfg(feature = "parametric")]
fn solid_of(kind: &str, object: Map<String, Value>) -> Result<Kind, Error> {
    Parametric::of_type(kind, object).map(Kind::Parametric)
}

#[cfg(not(feature = "parametric"))]
fn solid_of(kind: &str, _: Map<String, Value>) -> Result<Kind, Error> {
    Err(super::without_parametric(kind))
}

#[cfg(feature = "parametric")]
fn region_of(description: Value) -> Result<Kind, Error> {
    Ok(Kind::Contour(PlaneRegion::Curves(Curves::new(description))))
}

#[cfg(not(feature = "parametric"))]
fn region_of(_: Value) -> Result<Kind, Error> {
    Err(super::without_parametric("region"))
}

/// The ending of a name that looks like a mesh file or a description of a solid.
fn extension(text: &str) -> Option<&'static str> {
    let path = Path::new(text);
    if path.extension()?.eq_ignore_ascii_case("json") {
        return Some("json");
    }
    Format::from_path(path).map(Format::extension)
}

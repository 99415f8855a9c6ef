//! Curves, regions, patches and solids as JSON. The shapes are documented in `docs/parametric.md`.
//!
//! Every object names its kind in `"type"`. Members that a kind does not have are refused, so that a misspelt one is
//! not silently ignored; every error says where, as a JSON pointer. Angles in files are in degrees.

mod curve;
mod patch;
mod region;
mod solid;
mod write;

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::parametric::error::{GeometryError, Result};

pub use curve::{AnyCurve, curve};
pub use patch::{named_patches, patch};
pub use region::region;
pub use solid::{SOLID_TYPES, solid};
pub use write::{bezier_to_json, bspline_to_json, patch_to_json, region_to_json};

/// Reads JSON text.
///
/// # Errors
/// [`GeometryError::Json`] with line and column.
pub fn parse(text: &str) -> Result<Value> {
    serde_json::from_str(text).map_err(|error| GeometryError::Json {
        place: format!("line {}, column {}", error.line(), error.column()),
        what: "not valid JSON: ".to_owned() + &syntax(&error),
    })
}

/// The message without the position, which is given separately.
fn syntax(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.split(" at line ").next().unwrap_or(&text).to_owned()
}

/// A JSON object under examination, with the pointer to it.
pub(crate) struct JsonNode<'a> {
    pub(crate) value: &'a Value,
    pub(crate) pointer: String,
}

impl<'a> JsonNode<'a> {
    pub(crate) fn root(value: &'a Value) -> Self {
        Self { value, pointer: String::new() }
    }

    pub(crate) fn child(value: &'a Value, parent: &str, name: impl std::fmt::Display) -> Self {
        Self { value, pointer: format!("{parent}/{name}") }
    }

    pub(crate) fn fault(&self, what: impl Into<String>) -> GeometryError {
        GeometryError::Json { place: self.pointer.clone(), what: what.into() }
    }

    fn object(&self) -> Result<&'a Map<String, Value>> {
        self.value
            .as_object()
            .ok_or_else(|| self.fault(format!("expected an object, found {}", kind(self.value))))
    }

    /// The value of `"type"`.
    pub(crate) fn type_name(&self) -> Result<&'a str> {
        match self.object()?.get("type") {
            Some(Value::String(name)) => Ok(name),
            Some(other) => Err(self.fault(format!("\"type\" must be a string, found {}", kind(other)))),
            None => Err(self.fault("\"type\" is missing")),
        }
    }

    /// The members besides `"type"` and `"name"`, read into `T`.
    pub(crate) fn members<T: DeserializeOwned>(&self) -> Result<T> {
        let mut members = self.object()?.clone();
        members.remove("type");
        members.remove("name");
        serde_path_to_error::deserialize(Value::Object(members)).map_err(|error| {
            let path = error.path().to_string();
            let steps = if path == "." { String::new() } else { pointer_of(&path) };
            GeometryError::Json { place: self.pointer.clone() + &steps, what: error.inner().to_string() }
        })
    }

    /// The fault of a construction, with the place of its description.
    pub(crate) fn place<T>(&self, result: Result<T>) -> Result<T> {
        result.map_err(|fault| match fault {
            GeometryError::Json { .. } | GeometryError::At { .. } => fault,
            fault => GeometryError::At { place: self.pointer.clone(), fault: Box::new(fault) },
        })
    }

    pub(crate) fn unknown_type(&self, name: &str, what: &str, known: &[&str]) -> GeometryError {
        self.fault(format!("unknown type \"{name}\" of a {what}; known: {}", known.join(", ")))
    }
}

/// `points[3].x` as `/points/3/x`.
fn pointer_of(path: &str) -> String {
    let mut pointer = String::from("/");
    for c in path.chars() {
        match c {
            '.' | '[' => pointer.push('/'),
            ']' => {}
            c => pointer.push(c),
        }
    }
    pointer
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

/// Lists of numbers as points of one dimension.
pub(crate) fn points<const D: usize>(
    node: &JsonNode<'_>,
    name: &str,
    lists: &[Vec<f64>],
) -> Result<Vec<[f64; D]>> {
    lists.iter().enumerate().map(|(i, list)| point(node, &format!("{name}/{i}"), list)).collect()
}

/// A list of numbers as a point.
pub(crate) fn point<const D: usize>(node: &JsonNode<'_>, name: &str, list: &[f64]) -> Result<[f64; D]> {
    <[f64; D]>::try_from(list).map_err(|_| GeometryError::Json {
        place: format!("{}/{name}", node.pointer),
        what: format!("expected {D} numbers, found {}", list.len()),
    })
}

//! Errors become exceptions that carry the data of the diagnosis. The classes are Python's (`trisect/_errors.py`), which makes
//! one of a kind, a text and the data as JSON.

use std::any::Any;

use pyo3::prelude::*;
use serde_json::{Map, Value, json};
use trisect::io::FormatError;
use trisect::mesh::Fault;
use trisect::{Error, Limit, MeshError};

/// The exception for an error of the crate.
pub(crate) fn exception(error: &Error) -> PyErr {
    let mut data = Map::new();
    let kind = describe(error, &mut data);
    made(kind, &error.to_string(), &Value::Object(data))
}

/// The exception for a panic, which is a fault of ours.
pub(crate) fn panic(payload: &(dyn Any + Send)) -> PyErr {
    let text = (payload.downcast_ref::<String>().map(String::as_str))
        .or_else(|| payload.downcast_ref::<&str>().copied())
        .unwrap_or("unknown");
    let text =
        format!("internal fault: {text}; this is a bug in trisect, not in your data: please report it");
    made("internal", &text, &json!({}))
}

/// An argument without meaning.
pub(crate) fn argument(text: &str) -> PyErr {
    made("argument", text, &json!({}))
}

/// An array of another shape than wanted.
pub(crate) fn shape(what: &str, shape: &[usize]) -> PyErr {
    made("argument", &format!("{what} must be an array of shape (n, 3), not {shape:?}"), &json!({}))
}

/// A face that names a vertex that is not there.
pub(crate) fn index(face: usize, index: i64, vertices: usize) -> PyErr {
    let text = format!(
        "face {face} names vertex {index}, but vertices are counted from 0 to {vertices} (exclusive)"
    );
    made("index", &text, &json!({ "face": face, "index": index, "vertices": vertices }))
}

/// The exception that Python makes of this; the error of making it, should that fail.
fn made(kind: &str, text: &str, data: &Value) -> PyErr {
    Python::attach(|py| {
        let exception = py
            .import("trisect._errors")
            .and_then(|errors| errors.getattr("make"))
            .and_then(|make| make.call1((kind, text, data.to_string())));
        match exception {
            Ok(exception) => PyErr::from_value(exception),
            Err(error) => error,
        }
    })
}

/// The kind of an error; its data go into `data`.
fn describe(error: &Error, data: &mut Map<String, Value>) -> &'static str {
    match error {
        Error::File { action, path, source } => {
            data.insert("action".into(), action.to_string().into());
            data.insert("filename".into(), path.display().to_string().into());
            data.insert("errno".into(), source.raw_os_error().into());
            data.insert("strerror".into(), source.to_string().into());
            "file"
        }
        Error::Format(fault) => {
            if let FormatError::Malformed { format, place, .. } = fault {
                data.insert("format".into(), format.extension().into());
                data.insert("place".into(), place.as_str().into());
            }
            "format"
        }
        Error::Mesh(fault) => of_mesh(fault, data),
        Error::Limit(limit) => match limit {
            Limit::DeadlineExceeded => "deadline",
            Limit::Memory { needed, limit } => {
                data.insert("needed".into(), json!(needed));
                data.insert("limit".into(), json!(limit));
                "memory"
            }
            _ => "cancelled",
        },
        Error::Operand { operand, name, source } => {
            let kind = describe(source, data);
            data.insert("operand".into(), json!(operand));
            data.insert("operand_name".into(), name.as_str().into());
            kind
        }
        Error::InNode { node, source } => {
            let kind = describe(source, data);
            data.insert("node".into(), node.as_str().into());
            kind
        }
        Error::Formula(fault) => {
            data.insert("line".into(), json!(fault.line));
            data.insert("column".into(), json!(fault.column));
            "formula"
        }
        Error::TooLarge { .. } => "too large",
        Error::InvalidArgument(_) => "argument",
        Error::Model(_) => "model",
        Error::Field(_) | Error::Geometry(_) | Error::Cage(_) => "geometry",
        _ => "other",
    }
}

fn of_mesh(fault: &MeshError, data: &mut Map<String, Value>) -> &'static str {
    let shells = |fault: &Fault| serde_json::to_value(fault).unwrap_or_default();
    match fault {
        MeshError::NotClosed(diagnosis) => {
            data.insert("diagnosis".into(), serde_json::to_value(diagnosis).unwrap_or_default());
            "not closed"
        }
        MeshError::InsideOut { volume } => {
            data.insert("volume".into(), json!(volume));
            "inside out"
        }
        MeshError::InsideOutShells(fault) => {
            data.insert("shells".into(), shells(fault));
            "inside out"
        }
        MeshError::IndexOutOfRange { triangle, index, vertices } => {
            data.insert("face".into(), json!(triangle));
            data.insert("index".into(), json!(index));
            data.insert("vertices".into(), json!(vertices));
            "index"
        }
        MeshError::NotFinite { vertex, .. } => {
            data.insert("vertex".into(), json!(vertex));
            "not finite"
        }
        MeshError::TooLarge { .. } => "too large",
        MeshError::WeldingDistance(_) | MeshError::Transform(_) | MeshError::NotInThrees { .. } => "argument",
        _ => "mesh",
    }
}

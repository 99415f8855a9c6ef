//! Model files: solids composed of meshes, primitives, formulas, curves and patches, as JSON.
//!
//! `docs/models.md` describes the file. A [`Model`] is read and checked as a whole, then evaluated: operations marked
//! `exact` run on meshes, those marked `field` on R-functions, with one extraction at the end.
//!
//! ```
//! use trisect::model::{Evaluation, Model};
//! let model = Model::parse(
//!     r#"{ "kind": "difference", "evaluate": "field", "operands": [
//!         { "kind": "box", "size": [2, 2, 1] },
//!         { "kind": "cylinder", "radius": 0.5, "height": 2 } ] }"#,
//!     ".".as_ref(),
//! )?;
//! let found = Evaluation::new().tolerance(0.02).run(&model)?;
//! assert!(found.mesh.triangles.len() > 100);
//! # Ok::<(), trisect::Error>(())
//! ```

#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a NaN fails every comparison, and is meant to be refused"
)]

#[cfg(feature = "subdivision")]
mod cage;
mod contour;
mod cuts;
mod evaluate;
mod half_space;
mod made;
#[cfg(feature = "parametric")]
mod parametric;
mod parse;
mod primitive;
mod references;
mod transform;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use evaluate::{Evaluated, Evaluation, ExtractionReport, LeafKind};

use crate::Error;
use crate::boolean::Operation;
use crate::field::{Formula, System};
#[cfg(not(feature = "parametric"))]
use crate::{Control, Mesh};
#[cfg(feature = "subdivision")]
use cage::Cage;
use contour::PlaneRegion;
use cuts::{Cut, MeshFile};
use glam::DAffine3;
use half_space::HalfSpace;
use made::Made;
#[cfg(feature = "parametric")]
use parametric::Parametric;
use primitive::Primitive;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// Nothing is a cage in a build without the feature.
#[cfg(not(feature = "subdivision"))]
#[derive(Clone, Debug)]
enum Cage {}

/// No solid is parametric in a build without the feature.
#[cfg(not(feature = "parametric"))]
#[derive(Clone, Debug)]
enum Parametric {}

#[cfg(not(feature = "parametric"))]
impl Parametric {
    fn mesh(&self, _: Option<f64>, _: &Control) -> Result<Mesh, Error> {
        match *self {}
    }
}

/// A model: named and unnamed nodes, one of which is the result.
#[derive(Clone, Debug)]
pub struct Model {
    nodes: Vec<Node>,
    names: BTreeMap<String, usize>,
    result: usize,
    /// Where relative file names start.
    folder: PathBuf,
    defaults: Defaults,
}

/// Settings of the whole model.
#[derive(Clone, Debug, Default)]
struct Defaults {
    tolerance: Option<f64>,
    smooth: Option<bool>,
    bounds: Option<[[f64; 3]; 2]>,
    system: Option<System>,
    parameters: Vec<(String, f64)>,
}

/// How an operation is carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    /// On meshes, exactly.
    Exact,
    /// On functions.
    Field,
    /// On cages.
    FreeForm,
}

#[derive(Clone, Debug)]
struct Node {
    /// What errors call the node: its name, if any, and its place in the file.
    label: String,
    kind: Kind,
    extrude: Option<[f64; 2]>,
    transform: DAffine3,
    mode: Option<Mode>,
    system: Option<System>,
    tolerance: Option<f64>,
    /// Whether a surface that is extracted from a field is made smooth.
    smooth: Option<bool>,
    bounds: Option<[[f64; 3]; 2]>,
    clip: bool,
}

#[derive(Clone, Debug)]
enum Kind {
    Operation(Operation, Vec<usize>),
    Complement(usize),
    /// Another node, by name, and its position once names are resolved.
    Reference(String, usize),
    Mesh(MeshFile),
    Primitive(Primitive),
    Formula {
        formula: Box<Formula>,
        parameters: Vec<(String, f64)>,
        /// Nodes the formula uses by name.
        uses: Vec<(String, usize)>,
    },
    /// All that is below a plane.
    HalfSpace(HalfSpace),
    /// A plane region, the same at every height.
    Contour(PlaneRegion),
    /// Patches, or a region moved.
    #[cfg_attr(
        not(feature = "parametric"),
        allow(dead_code, reason = "nothing is parametric in such a build")
    )]
    Parametric(Parametric),
    /// Something made of other nodes as meshes, or of text.
    Made(Made, Vec<usize>),
    /// What is cut, or made of a soup.
    Cut(Cut, Vec<usize>),
    /// A cage: the solid of its limit surface.
    #[cfg_attr(not(feature = "subdivision"), allow(dead_code, reason = "there are no cages in such a build"))]
    Cage(Box<Cage>),
    /// A leaf of a kind of the caller's own.
    Custom {
        kind: String,
        value: Value,
    },
}

impl Model {
    /// Reads a model file.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read; else as [`parse`](Self::parse).
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::File {
            action: crate::FileAction::Read,
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&text, path.parent().unwrap_or(Path::new(".")))
    }

    /// Reads a model; relative file names in it start at `folder`.
    ///
    /// # Errors
    /// [`Error::Model`], in [`Error::InNode`] where a node is at fault: not JSON, unknown or missing keys, values out of
    /// range, unknown names, cyclic references. [`Error::Formula`] for formulas.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, Error> {
        parse::model(text, folder)
    }

    /// The names of the named nodes, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.keys().map(String::as_str)
    }

    /// The mesh files the model needs.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = Vec::new();
        for node in &self.nodes {
            let named = match &node.kind {
                Kind::Mesh(mesh) => vec![&mesh.file],
                Kind::Cut(cut, _) => cut.files(),
                _ => Vec::new(),
            };
            for file in named {
                let file = self.folder.join(file);
                if !files.contains(&file) {
                    files.push(file);
                }
            }
        }
        files
    }

    /// The nodes a node is made of.
    fn operands(&self, node: usize) -> Vec<usize> {
        match &self.nodes[node].kind {
            Kind::Operation(_, operands) | Kind::Made(_, operands) | Kind::Cut(_, operands) => {
                operands.clone()
            }
            Kind::Complement(operand) | Kind::Reference(_, operand) => vec![*operand],
            Kind::Formula { uses, .. } => uses.iter().map(|used| used.1).collect(),
            Kind::Mesh(_)
            | Kind::Primitive(_)
            | Kind::HalfSpace(_)
            | Kind::Contour(_)
            | Kind::Parametric(_)
            | Kind::Cage(_)
            | Kind::Custom { .. } => Vec::new(),
        }
    }
}

/// A fault of the model file itself.
fn fault(what: impl Into<String>) -> Error {
    Error::Model(what.into())
}

/// What stands at a key of a node, which is taken out of it.
fn take<T: DeserializeOwned>(object: &mut Map<String, Value>, key: &str) -> Result<Option<T>, Error> {
    match object.remove(key) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => {
            serde_json::from_value(value).map(Some).map_err(|error| fault(format!("`{key}`: {error}")))
        }
    }
}

/// What is said of a kind that this build cannot read.
#[cfg(not(feature = "parametric"))]
fn without_parametric(kind: &str) -> Error {
    Error::Model(format!("`{kind}` needs a build with the feature `parametric`"))
}

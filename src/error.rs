//! What can go wrong, with the data a caller needs to act on it.

use std::path::PathBuf;

use crate::io::Format;
use crate::mesh::{Diagnosis, Fault, SelfCrossings};

/// Everything that can go wrong. Each variant carries what was found and where; the text says how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to open, read, create or rename a file.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// What was tried: "open", "read", "write", "replace".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The name or the first bytes of a file do not tell its format.
    #[error("cannot tell the format of {name}; known formats: obj, gltf, glb, stl, ply, off")]
    UnknownFormat {
        /// The file's name, or "standard input".
        name: String,
    },
    /// A file is damaged: truncated, out of range, not of the format it claims.
    #[error("damaged {format} file, {place}: {what}")]
    Malformed {
        /// The format the file was read as.
        format: Format,
        /// Where: "line 12", "byte 84", "/meshes/0/primitives/1".
        place: String,
        /// What is wrong and, where that helps, how to mend it.
        what: String,
    },
    /// A file is sound but uses something this reader or writer cannot do.
    #[error("unsupported in {format}: {what}")]
    Unsupported {
        /// The format of the file.
        format: Format,
        /// What is not supported, and how to convert the file.
        what: String,
    },
    /// A mesh has more vertices or triangles than 32-bit indices can name.
    #[error("too large: {what}")]
    TooLarge {
        /// What is too large, with its count.
        what: String,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A vertex used by a triangle has a coordinate that is not a finite number.
    #[error("vertex {vertex} is not finite: {position:?}")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// The mesh is not the closed boundary of a solid.
    #[error("the mesh is not a closed surface: {0}")]
    NotClosed(Box<Diagnosis>),
    /// The mesh is closed but turned inside out: its faces point inwards.
    #[error(
        "the mesh is inside out (volume {volume}): its faces point inwards; reverse its triangles (--orient does it)"
    )]
    InsideOut {
        /// The signed volume, negative.
        volume: f64,
    },
    /// Some shells face the wrong way: inwards without lying inside another, or outwards inside another.
    #[error(
        "{} of its shells face the wrong way (outwards inside another, or inwards by themselves){}; turn them (--orient \
         does it), or unite bodies that lie inside others one by one", .0.count, first_place(.0)
    )]
    InsideOutShells(Box<Fault>),
    /// The surface crosses itself.
    #[error("the surface crosses itself: {0}; unite its parts one by one, or repair it")]
    SelfCrossing(Box<SelfCrossings>),
    /// The operand at this position (counted from 0) is at fault.
    #[error("operand {} ({name}): {source}", operand + 1)]
    Operand {
        /// Position in the argument list, from 0.
        operand: usize,
        /// The operand's name: its file or "operand N".
        name: String,
        /// What is wrong with it.
        source: Box<Error>,
    },
    /// An argument has no meaning: a radius that is not positive, too few segments, an empty list of operands.
    #[error("invalid argument: {0}")]
    InvalidArgument(String),
    /// A field cannot be evaluated or meshed as asked: not a number, no surface where one is needed, a surface that
    /// leaves the box.
    #[error("{0}")]
    Field(String),
    /// A formula that cannot be read.
    #[error("{0}")]
    Formula(#[from] crate::field::FormulaError),
    /// A model file says something that has no meaning.
    #[error("model: {0}")]
    Model(String),
    /// A node of a model is at fault.
    #[error("model, node {node}: {source}")]
    InNode {
        /// The node's name, if it has one, and its place in the file.
        node: String,
        /// What is wrong with it.
        source: Box<Error>,
    },
    /// A curve, region or patch, or its file, is at fault.
    #[cfg(feature = "parametric")]
    #[error(transparent)]
    Geometry(#[from] crate::parametric::GeometryError),
    /// The caller cancelled the operation.
    #[error("cancelled")]
    Cancelled,
    /// The deadline passed.
    #[error("the time limit was reached before the operation was done")]
    DeadlineExceeded,
    /// The memory ceiling would have been exceeded.
    #[error("the operation needs {needed} bytes for its tables, more than the limit of {limit}")]
    MemoryLimit {
        /// Bytes the operation would hold.
        needed: u64,
        /// The limit set.
        limit: u64,
    },
}

/// The first place of a fault, after a comma.
fn first_place(fault: &Fault) -> String {
    fault.places.first().map_or_else(String::new, |place| format!(", the first at {place}"))
}

/// The kinds of failure a program tells apart (and the program's exit codes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Failure {
    /// The caller's arguments make no sense (exit code 1).
    Usage,
    /// Input that cannot be read, or output that cannot be written (exit code 2).
    Unreadable,
    /// Input that was read but cannot be used as asked (exit code 3).
    Unusable,
    /// A limit was hit, or the operation was cancelled (exit code 4).
    Limit,
}

impl Error {
    /// Which kind of failure this is.
    #[must_use]
    pub fn failure(&self) -> Failure {
        match self {
            Self::File { .. }
            | Self::UnknownFormat { .. }
            | Self::Malformed { .. }
            | Self::Unsupported { .. } => Failure::Unreadable,
            Self::TooLarge { .. }
            | Self::IndexOutOfRange { .. }
            | Self::NotFinite { .. }
            | Self::NotClosed(_)
            | Self::InsideOut { .. }
            | Self::InsideOutShells(_)
            | Self::Field(_)
            | Self::Formula(_)
            | Self::Model(_)
            | Self::SelfCrossing(_) => Failure::Unusable,
            #[cfg(feature = "parametric")]
            Self::Geometry(fault) if fault.is_unreadable() => Failure::Unreadable,
            #[cfg(feature = "parametric")]
            Self::Geometry(_) => Failure::Unusable,
            Self::Operand { source, .. } | Self::InNode { source, .. } => source.failure(),
            Self::InvalidArgument(_) => Failure::Usage,
            Self::Cancelled | Self::DeadlineExceeded | Self::MemoryLimit { .. } => Failure::Limit,
        }
    }

    /// This error, said of the operand at `operand` (counted from 0), named `name`.
    #[must_use]
    pub fn of_operand(self, operand: usize, name: impl Into<String>) -> Self {
        match self {
            Self::Cancelled | Self::DeadlineExceeded | Self::MemoryLimit { .. } | Self::Operand { .. } => {
                self
            }
            other => Self::Operand { operand, name: name.into(), source: Box::new(other) },
        }
    }

    /// This error, said of the node of a model called `node`.
    #[must_use]
    pub fn in_node(self, node: &str) -> Self {
        match self {
            Self::Cancelled | Self::DeadlineExceeded | Self::MemoryLimit { .. } | Self::InNode { .. } => self,
            other => Self::InNode { node: node.to_owned(), source: Box::new(other) },
        }
    }
}

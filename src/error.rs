//! What can go wrong, by subject. Only this file knows all subjects: each room below has its own error, and `?` makes it
//! an [`Error`].

use std::fmt;
use std::path::PathBuf;

use crate::control::Limit;
#[cfg(feature = "field")]
use crate::field::{FieldError, FormulaError};
#[cfg(feature = "formats")]
use crate::io::FormatError;
use crate::mesh::{MeshError, Refusal};

/// What was tried with a file. The text is the verb.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileAction {
    /// Opening it, and reading from it.
    Read,
    /// Making a new one.
    Create,
    /// Writing to it.
    Write,
    /// Putting another in its place.
    Replace,
}

impl fmt::Display for FileAction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Read => "read",
            Self::Create => "create",
            Self::Write => "write",
            Self::Replace => "replace",
        })
    }
}

/// Everything that can go wrong, by subject. The subjects' own errors carry what was found and where; their texts say how
/// to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to open, read, create or rename a file.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// What was tried.
        action: FileAction,
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is not what its format says, or the format cannot hold a mesh.
    #[cfg(feature = "formats")]
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A mesh is not what an operation needs.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// There is more of something than 32-bit indices can name.
    #[error("too large: {what}")]
    TooLarge {
        /// What is too large, with its count.
        what: String,
    },
    /// An argument has no meaning: a radius that is not positive, too few segments, an empty list of operands.
    #[error("invalid argument: {0}")]
    InvalidArgument(String),
    /// A limit that the caller set, or the caller, stopped the operation.
    #[error(transparent)]
    Limit(#[from] Limit),
    /// A field cannot be evaluated or meshed as asked.
    #[cfg(feature = "field")]
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A formula that cannot be read.
    #[cfg(feature = "field")]
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// A model file says something that has no meaning.
    #[cfg(feature = "model")]
    #[error("model: {0}")]
    Model(String),
    /// A curve, region or patch, or its file, is at fault.
    #[cfg(feature = "parametric")]
    #[error(transparent)]
    Geometry(#[from] crate::parametric::GeometryError),
    /// A cage, its tags or its file is at fault, or a boolean of cages came to none.
    #[cfg(feature = "subdivision")]
    #[error(transparent)]
    Cage(#[from] crate::subdivision::CageError),
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
    /// A node of a model is at fault.
    #[cfg(feature = "model")]
    #[error("model, node {node}: {source}")]
    InNode {
        /// The node's name, if it has one, and its place in the file.
        node: String,
        /// What is wrong with it.
        source: Box<Error>,
    },
}

/// Numbers that are no plane are an argument without meaning.
impl From<crate::exact::PlaneFault> for Error {
    fn from(fault: crate::exact::PlaneFault) -> Self {
        Self::InvalidArgument(fault.to_string())
    }
}

/// The kinds of failure a program tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Failure {
    /// The caller's arguments make no sense.
    Usage,
    /// Input that cannot be read, or output that cannot be written.
    Unreadable,
    /// Input that was read but cannot be used as asked.
    Unusable,
    /// A limit was hit, or the operation was cancelled.
    Limit,
}

impl From<Box<Refusal>> for Error {
    fn from(refusal: Box<Refusal>) -> Self {
        refusal.error.into()
    }
}

impl Error {
    /// Which kind of failure this is.
    #[must_use]
    pub fn failure(&self) -> Failure {
        match self {
            Self::File { .. } => Failure::Unreadable,
            #[cfg(feature = "formats")]
            Self::Format(FormatError::NoSuchPart { .. }) => Failure::Unusable,
            #[cfg(feature = "formats")]
            Self::Format(_) => Failure::Unreadable,
            Self::InvalidArgument(_)
            | Self::Mesh(
                MeshError::Groups(_)
                | MeshError::UnevenPolygons { .. }
                | MeshError::WeldingDistance(_)
                | MeshError::Transform(_),
            ) => Failure::Usage,
            Self::Mesh(_) | Self::TooLarge { .. } => Failure::Unusable,
            #[cfg(feature = "field")]
            Self::Field(_) | Self::Formula(_) => Failure::Unusable,
            #[cfg(feature = "model")]
            Self::Model(_) => Failure::Unusable,
            #[cfg(feature = "parametric")]
            Self::Geometry(fault) if fault.is_unreadable() => Failure::Unreadable,
            #[cfg(feature = "parametric")]
            Self::Geometry(_) => Failure::Unusable,
            #[cfg(feature = "subdivision")]
            Self::Cage(fault) if fault.is_unreadable() => Failure::Unreadable,
            #[cfg(feature = "subdivision")]
            Self::Cage(_) => Failure::Unusable,
            Self::Operand { source, .. } => source.failure(),
            #[cfg(feature = "model")]
            Self::InNode { source, .. } => source.failure(),
            Self::Limit(_) => Failure::Limit,
        }
    }

    /// This error, said of the operand at `operand` (counted from 0), named `name`. A limit is no operand's fault and
    /// stays as it is.
    #[must_use]
    pub fn of_operand(self, operand: usize, name: impl Into<String>) -> Self {
        match self {
            Self::Limit(_) | Self::Operand { .. } => self,
            other => Self::Operand { operand, name: name.into(), source: Box::new(other) },
        }
    }

    /// This error, said of the node of a model called `node`. A limit is no node's fault and stays as it is.
    #[cfg(feature = "model")]
    #[must_use]
    pub fn in_node(self, node: &str) -> Self {
        match self {
            Self::Limit(_) | Self::InNode { .. } => self,
            other => Self::InNode { node: node.to_owned(), source: Box::new(other) },
        }
    }
}

//! What can be wrong with a cage.

/// Why a control mesh, its tags or its file cannot be used, with the place and what helps.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CageError {
    /// An index names a vertex that is not there.
    #[error("cage: {what} names vertex {vertex}, but there are {count} (counted from 0)")]
    NoSuchVertex {
        /// The face or tag, in words.
        what: String,
        /// The index.
        vertex: u64,
        /// How many vertices there are.
        count: usize,
    },
    /// A face names a vertex twice.
    #[error("cage: face {face} names vertex {vertex} twice; leave the face out")]
    RepeatedVertex {
        /// The face, counted from 0.
        face: usize,
        /// The vertex.
        vertex: u32,
    },
    /// More than two faces share an edge, or two run along it in the same direction.
    #[error(
        "cage: edge {}-{} is used twice in the same direction (by faces {} and {}): the faces around it are not oriented \
         alike, or more than two meet there; `check` lists such places",
        edge[0], edge[1], faces[0], faces[1]
    )]
    EdgeNotManifold {
        /// The directed edge.
        edge: [u32; 2],
        /// Two of the faces.
        faces: [usize; 2],
    },
    /// Faces around a vertex form several fans.
    #[error(
        "cage: the faces around vertex {vertex} are not connected there; give each fan a vertex of its own"
    )]
    VertexNotManifold {
        /// The vertex.
        vertex: u32,
    },
    /// A coordinate is infinite or not a number.
    #[error("cage: vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A tag has a value without meaning.
    #[error("cage: {0}")]
    Tag(String),
    /// A boolean needs closed cages, and this one has a border.
    #[error("cage: not closed: edge {}-{} has a face on one side only; `subdivide` takes open cages, booleans do not", edge[0], edge[1])]
    NotClosed {
        /// The first border edge.
        edge: [u32; 2],
    },
    /// The file cannot be read as a cage.
    #[error("cage file, {place}: {what}")]
    File {
        /// The line or key.
        place: String,
        /// What is wrong with it.
        what: String,
    },
    /// A boolean of cages came to an end without a cage.
    #[error("free forms: {0}")]
    Operation(String),
}

impl CageError {
    /// Whether a file could not be read, rather than its cage not be used.
    pub(crate) fn is_unreadable(&self) -> bool {
        matches!(self, Self::File { .. })
    }
}

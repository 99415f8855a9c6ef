//! What can be wrong with a mesh, with the data a caller needs to act on it.

use super::{Diagnosis, Fault};

/// A mesh that is not what an operation needs, or an argument that has no meaning for it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
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
    #[error("the mesh is inside out (volume {volume}): its faces point inwards; reverse its triangles")]
    InsideOut {
        /// The signed volume, negative.
        volume: f64,
    },
    /// Some shells face the wrong way: inwards without lying inside another, or outwards inside another.
    #[error(
        "{} of its shells face the wrong way (outwards inside another, or inwards by themselves){}; turn them, or unite \
         bodies that lie inside others one by one", .0.count, first_place(.0)
    )]
    InsideOutShells(Box<Fault>),
    /// There are more vertices or triangles than can be numbered.
    #[error("too large: {vertices} vertices, {triangles} triangles")]
    TooLarge {
        /// Number of vertices.
        vertices: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// A flat list of coordinates or of vertices that does not come out even.
    #[error("{numbers} {what} are no whole number of threes")]
    NotInThrees {
        /// What is listed.
        what: &'static str,
        /// How many numbers there are.
        numbers: usize,
    },
    /// The groups do not fit the triangles.
    #[error("face groups: {0}")]
    Groups(GroupFault),
    /// An attribute does not fit the triangles, or is none.
    #[error("attribute {name:?}: {fault}")]
    Attribute {
        /// Its name.
        name: String,
        /// What is wrong.
        fault: AttributeFault,
    },
    /// A distance to weld by that is negative or not finite.
    #[error("the welding distance must be finite and not negative, not {0}")]
    WeldingDistance(f64),
    /// A surface that is to part a solid does not pass through it.
    #[error(
        "the surface ends inside the solid, at ({}, {}, {}), beside its triangle {triangle}: what it parts there is one piece; \
         extend it past the solid or up to another surface, or imprint it only",
        position[0], position[1], position[2]
    )]
    EndsInside {
        /// A place of the surface that has the same piece of the solid on both sides.
        position: [f64; 3],
        /// The triangle of the surface there.
        triangle: u32,
    },
    /// A transform that would flatten the mesh, or is none.
    #[error("{0}")]
    Transform(TransformFault),
}

/// Why groups do not fit the triangles of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GroupFault {
    /// Not every triangle has a group.
    #[error("{assigned} triangles have a group, but there are {triangles} triangles")]
    Count {
        /// Triangles with a group.
        assigned: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// A triangle is in a group that does not exist.
    #[error("triangle {triangle} is in group {group}, but there are only {groups} groups")]
    OutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The group it names.
        group: u32,
        /// Number of groups.
        groups: usize,
    },
}

/// Why an attribute does not fit the triangles of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AttributeFault {
    /// A name that says nothing.
    #[error(
        "the name is neither NORMAL, TANGENT, TEXCOORD_n, COLOR_n, JOINTS_n nor WEIGHTS_n; one of its own begins with an \
         underscore"
    )]
    Name,
    /// Another attribute has the same name.
    #[error("another attribute has the same name")]
    Twice,
    /// A number of numbers to a value that its name does not allow.
    #[error("{components} numbers to a value are not what the name says")]
    Components {
        /// Numbers to a value.
        components: usize,
    },
    /// The table does not come out even, or is longer than can be numbered.
    #[error("{numbers} numbers are no whole number of values of {components} numbers that 32 bits can count")]
    Values {
        /// Numbers in the table.
        numbers: usize,
        /// Numbers to a value.
        components: usize,
    },
    /// Not every corner says which value it has.
    #[error("it is given for {corners} corners, but there are {triangles} triangles with three corners each")]
    Count {
        /// Corners it is given for.
        corners: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// A corner names a value that does not exist.
    #[error("corner {corner} of triangle {triangle} names value {value}, but there are only {values} values")]
    OutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// Which of its corners: 0, 1 or 2.
        corner: usize,
        /// The value it names.
        value: u32,
        /// Number of values.
        values: usize,
    },
    /// A value is not finite.
    #[error("value {value} is not finite: {number}")]
    NotFinite {
        /// Index of the value.
        value: usize,
        /// The number.
        number: f64,
    },
}

/// Why a transform cannot be applied.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TransformFault {
    /// A factor is zero or not finite.
    #[error("scale factors must be finite and not zero, not {0:?}")]
    Scale([f64; 3]),
    /// The axis has no direction, or something is not finite.
    #[error("a rotation needs a finite axis other than zero and a finite angle, not {axis:?} and {degrees}")]
    Rotation {
        /// The axis.
        axis: [f64; 3],
        /// The angle.
        degrees: f64,
    },
    /// A matrix of neither 12 nor 16 numbers.
    #[error("transformation matrix: 12 or 16 numbers, row by row, are needed, not {0}")]
    MatrixLength(usize),
    /// A number of a matrix that is not finite.
    #[error("transformation matrix: its numbers must be finite, not {0}")]
    MatrixNumber(f64),
    /// A matrix that is not affine.
    #[error(
        "transformation matrix: the last row must be 0, 0, 0, 1, not {0:?}; if the translation is there, the matrix is \
         given column by column: transpose it"
    )]
    MatrixLastRow([f64; 4]),
    /// A matrix without an inverse.
    #[error("transformation matrix: it is singular: it would flatten the mesh")]
    MatrixSingular,
    /// A size to fit into that is none, or a mesh without any extent.
    #[error(
        "cannot fit a mesh with extents {extents:?} into {size:?}: sizes must be positive and finite, and a mesh that has no \
         extent has none to fit"
    )]
    Fit {
        /// The box to fit into.
        size: [f64; 3],
        /// The extents of the mesh.
        extents: [f64; 3],
    },
}

/// The first place of a fault, after a comma.
fn first_place(fault: &Fault) -> String {
    fault.places.first().map_or_else(String::new, |place| format!(", the first at {place}"))
}

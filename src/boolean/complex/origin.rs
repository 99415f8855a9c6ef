//! Where a triangle of a result came from.

/// Where a triangle of a result came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Origin {
    /// Position of the operand in the argument list.
    pub operand: u32,
    /// Index of the triangle in that operand's [`Solid::mesh`](crate::Solid::mesh) (see
    /// [`Solid::source_triangle`](crate::Solid::source_triangle) for the mesh the solid was made of). Where faces of one
    /// plane were merged, one of them.
    pub triangle: u32,
    /// Whether the result's triangle faces the other way.
    pub reversed: bool,
}

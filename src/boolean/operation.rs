//! Which boolean, and what becomes of touching operands.

/// A regularised boolean operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// What is in any operand.
    Union,
    /// What is in all operands.
    Intersection,
    /// What is in the first and in none of the others.
    Difference,
    /// What is in an odd number of operands.
    SymmetricDifference,
}

/// What becomes of operands of a union that touch without overlapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Contact {
    /// Touching faces vanish: the bodies become one. (Bodies that touch in an edge or a vertex alone stay apart.)
    #[default]
    Fuse,
    /// Touching bodies stay apart, each with its own face.
    Separate,
}

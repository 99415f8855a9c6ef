//! The ground of a boolean: the operands as one numbered complex, how each vertex is perturbed, and which faces share a plane.

pub(super) mod directions;
pub(super) mod operands;
pub(super) mod planes;

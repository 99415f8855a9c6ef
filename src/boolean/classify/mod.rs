//! What is kept: winding numbers around vertices, how often a piece of surface counts for an operation, and the boundary of
//! what is kept of a face.

pub(super) mod body;
pub(super) mod multiplicity;
pub(super) mod winding;

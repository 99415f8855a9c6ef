//! What is kept: winding numbers round vertices, and how often a piece of surface counts.

pub(super) mod multiplicity;
pub(super) mod winding;

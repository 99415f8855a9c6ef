//! What counts a number of times in a chain of one plane.

/// A directed edge, and how often it counts.
pub(super) type CountedEdge = ([u32; 2], i32);

/// A counter-clockwise triangle, and how often it counts.
pub(crate) type CountedTriangle = ([u32; 3], i32);

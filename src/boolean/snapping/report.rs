//! What snapping came to.

/// What welding the operands to each other moved and split.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Snapping {
    /// What is no further apart than this was made the same, in units of the coordinates.
    pub distance: f64,
    /// Vertices that were moved.
    pub moved: u64,
    /// Triangles that vanished since corners of theirs became one.
    pub collapsed: u64,
    /// Triangles that were left out in pairs, since they lay back to back in one operand.
    pub walls: u64,
    /// Operands of which nothing is left: they were no larger than the distance.
    pub vanished: u64,
    /// Edges that got vertices.
    pub split_edges: u64,
    /// Faces that got vertices or edges inside.
    pub split_faces: u64,
    /// How far a vertex was moved, at most. (Where the corners of a part collapse, and are welded in several rounds, that is more than
    /// the distance.)
    pub farthest: f64,
    /// Rounds until nothing was near and apart.
    pub rounds: u32,
    /// Whether something near was left as it was, since the rounds were used up.
    pub unfinished: bool,
}

//! The arrangement of two surfaces: where edges cross faces, in which order, which faces are cut, and which points are one.

pub(super) mod crossings;
pub(super) mod cut_edges;
pub(super) mod cut_faces;
pub(super) mod identify;
pub(super) mod plane_faces;
pub(super) mod self_crossings;
pub(super) mod unrounded;

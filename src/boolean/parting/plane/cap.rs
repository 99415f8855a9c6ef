//! What closes both halves.

use super::nodes::{Nodes, Point};
use super::pieces::{numbered, seam, without_opposites};
use super::split::{Half, ON, Split};
use crate::polygon::{self, Region};

/// The common part of the plane and the solid.
pub(super) struct Cap {
    /// Triangles, seen counter-clockwise from above: they close the half below, and turned over that above.
    pub(super) triangles: Vec<[Point; 3]>,
    /// Whether its boundary winds once around all of it, and nowhere crosses itself.
    pub(super) is_simple: bool,
    /// Triangles that rounding turned over.
    pub(super) inverted: u64,
}

/// The boundary of the cap, the solid to its left seen from above: the negative of that of what is kept below.
///
/// It is also the negative of that of what is kept above, turned over: all triangles together are closed, and each belongs to one
/// half. So one cap closes both.
pub(super) fn outline(split: &Split<'_>, nodes: &Nodes) -> Vec<[Point; 2]> {
    let mut edges: Vec<[Point; 2]> =
        seam(nodes).into_iter().map(|[exit, entry]| [nodes.in_cap(entry), nodes.in_cap(exit)]).collect();
    for triangle in split.touching(Half::Below) {
        let corners = split.corners(triangle);
        let sides = (0..3).map(|k| [corners[(k + 1) % 3], corners[k]]);
        edges.extend(sides.filter(|side| side.iter().all(|&v| split.mark(v) == ON)));
    }
    without_opposites(edges)
}

/// The cap over its boundary.
pub(super) fn cap(split: &Split<'_>, nodes: &Nodes) -> Cap {
    let (points, edges) = numbered(&outline(split, nodes));
    let projection = split.plane.projection();
    let flat: Vec<[f64; 2]> =
        points.iter().map(|&point| projection.project(&nodes.position(split, point))).collect();
    let Region { triangles, is_simple, inverted } = polygon::fill_wound(&flat, &edges);
    let triangles =
        triangles.into_iter().map(|corners| corners.map(|number| points[number as usize])).collect();
    Cap { triangles, is_simple, inverted }
}

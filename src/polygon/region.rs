//! Regions given by directed edges: filled, and as polygons.

use super::counted::{CountedEdge, CountedTriangle};
use super::ears::shape_of;
use super::loops::Tracer;
use super::{Shape, Triangulator, delaunay, holes};

/// A region, filled.
#[derive(Debug)]
pub(crate) struct Region {
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Whether its boundary winds once around all of it, and nowhere crosses or touches itself but in common vertices.
    pub(crate) is_simple: bool,
    /// Triangles that are turned over.
    pub(crate) inverted: u64,
}

/// Triangles over what directed edges wind around, as often as they do; every edge is used exactly once, and besides them only
/// diagonals in pairs. O(n log n) where no edges cross.
pub(crate) fn fill_wound(points: &[[f64; 2]], edges: &[[u32; 2]]) -> Region {
    let counted: Vec<CountedEdge> = edges.iter().map(|&edge| (edge, 1)).collect();
    if let Ok(found) = delaunay::triangulate_between(points, &counted) {
        let is_simple = found.iter().all(|&(_, winding)| winding == 1);
        let times = |&([a, b, c], winding): &CountedTriangle| {
            let corners = if winding > 0 { [a, b, c] } else { [a, c, b] };
            std::iter::repeat_n(corners, winding.unsigned_abs() as usize)
        };
        return Region { triangles: found.iter().flat_map(times).collect(), is_simple, inverted: 0 };
    }
    let mut triangles = Vec::new();
    Triangulator::default().triangulate(points, edges, &mut triangles);
    let is_inverted = |corners: &&[u32; 3]| shape_of(points, **corners) == Shape::Folded;
    let inverted = triangles.iter().filter(is_inverted).count() as u64;
    Region { triangles, is_simple: false, inverted }
}

/// The loops of edges that bound a region to their left, as polygons: an outline each, counter-clockwise, then its holes. Every edge
/// is in one loop. O(n log n), and besides O(h p) for h holes and p polygons.
pub(crate) fn polygons(points: &[[f64; 2]], edges: &[[u32; 2]]) -> Vec<Vec<Vec<u32>>> {
    polygons_of_loops(points, Tracer::default().trace(points, edges))
}

/// The same of loops that neither cross nor touch.
pub(crate) fn polygons_of_loops(points: &[[f64; 2]], loops: Vec<Vec<u32>>) -> Vec<Vec<Vec<u32>>> {
    let polygons = holes::group(points, loops);
    polygons
        .into_iter()
        .map(|polygon| std::iter::once(polygon.outer).chain(polygon.holes).collect())
        .collect()
}

//! Snapping: points at the same place become one.

use super::face::LocalPoint;
use super::patch::Patch;
use crate::mesh::SparseUnionFind;

/// Makes one point of each pair, the lower one.
pub(super) fn snap_pairs(patch: &mut Patch<'_>, pairs: &[(LocalPoint, LocalPoint)]) {
    let mut sets = SparseUnionFind::default();
    pairs.iter().for_each(|&(x, y)| sets.join(x, y));
    let lowest = sets.into_roots();
    patch.substitute(|point| lowest.get(&point).copied().unwrap_or(point));
    patch.cancel();
}

/// Makes one point of those complete points that are at the same place.
pub(super) fn snap_coincident(patch: &mut Patch<'_>) {
    let mut points = complete_points(patch);
    points.sort_unstable_by_key(|&point| (patch.position(point).map(|x| (x + 0.0).to_bits()), point));
    let coincident = pairs_at_one_place(patch, &points);
    if !coincident.is_empty() {
        snap_pairs(patch, &coincident);
    }
}

/// Makes one point of both ends of an edge without length, and of an edge of several pairs of triangles between the ends of which no
/// number lies, so that the pairs could not come apart in its middle. Both ends must be complete; no vertex of an operand moves.
pub(super) fn snap_ends(patch: &mut Patch<'_>) {
    let has_middle = |&(u, v): &(LocalPoint, LocalPoint)| {
        let (p, q) = (patch.position(u), patch.position(v));
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]);
        middle != *p && middle != *q
    };
    // 1. Edges without a middle, once for each triangle there.
    let ascending = |(u, v): (LocalPoint, LocalPoint)| (u.min(v), u.max(v));
    let edges = patch.faces().flat_map(|(_, face)| face.sides()).map(ascending);
    let mut short: Vec<(LocalPoint, LocalPoint)> = edges.filter(|edge| !has_middle(edge)).collect();
    short.sort_unstable();
    // 2. Those that stand in the way.
    let is_in_the_way = |edge: &&[(LocalPoint, LocalPoint)]| {
        let (u, v) = edge[0];
        let has_no_length = patch.position(u) == patch.position(v);
        (has_no_length || edge.len() > 2 && patch.is_new(v)) && patch.is_complete(u) && patch.is_complete(v)
    };
    let ends: Vec<_> = short.chunk_by(PartialEq::eq).filter(is_in_the_way).map(|edge| edge[0]).collect();
    if !ends.is_empty() {
        snap_pairs(patch, &ends);
    }
}

/// The pairs of successive points that are at the same place.
pub(super) fn pairs_at_one_place(patch: &Patch<'_>, points: &[LocalPoint]) -> Vec<(LocalPoint, LocalPoint)> {
    let is_coincident = |pair: &&[LocalPoint]| patch.position(pair[0]) == patch.position(pair[1]);
    points.windows(2).filter(is_coincident).map(|pair| (pair[0], pair[1])).collect()
}

/// The points of faces all of whose triangles are in the patch, ascending.
pub(super) fn complete_points(patch: &Patch<'_>) -> Vec<LocalPoint> {
    let mut is_used = vec![false; patch.point_count()];
    for (_, face) in patch.faces() {
        face.corners.iter().for_each(|point| is_used[point.index()] = true);
    }
    let points = (0..patch.point_count() as u32).map(LocalPoint);
    points.filter(|&point| is_used[point.index()] && patch.is_complete(point)).collect()
}

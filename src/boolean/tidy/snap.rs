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

//! Triangles without area one by one, while the patch is still a sum of triangles: their longest side is split or flipped.

use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::face::{LocalFace, LocalPoint, sides};
use super::flatness::{is_flat, longest_side};
use super::flip::Flip;
use super::patch::Patch;
use super::snap::snap_pairs;

/// Rounds of splitting and snapping at most. Another round follows only where two middle corners over one side are at the
/// same place; it has fewer points then, so the bound is for time alone.
const MOST_ROUNDS: usize = 8;

/// Triangles looked at in a round, for each that has no area at its start. Splitting only makes shorter sides, but flips
/// may go around in circles among triangles that all have no area.
const LOOKS_PER_TRIANGLE: usize = 16;

/// The faces to the left of each directed edge, while there may be several.
#[derive(Default)]
struct Chain {
    faces_left_of: FxHashMap<(LocalPoint, LocalPoint), SmallVec<[LocalFace; 2]>>,
}

impl Chain {
    fn of(patch: &Patch<'_>) -> Self {
        let mut chain = Self::default();
        for (number, face) in patch.faces() {
            chain.link(number, face.corners);
        }
        chain
    }

    fn left_of(&self, from: LocalPoint, to: LocalPoint) -> &[LocalFace] {
        self.faces_left_of.get(&(from, to)).map_or(&[], SmallVec::as_slice)
    }

    fn link(&mut self, face: LocalFace, corners: [LocalPoint; 3]) {
        for side in sides(corners) {
            self.faces_left_of.entry(side).or_default().push(face);
        }
    }

    fn unlink(&mut self, face: LocalFace, corners: [LocalPoint; 3]) {
        for side in sides(corners) {
            if let Some(list) = self.faces_left_of.get_mut(&side) {
                list.retain(|other| *other != face);
            }
        }
    }

    fn drop_face(&mut self, patch: &mut Patch<'_>, face: LocalFace) {
        self.unlink(face, patch[face].corners);
        patch.drop_face(face);
    }

    fn set_corners(&mut self, patch: &mut Patch<'_>, face: LocalFace, corners: [LocalPoint; 3]) {
        self.unlink(face, patch[face].corners);
        patch.set_corners(face, corners);
        self.link(face, corners);
    }

    /// Other points at the place of `b` that faces at the edge from `a` to `c` have, where both are complete.
    fn coincident_middles(
        &self,
        patch: &Patch<'_>,
        a: LocalPoint,
        b: LocalPoint,
        c: LocalPoint,
    ) -> Vec<LocalPoint> {
        [(a, c), (c, a)]
            .iter()
            .flat_map(|&(from, to)| self.left_of(from, to))
            .flat_map(|&face| patch[face].corners)
            .filter(|&point| point != b && patch.position(point) == patch.position(b))
            .filter(|&point| patch.is_complete(point) && patch.is_complete(b))
            .collect()
    }

    /// Gives all faces at the edge from `a` to `c` the vertex `b` on it; those that have it already vanish. Returns the
    /// faces that changed.
    fn split_edge(
        &mut self,
        patch: &mut Patch<'_>,
        a: LocalPoint,
        b: LocalPoint,
        c: LocalPoint,
    ) -> Vec<LocalFace> {
        let mut changed = Vec::new();
        for (from, to) in [(a, c), (c, a)] {
            for face in self.left_of(from, to).to_vec() {
                let Some(d) = patch[face].third_corner(a, c) else { continue };
                if d == b {
                    self.drop_face(patch, face);
                    continue;
                }
                self.set_corners(patch, face, [from, b, d]);
                let other = patch.add_part(face, [b, to, d]);
                self.link(other, [b, to, d]);
                changed.extend([face, other]);
            }
        }
        changed
    }

    /// Flips the longest side of a flat face with one other face there.
    fn flip_edge(&mut self, patch: &mut Patch<'_>, flip: &Flip) -> [Option<LocalFace>; 2] {
        let &Flip { flat, other, a, b, c, d } = flip;
        if b == d {
            self.drop_face(patch, flat);
            self.drop_face(patch, other);
            return [None; 2];
        }
        patch.set_plane_of(flat, other);
        self.set_corners(patch, flat, [a, b, d]);
        self.set_corners(patch, other, [b, c, d]);
        [Some(flat), Some(other)]
    }
}

/// Removes faces without area while the patch is still a sum of triangles, not a 2-manifold: the middle corner becomes a
/// vertex of all faces at the longest side, so that whatever meets there meets in the same edges. Where not all of them are
/// known, the side is flipped with one of them.
pub(super) fn remove_flat(patch: &mut Patch<'_>) {
    for _ in 0..MOST_ROUNDS {
        let coincident = split_longest_sides(patch);
        if coincident.is_empty() {
            return;
        }
        snap_pairs(patch, &coincident);
    }
    patch.count_stop();
}

/// One round; returns pairs of points at the same place that two faces without area have as their middle corners over the
/// same side.
fn split_longest_sides(patch: &mut Patch<'_>) -> Vec<(LocalPoint, LocalPoint)> {
    let mut coincident = Vec::new();
    // 1. The longest first: what meets its longest side then ends between its ends, and all new sides on the line are
    //    shorter.
    let by_length =
        |patch: &Patch<'_>, face: LocalFace| is_flat(patch, face).then(|| (longest_side(patch, face), face));
    let mut queue: BinaryHeap<(u128, LocalFace)> =
        patch.face_numbers().filter_map(|face| by_length(patch, face)).collect();
    if queue.is_empty() {
        return coincident;
    }
    let mut chain = Chain::of(patch);
    let mut budget = LOOKS_PER_TRIANGLE * queue.len();
    while let Some((length, face)) = queue.pop() {
        if budget == 0 {
            patch.count_stop();
            break;
        }
        budget -= 1;
        // 2. What has changed since it was queued has been queued again.
        if by_length(patch, face) != Some((length, face)) {
            continue;
        }
        let flip = Flip::of(patch, face, |a, c| {
            let opposite = chain.left_of(a, c);
            opposite.iter().copied().find(|&other| !is_flat(patch, other)).or(opposite.first().copied())
        });
        let Some(flip) = flip else { continue };
        let Flip { a, b, c, .. } = flip;
        // 3. A complete point knows all faces at its edges: they are split. Otherwise one is flipped.
        if !patch.is_complete(a) && !patch.is_complete(c) {
            let changed = chain.flip_edge(patch, &flip);
            queue.extend(changed.into_iter().flatten().filter_map(|face| by_length(patch, face)));
            continue;
        }
        let others = chain.coincident_middles(patch, a, b, c);
        if others.is_empty() {
            let changed = chain.split_edge(patch, a, b, c);
            queue.extend(changed.into_iter().filter_map(|face| by_length(patch, face)));
        } else {
            coincident.extend(others.into_iter().map(|point| (b, point)));
        }
    }
    coincident
}

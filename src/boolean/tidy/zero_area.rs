//! Triangles without area: split or flip their longest side. The middle corner lies on that side, so the shape does not
//! change.

use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::patch::{Face, Patch};
use super::source::Source;
use crate::exact::collinear;
use crate::mesh::SparseUnionFind;

/// A flip: the two triangles that share the longest side from `c` to `a` of the flat triangle `a, b, c`.
struct Flip {
    flat: u32,
    other: u32,
    a: u32,
    b: u32,
    c: u32,
    d: u32,
}

fn is_flat(patch: &Patch<'_>, index: u32) -> bool {
    let face = &patch.faces[index as usize];
    face.alive && (face.flat || is_exactly_flat(patch, index))
}

/// Whether the corners of a triangle lie on one line as they are.
pub(super) fn is_exactly_flat(patch: &Patch<'_>, index: u32) -> bool {
    let face = &patch.faces[index as usize];
    let [a, b, c] = face.corners.map(|point| patch.position(point));
    face.alive && collinear(a, b, c)
}

/// Whether a triangle without area is left.
pub(super) fn any_flat(patch: &Patch<'_>) -> bool {
    (0..patch.faces.len() as u32).any(|index| !patch.faces[index as usize].untouched && is_flat(patch, index))
}

/// The square of a triangle's longest side, in an order of bits.
fn longest(patch: &Patch<'_>, index: u32) -> u64 {
    let [a, b, c] = patch.faces[index as usize].corners.map(|point| patch.position(point));
    let square = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f64>();
    square(a, b).max(square(b, c)).max(square(c, a)).to_bits()
}

/// Whether a triangle that is not untouched is no higher over its longest side than `height`.
fn is_lower(patch: &Patch<'_>, index: u32, height: f64) -> bool {
    let face = &patch.faces[index as usize];
    face.alive && !face.untouched && is_low(face.corners.map(|point| patch.position(point)), height)
}

/// Whether a triangle is no higher over its longest side than `height`.
pub(super) fn is_low([a, b, c]: [&[f64; 3]; 3], height: f64) -> bool {
    let difference = |p: &[f64; 3], q: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| q[k] - p[k]) };
    let (u, v, w) = (difference(a, b), difference(b, c), difference(c, a));
    let cross: [f64; 3] =
        std::array::from_fn(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
    let square = |v: &[f64; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    square(&cross) <= height * height * square(&u).max(square(&v)).max(square(&w))
}

/// Marks the triangles whose corners lay on one line before they were rounded, but do not now.
pub(super) fn mark_flat(patch: &mut Patch<'_>, cutter: &Source<'_>) {
    for index in 0..patch.faces.len() as u32 {
        let corners = patch.faces[index as usize].corners;
        let is_low = is_lower(patch, index, cutter.rounding) && !is_exactly_flat(patch, index);
        if is_low && cutter.were_on_one_line(corners.map(|point| patch.number(point))) {
            patch.faces[index as usize].flat = true;
        }
    }
}

/// The triangles to the left of each directed edge, while there may be several.
#[derive(Default)]
struct Chain {
    left_of: FxHashMap<(u32, u32), SmallVec<[u32; 2]>>,
}

impl Chain {
    fn of(patch: &Patch<'_>) -> Self {
        let mut chain = Self::default();
        for (index, face) in patch.faces.iter().enumerate().filter(|(_, face)| face.alive) {
            chain.add(index as u32, face.corners);
        }
        chain
    }

    fn add(&mut self, index: u32, corners: [u32; 3]) {
        for k in 0..3 {
            self.left_of.entry((corners[k], corners[(k + 1) % 3])).or_default().push(index);
        }
    }

    fn beside(&self, from: u32, to: u32) -> &[u32] {
        self.left_of.get(&(from, to)).map_or(&[], SmallVec::as_slice)
    }

    fn change(&mut self, patch: &mut Patch<'_>, index: u32, corners: Option<[u32; 3]>) {
        let face = &mut patch.faces[index as usize];
        for k in 0..3 {
            if let Some(list) = self.left_of.get_mut(&(face.corners[k], face.corners[(k + 1) % 3])) {
                list.retain(|other| *other != index);
            }
        }
        match corners {
            None => face.alive = false,
            Some(corners) => {
                face.corners = corners;
                face.untouched = false;
                self.add(index, corners);
            }
        }
    }

    /// Other points at the place of `b` that triangles at the edge from `a` to `c` have, where both are known completely.
    fn coincident_middles(&self, patch: &Patch<'_>, a: u32, b: u32, c: u32) -> Vec<u32> {
        [(a, c), (c, a)]
            .iter()
            .flat_map(|&(from, to)| self.beside(from, to))
            .flat_map(|&index| patch.faces[index as usize].corners)
            .filter(|&point| point != b && patch.position(point) == patch.position(b))
            .filter(|&point| patch.is_complete(point) && patch.is_complete(b))
            .collect()
    }

    /// Gives all triangles at the edge from `a` to `c` the vertex `b` on it; those that have it already vanish. Returns
    /// the triangles that changed.
    fn split(&mut self, patch: &mut Patch<'_>, a: u32, b: u32, c: u32) -> Vec<u32> {
        let mut changed = Vec::new();
        for (from, to) in [(a, c), (c, a)] {
            for index in self.beside(from, to).to_vec() {
                let face = patch.faces[index as usize];
                let Some(&d) = face.corners.iter().find(|&&point| point != a && point != c) else { continue };
                if d == b {
                    self.change(patch, index, None);
                    continue;
                }
                self.change(patch, index, Some([from, b, d]));
                patch.faces.push(Face { corners: [b, to, d], untouched: false, ..face });
                let other = patch.faces.len() as u32 - 1;
                self.add(other, [b, to, d]);
                changed.extend([index, other]);
            }
        }
        changed
    }
}

/// Rounds of identifying points and splitting again.
const ROUNDS: usize = 8;

/// Removes triangles without area while the patch is still a sum of triangles, not a 2-manifold: the middle corner becomes
/// a vertex of all triangles at the longest side, so that whatever meets there meets in the same edges. Where not all of
/// them are known, the side is flipped with one of them.
pub(super) fn split_chain(patch: &mut Patch<'_>) {
    for _ in 0..ROUNDS {
        let coincident = split_round(patch);
        if coincident.is_empty() {
            return;
        }
        identify(patch, &coincident);
    }
}

/// One round; returns pairs of points at the same place that two triangles without area have as their middle corners over
/// the same side.
fn split_round(patch: &mut Patch<'_>) -> Vec<(u32, u32)> {
    let mut coincident = Vec::new();
    // The longest first: what meets its longest side then ends between its ends, and all new sides on the line are shorter.
    let by_length =
        |patch: &Patch<'_>, index: u32| is_flat(patch, index).then(|| (longest(patch, index), index));
    let mut queue: BinaryHeap<(u64, u32)> =
        (0..patch.faces.len() as u32).filter_map(|x| by_length(patch, x)).collect();
    if queue.is_empty() {
        return coincident;
    }
    let mut chain = Chain::of(patch);
    let mut budget = 16 * queue.len();
    while let Some((length, index)) = queue.pop() {
        if budget == 0 {
            break;
        }
        budget -= 1;
        if by_length(patch, index) != Some((length, index)) {
            continue;
        }
        let flip = longest_side(patch, index, |a, c| {
            let beyond = chain.beside(a, c);
            beyond.iter().copied().find(|&other| !is_flat(patch, other)).or(beyond.first().copied())
        });
        let Some(Flip { flat, other, a, b, c, d }) = flip else { continue };
        // A complete point knows all triangles at its edges.
        if patch.is_complete(a) || patch.is_complete(c) {
            let apart = chain.coincident_middles(patch, a, b, c);
            if apart.is_empty() {
                let changed = chain.split(patch, a, b, c);
                queue.extend(changed.into_iter().filter_map(|x| by_length(patch, x)));
            } else {
                coincident.extend(apart.into_iter().map(|point| (b, point)));
            }
            continue;
        }
        if b == d {
            chain.change(patch, flat, None);
            chain.change(patch, other, None);
            continue;
        }
        let beyond = patch.faces[other as usize];
        patch.faces[flat as usize] =
            Face { origin: beyond.origin, flat: beyond.flat, ..patch.faces[flat as usize] };
        chain.change(patch, flat, Some([a, b, d]));
        chain.change(patch, other, Some([b, c, d]));
        queue.extend([flat, other].into_iter().filter_map(|x| by_length(patch, x)));
    }
    coincident
}

/// Makes one point of each pair.
pub(super) fn identify(patch: &mut Patch<'_>, pairs: &[(u32, u32)]) {
    let mut points = SparseUnionFind::default();
    for &(x, y) in pairs {
        points.join(x, y);
    }
    for face in patch.faces.iter_mut().filter(|face| face.alive) {
        let corners = face.corners.map(|point| points.root(point));
        if corners != face.corners {
            face.corners = corners;
            face.untouched = false;
        }
    }
    patch.cancel();
}

/// Flips triangles in the 2-manifold that are no higher than `height`, as long as that makes no double edge, and (for those
/// with some height) both triangles afterwards look the way of the one beyond the side.
pub(super) fn flip(patch: &mut Patch<'_>, height: f64) {
    let is_low = |patch: &Patch<'_>, index: u32| is_flat(patch, index) || is_lower(patch, index, height);
    let mut queue: Vec<u32> = (0..patch.faces.len() as u32).filter(|&index| is_low(patch, index)).collect();
    // Each flip moves a vertex off a longest side; the bound stops cycles among triangles that are all flat.
    let mut budget = 8 * queue.len();
    while let Some(index) = queue.pop() {
        if budget == 0 {
            break;
        }
        budget -= 1;
        if !is_low(patch, index) {
            continue;
        }
        let Some(flip) = longest_side(patch, index, |a, c| patch.left_of(a, c)) else { continue };
        let Flip { flat, other, a, b, c, d } = flip;
        if d == b {
            // The same triangle turned over: both enclose nothing.
            patch.replace(&[flat, other], &[]);
            continue;
        }
        if patch.position(b) == patch.position(d) {
            // Two bodies that touch in this point: no edge may join them.
            continue;
        }
        let origin = patch.faces[other as usize].origin;
        let new = [([a, b, d], origin), ([b, c, d], origin)];
        let harmless =
            is_flat(patch, flat) || new.iter().all(|(corners, origin)| patch.is_sound(corners, *origin));
        if harmless && !patch.has_edge(b, d) && !patch.has_edge(d, b) {
            patch.replace(&[flat, other], &new);
            queue.extend([flat, other].into_iter().filter(|&index| is_low(patch, index)));
        }
    }
}

/// The flip of the longest side of a flat triangle with the triangle that `beyond` finds on its other side.
fn longest_side(patch: &Patch<'_>, flat: u32, beyond: impl FnOnce(u32, u32) -> Option<u32>) -> Option<Flip> {
    let corners = patch.faces[flat as usize].corners;
    // Rotate so that b is the middle corner, opposite the longest side.
    let k = middle(corners.map(|point| *patch.position(point)))?;
    let [b, c, a] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
    let other = beyond(a, c).filter(|&other| other != flat)?;
    let Face { corners: opposite, .. } = patch.faces[other as usize];
    let d = *opposite.iter().find(|&&point| point != a && point != c)?;
    Some(Flip { flat, other, a, b, c, d })
}

/// Which of three points that are (nearly) on one line lies strictly between the others. Compared along one axis: squared
/// lengths would not tell a point from one next to it.
fn middle(points: [[f64; 3]; 3]) -> Option<usize> {
    let extent = |k: usize| {
        let [a, b, c] = points.map(|p| p[k]);
        a.max(b).max(c) - a.min(b).min(c)
    };
    let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
    let at = points.map(|p| p[axis]);
    (0..3).find(|&k| {
        let (p, q) = (at[(k + 1) % 3], at[(k + 2) % 3]);
        p.min(q) < at[k] && at[k] < p.max(q)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_three_points_however_near_it_is_to_an_end() {
        let (p, q, r) = ([1.0, 1.0, 0.0], [1.0, 1.0, 5e-17], [1.0, 1.0, 1.0]);
        assert_eq!(middle([p, q, r]), Some(1));
        assert_eq!(middle([r, p, q]), Some(2));
        assert_eq!(middle([q, r, p]), Some(0));
        assert_eq!(middle([p, r, p]), None);
        assert_eq!(middle([p; 3]), None);
    }
}

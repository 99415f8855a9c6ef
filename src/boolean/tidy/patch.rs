//! The part of the result that tidying works on.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::assemble::NewTriangle;
use super::super::cut::Cutter;
use super::super::cut_faces::BitSet;
use super::super::multiplicity::Part;
use super::super::outcome::Origin;
use super::super::planes::source_and_axes;
use super::Tidied;
use super::manifold::Surface;
use crate::exact::{Sign, orient2d};

/// A triangle of the patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) corners: [u32; 3],
    pub(super) origin: Origin,
    /// The only copy of an uncut triangle, with its corners as they were.
    pub(super) untouched: bool,
    /// Whether its corners lay on one line before they were rounded.
    pub(super) flat: bool,
    pub(super) alive: bool,
}

/// Triangles round the intersection curve with their adjacency.
pub(super) struct Patch<'a> {
    cutter: &'a Cutter<'a>,
    pub(super) faces: Vec<Face>,
    /// Points all of whose triangles are here.
    complete: Flags,
    /// The triangle to the left of each directed edge; filled by [`connect`](Self::connect).
    left_of: FxHashMap<(u32, u32), u32>,
    /// Some triangle at each point.
    some_face: FxHashMap<u32, u32>,
    /// Directed edges of the result outside the patch between points of the patch.
    beyond: FxHashSet<(u32, u32)>,
    /// Uncut triangles that were taken into the patch.
    taken: [Vec<u32>; 2],
    first_copy: u32,
    copies: Vec<[f64; 3]>,
}

/// A flag for every vertex and node.
struct Flags {
    bits: BitSet,
}

impl Flags {
    fn new(count: usize) -> Self {
        Self { bits: BitSet::new(count) }
    }
    fn set(&mut self, point: u32) {
        self.bits.insert(point);
    }
    fn get(&self, point: u32) -> bool {
        self.bits.contains(point)
    }
}

impl<'a> Patch<'a> {
    /// The pieces and all kept triangles round their points, and round some others.
    pub(super) fn new(
        cutter: &'a Cutter<'a>,
        parts: &[Part],
        pieces: &[NewTriangle],
        others: &FxHashSet<u32>,
    ) -> Self {
        let operands = cutter.operands;
        let points = operands.vertex_count() as usize + cutter.edges.positions.len();
        let mut complete = Flags::new(points);
        for point in pieces.iter().flat_map(|piece| piece.corners) {
            complete.set(point);
        }
        // Kept triangles of both operands may share a point where all that was cut cancelled.
        for point in cutter.identification.representatives().into_iter().chain(others.iter().copied()) {
            complete.set(point);
        }
        let mut patch = Self {
            cutter,
            faces: Vec::with_capacity(2 * pieces.len()),
            complete,
            left_of: FxHashMap::default(),
            some_face: FxHashMap::default(),
            beyond: FxHashSet::default(),
            taken: [Vec::new(), Vec::new()],
            first_copy: points as u32,
            copies: Vec::new(),
        };
        patch.take_kept_triangles(parts);
        patch.faces.extend(pieces.iter().map(|piece| Face {
            corners: piece.corners,
            origin: piece.origin,
            untouched: false,
            flat: piece.flat,
            alive: true,
        }));
        patch.note_edges_beyond(parts, points);
        patch
    }

    /// Whether all triangles at a point are in the patch.
    pub(super) fn is_complete(&self, point: u32) -> bool {
        point >= self.first_copy || self.complete.get(point)
    }

    /// Points, not all of whose triangles are here, at which triangles came apart all the same: at edges to a point of
    /// which copies were made.
    pub(super) fn pinched(&self, copied_from: &[(u32, u32)]) -> FxHashSet<u32> {
        let original: FxHashMap<u32, u32> = copied_from.iter().copied().collect();
        let copied: FxHashSet<u32> = copied_from.iter().map(|&(_, of)| of).collect();
        let mut seen: FxHashMap<(u32, u32), u32> = FxHashMap::default();
        let mut pinched = FxHashSet::default();
        for face in self.faces.iter().filter(|face| face.alive && !copied_from.is_empty()) {
            for &point in face.corners.iter().filter(|&&point| !self.is_complete(point)) {
                for &other in &face.corners {
                    let of = original.get(&other).copied().unwrap_or(other);
                    if copied.contains(&of) && *seen.entry((point, of)).or_insert(other) != other {
                        pinched.insert(point);
                    }
                }
            }
        }
        pinched
    }

    /// Whether the operation made a point.
    pub(super) fn is_new(&self, point: u32) -> bool {
        point >= self.cutter.operands.vertex_count()
    }

    /// Where a point is.
    pub(super) fn position(&self, point: u32) -> &[f64; 3] {
        if point >= self.first_copy {
            &self.copies[(point - self.first_copy) as usize]
        } else {
            self.cutter.position(point)
        }
    }

    /// Whether a triangle looks the way of the face it was cut from.
    pub(super) fn is_sound(&self, corners: &[u32; 3], origin: Origin) -> bool {
        let (_, (x, y)) = source_and_axes(self.cutter.operands, origin);
        let [a, b, c] = corners.map(|point| {
            let position = self.position(point);
            [position[x], position[y]]
        });
        orient2d(a, b, c) == Sign::Positive
    }

    /// Calls `found` for every kept uncut triangle: part, triangle, its points, and how often it counts (negative where
    /// it is turned over once more).
    fn for_kept(&self, parts: &[Part], mut found: impl FnMut(Part, u32, [u32; 3], i32)) {
        let cutter = self.cutter;
        for &part in parts {
            let first = cutter.operands.first_vertex(part.side);
            let windings = &cutter.windings[part.side];
            for (t, corners) in cutter.operands.sides[part.side].triangles.iter().enumerate() {
                if cutter.faces[part.side].is_cut(t as u32) {
                    continue;
                }
                let count = part.multiplicity(windings[corners[0] as usize]);
                if count != 0 {
                    let points = corners.map(|v| cutter.identification.representative(first + v));
                    found(part, t as u32, points, count);
                }
            }
        }
    }

    fn take_kept_triangles(&mut self, parts: &[Part]) {
        let mut faces = Vec::new();
        let mut taken = [Vec::new(), Vec::new()];
        self.for_kept(parts, |part, t, points, count| {
            if !points.iter().any(|&point| self.complete.get(point)) {
                return;
            }
            taken[part.side].push(t);
            let reversed = part.reversed != (count < 0);
            let [a, b, c] = points;
            let face = Face {
                corners: if reversed { [a, c, b] } else { [a, b, c] },
                origin: Origin { operand: part.side as u32, triangle: t, reversed },
                untouched: count == 1,
                flat: false,
                alive: true,
            };
            faces.extend(std::iter::repeat_n(face, count.unsigned_abs() as usize));
        });
        self.faces = faces;
        self.taken = taken;
    }

    fn note_edges_beyond(&mut self, parts: &[Part], points: usize) {
        let mut here = Flags::new(points);
        for face in &self.faces {
            face.corners.iter().for_each(|&point| here.set(point));
        }
        let mut beyond = FxHashSet::default();
        self.for_kept(parts, |part, _, points, count| {
            if points.iter().any(|&point| self.complete.get(point)) {
                return;
            }
            for k in 0..3 {
                let (u, v) = (points[k], points[(k + 1) % 3]);
                if here.get(u) && here.get(v) {
                    beyond.insert(if part.reversed != (count < 0) { (v, u) } else { (u, v) });
                }
            }
        });
        self.beyond = beyond;
    }

    /// Drops triangles with a repeated corner, and pairs of opposite triangles.
    pub(super) fn cancel(&mut self) {
        let mut order: Vec<([u32; 3], bool, u32)> = Vec::with_capacity(self.faces.len());
        for (i, face) in self.faces.iter_mut().enumerate().filter(|(_, face)| face.alive) {
            let [a, b, c] = face.corners;
            if a == b || b == c || c == a {
                face.alive = false;
                continue;
            }
            let mut sorted = face.corners;
            sorted.sort_unstable();
            let even = [[a, b, c], [b, c, a], [c, a, b]].contains(&sorted);
            order.push((sorted, even, i as u32));
        }
        order.sort_unstable();
        for group in order.chunk_by(|x, y| x.0 == y.0) {
            let odd = group.partition_point(|entry| !entry.1);
            let pairs = odd.min(group.len() - odd);
            for entry in group[..pairs].iter().chain(&group[group.len() - pairs..]) {
                self.faces[entry.2 as usize].alive = false;
            }
        }
    }

    /// The boundary of the sum of all triangles: directed edges that do not cancel, ascending.
    #[cfg(debug_assertions)]
    pub(super) fn boundary(&self) -> Vec<((u32, u32), i32)> {
        let mut counts: std::collections::BTreeMap<(u32, u32), i32> = std::collections::BTreeMap::new();
        for face in self.faces.iter().filter(|face| face.alive) {
            for k in 0..3 {
                let (u, v) = (face.corners[k], face.corners[(k + 1) % 3]);
                *counts.entry((u.min(v), u.max(v))).or_default() += if u < v { 1 } else { -1 };
            }
        }
        counts.into_iter().filter(|&((u, v), count)| count != 0 && u != v).collect()
    }

    /// Builds the adjacency; from now on every directed edge occurs once.
    pub(super) fn connect(&mut self) {
        self.left_of.clear();
        self.some_face.clear();
        for index in 0..self.faces.len() as u32 {
            if self.faces[index as usize].alive {
                self.link(index);
            }
        }
    }

    fn link(&mut self, index: u32) {
        let corners = self.faces[index as usize].corners;
        for k in 0..3 {
            self.left_of.insert((corners[k], corners[(k + 1) % 3]), index);
            self.some_face.insert(corners[k], index);
        }
    }

    /// The triangle to the left of a directed edge.
    pub(super) fn left_of(&self, from: u32, to: u32) -> Option<u32> {
        self.left_of.get(&(from, to)).copied()
    }

    /// Whether a directed edge exists, here or beyond.
    pub(super) fn has_edge(&self, from: u32, to: u32) -> bool {
        self.left_of.contains_key(&(from, to)) || self.beyond.contains(&(from, to))
    }

    /// The triangles round a complete point with the corner that follows it in each, counter-clockwise.
    pub(super) fn star(&self, point: u32) -> Option<Vec<(u32, u32)>> {
        let start = *self.some_face.get(&point)?;
        let mut star = Vec::new();
        let mut face = start;
        loop {
            let corners = self.faces[face as usize].corners;
            let k = corners.iter().position(|&corner| corner == point)?;
            star.push((face, corners[(k + 1) % 3]));
            face = self.left_of(point, corners[(k + 2) % 3])?;
            if face == start {
                return Some(star);
            }
            if star.len() > self.faces.len() {
                return None;
            }
        }
    }

    /// Replaces triangles by others.
    pub(super) fn replace(&mut self, old: &[u32], new: &[([u32; 3], Origin)]) {
        for &index in old {
            let corners = self.faces[index as usize].corners;
            for k in 0..3 {
                self.left_of.remove(&(corners[k], corners[(k + 1) % 3]));
                self.some_face.remove(&corners[k]);
            }
            self.faces[index as usize].alive = false;
        }
        for (i, &(corners, origin)) in new.iter().enumerate() {
            let face = Face { corners, origin, untouched: false, flat: false, alive: true };
            let index = match old.get(i) {
                Some(&index) => {
                    self.faces[index as usize] = face;
                    index
                }
                None => {
                    self.faces.push(face);
                    self.faces.len() as u32 - 1
                }
            };
            self.link(index);
        }
        // Points that lost the triangle they were known by, but still have others.
        for &index in old {
            for (from, to) in self.border_of(index) {
                if !self.some_face.contains_key(&from)
                    && let Some(face) = self.left_of(from, to)
                {
                    self.some_face.insert(from, face);
                }
            }
        }
    }

    fn border_of(&self, index: u32) -> Vec<(u32, u32)> {
        let corners = self.faces[index as usize].corners;
        (0..3).map(|k| (corners[k], corners[(k + 1) % 3])).collect()
    }

    /// The new triangles, and which uncut ones they replace.
    pub(super) fn collect(self) -> Tidied {
        let operands = self.cutter.operands;
        let mut replaced = [0, 1].map(|side| BitSet::new(operands.sides[side].triangles.len()));
        for side in 0..2 {
            self.taken[side].iter().for_each(|&t| replaced[side].insert(t));
        }
        let mut new = Vec::new();
        for face in self.faces.iter().filter(|face| face.alive) {
            if face.untouched {
                replaced[face.origin.operand as usize].remove(face.origin.triangle);
            } else {
                new.push(NewTriangle { corners: face.corners, origin: face.origin, flat: face.flat });
            }
        }
        new.sort_by_key(|triangle| (triangle.origin.operand, triangle.origin.triangle));
        Tidied { new, replaced, copies: self.copies }
    }
}

impl Surface for Patch<'_> {
    fn len(&self) -> usize {
        self.faces.len()
    }

    fn corners(&self, triangle: u32) -> Option<[u32; 3]> {
        let face = &self.faces[triangle as usize];
        face.alive.then_some(face.corners)
    }

    fn set_corners(&mut self, triangle: u32, corners: [u32; 3]) {
        let face = &mut self.faces[triangle as usize];
        *face = Face { corners, untouched: false, ..*face };
    }

    fn add_part(&mut self, of: u32, corners: [u32; 3]) {
        self.faces.push(Face { corners, untouched: false, ..self.faces[of as usize] });
    }

    fn position(&self, point: u32) -> [f64; 3] {
        *self.position(point)
    }

    /// The corner of the face a triangle was cut from that lies furthest to the left: a narrow triangle's own corner would
    /// tell nothing but how it was rounded.
    fn left_of_side(&self, triangle: u32, side: usize) -> [f64; 3] {
        let face = &self.faces[triangle as usize];
        let corners = [0, 1, 2].map(|k| *self.position(face.corners[(side + k) % 3]));
        let (source, (x, y)) = source_and_axes(self.cutter.operands, face.origin);
        let [p, q] = [corners[0], corners[1]].map(|point| [point[x], point[y]]);
        let left = |c: &[f64; 3]| (q[0] - p[0]) * (c[y] - p[1]) - (q[1] - p[1]) * (c[x] - p[0]);
        source
            .into_iter()
            .max_by(|c, d| left(c).total_cmp(&left(d)))
            .filter(|corner| left(corner) > 0.0)
            .unwrap_or(corners[2])
    }

    fn add_point(&mut self, position: [f64; 3]) -> u32 {
        self.copies.push(position);
        self.first_copy + self.copies.len() as u32 - 1
    }

    fn is_complete(&self, point: u32) -> bool {
        self.is_complete(point)
    }
}

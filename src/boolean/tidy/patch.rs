//! The part of the result that tidying works on.

use rustc_hash::{FxHashMap, FxHashSet};

use super::Tidied;
use super::adjacency::Adjacency;
use super::kept::{Renumbering, edges_beyond, kept_triangles};
use super::source::Source;
use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::ids::PointId;
use crate::boolean::complex::origin::Origin;
use crate::boolean::cut::piece::Piece;
use crate::exact::Projection;
use crate::exact::{Sign, orient2d};
use crate::mesh::BitSet;
use crate::mesh::Buckets;
use crate::mesh::Surface;

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
///
/// The patch has numbers of its own for its points, without gaps and in the order of the others: what is kept for each point
/// is then a list, and points near each other are so in memory.
pub(super) struct Patch<'a> {
    cutter: &'a Source<'a>,
    pub(super) faces: Vec<Face>,
    /// For each point which vertex or node it is, ascending; copies are not among them.
    numbers: Vec<u32>,
    /// How many of the points are vertices; they come first.
    vertices: u32,
    /// Where each point is, the copies last.
    positions: Vec<[f64; 3]>,
    /// Points all of whose triangles are here.
    complete: BitSet,
    /// Filled by [`connect`](Self::connect).
    adjacency: Adjacency,
    /// Directed edges of the result outside the patch between points of the patch.
    beyond: FxHashSet<(u32, u32)>,
    /// Uncut triangles that were taken into the patch.
    taken: [Vec<u32>; 2],
}

impl<'a> Patch<'a> {
    /// The pieces and all kept triangles round their points, and round some others.
    pub(super) fn new(
        cutter: &'a Source<'a>,
        parts: &[Part],
        pieces: &[Piece],
        others: &FxHashSet<u32>,
    ) -> Self {
        let count = cutter.point_count() as usize;
        let mut complete = BitSet::new(count);
        for point in pieces.iter().flat_map(|piece| piece.corners) {
            complete.insert(point.number());
        }
        // Kept triangles of both operands may share a point where all that was cut cancelled.
        for point in cutter.representatives().chain(others.iter().copied()) {
            complete.insert(point);
        }
        let (mut faces, taken) = kept_triangles(cutter, parts, &complete);
        faces.extend(pieces.iter().map(|piece| Face {
            corners: piece.corners.map(PointId::number),
            origin: piece.origin,
            untouched: false,
            flat: piece.flat,
            alive: true,
        }));
        let numbers = Renumbering::of(count, faces.iter().flat_map(|face| face.corners));
        let beyond = edges_beyond(cutter, parts, &complete, &numbers);
        for face in &mut faces {
            face.corners = face.corners.map(|point| numbers.here(point));
        }
        let numbers = numbers.all();
        let mut complete_here = BitSet::new(numbers.len());
        for (here, &point) in (0..).zip(&numbers) {
            if complete.contains(point) {
                complete_here.insert(here);
            }
        }
        Self {
            cutter,
            faces,
            vertices: numbers.partition_point(|&point| point < cutter.body.complex().vertex_count()) as u32,
            positions: numbers.iter().map(|&point| *cutter.position(point)).collect(),
            numbers,
            complete: complete_here,
            adjacency: Adjacency::default(),
            beyond,
            taken,
        }
    }

    /// The patch's number of a vertex or node; `None` if it is not in the patch.
    pub(super) fn here(&self, point: u32) -> Option<u32> {
        self.numbers.binary_search(&point).ok().map(|here| here as u32)
    }

    /// The number of a point outside the patch: copies come after the nodes.
    pub(super) fn number(&self, point: u32) -> u32 {
        match self.numbers.get(point as usize) {
            Some(&number) => number,
            None => self.first_copy() + (point - self.numbers.len() as u32),
        }
    }

    /// The number outside the patch of the first copy.
    fn first_copy(&self) -> u32 {
        self.cutter.point_count()
    }

    /// Whether all triangles at a point are in the patch.
    #[inline]
    pub(super) fn is_complete(&self, point: u32) -> bool {
        point as usize >= self.numbers.len() || self.complete.contains(point)
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
        point >= self.vertices
    }

    /// Where a point is.
    #[inline]
    pub(super) fn position(&self, point: u32) -> &[f64; 3] {
        &self.positions[point as usize]
    }

    /// The size of rounding.
    pub(super) fn rounding(&self) -> f64 {
        self.cutter.rounding
    }

    /// Points along the axis a face looks along most, so that it is seen counter-clockwise.
    pub(super) fn projected(&self, points: &[u32], origin: Origin) -> Vec<[f64; 2]> {
        let seen = Projection::of(&self.cutter.body.complex().source(origin));
        points.iter().map(|&point| seen.project(self.position(point))).collect()
    }

    /// Whether a triangle looks the way of the face it was cut from.
    pub(super) fn is_sound(&self, corners: &[u32; 3], origin: Origin) -> bool {
        let seen = Projection::of(&self.cutter.body.complex().source(origin));
        let [a, b, c] = corners.map(|point| seen.project(self.position(point)));
        orient2d(a, b, c) == Sign::Positive
    }

    /// Drops triangles with a repeated corner, and pairs of opposite triangles.
    pub(super) fn cancel(&mut self) {
        for face in self.faces.iter_mut().filter(|face| face.alive) {
            let [a, b, c] = face.corners;
            face.alive = a != b && b != c && c != a;
        }
        // Triangles with the same corners have the same lowest one.
        let alive = (0..).zip(&self.faces).filter(|(_, face)| face.alive);
        let mut by_lowest = Buckets::new(
            self.positions.len(),
            alive.map(|(i, face)| {
                let [a, b, c] = face.corners;
                let lowest = a.min(b).min(c);
                let (next, last) = match lowest {
                    _ if lowest == a => (b, c),
                    _ if lowest == b => (c, a),
                    _ => (a, b),
                };
                (lowest, (next.min(last), next.max(last), next < last, i))
            }),
        );
        for bucket in by_lowest.each_mut().filter(|bucket| bucket.len() > 1) {
            bucket.sort_unstable();
            for group in bucket.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
                let odd = group.partition_point(|entry| !entry.2);
                let pairs = odd.min(group.len() - odd);
                for entry in group[..pairs].iter().chain(&group[group.len() - pairs..]) {
                    self.faces[entry.3 as usize].alive = false;
                }
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
        self.adjacency = Adjacency::new(self.positions.len(), &self.faces);
    }

    /// The triangle to the left of a directed edge.
    pub(super) fn left_of(&self, from: u32, to: u32) -> Option<u32> {
        self.adjacency.left_of(from, to)
    }

    /// Whether a directed edge exists, here or beyond.
    pub(super) fn has_edge(&self, from: u32, to: u32) -> bool {
        self.left_of(from, to).is_some() || self.beyond.contains(&(from, to))
    }

    /// The triangles round a complete point with the corner that follows it in each, counter-clockwise.
    pub(super) fn star(&self, point: u32) -> Option<Vec<(u32, u32)>> {
        let start = self.adjacency.some_face(point)?;
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
            self.adjacency.unlink(corners);
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
            self.adjacency.link(index, corners);
        }
        // Points that lost the triangle they were known by, but still have others.
        for &index in old {
            self.adjacency.find_some_faces(self.faces[index as usize].corners);
        }
    }

    /// The new triangles, and which uncut ones they replace.
    pub(super) fn collect(self) -> Tidied {
        let operands = &self.cutter.body.complex().operands;
        let mut replaced = [0, 1].map(|side| BitSet::new(operands[side].triangles.len()));
        for side in 0..2 {
            self.taken[side].iter().for_each(|&t| replaced[side].insert(t));
        }
        let mut new = Vec::new();
        for face in self.faces.iter().filter(|face| face.alive) {
            if face.untouched {
                // It stays as it was.
                replaced[face.origin.operand as usize].remove(face.origin.triangle);
            } else {
                let corners = face.corners.map(|point| PointId::new(self.number(point)));
                new.push(Piece { corners, origin: face.origin, flat: face.flat });
            }
        }
        new.sort_by_key(|triangle| (triangle.origin.operand, triangle.origin.triangle));
        let copies = self.positions[self.numbers.len()..].to_vec();
        Tidied { new, replaced, copies }
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
        let source = self.cutter.body.complex().source(face.origin);
        let seen = Projection::of(&source);
        let [p, q] = [corners[0], corners[1]].map(|point| seen.project(&point));
        let left = |c: &[f64; 3]| {
            let [x, y] = seen.project(c);
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
        };
        source
            .into_iter()
            .max_by(|c, d| left(c).total_cmp(&left(d)))
            .filter(|corner| left(corner) > 0.0)
            .unwrap_or(corners[2])
    }

    fn point_count(&self) -> usize {
        self.positions.len()
    }

    fn add_point(&mut self, position: [f64; 3]) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }

    fn is_complete(&self, point: u32) -> bool {
        self.is_complete(point)
    }
}

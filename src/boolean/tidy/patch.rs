//! The part of the result that the clean-up works on.

use std::ops::Index;

use rustc_hash::FxHashSet;

use super::adjacency::Adjacency;
#[cfg(debug_assertions)]
use super::face::{Edge, edge_between};
use super::face::{Face, LocalFace, LocalPoint};
use super::flatten::Flattening;
use super::source::Source;
use crate::boolean::complex::ids::PointId;
use crate::boolean::complex::origin::Origin;
use crate::boolean::cut::piece::Piece;
use crate::exact::{Sign, orient2d};
use crate::mesh::{BitSet, Buckets};

/// What the clean-up made of the pieces.
pub(crate) struct Tidied {
    /// The triangles of the patch that were cut or changed.
    pub(crate) new: Vec<Piece>,
    /// Uncut triangles that are replaced, by side.
    pub(crate) replaced: [BitSet; 2],
    /// Positions of points made here; they are numbered after all others.
    pub(crate) copies: Vec<[f64; 3]>,
    /// How often a step stopped at its bound with work left.
    pub(crate) stopped: u64,
    /// What became one plane that was so but for rounding.
    pub(crate) flattening: Flattening,
}

/// What a patch begins with.
pub(super) struct Contents {
    pub(super) faces: Vec<Face>,
    /// For each point which vertex or node of the source it is, ascending.
    pub(super) numbers: Vec<PointId>,
    /// Points all of whose triangles are among the faces.
    pub(super) complete: BitSet,
    /// Directed edges of the result outside the patch between points of the patch.
    pub(super) outer_edges: FxHashSet<(LocalPoint, LocalPoint)>,
    /// Uncut triangles that are among the faces, by side.
    pub(super) taken: [Vec<u32>; 2],
}

/// Triangles around the intersection curve, the one value that every step of the clean-up changes.
///
/// The patch has numbers of its own for its points, without gaps and in the order of the others: what is kept for each point
/// is then a list, and points near each other are so in memory. Its triangles are at first a chain: an edge may have any
/// number of them. From [`connect`](Self::connect) on they are a 2-manifold with adjacency.
pub(super) struct Patch<'a> {
    source: Source<'a>,
    faces: Vec<Face>,
    /// For each point which vertex or node of the source it is, ascending; copies are not among them.
    numbers: Vec<PointId>,
    /// How many of the points are vertices; they come first.
    vertex_count: u32,
    /// Where each point is, the copies last.
    positions: Vec<[f64; 3]>,
    /// Points all of whose triangles are here.
    complete: BitSet,
    /// Filled by [`connect`](Self::connect).
    adjacency: Adjacency,
    /// Directed edges of the result outside the patch between points of the patch.
    outer_edges: FxHashSet<(LocalPoint, LocalPoint)>,
    /// Uncut triangles that were taken into the patch, by side.
    taken: [Vec<u32>; 2],
    /// How often a step stopped at its bound with work left.
    stopped: u64,
    /// What became one plane that was so but for rounding.
    flattening: Flattening,
}

impl Index<LocalFace> for Patch<'_> {
    type Output = Face;

    #[inline]
    fn index(&self, face: LocalFace) -> &Face {
        &self.faces[face.index()]
    }
}

impl<'a> Patch<'a> {
    pub(super) fn new(source: Source<'a>, contents: Contents) -> Self {
        let Contents { faces, numbers, complete, outer_edges, taken } = contents;
        Self {
            source,
            faces,
            vertex_count: numbers.partition_point(|point| point.number() < source.vertex_count()) as u32,
            positions: numbers.iter().map(|&point| source.position(point)).collect(),
            numbers,
            complete,
            adjacency: Adjacency::default(),
            outer_edges,
            taken,
            stopped: 0,
            flattening: Flattening::default(),
        }
    }

    /// The rest of the arrangement.
    pub(super) fn source(&self) -> Source<'a> {
        self.source
    }

    /// The patch's number of a vertex or node; `None` if it is not in the patch.
    pub(super) fn find_point(&self, point: PointId) -> Option<LocalPoint> {
        self.numbers.binary_search(&point).ok().map(|local| LocalPoint(local as u32))
    }

    /// The number of a point outside the patch: copies come after the nodes.
    pub(super) fn source_point(&self, point: LocalPoint) -> PointId {
        match self.numbers.get(point.index()) {
            Some(&number) => number,
            None => PointId::new((self.source.point_count() + point.index() - self.numbers.len()) as u32),
        }
    }

    /// Number of points, the copies included.
    pub(super) fn point_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of faces, the dropped ones included.
    pub(super) fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The numbers of all faces, the dropped ones included.
    pub(super) fn face_numbers(&self) -> impl Iterator<Item = LocalFace> + use<> {
        (0..self.faces.len() as u32).map(LocalFace)
    }

    /// The faces that were not dropped.
    pub(super) fn faces(&self) -> impl Iterator<Item = (LocalFace, &Face)> + Clone {
        (0..).map(LocalFace).zip(&self.faces).filter(|(_, face)| face.alive)
    }

    /// Whether all triangles at a point are in the patch.
    #[inline]
    pub(super) fn is_complete(&self, point: LocalPoint) -> bool {
        point.index() >= self.numbers.len() || self.complete.contains(point.0)
    }

    /// Notes that a step stopped at its bound with work left.
    pub(super) fn count_stop(&mut self) {
        self.stopped += 1;
    }

    /// Adds to what became one plane.
    pub(super) fn note_flattening(&mut self, more: Flattening) {
        self.flattening = self.flattening.and(more);
    }

    /// Whether the operation made a point.
    pub(super) fn is_new(&self, point: LocalPoint) -> bool {
        point.0 >= self.vertex_count
    }

    /// Where a point is.
    #[inline]
    pub(super) fn position(&self, point: LocalPoint) -> &[f64; 3] {
        &self.positions[point.index()]
    }

    /// Points in the projection of the plane of a face, so that the face is seen counter-clockwise.
    pub(super) fn project(&self, points: &[LocalPoint], origin: Origin) -> Vec<[f64; 2]> {
        let (_, projection) = self.source.source_and_projection(origin);
        points.iter().map(|&point| projection.project(self.position(point))).collect()
    }

    /// Whether a triangle looks the way of the face it was cut from.
    pub(super) fn is_sound(&self, corners: [LocalPoint; 3], origin: Origin) -> bool {
        let (_, projection) = self.source.source_and_projection(origin);
        let [a, b, c] = corners.map(|point| projection.project(self.position(point)));
        orient2d(a, b, c) == Sign::Positive
    }

    /// Marks a face whose corners lay on one line before they were rounded.
    pub(super) fn mark_flat(&mut self, face: LocalFace) {
        self.faces[face.index()].flat = true;
    }

    /// Gives a face other corners.
    pub(super) fn set_corners(&mut self, face: LocalFace, corners: [LocalPoint; 3]) {
        let face = &mut self.faces[face.index()];
        face.corners = corners;
        face.untouched = false;
    }

    /// Makes a face a part of the face that another was cut from.
    pub(super) fn set_plane_of(&mut self, face: LocalFace, other: LocalFace) {
        let Face { origin, flat, .. } = self.faces[other.index()];
        let face = &mut self.faces[face.index()];
        (face.origin, face.flat) = (origin, flat);
    }

    /// Adds a face that is a part of another.
    pub(super) fn add_part(&mut self, of: LocalFace, corners: [LocalPoint; 3]) -> LocalFace {
        self.faces.push(Face { corners, untouched: false, alive: true, ..self.faces[of.index()] });
        LocalFace(self.faces.len() as u32 - 1)
    }

    /// Adds a face.
    pub(super) fn add_face(&mut self, corners: [LocalPoint; 3], origin: Origin, flat: bool) {
        self.faces.push(Face { corners, origin, untouched: false, flat, alive: true });
    }

    /// Drops a face.
    pub(super) fn drop_face(&mut self, face: LocalFace) {
        self.faces[face.index()].alive = false;
    }

    /// Adds a copy.
    pub(super) fn add_point(&mut self, position: [f64; 3]) -> LocalPoint {
        self.positions.push(position);
        LocalPoint(self.positions.len() as u32 - 1)
    }

    /// Puts other points into the place of points, in all faces.
    pub(super) fn substitute(&mut self, substitute: impl Fn(LocalPoint) -> LocalPoint) {
        for face in self.faces.iter_mut().filter(|face| face.alive) {
            let corners = face.corners.map(&substitute);
            if corners != face.corners {
                face.corners = corners;
                face.untouched = false;
            }
        }
    }

    /// Drops triangles with a repeated corner, and pairs of opposite triangles.
    pub(super) fn cancel(&mut self) {
        for face in self.faces.iter_mut().filter(|face| face.alive) {
            let [a, b, c] = face.corners;
            face.alive = a != b && b != c && c != a;
        }
        // Triangles with the same corners have the same lowest one.
        let mut by_lowest = Buckets::new(
            self.positions.len(),
            self.faces().map(|(number, face)| {
                let [a, b, c] = face.corners;
                let lowest = a.min(b).min(c);
                let (next, last) = match lowest {
                    _ if lowest == a => (b, c),
                    _ if lowest == b => (c, a),
                    _ => (a, b),
                };
                (lowest.0, (next.min(last), next.max(last), next < last, number))
            }),
        );
        for bucket in by_lowest.each_mut().filter(|bucket| bucket.len() > 1) {
            bucket.sort_unstable();
            for group in bucket.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
                let odd = group.partition_point(|entry| !entry.2);
                let pairs = odd.min(group.len() - odd);
                for entry in group[..pairs].iter().chain(&group[group.len() - pairs..]) {
                    self.faces[entry.3.index()].alive = false;
                }
            }
        }
    }

    /// The boundary of the sum of all triangles: directed edges that do not cancel, ascending.
    #[cfg(debug_assertions)]
    pub(super) fn boundary(&self) -> Vec<(Edge, i32)> {
        let mut counts: std::collections::BTreeMap<Edge, i32> = std::collections::BTreeMap::new();
        for (_, face) in self.faces() {
            for (u, v) in face.sides() {
                *counts.entry(edge_between(u, v)).or_default() += if u < v { 1 } else { -1 };
            }
        }
        counts.into_iter().filter(|&((u, v), count)| count != 0 && u != v).collect()
    }

    /// Builds the adjacency of what must be a 2-manifold by now.
    pub(super) fn connect(&mut self) {
        self.adjacency = Adjacency::new(self.point_count(), &self.faces);
    }

    /// The triangle to the left of a directed edge.
    pub(super) fn left_of(&self, from: LocalPoint, to: LocalPoint) -> Option<LocalFace> {
        self.adjacency.left_of(from, to)
    }

    /// Whether the result has a directed edge, in the patch or outside.
    pub(super) fn has_edge(&self, from: LocalPoint, to: LocalPoint) -> bool {
        self.left_of(from, to).is_some() || self.has_outer_edge(from, to)
    }

    /// Whether the result has a directed edge outside the patch.
    pub(super) fn has_outer_edge(&self, from: LocalPoint, to: LocalPoint) -> bool {
        self.outer_edges.contains(&(from, to))
    }

    /// The triangles around a complete point with the corner that follows it in each, counter-clockwise.
    pub(super) fn star(&self, point: LocalPoint) -> Option<Vec<(LocalFace, LocalPoint)>> {
        let start = self.adjacency.some_face(point)?;
        let mut star = Vec::new();
        let mut face = start;
        loop {
            let corners = self[face].corners;
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
    pub(super) fn replace(&mut self, old: &[LocalFace], new: &[([LocalPoint; 3], Origin)]) {
        for &index in old {
            self.adjacency.unlink(self[index].corners);
            self.drop_face(index);
        }
        for (i, &(corners, origin)) in new.iter().enumerate() {
            let face = Face { corners, origin, untouched: false, flat: false, alive: true };
            let index = match old.get(i) {
                Some(&index) => {
                    self.faces[index.index()] = face;
                    index
                }
                None => {
                    self.faces.push(face);
                    LocalFace(self.faces.len() as u32 - 1)
                }
            };
            self.adjacency.link(index, corners);
        }
        // Points that lost the triangle they were known by, but still have others.
        for &index in old {
            self.adjacency.find_some_faces(self.faces[index.index()].corners);
        }
    }

    /// The new triangles, and which uncut ones they replace.
    pub(super) fn collect(self) -> Tidied {
        let mut replaced = [0, 1].map(|side| BitSet::new(self.source.triangle_count(side)));
        for side in 0..2 {
            self.taken[side].iter().for_each(|&t| replaced[side].insert(t));
        }
        let mut new = Vec::new();
        for (_, face) in self.faces() {
            if face.untouched {
                // It stays as it was.
                replaced[face.origin.operand as usize].remove(face.origin.triangle);
            } else {
                let corners = face.corners.map(|point| self.source_point(point));
                new.push(Piece { corners, origin: face.origin, flat: face.flat });
            }
        }
        new.sort_by_key(|triangle| (triangle.origin.operand, triangle.origin.triangle));
        let copies = self.positions[self.numbers.len()..].to_vec();
        Tidied { new, replaced, copies, stopped: self.stopped, flattening: self.flattening }
    }
}

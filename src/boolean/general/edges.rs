//! The edges of surfaces, with all faces round each.

use std::ops::Range;

use crate::boolean::complex::ids::{EdgeId, FaceId, VertexId};
use crate::mesh::Buckets;

/// Side k of a face: from its corner k to the next one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Side(u32);

impl Side {
    fn new(face: u32, k: u32) -> Self {
        Self(face << 2 | k)
    }

    /// Side 0 of a face.
    pub(crate) fn first_of(face: FaceId) -> Self {
        Self::new(face.number(), 0)
    }

    #[inline]
    pub(crate) fn face(self) -> FaceId {
        FaceId::new(self.0 >> 2)
    }

    #[inline]
    pub(crate) fn place(self) -> usize {
        (self.0 & 3) as usize
    }
}

/// The most faces whose sides can be numbered.
pub(crate) const MOST_FACES: usize = 1 << 30;

/// The edges of all faces, or of some. An edge runs from its low end, the vertex with the lower number, to its high end.
#[derive(Debug)]
pub(crate) struct Edges {
    ends: Vec<[VertexId; 2]>,
    /// Where the sides of each edge begin; one more for the end.
    starts: Vec<u32>,
    sides: Vec<Side>,
    /// By face.
    of_face: Vec<[EdgeId; 3]>,
}

impl Edges {
    /// The edges of triangles with the given corners.
    pub(crate) fn new(corners: &[[u32; 3]], vertices: usize) -> Self {
        Self::of_faces(corners, vertices, (0..corners.len() as u32).map(FaceId::new))
    }

    /// The edges of some of these triangles. Each has the sides of these alone.
    pub(crate) fn of_faces(
        corners: &[[u32; 3]],
        vertices: usize,
        faces: impl ExactSizeIterator<Item = FaceId> + Clone,
    ) -> Self {
        // 1. All sides by their lower ends, and those by their higher ends.
        let count = faces.len();
        let half_edges = faces.flat_map(|face| {
            let corners = &corners[face.index()];
            [0, 1, 2].map(|k| {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                (u.min(v), [u.max(v), Side::new(face.number(), k as u32).0])
            })
        });
        let mut at_low = Buckets::new(vertices, half_edges);
        let mut edges = Self {
            ends: Vec::with_capacity(count * 3 / 2),
            starts: Vec::with_capacity(count * 3 / 2 + 1),
            sides: Vec::with_capacity(count * 3),
            of_face: vec![[EdgeId::NONE; 3]; corners.len()],
        };
        // 2. Equal ones are an edge.
        for (low, list) in (0..).map(VertexId::new).zip(at_low.each_mut()) {
            list.sort_unstable();
            for sides in list.chunk_by(|x, y| x[0] == y[0]) {
                let edge = EdgeId::new(edges.ends.len() as u32);
                edges.ends.push([low, VertexId::new(sides[0][0])]);
                edges.starts.push(edges.sides.len() as u32);
                for &[_, side] in sides {
                    let side = Side(side);
                    edges.sides.push(side);
                    edges.of_face[side.face().index()][side.place()] = edge;
                }
            }
        }
        edges.starts.push(edges.sides.len() as u32);
        edges
    }

    /// Takes the ends of all edges from the corners of their faces, whose vertices have got other numbers.
    pub(crate) fn renumber(&mut self, corners: &[[u32; 3]]) {
        for (ends, &start) in self.ends.iter_mut().zip(&self.starts) {
            let side = self.sides[start as usize];
            let (k, corners) = (side.place(), corners[side.face().index()]);
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            *ends = [u.min(v), u.max(v)].map(VertexId::new);
        }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// All edges with their ends.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (EdgeId, [VertexId; 2])> {
        (0..).map(EdgeId::new).zip(self.ends.iter().copied())
    }

    /// The low end of an edge and its high end.
    #[inline]
    pub(crate) fn ends(&self, edge: EdgeId) -> [VertexId; 2] {
        self.ends[edge.index()]
    }

    /// The edge that a side of a face is; the face must be one of those whose edges these are.
    #[inline]
    pub(crate) fn edge(&self, face: FaceId, k: usize) -> EdgeId {
        self.of_face[face.index()][k]
    }

    /// The sides that an edge is: of two faces, nearly always; of one at the border of those whose edges these are.
    #[inline]
    pub(crate) fn sides(&self, edge: EdgeId) -> &[Side] {
        &self.sides[self.range(edge)]
    }

    /// The same, to be put in order.
    pub(crate) fn sides_mut(&mut self, edge: EdgeId) -> &mut [Side] {
        let range = self.range(edge);
        &mut self.sides[range]
    }

    fn range(&self, edge: EdgeId) -> Range<usize> {
        self.starts[edge.index()] as usize..self.starts[edge.index() + 1] as usize
    }
}

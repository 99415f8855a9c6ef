//! Whether two faces cross, and where.
//!
//! Two faces without a common vertex cross in exactly two nodes or not at all. With one vertex in common they cross iff the
//! edge opposite it of one pierces the other; then the segment runs from the vertex to that node. With two in common they do
//! not cross; with three they are one face.

use super::edges::Edges;
use super::surfaces::Surfaces;
use crate::boolean::complex::Corner;
use crate::boolean::complex::along::sides_along;
use crate::boolean::complex::ids::{EdgeId, FaceId, VertexId};
use crate::boolean::complex::meeting::Meeting;
use crate::boolean::complex::planes;
use crate::boolean::complex::predicates::{Plane, Predicates};
use crate::boolean::complex::rounding::Rounding;

/// Where an edge pierces a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Node {
    pub(crate) edge: EdgeId,
    pub(crate) face: FaceId,
    /// Whether the edge, from its low end to its high one, goes from the face's inner side to its outer side.
    pub(crate) leaves: bool,
}

/// One end of a segment, before nodes are numbered.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    Node(Node),
    Vertex(VertexId),
}

/// A segment, before nodes are numbered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) faces: [FaceId; 2],
    pub(super) tail: End,
    pub(super) head: End,
}

/// What deciding about pairs needs.
pub(super) struct Search<'a> {
    pub(super) surfaces: &'a Surfaces,
    pub(super) edges: &'a Edges,
    pub(super) predicates: Predicates<'a>,
    pub(super) rounding: Rounding,
}

/// Pairs of faces that lie on each other, and edges.
#[derive(Default)]
pub(super) struct Touching {
    /// In one plane, and folded back at a common edge.
    pub(super) exactly: Vec<[FaceId; 2]>,
    /// In one plane but for rounding.
    pub(super) nearly: Vec<[FaceId; 2]>,
    /// The vertices of edges that run along one another.
    pub(super) along_edges: Vec<VertexId>,
}

impl Search<'_> {
    /// Adds the segment of a pair that crosses, and a pair that lies on each other.
    pub(super) fn decide(&self, pair: [FaceId; 2], found: &mut Vec<Found>, touching: &mut Touching) {
        let [a, b] = pair.map(|face| self.surfaces.corners(face));
        let shared = a.iter().position(|x| b.iter().any(|y| y.id == x.id));
        if let Some(i) = shared
            && let Some(j) = b.iter().position(|y| y.id == a[i].id)
        {
            let others = |t: &[Corner; 3], k: usize| [t[(k + 1) % 3].id, t[(k + 2) % 3].id];
            if others(&a, i).iter().any(|v| others(&b, j).contains(v)) {
                // Folded back at a common edge.
                self.touch(pair, true, touching);
                return;
            }
            found.extend(self.cross_from(pair, [&a, &b], [i, j]));
        } else {
            found.extend(self.cross(pair, [&a, &b]));
        }
        let [vertices, others] = pair.map(|face| self.surfaces.vertices(face));
        let [a, b] = pair.map(|face| self.surfaces.positions(face));
        for [i, j] in sides_along(&a, &b) {
            touching.along_edges.extend([vertices[i], vertices[(i + 1) % 3], others[j], others[(j + 1) % 3]]);
        }
        self.touch(pair, shared.is_some(), touching);
    }

    /// Adds a pair that lies on each other, exactly or but for rounding.
    fn touch(&self, pair: [FaceId; 2], are_joined: bool, touching: &mut Touching) {
        let [a, b] = pair.map(|face| self.surfaces.positions(face));
        if planes::lie_on_each_other(&a, &b) {
            touching.exactly.push(pair);
        } else if planes::are_nearly_flush_contact(&a, &b, are_joined, self.rounding) {
            touching.nearly.push(pair);
        }
    }

    /// Where two faces without a common vertex cross: at most ten signs.
    fn cross(&self, faces: [FaceId; 2], [a, b]: [&[Corner; 3]; 2]) -> Option<Found> {
        // 1. How they meet.
        let Meeting { alone: [i, j], inside: [p_inside, u_inside], pierces } =
            Meeting::of(&self.predicates, a, b, self.inside(b, a), || self.inside(a, b))?;
        // 2. The nodes. Directed as in the first face, an edge of it that leaves the second starts the segment; directed as
        //    in the second face, an edge of it that leaves the first ends it.
        let [f, g] = faces;
        let (mut tail, mut head) = (None, None);
        let mut place = |node: Node, is_tail: bool| {
            *(if is_tail { &mut tail } else { &mut head }) = Some(End::Node(node));
        };
        let [[by_pq, by_pr], [by_uv, by_uw]] = pierces;
        if by_pq {
            place(self.node(f, i, p_inside, g), p_inside);
        }
        if by_pr {
            place(self.node(f, (i + 2) % 3, !p_inside, g), !p_inside);
        }
        if by_uv {
            place(self.node(g, j, u_inside, f), !u_inside);
        }
        if by_uw {
            place(self.node(g, (j + 2) % 3, !u_inside, f), u_inside);
        }
        debug_assert_eq!(tail.is_some(), head.is_some(), "faces that cross have a node of each direction");
        Some(Found { faces, tail: tail?, head: head? })
    }

    /// The node where side k of a face pierces another; `leaves`: directed as in its face.
    fn node(&self, face: FaceId, k: usize, leaves: bool, pierced: FaceId) -> Node {
        let (edge, is_forward) = self.edges.of_side(self.surfaces, face, k);
        Node { edge, face: pierced, leaves: leaves == is_forward }
    }

    /// Where two faces cross that have one vertex in common: corner i of the first, corner j of the second.
    fn cross_from(&self, faces: [FaceId; 2], [a, b]: [&[Corner; 3]; 2], [i, j]: [usize; 2]) -> Option<Found> {
        let vertex = End::Vertex(a[i].id);
        for (t, k, plane, from, is_first) in [(a, i, b, 0, true), (b, j, a, 1, false)] {
            let (p, q) = (&t[(k + 1) % 3], &t[(k + 2) % 3]);
            let inside = |x: &Corner| self.predicates.is_positive(&plane[0], &plane[1], &plane[2], x);
            let p_inside = inside(p);
            if p_inside != inside(q) && self.predicates.passes(p, q, plane) {
                let node = End::Node(self.node(faces[from], (k + 1) % 3, p_inside, faces[1 - from]));
                // As above: of the first face, an edge that leaves starts the segment.
                let is_tail = p_inside == is_first;
                let (tail, head) = if is_tail { (node, vertex) } else { (vertex, node) };
                return Some(Found { faces, tail, head });
            }
        }
        None
    }

    /// Which of three corners lie inside the plane of a face.
    #[inline]
    fn inside(&self, face: &[Corner; 3], others: &[Corner; 3]) -> [bool; 3] {
        let [a, b, c] = face;
        let plane = Plane::new(a, b, c);
        let [u, v, w] = others;
        [
            self.predicates.is_inside(&plane, u),
            self.predicates.is_inside(&plane, v),
            self.predicates.is_inside(&plane, w),
        ]
    }
}

//! All places where edges pierce faces, and the segments between them.

use super::cross::{End, Found, Node, Search, Touching};
use super::edges::Edges;
use super::surfaces::Surfaces;
use crate::Error;
use crate::boolean::arrangement::cut_edges::compare_with_plane;
use crate::boolean::complex::Corner;
use crate::boolean::complex::ids::{FaceId, NodeId, PointId, SegmentId, VertexId};
use crate::boolean::complex::predicates::{Perturbed, Predicates};
use crate::boolean::complex::rounding::Rounding;
use crate::exact::{Sign, order};
use crate::mesh::Buckets;
use crate::parallel::Runner;

/// Where two faces cross, along `n_f x n_g` (the normals of `faces[0]` and `faces[1]`) from tail to head: on the first face
/// the inner side of the second lies to the left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    /// The lower one first.
    pub(crate) faces: [FaceId; 2],
    /// Nodes, or at one end a common vertex.
    pub(crate) tail: PointId,
    pub(crate) head: PointId,
}

impl Segment {
    /// The other face.
    #[inline]
    pub(crate) fn partner(&self, face: FaceId) -> FaceId {
        if self.faces[0] == face { self.faces[1] } else { self.faces[0] }
    }
}

/// All nodes, and the segments between them.
#[derive(Debug)]
pub(crate) struct Crossings {
    pub(crate) nodes: Vec<Node>,
    /// By faces.
    pub(crate) segments: Vec<Segment>,
    /// By face, the segments on it, by partner.
    of_face: Buckets<SegmentId>,
    /// Pairs of faces in one plane that overlap.
    pub(crate) touching: Vec<[FaceId; 2]>,
    /// Pairs of faces in one plane but for rounding.
    pub(crate) nearly_flush: Vec<[FaceId; 2]>,
    /// The vertices of edges that run along one another, ascending.
    pub(crate) along_edges: Vec<VertexId>,
    /// How many decisions plain coordinates left open.
    pub(crate) contacts: u64,
    vertex_count: u32,
}

impl Default for SegmentId {
    fn default() -> Self {
        Self::NONE
    }
}

/// Pairs that one thread decides on before the limits are checked.
const PAIRS_AT_ONCE: usize = 4096;

impl Crossings {
    /// Decides which pairs cross, and which touch in one plane.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where the points cannot be numbered.
    pub(crate) fn find(
        surfaces: &Surfaces,
        edges: &Edges,
        pairs: &[[FaceId; 2]],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let predicates = Predicates::new(surfaces);
        let rounding = Rounding::up_to(surfaces.largest_coordinate());
        let search = Search { surfaces, edges, predicates, rounding };
        let pieces = runner.pieces(pairs.len(), PAIRS_AT_ONCE, |range| {
            let (mut found, mut touching) = (Vec::new(), Touching::default());
            for &pair in &pairs[range] {
                search.decide(pair, &mut found, &mut touching);
            }
            (found, touching)
        })?;
        let (mut found, mut touching) = (Vec::new(), Touching::default());
        for (mut more, mut other) in pieces {
            found.append(&mut more);
            touching.exactly.append(&mut other.exactly);
            touching.nearly.append(&mut other.nearly);
            touching.along_edges.append(&mut other.along_edges);
        }
        Self::number(surfaces, &found, touching, search.predicates.into_contacts())
    }

    fn number(
        surfaces: &Surfaces,
        found: &[Found],
        touching: Touching,
        contacts: u64,
    ) -> Result<Self, Error> {
        let ends = found.iter().flat_map(|pair| [pair.tail, pair.head]);
        let mut nodes: Vec<Node> =
            ends.filter_map(|end| if let End::Node(node) = end { Some(node) } else { None }).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let points = surfaces.vertex_count() as usize + nodes.len();
        // Some are left for three-face points and for points that are added later.
        if points > 1 << 31 {
            return Err(Error::TooLarge {
                what: format!("{points} vertices and crossings in one operation"),
            });
        }
        let vertex_count = surfaces.vertex_count();
        let number = |end: End| match end {
            End::Vertex(vertex) => PointId::new(vertex.number()),
            End::Node(node) => {
                PointId::new(vertex_count + nodes.partition_point(|other| *other < node) as u32)
            }
        };
        let segments: Vec<Segment> = found
            .iter()
            .map(|pair| Segment { faces: pair.faces, tail: number(pair.tail), head: number(pair.head) })
            .collect();
        let by_face = (0..).map(SegmentId::new).zip(&segments);
        let by_face = by_face.flat_map(|(id, segment)| segment.faces.map(|face| (face.number(), id)));
        // Segments come by their first face, then by their second: those with a lower partner first.
        let mut of_face = Buckets::new(surfaces.face_count() as usize, by_face);
        for (face, list) in surfaces.faces().zip(of_face.each_mut()) {
            list.sort_unstable_by_key(|segment| segments[segment.index()].partner(face));
        }
        let Touching { exactly: touching, nearly: nearly_flush, mut along_edges } = touching;
        along_edges.sort_unstable();
        along_edges.dedup();
        Ok(Self { nodes, segments, of_face, touching, nearly_flush, along_edges, contacts, vertex_count })
    }

    /// The segments on a face, by partner.
    #[inline]
    pub(crate) fn of_face(&self, face: FaceId) -> &[SegmentId] {
        self.of_face.get(face.index())
    }

    /// All segments, by faces.
    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = (SegmentId, &Segment)> {
        (0..self.segments.len() as u32).map(SegmentId::new).zip(&self.segments)
    }

    #[inline]
    pub(crate) fn segment(&self, segment: SegmentId) -> &Segment {
        &self.segments[segment.index()]
    }

    #[inline]
    pub(crate) fn node(&self, node: NodeId) -> &Node {
        &self.nodes[node.index()]
    }

    /// A node as a point: nodes come after the vertices.
    #[inline]
    pub(crate) fn point(&self, node: NodeId) -> PointId {
        PointId::new(self.vertex_count + node.number())
    }

    /// What an end of a segment is: a node, or a vertex.
    #[inline]
    pub(crate) fn node_of(&self, point: PointId) -> Option<NodeId> {
        point.number().checked_sub(self.vertex_count).map(NodeId::new)
    }

    /// Whether an end of a segment lies on the inner side of a face's plane. The face must not have the end on its border.
    pub(crate) fn is_inside(
        &self,
        surfaces: &Surfaces,
        edges: &Edges,
        predicates: &Predicates<'_>,
        point: PointId,
        face: FaceId,
    ) -> bool {
        let corners = surfaces.corners(face);
        let [a, b, c] = &corners;
        let side = |v: VertexId| {
            let is_corner = corners.iter().any(|corner| corner.id == v);
            (!is_corner).then(|| predicates.is_positive(a, b, c, &surfaces.corner(v)))
        };
        let Some(node) = self.node_of(point) else {
            return side(VertexId::new(point.number())).expect("the vertex is none of the face's");
        };
        let node = self.node(node);
        let [p, q] = edges.ends(node.edge);
        match (side(p), side(q)) {
            (Some(x), Some(y)) if x != y => {
                // The edge crosses both planes: the order of the two places tells.
                match compare_on_edge(surfaces, edges, predicates, node, (face, x)) {
                    Sign::Negative => x,
                    _ => y,
                }
            }
            (Some(side), _) | (None, Some(side)) => side,
            (None, None) => unreachable!("the face shares the edge that the node lies on"),
        }
    }
}

/// The order, from the low end of a node's edge on, of the node and the place where the edge crosses the plane of a face, of
/// which is given whether the low end lies inside it.
pub(crate) fn compare_on_edge(
    surfaces: &Surfaces,
    edges: &Edges,
    predicates: &Predicates<'_>,
    node: &Node,
    (face, low_inside): (FaceId, bool),
) -> Sign {
    let [p, q] = edges.ends(node.edge).map(|v| surfaces.corner(v));
    let (t1, t2) = (surfaces.corners(node.face), surfaces.corners(face));
    let positions = |t: &[Corner; 3]| [t[0].position, t[1].position, t[2].position];
    let (first, second) = (positions(&t1), positions(&t2));
    // The low end is inside a face's plane iff the edge leaves there.
    order::compare_filter(
        &p.position,
        &q.position,
        first.each_ref(),
        second.each_ref(),
        node.leaves,
        low_inside,
    )
    .or_else(|| compare_with_plane(predicates, &t1, &t2, low_inside))
    .or_else(|| {
        let (t1, t2) = (first.each_ref(), second.each_ref());
        order::compare_in_double_double(&p.position, &q.position, t1, t2, node.leaves, low_inside)
    })
    .unwrap_or_else(|| {
        let point = |corner: &Corner| surfaces.perturbed(corner);
        let (t1, t2) = (t1.each_ref().map(point), t2.each_ref().map(point));
        order::compare(&point(&p), &point(&q), t1.each_ref(), t2.each_ref())
    })
}

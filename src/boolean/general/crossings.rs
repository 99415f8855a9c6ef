//! Which faces cross, and where their edges do.
//!
//! Two faces without a common vertex cross in exactly two nodes or not at all. With one vertex in common they cross iff the
//! edge opposite it of one pierces the other; then the segment runs from the vertex to that node. With two in common they do
//! not cross; with three they are one face.

use super::edges::Edges;
use super::surfaces::Surfaces;
use crate::Error;
use crate::boolean::arrangement::cut_edges::compare_with_plane;
use crate::boolean::complex::Corner;
use crate::boolean::complex::ids::{EdgeId, FaceId, NodeId, PointId, SegmentId, VertexId};
use crate::boolean::complex::planes;
use crate::boolean::complex::predicates::{Perturbed, Plane, Predicates};
use crate::exact::order;
use crate::exact::{FILTER_RANGE, PlaneFilter, Projection, Sign, orient2d, orient2d_filter, orient3d};
use crate::mesh::{Bounds, Buckets};
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, self_overlapping_pairs};

/// Where an edge pierces a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Node {
    pub(crate) edge: EdgeId,
    pub(crate) face: FaceId,
    /// Whether the edge, from its low end to its high one, goes from the face's inner side to its outer side.
    pub(crate) leaves: bool,
}

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

/// The pairs of faces that may cross or lie on each other, the lower one first: those whose boxes meet and that plain
/// arithmetic cannot tell apart. Pairs of faces of one operand are left out where it is `simple`: known to neither cross nor
/// touch itself.
///
/// # Errors
/// Only limits.
pub(crate) fn find_pairs(
    surfaces: &Surfaces,
    bounds: &Bounds,
    simple: &[bool],
    runner: Runner<'_>,
) -> Result<Vec<[FaceId; 2]>, Error> {
    let frame = Frame::of(bounds.low, bounds.high);
    let all: Vec<u32> = (0..surfaces.face_count()).collect();
    let tree = BoxTree::new(&all, |t| {
        let corners = surfaces.positions(FaceId::new(t));
        frame.triangle(corners.each_ref())
    });
    let filters_hold = surfaces.largest_coordinate() <= FILTER_RANGE;
    let pairs = self_overlapping_pairs(&tree, runner, |pair| {
        let [f, g] = pair.map(FaceId::new);
        if surfaces.owner(f) == surfaces.owner(g) && simple[surfaces.owner(f) as usize] {
            return false;
        }
        let (a, b) = (surfaces.vertices(f), surfaces.vertices(g));
        match a.iter().filter(|v| b.contains(v)).count() {
            2 => are_folded(surfaces, f, g),
            _ => !filters_hold || !surely_apart(surfaces, [f, g], [&a, &b]),
        }
    })?;
    let mut pairs: Vec<[FaceId; 2]> = pairs.into_iter().map(|pair| pair.map(FaceId::new)).collect();
    runner.sort(&mut pairs);
    Ok(pairs)
}

/// Whether `f64` is certain that two faces have nothing in common but a vertex: one lies on one side of the other's plane, or
/// they lie in one plane, or nearly, on different sides of a line.
#[inline]
fn surely_apart(surfaces: &Surfaces, [f, g]: [FaceId; 2], [a, b]: [&[VertexId; 3]; 2]) -> bool {
    let (p, q) = (surfaces.positions(f), surfaces.positions(g));
    let others = |t: &[VertexId; 3], of: &[VertexId; 3]| [0, 1, 2].map(|k| !of.contains(&t[k]));
    // 1. By the planes. (A common vertex lies in both.)
    let (in_a, in_b) = (others(a, b), others(b, a));
    let of_b = sides(&p, &q, in_b);
    if of_b.is_one_sided() {
        return true;
    }
    let of_a = sides(&q, &p, in_a);
    if of_a.is_one_sided() {
        return true;
    }
    // 2. By a line, where at least one of them may lie in the other's plane.
    (of_a.open > 0 || of_b.open > 0) && (separated_in_plane(&p, &q, in_b) || separated_in_plane(&q, &p, in_a))
}

/// On which sides of a plane some points lie.
struct Sides {
    inside: u32,
    outside: u32,
    /// Too near to tell.
    open: u32,
}

impl Sides {
    fn is_one_sided(&self) -> bool {
        self.open == 0 && (self.inside == 0 || self.outside == 0)
    }
}

#[inline]
fn sides(plane: &[[f64; 3]; 3], points: &[[f64; 3]; 3], wanted: [bool; 3]) -> Sides {
    let filter = PlaneFilter::new(&plane[0], &plane[1], &plane[2]);
    let mut sides = Sides { inside: 0, outside: 0, open: 0 };
    for k in 0..3 {
        if wanted[k] {
            let (determinant, bound) = filter.determinant(&points[k]);
            if determinant > bound {
                sides.inside += 1;
            } else if determinant < -bound {
                sides.outside += 1;
            } else {
                sides.open += 1;
            }
        }
    }
    sides
}

/// Whether the points that are wanted lie outside one side of a triangle, seen along the axis it looks along most, and so do,
/// or lie in the line of that side, those that it shares.
fn separated_in_plane(triangle: &[[f64; 3]; 3], points: &[[f64; 3]; 3], wanted: [bool; 3]) -> bool {
    let seen = Projection::of(triangle);
    let corners = triangle.map(|p| seen.project(&p));
    // (One without area has no sides that are sure to stay apart.)
    if orient2d(corners[0], corners[1], corners[2]) != Sign::Positive {
        return false;
    }
    let points = points.map(|p| seen.project(&p));
    let shared = (0..3).find(|&k| !wanted[k]).map(|k| points[k]);
    (0..3).any(|side| {
        let (from, to) = (corners[side], corners[(side + 1) % 3]);
        // A vertex that is shared is a corner: only sides through it can have it in their line.
        if shared.is_some_and(|v| v != from && v != to) {
            return false;
        }
        let is_beyond = |k: usize| {
            let (determinant, bound) = orient2d_filter(from, to, points[k]);
            // At a shared vertex a side may go on beyond it.
            determinant < -bound || shared.is_some_and(|v| goes_on(from, to, v, points[k]))
        };
        let mut beyond = (0..3).filter(|&k| wanted[k]);
        beyond.all(is_beyond)
            && (0..3).any(|k| {
                let (determinant, bound) = orient2d_filter(from, to, points[k]);
                wanted[k] && determinant < -bound
            })
    })
}

/// Whether a point lies in the line of a side, beyond the end of it that is given.
fn goes_on(from: [f64; 2], to: [f64; 2], end: [f64; 2], point: [f64; 2]) -> bool {
    let other = if end == from { to } else { from };
    let k = usize::from(other[0] == end[0]);
    (point[k] > end[k]) != (other[k] > end[k])
        && point[k] != end[k]
        && other[k] != end[k]
        && orient2d(from, to, point) == Sign::Zero
}

/// Whether two faces with a common edge lie on each other.
fn are_folded(surfaces: &Surfaces, f: FaceId, g: FaceId) -> bool {
    let (a, b) = (surfaces.vertices(f), surfaces.vertices(g));
    let Some(apex) = b.into_iter().find(|v| !a.contains(v)) else { return false };
    let [p, q, r] = surfaces.positions(f);
    orient3d(&p, &q, &r, surfaces.position(apex)) == Sign::Zero && overlap_in_plane(surfaces, f, g)
}

/// Whether two faces that lie in one plane, exactly, have area in common.
fn overlap_in_plane(surfaces: &Surfaces, f: FaceId, g: FaceId) -> bool {
    planes::overlap(&surfaces.positions(f), &surfaces.positions(g))
}

/// One end of a segment, before nodes are numbered.
#[derive(Clone, Copy, Debug)]
enum End {
    Node(Node),
    Vertex(VertexId),
}

#[derive(Clone, Copy, Debug)]
struct Found {
    faces: [FaceId; 2],
    tail: End,
    head: End,
}

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
        let search = Search { surfaces, edges, predicates };
        let pieces = runner.pieces(pairs.len(), PAIRS_AT_ONCE, |range| {
            let (mut found, mut touching) = (Vec::new(), Vec::new());
            for &pair in &pairs[range] {
                search.decide(pair, &mut found, &mut touching);
            }
            (found, touching)
        })?;
        let (found, touching): (Vec<_>, Vec<_>) = pieces.into_iter().unzip();
        Self::number(surfaces, &found.concat(), touching.concat(), search.predicates.into_contacts())
    }

    fn number(
        surfaces: &Surfaces,
        found: &[Found],
        touching: Vec<[FaceId; 2]>,
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
        Ok(Self { nodes, segments, of_face, touching, contacts, vertex_count })
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
    .unwrap_or_else(|| {
        let point = |corner: &Corner| surfaces.perturbed(corner);
        let (t1, t2) = (t1.each_ref().map(point), t2.each_ref().map(point));
        order::compare(&point(&p), &point(&q), t1.each_ref(), t2.each_ref())
    })
}

/// What deciding about pairs needs.
struct Search<'a> {
    surfaces: &'a Surfaces,
    edges: &'a Edges,
    predicates: Predicates<'a>,
}

impl Search<'_> {
    fn decide(&self, pair: [FaceId; 2], found: &mut Vec<Found>, touching: &mut Vec<[FaceId; 2]>) {
        let [a, b] = pair.map(|face| self.surfaces.corners(face));
        let shared = a.iter().position(|x| b.iter().any(|y| y.id == x.id));
        if let Some(i) = shared
            && let Some(j) = b.iter().position(|y| y.id == a[i].id)
        {
            let others = |t: &[Corner; 3], k: usize| [t[(k + 1) % 3].id, t[(k + 2) % 3].id];
            if others(&a, i).iter().any(|v| others(&b, j).contains(v)) {
                // Folded back at a common edge.
                touching.push(pair);
                return;
            }
            found.extend(self.cross_from(pair, [&a, &b], [i, j]));
        } else {
            found.extend(self.cross(pair, [&a, &b]));
        }
        let [a, b] = pair.map(|face| self.surfaces.positions(face));
        if planes::lie_on_each_other(&a, &b) {
            touching.push(pair);
        }
    }

    /// Where two faces without a common vertex cross: at most ten signs.
    fn cross(&self, faces: [FaceId; 2], [a, b]: [&[Corner; 3]; 2]) -> Option<Found> {
        // 1. Each must have corners on both sides of the other's plane; one of them is alone on its side.
        let a_inside = self.inside(b, a);
        let i = odd_one_out(a_inside)?;
        let b_inside = self.inside(a, b);
        let j = odd_one_out(b_inside)?;
        let [p, q, r] = [0, 1, 2].map(|k| &a[(i + k) % 3]);
        let [u, v, w] = [0, 1, 2].map(|k| &b[(j + k) % 3]);
        // 2. Both cut the line in which their planes meet in an interval, bounded by their edges at the corner that is alone.
        //    An edge crosses the other face iff it passes that one's two edges on different sides.
        let (pqu, pru) = (Plane::new(p, q, u), Plane::new(p, r, u));
        let qv = self.predicates.is_inside(&pqu, v);
        let qw = self.predicates.is_inside(&pqu, w);
        let rv = self.predicates.is_inside(&pru, v);
        let rw = self.predicates.is_inside(&pru, w);
        // 3. The nodes. Directed as in the first face, an edge of it that leaves the second starts the segment; directed as
        //    in the second face, an edge of it that leaves the first ends it.
        let [f, g] = faces;
        let (mut tail, mut head) = (None, None);
        let mut place = |node: Node, is_tail: bool| {
            *(if is_tail { &mut tail } else { &mut head }) = Some(End::Node(node));
        };
        let (p_inside, u_inside) = (a_inside[i], b_inside[j]);
        if qv != qw {
            place(self.node(f, i, p_inside, g), p_inside);
        }
        if rv != rw {
            place(self.node(f, (i + 2) % 3, !p_inside, g), !p_inside);
        }
        if qv != rv {
            place(self.node(g, j, u_inside, f), !u_inside);
        }
        if qw != rw {
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
            if p_inside != inside(q) && self.passes(p, q, plane) {
                let node = End::Node(self.node(faces[from], (k + 1) % 3, p_inside, faces[1 - from]));
                // As above: of the first face, an edge that leaves starts the segment.
                let is_tail = p_inside == is_first;
                let (tail, head) = if is_tail { (node, vertex) } else { (vertex, node) };
                return Some(Found { faces, tail, head });
            }
        }
        None
    }

    /// Whether a line that crosses a plane passes the triangle in it.
    fn passes(&self, p: &Corner, q: &Corner, t: &[Corner; 3]) -> bool {
        let first = self.predicates.is_positive(p, q, &t[0], &t[1]);
        self.predicates.is_positive(p, q, &t[1], &t[2]) == first
            && self.predicates.is_positive(p, q, &t[2], &t[0]) == first
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

/// The index of the one that differs from the other two.
#[inline]
fn odd_one_out(inside: [bool; 3]) -> Option<usize> {
    match inside {
        [a, b, c] if a == b && b == c => None,
        [a, b, _] if a == b => Some(2),
        [a, _, c] if a == c => Some(1),
        _ => Some(0),
    }
}

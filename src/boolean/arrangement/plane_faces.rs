//! Plane faces: cut triangles of one operand that lie in one plane side by side are cut as one.
//!
//! A plane face of a solid consists of many triangles, and the edges between them, *coplanar* edges, are no edges of the
//! solid. Where the intersection curve passes a coplanar edge in a point that is nothing else, the curve is straight there in
//! both operands, so the crossing is dropped: its two segments are one, and the triangles beside the edge are cut together.
//! What is left is cut, rounded and triangulated once, instead of being put together again afterwards.

use rustc_hash::FxHashSet;

use super::crossings::Crossings;
use super::curve::Curve;
use super::location::locate;
use super::sheets::Sheet;
use crate::Error;
use crate::boolean::complex::ids::{CutEdgeId, CutFaceId, FaceId, NodeId, SegmentId};
use crate::exact::{Sign, orient3d};
use crate::mesh::{BitSet, UnionFind};
use crate::parallel::Runner;

/// Edges that are looked at before the limits are checked: about a millisecond of work.
const EDGES_AT_ONCE: usize = 1 << 12;

/// More than two faces at an edge.
const MANY: CutFaceId = CutFaceId::new(u32::MAX - 1);

/// Which cut faces are cut as one, and which crossings are dropped.
#[derive(Debug, Default)]
pub(crate) struct PlaneFaces {
    /// The nodes that are dropped; absent where there is none.
    dropped: Option<BitSet>,
    /// For each segment that starts a straight run of them the node where the run ends, none for the others; empty where
    /// nothing is dropped.
    run_ends: Vec<NodeId>,
    /// By operand, for each cut face the first one of its plane face, if that has several; empty where no operand has such.
    first: [Vec<CutFaceId>; 2],
    /// By operand, for each cut face the next one of its plane face, or none.
    next: [Vec<CutFaceId>; 2],
    /// Nodes on coplanar edges that are not dropped, ascending.
    on_coplanar_edges: Vec<NodeId>,
}

impl PlaneFaces {
    /// Finds the crossings to drop, and the faces that join. Faces of sheets are not joined with others.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(curve: &Curve<'_>, sheets: &[Sheet], runner: Runner<'_>) -> Result<Self, Error> {
        let Curve { complex, edges, faces, crossings } = curve;
        let in_sheets: FxHashSet<FaceId> = sheets.iter().flatten().copied().collect();
        // 1. The coplanar edges, with the two faces beside each.
        let coplanar = CoplanarEdges::new(curve, runner)?;
        // 2. On each, the crossings that can be dropped.
        let mut result = Self::default();
        let mut dropped = BitSet::new(crossings.node_count());
        let mut joined: Vec<CutEdgeId> = Vec::new();
        for (edge, ends) in edges.iter() {
            if edge.index() % EDGES_AT_ONCE == 0 {
                runner.control.check()?;
            }
            let Some(beside) = coplanar.beside(edge) else { continue };
            let owner = complex.owner(ends.low);
            let may_join = !beside.iter().any(|&face| in_sheets.contains(&faces[owner][face].id));
            let mut joins = false;
            for &node in edges.nodes(edge) {
                if may_join && coplanar.passes_inside(curve, node) {
                    dropped.insert(node.number());
                    joins = true;
                } else {
                    result.on_coplanar_edges.push(node);
                }
            }
            if joins {
                joined.push(edge);
            }
        }
        result.on_coplanar_edges.sort_unstable();
        if joined.is_empty() {
            return Ok(result);
        }
        // 3. The faces beside edges with dropped crossings join, and so do the segments.
        for operand in 0..2 {
            let of_operand = joined.iter().filter(|&&edge| complex.owner(edges[edge].low) == operand);
            let pairs = of_operand.filter_map(|&edge| coplanar.beside(edge));
            (result.first[operand], result.next[operand]) = join(faces[operand].len(), pairs);
        }
        result.run_ends = run_ends(crossings, &dropped);
        result.dropped = Some(dropped);
        Ok(result)
    }

    /// Whether a crossing is dropped.
    #[inline]
    pub(crate) fn is_dropped(&self, node: NodeId) -> bool {
        self.dropped.as_ref().is_some_and(|dropped| dropped.contains(node.number()))
    }

    /// Nodes on coplanar edges that are not dropped, ascending.
    pub(crate) fn nodes_on_coplanar_edges(&self) -> &[NodeId] {
        &self.on_coplanar_edges
    }

    /// Where the straight run of segments that a segment starts ends; `None` for a segment within a run. `head` is the
    /// segment's own end.
    #[inline]
    pub(crate) fn run_end(&self, segment: SegmentId, head: NodeId) -> Option<NodeId> {
        if self.run_ends.is_empty() {
            return Some(head);
        }
        self.run_ends[segment.index()].get()
    }

    /// Whether a cut face is cut together with an earlier one.
    pub(crate) fn belongs_to_earlier(&self, operand: usize, face: CutFaceId) -> bool {
        self.first[operand].get(face.index()).is_some_and(|&first| first != face)
    }

    /// The faces that are cut together with the first of them, itself included, ascending.
    pub(crate) fn members(&self, operand: usize, first: CutFaceId) -> impl Iterator<Item = CutFaceId> {
        let next = &self.next[operand];
        std::iter::successors(Some(first), |face| next.get(face.index()).and_then(|next| next.get()))
    }
}

/// The cut edges that are coplanar.
struct CoplanarEdges {
    /// For each cut edge its two faces, if it is coplanar.
    beside: Vec<[CutFaceId; 2]>,
}

impl CoplanarEdges {
    fn new(curve: &Curve<'_>, runner: Runner<'_>) -> Result<Self, Error> {
        let Curve { complex, edges, faces, .. } = curve;
        const NONE: CutFaceId = CutFaceId::NONE;
        // 1. The faces at each cut edge.
        let mut beside = vec![[NONE; 2]; edges.len()];
        for faces in faces {
            for (place, face) in (0..).zip(faces.iter()) {
                let place = CutFaceId::new(place);
                for edge in face.edges.iter().filter_map(|edge| edge.get()) {
                    let slots = &mut beside[edge.index()];
                    // Where a result counts pieces twice, it has more than two faces at an edge when it is an operand.
                    *slots = match *slots {
                        [NONE, _] => [place, NONE],
                        [first, NONE] => [first, place],
                        [first, _] => [first, MANY],
                    };
                }
            }
        }
        // 2. Those of two faces in one plane are kept.
        let beside = runner
            .pieces(beside.len(), EDGES_AT_ONCE, |range| {
                let mut found = Vec::with_capacity(range.len());
                for index in range {
                    let owner = complex.owner(edges[CutEdgeId::new(index as u32)].low);
                    let [f, g] = beside[index];
                    let id = |face: CutFaceId| faces[owner][face].id;
                    let is_coplanar = ![NONE, MANY].contains(&g) && complex.are_faces_mergeable(id(f), id(g));
                    found.push(if is_coplanar { [f, g] } else { [NONE; 2] });
                }
                found
            })?
            .concat();
        Ok(Self { beside })
    }

    /// The two faces beside an edge, if it is coplanar.
    fn beside(&self, edge: CutEdgeId) -> Option<[CutFaceId; 2]> {
        let [f, g] = self.beside[edge.index()];
        Some([f.get()?, g])
    }

    /// Whether a crossing lies inside a face of the other operand, or on a coplanar edge there, where no vertex is, nor
    /// another crossing.
    fn passes_inside(&self, curve: &Curve<'_>, node: NodeId) -> bool {
        let Curve { complex, crossings, edges, .. } = curve;
        let crossing = &crossings[node];
        let [p, q] = [crossing.low, crossing.high].map(|vertex| complex.position(vertex));
        let corners = complex.corners(crossing.face);
        let [a, b, c] = corners.map(|corner| corner.position);
        // 1. The edge must not end in the face's plane.
        if [p, q].iter().any(|end| orient3d(&a, &b, &c, end) == Sign::Zero) {
            return false;
        }
        // 2. It passes the face's interior, one of its sides, or (twice in the outline) a corner.
        let mut on_outline = (0..3).filter(|&k| {
            let (from, to) = (&corners[k], &corners[(k + 1) % 3]);
            orient3d(p, q, &from.position, &to.position) == Sign::Zero
        });
        match (on_outline.next(), on_outline.next()) {
            (None, _) => true,
            (Some(k), None) => {
                // 3. On a side that is an edge of the solid, there must not be a node of that edge as well.
                let (u, v) = (corners[k].id, corners[(k + 1) % 3].id);
                edges.find(u.min(v), u.max(v)).is_none_or(|edge| {
                    self.beside(edge).is_some() || !has_node_at(curve, edge, &locate(complex, crossing))
                })
            }
            _ => false,
        }
    }
}

/// Whether a node of an edge is at the place of a point of it.
fn has_node_at(curve: &Curve<'_>, edge: CutEdgeId, point: &[f64; 3]) -> bool {
    let Curve { complex, crossings, edges, .. } = curve;
    let [from, to] = [edges[edge].low, edges[edge].high].map(|vertex| complex.position(vertex));
    let extent = |k: usize| (to[k] - from[k]).abs();
    let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
    // Correct rounding keeps the order along every axis.
    let is_before =
        |at: &[f64; 3]| (at[axis] != point[axis]) && (at[axis] < point[axis]) == (from[axis] < to[axis]);
    let at = |&node: &NodeId| locate(complex, &crossings[node]);
    let nodes = edges.nodes(edge);
    let first = nodes.partition_point(|node| is_before(&at(node)));
    nodes[first..].iter().map(at).take_while(|at| at[axis] == point[axis]).any(|at| at == *point)
}

/// Joins faces by pairs: for each face the first of its class, and the next one.
fn join(count: usize, pairs: impl Iterator<Item = [CutFaceId; 2]>) -> (Vec<CutFaceId>, Vec<CutFaceId>) {
    let mut classes = UnionFind::new(count);
    pairs.for_each(|[f, g]| classes.join(f.number(), g.number()));
    let first: Vec<CutFaceId> = (0..count as u32).map(|face| CutFaceId::new(classes.root(face))).collect();
    let mut next = vec![CutFaceId::NONE; count];
    // The last one met so far of each class, at the place of its first.
    let mut last: Vec<CutFaceId> = (0..count as u32).map(CutFaceId::new).collect();
    for (face, &first) in (0..).map(CutFaceId::new).zip(&first) {
        if first != face {
            next[last[first.index()].index()] = face;
            last[first.index()] = face;
        }
    }
    (first, next)
}

/// For each segment that starts at a node that stays the next such node along the curve; none for the others. (A run that
/// closes without one lies on a line and encloses nothing: it goes altogether.)
fn run_ends(crossings: &Crossings, dropped: &BitSet) -> Vec<NodeId> {
    let is_dropped = |node: NodeId| dropped.contains(node.number());
    let mut after = vec![NodeId::NONE; crossings.node_count()];
    for (_, segment) in crossings.segments() {
        if is_dropped(segment.tail) {
            after[segment.tail.index()] = segment.head;
        }
    }
    crossings
        .segments()
        .map(|(_, segment)| {
            if is_dropped(segment.tail) {
                return NodeId::NONE;
            }
            let mut head = segment.head;
            while is_dropped(head) {
                head = after[head.index()];
            }
            head
        })
        .collect()
}

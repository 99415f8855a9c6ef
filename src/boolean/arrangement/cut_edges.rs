//! The edges that are cut, with the crossings along each in order.

use std::cmp::Ordering;
use std::ops::Index;

use super::crossings::{Crossing, Crossings};
use crate::Error;
use crate::boolean::complex::ids::{CutEdgeId, NodeId, VertexId};
use crate::boolean::complex::predicates::{Perturbed, Predicates};
use crate::boolean::complex::{Complex, Corner};
use crate::exact::{Sign, order};
use crate::parallel::Runner;

/// An edge with crossings, from `low` to `high`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutEdge {
    pub(crate) low: VertexId,
    pub(crate) high: VertexId,
    /// Where its nodes start and end in [`CutEdges::nodes`]; also the lowest number among them, and one more than the
    /// highest.
    first: u32,
    end: u32,
}

/// All cut edges, in the order of their vertices.
#[derive(Debug, Default)]
pub(crate) struct CutEdges {
    edges: Vec<CutEdge>,
    /// Edge by edge, from its low end to its high end.
    nodes: Vec<NodeId>,
    /// For each node the edge it lies on.
    edge_of_node: Vec<CutEdgeId>,
    /// How many decisions plain coordinates left open.
    pub(crate) contacts: u64,
}

impl Index<CutEdgeId> for CutEdges {
    type Output = CutEdge;

    #[inline]
    fn index(&self, edge: CutEdgeId) -> &CutEdge {
        &self.edges[edge.index()]
    }
}

/// Edges whose nodes one thread puts in order before the limits are checked.
const EDGES_AT_ONCE: usize = 1024;

impl CutEdges {
    /// Groups the crossings by edge, and orders them along each.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        complex: &Complex<'_>,
        crossings: &Crossings,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        // 1. Nodes are sorted by edge already.
        let mut edges: Vec<CutEdge> = Vec::new();
        let mut edge_of_node = Vec::with_capacity(crossings.node_count());
        for (node, crossing) in crossings.nodes() {
            let (low, high, first) = (crossing.low, crossing.high, node.number());
            match edges.last_mut() {
                Some(edge) if edge.low == low && edge.high == high => edge.end += 1,
                _ => edges.push(CutEdge { low, high, first, end: first + 1 }),
            }
            edge_of_node.push(CutEdgeId::new(edges.len() as u32 - 1));
        }
        // 2. Those of one edge are put in order.
        let predicates = Predicates::new(complex);
        let count = crossings.node_count();
        let nodes = runner.gather(edges.len(), EDGES_AT_ONCE, count, |range, nodes: &mut Vec<u32>| {
            for edge in &edges[range] {
                let start = nodes.len();
                nodes.extend(edge.first..edge.end);
                if edge.end - edge.first > 1 {
                    let crossing = |&node: &u32| &crossings[NodeId::new(node)];
                    nodes[start..].sort_by(|x, y| compare(complex, &predicates, crossing(x), crossing(y)));
                }
            }
        })?;
        let nodes = nodes.into_iter().map(NodeId::new).collect();
        Ok(Self { edges, nodes, edge_of_node, contacts: predicates.into_contacts() })
    }

    /// How many edges are cut.
    pub(crate) fn len(&self) -> usize {
        self.edges.len()
    }

    /// All cut edges, ascending.
    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = (CutEdgeId, &CutEdge)> {
        (0..self.edges.len() as u32).map(CutEdgeId::new).zip(&self.edges)
    }

    /// The edge a node lies on.
    #[inline]
    pub(crate) fn edge_of(&self, node: NodeId) -> CutEdgeId {
        self.edge_of_node[node.index()]
    }

    /// A cut edge by its vertices.
    pub(crate) fn find(&self, low: VertexId, high: VertexId) -> Option<CutEdgeId> {
        let place = self.edges.binary_search_by_key(&(low, high), |edge| (edge.low, edge.high)).ok()?;
        Some(CutEdgeId::new(place as u32))
    }

    /// The lowest number of a node of an edge.
    pub(crate) fn lowest_node(&self, edge: CutEdgeId) -> NodeId {
        NodeId::new(self[edge].first)
    }

    /// The nodes of an edge, from its low end to its high end.
    #[inline]
    pub(crate) fn nodes(&self, edge: CutEdgeId) -> &[NodeId] {
        let CutEdge { first, end, .. } = self[edge];
        &self.nodes[first as usize..end as usize]
    }
}

/// The order of two crossings of one edge, from its low end on.
fn compare(complex: &Complex<'_>, predicates: &Predicates<'_>, x: &Crossing, y: &Crossing) -> Ordering {
    let (p, q) = (complex.corner(x.low), complex.corner(x.high));
    let (t1, t2) = (complex.corners(x.face), complex.corners(y.face));
    let positions = |t: &[Corner; 3]| [t[0].position, t[1].position, t[2].position];
    let (first, second) = (positions(&t1), positions(&t2));
    // The low end is inside a face's plane iff the edge leaves there.
    let sign = order::compare_filter(
        &p.position,
        &q.position,
        first.each_ref(),
        second.each_ref(),
        x.leaves,
        y.leaves,
    )
    .or_else(|| compare_by_sides(predicates, &t1, &t2, x.leaves, y.leaves))
    .or_else(|| {
        let (t1, t2) = (first.each_ref(), second.each_ref());
        order::compare_in_double_double(&p.position, &q.position, t1, t2, x.leaves, y.leaves)
    })
    .unwrap_or_else(|| {
        let point = |corner: &Corner| complex.perturbed(corner);
        let (t1, t2) = (t1.each_ref().map(point), t2.each_ref().map(point));
        order::compare(&point(&p), &point(&q), t1.each_ref(), t2.each_ref())
    });
    match sign {
        Sign::Negative => Ordering::Less,
        Sign::Positive => Ordering::Greater,
        Sign::Zero => compare_duplicates(x, y),
    }
}

/// The order where one face lies wholly on one side of the other's plane: then so does its crossing point. The edge must pierce
/// both faces.
fn compare_by_sides(
    predicates: &Predicates<'_>,
    t1: &[Corner; 3],
    t2: &[Corner; 3],
    p_inside_1: bool,
    p_inside_2: bool,
) -> Option<Sign> {
    if let Some(sign) = compare_with_plane(predicates, t1, t2, p_inside_2) {
        return Some(sign);
    }
    let inside = common_side(predicates, t2, t1)?;
    Some(if inside == p_inside_1 { Sign::Positive } else { Sign::Negative })
}

/// The same where the edge pierces the first face and crosses the plane of the second one anywhere.
pub(crate) fn compare_with_plane(
    predicates: &Predicates<'_>,
    t1: &[Corner; 3],
    t2: &[Corner; 3],
    p_inside_2: bool,
) -> Option<Sign> {
    // If the crossing with the one is on p's side of the other, it comes first.
    let inside = common_side(predicates, t1, t2)?;
    Some(if inside == p_inside_2 { Sign::Negative } else { Sign::Positive })
}

/// Whether all corners of `t` that `plane` does not share lie inside its plane (true), outside it (false), or neither.
fn common_side(predicates: &Predicates<'_>, t: &[Corner; 3], plane: &[Corner; 3]) -> Option<bool> {
    let [a, b, c] = plane;
    let mut side = None;
    for corner in t {
        if plane.iter().any(|other| other.id == corner.id) {
            continue;
        }
        let inside = predicates.is_positive(a, b, c, corner);
        if side.is_some_and(|side| side != inside) {
            return None;
        }
        side = Some(inside);
    }
    side
}

/// The order of crossings with the same face given twice: as if the one with the lower number were displaced along its
/// normal.
fn compare_duplicates(x: &Crossing, y: &Crossing) -> Ordering {
    let (lower, lower_is_x) = if x.face < y.face { (x, true) } else { (y, false) };
    // Displaced away from a low end inside it, it is met later.
    if lower.leaves == lower_is_x { Ordering::Greater } else { Ordering::Less }
}

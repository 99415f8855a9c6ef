//! The crossings along each cut edge, in order, and where they are.

use std::cmp::Ordering;

use crate::Error;
use crate::boolean::arrangement::crossings::{Crossing, Crossings};
use crate::boolean::arrangement::plane_faces::PlaneFaces;
use crate::boolean::arrangement::unrounded::ExtraCrossing;
use crate::boolean::complex::operands::{Corner, Operands};
use crate::exact::{Sign, order, position};
use crate::parallel::Runner;

/// An edge with crossings, from `low` to `high`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutEdge {
    pub(crate) low: u32,
    pub(crate) high: u32,
    /// Where its nodes start and end in [`CutEdges::nodes`].
    first: u32,
    end: u32,
}

/// All cut edges.
#[derive(Clone, Debug, Default)]
pub(crate) struct CutEdges {
    pub(crate) edges: Vec<CutEdge>,
    /// Node numbers, edge by edge, from the edge's low end to its high end.
    nodes: Vec<u32>,
    /// For each node the index of its edge.
    pub(crate) edge_of_node: Vec<u32>,
    /// For each node where it is, correctly rounded; filled by [`locate`](Self::locate).
    pub(crate) positions: Vec<[f64; 3]>,
}

impl CutEdges {
    /// Groups the crossings by edge, and orders them along each.
    pub(crate) fn new(
        operands: &Operands<'_>,
        crossings: &Crossings,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let all = &crossings.nodes;
        let mut edges: Vec<CutEdge> = Vec::new();
        let mut edge_of_node = Vec::with_capacity(all.len());
        for (i, node) in all.iter().enumerate() {
            match edges.last_mut() {
                Some(edge) if edge.low == node.low && edge.high == node.high => edge.end += 1,
                _ => {
                    edges.push(CutEdge {
                        low: node.low,
                        high: node.high,
                        first: i as u32,
                        end: i as u32 + 1,
                    });
                }
            }
            edge_of_node.push(edges.len() as u32 - 1);
        }
        let nodes = runner.gather(edges.len(), 1024, all.len(), |range, nodes: &mut Vec<u32>| {
            for edge in &edges[range] {
                let start = nodes.len();
                nodes.extend(edge.first..edge.end);
                if edge.end - edge.first > 1 {
                    nodes[start..].sort_by(|&x, &y| compare(operands, &all[x as usize], &all[y as usize]));
                }
            }
        })?;
        Ok(Self { edges, nodes, edge_of_node, positions: Vec::new() })
    }

    /// Computes where the nodes are, but for the dropped ones.
    pub(crate) fn locate(
        &mut self,
        operands: &Operands<'_>,
        crossings: &Crossings,
        plane_faces: &PlaneFaces,
        runner: Runner<'_>,
    ) -> Result<(), Error> {
        let all = &crossings.nodes;
        let nowhere = [f64::NAN; 3];
        self.positions = runner.gather(all.len(), 1024, all.len(), |range, positions| {
            let mut points = Vec::with_capacity(AT_ONCE);
            for start in range.clone().step_by(AT_ONCE) {
                let part = start..(start + AT_ONCE).min(range.end);
                points.clear();
                points.extend(all[part.clone()].iter().map(|node| Plain::new(operands, node)));
                positions.extend(part.zip(&points).map(|(i, points)| {
                    if plane_faces.is_dropped(i as u32) { nowhere } else { points.locate(operands, &all[i]) }
                }));
            }
        })?;
        Ok(())
    }

    /// The number of a cut edge by its vertices.
    pub(crate) fn find(&self, low: u32, high: u32) -> Option<u32> {
        let place = self.edges.binary_search_by_key(&(low, high), |edge| (edge.low, edge.high)).ok()?;
        Some(place as u32)
    }

    /// Whether a node of an edge is at the place of a point of it; before [`locate`](Self::locate).
    pub(crate) fn has_node_at(
        &self,
        operands: &Operands<'_>,
        crossings: &Crossings,
        edge: u32,
        point: &[f64; 3],
    ) -> bool {
        let CutEdge { low, high, .. } = self.edges[edge as usize];
        let [from, to] = [low, high].map(|vertex| operands.position(vertex));
        let extent = |k: usize| (to[k] - from[k]).abs();
        let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
        // Correct rounding keeps the order along every axis.
        let is_before =
            |at: &[f64; 3]| (at[axis] != point[axis]) && (at[axis] < point[axis]) == (from[axis] < to[axis]);
        let at = |node: &u32| locate(operands, &crossings.nodes[*node as usize]);
        let nodes = self.nodes(edge);
        let first = nodes.partition_point(|node| is_before(&at(node)));
        nodes[first..].iter().map(at).take_while(|at| at[axis] == point[axis]).any(|at| at == *point)
    }

    /// The same with points after the nodes.
    pub(crate) fn with_more(&self, crossings: &[ExtraCrossing]) -> Self {
        let mut more = self.clone();
        more.positions.extend(crossings.iter().map(|crossing| crossing.position));
        more
    }

    /// The lowest number of a node of an edge.
    pub(crate) fn first_node(&self, edge: u32) -> u32 {
        self.edges[edge as usize].first
    }

    /// The nodes of an edge, from its low end to its high end.
    pub(crate) fn nodes(&self, edge: u32) -> &[u32] {
        let CutEdge { first, end, .. } = self.edges[edge as usize];
        &self.nodes[first as usize..end as usize]
    }
}

/// The order of two crossings of one edge, from its low end on.
fn compare(operands: &Operands<'_>, x: &Crossing, y: &Crossing) -> Ordering {
    let (p, q) = (operands.corner(x.low), operands.corner(x.high));
    let other = 1 - operands.side_of(x.low);
    let (t1, t2) = (operands.corners(other, x.triangle), operands.corners(other, y.triangle));
    let positions = |t: &[Corner; 3]| [t[0].position, t[1].position, t[2].position];
    let (first, second) = (positions(&t1), positions(&t2));
    // The low end is inside (below) a triangle's plane iff the edge leaves there.
    let sign = order::compare_filter(
        &p.position,
        &q.position,
        first.each_ref(),
        second.each_ref(),
        x.leaves,
        y.leaves,
    )
    .or_else(|| by_sides(operands, &t1, &t2, x.leaves, y.leaves))
    .unwrap_or_else(|| {
        let point = |corner: &Corner| operands.perturbed(corner);
        let (t1, t2) = (t1.each_ref().map(point), t2.each_ref().map(point));
        order::compare(&point(&p), &point(&q), t1.each_ref(), t2.each_ref())
    });
    match sign {
        Sign::Negative => Ordering::Less,
        Sign::Positive => Ordering::Greater,
        Sign::Zero => duplicates(x, y),
    }
}

/// The order where one triangle lies wholly on one side of the other's plane: then so does its crossing point.
fn by_sides(
    operands: &Operands<'_>,
    t1: &[Corner; 3],
    t2: &[Corner; 3],
    p_below_1: bool,
    p_below_2: bool,
) -> Option<Sign> {
    // If the crossing with the one is on p's side of the other, it comes first.
    if let Some(below) = common_side(operands, t1, t2) {
        return Some(if below == p_below_2 { Sign::Negative } else { Sign::Positive });
    }
    let below = common_side(operands, t2, t1)?;
    Some(if below == p_below_1 { Sign::Positive } else { Sign::Negative })
}

/// Whether all corners of `t` that `plane` does not share lie below its plane (true), above it (false), or neither.
fn common_side(operands: &Operands<'_>, t: &[Corner; 3], plane: &[Corner; 3]) -> Option<bool> {
    let mut side = None;
    for corner in t {
        if plane.iter().any(|other| other.id == corner.id) {
            continue;
        }
        let below = operands.positive(&plane[0], &plane[1], &plane[2], corner);
        if side.is_some_and(|side| side != below) {
            return None;
        }
        side = Some(below);
    }
    side
}

/// The order of crossings with the same triangle given twice: as if the one with the lower number were displaced along its
/// normal.
fn duplicates(x: &Crossing, y: &Crossing) -> Ordering {
    let (lower, lower_is_x) = if x.triangle < y.triangle { (x, true) } else { (y, false) };
    // Displaced away from a low end inside it, it is met later.
    if lower.leaves == lower_is_x { Ordering::Greater } else { Ordering::Less }
}

/// Where a crossing is, correctly rounded.
pub(crate) fn locate(operands: &Operands<'_>, crossing: &Crossing) -> [f64; 3] {
    Plain::new(operands, crossing).locate(operands, crossing)
}

/// Crossings whose points are read before the first is located, so that cache misses overlap.
const AT_ONCE: usize = 64;

/// The ends of the edge and the corners of the triangle of a crossing.
struct Plain {
    edge: [[f64; 3]; 2],
    triangle: [[f64; 3]; 3],
}

impl Plain {
    #[inline]
    fn new(operands: &Operands<'_>, node: &Crossing) -> Self {
        let side = operands.side_of(node.low);
        let (ends, other) = (&operands.sides[side], &operands.sides[1 - side]);
        let first = operands.first_vertex(side);
        let [low, high] = [node.low, node.high].map(|v| (v - first) as usize);
        let [u, v, w] = other.triangles[node.triangle as usize].map(|v| v as usize);
        Self {
            edge: [ends.positions[low], ends.positions[high]],
            triangle: [other.positions[u], other.positions[v], other.positions[w]],
        }
    }

    /// Where the crossing is, correctly rounded.
    fn locate(&self, operands: &Operands<'_>, node: &Crossing) -> [f64; 3] {
        let Self { edge: [p, q], triangle } = self;
        position::crossing_filter(p, q, triangle.each_ref()).unwrap_or_else(|| {
            let other = 1 - operands.side_of(node.low);
            let [p, q] = [node.low, node.high].map(|v| operands.perturbed(&operands.corner(v)));
            let triangle = operands.corners(other, node.triangle).map(|corner| operands.perturbed(&corner));
            position::crossing(&p, &q, triangle.each_ref())
        })
    }
}

//! Plane faces: cut triangles of one operand that lie in one plane side by side are cut as one.
//!
//! A plane face of a solid consists of many triangles, and the borders between them mean nothing. Where the intersection
//! curve passes such a border in a point that is nothing else, the curve is straight there in both operands, so the
//! crossing is dropped: its two segments are one, and the triangles beside the border are cut together. What is left is
//! cut, rounded and triangulated once, instead of being put together again afterwards.

use crate::Error;
use crate::boolean::arrangement::crossings::Crossings;
use crate::boolean::arrangement::cut_edges::{CutEdges, locate};
use crate::boolean::arrangement::cut_faces::{CutFaces, UNCUT};
use crate::boolean::complex::operands::Operands;
use crate::boolean::complex::planes::Planes;
use crate::exact::{Sign, orient3d};
use crate::mesh::BitSet;
use crate::mesh::UnionFind;
use crate::parallel::Runner;

/// No face, segment or node.
const NONE: u32 = u32::MAX;
/// So many edges are looked at between looks at the limits.
const EDGES_BETWEEN_CHECKS: usize = 1 << 12;
/// More than two faces.
const MANY: u32 = u32::MAX - 1;

/// Which cut faces are cut as one, and which crossings are dropped.
#[derive(Debug, Default)]
pub(crate) struct PlaneFaces {
    /// The nodes that are dropped; not filled where there is none.
    dropped: Option<BitSet>,
    /// For each segment that starts a straight run of them the node where the run ends; [`NONE`] for the others.
    run_ends: Vec<u32>,
    /// By side, for each cut face the first one of its plane face, if that has several; empty where no side has such.
    first: [Vec<u32>; 2],
    /// By side, for each cut face the next one of its plane face.
    next: [Vec<u32>; 2],
    /// Nodes on meaningless borders that are not dropped, ascending.
    left: Vec<u32>,
}

/// The borders that mean nothing.
struct Borders {
    /// For each cut edge the places of its two faces among the cut faces of its side, if it is such a border.
    beside: Vec<[u32; 2]>,
}

impl PlaneFaces {
    /// Finds the crossings to drop, and what they join. `kept_apart` tells faces that are not to be joined with others.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        planes: &Planes<'_>,
        crossings: &Crossings,
        edges: &CutEdges,
        faces: &[CutFaces; 2],
        kept_apart: impl Fn(usize, u32) -> bool,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let operands = planes.operands;
        let borders = Borders::new(planes, edges, faces, runner)?;
        let mut result = Self::default();
        let mut dropped = BitSet::new(crossings.nodes.len());
        let mut joined: Vec<[u32; 2]> = Vec::new();
        for (index, &[f, g]) in borders.beside.iter().enumerate() {
            if index % EDGES_BETWEEN_CHECKS == 0 {
                runner.control.check()?;
            }
            if f == NONE {
                continue;
            }
            let side = operands.side_of(edges.edges[index].low);
            let may_join =
                ![f, g].iter().any(|&face| kept_apart(side, faces[side].faces[face as usize].triangle));
            let mut joins = false;
            for &node in edges.nodes(index as u32) {
                if may_join && borders.passes_plainly(operands, crossings, edges, node) {
                    dropped.insert(node);
                    joins = true;
                } else {
                    result.left.push(node);
                }
            }
            if joins {
                joined.push([side as u32, index as u32]);
            }
        }
        result.left.sort_unstable();
        if joined.is_empty() {
            return Ok(result);
        }
        for side in 0..2 {
            let pairs = joined.iter().filter(|entry| entry[0] == side as u32);
            let pairs = pairs.map(|entry| borders.beside[entry[1] as usize]);
            (result.first[side], result.next[side]) = join(faces[side].faces.len(), pairs);
        }
        result.run_ends = run_ends(crossings, &dropped);
        result.dropped = Some(dropped);
        Ok(result)
    }

    /// Whether a crossing is dropped.
    #[inline]
    pub(crate) fn is_dropped(&self, node: u32) -> bool {
        self.dropped.as_ref().is_some_and(|dropped| dropped.contains(node))
    }

    /// Nodes on borders that mean nothing which are not dropped, ascending.
    pub(crate) fn left(&self) -> &[u32] {
        &self.left
    }

    /// Where the straight run of segments that a segment starts ends; `None` for a segment within a run.
    #[inline]
    pub(crate) fn run_end(&self, segment: u32, head: u32) -> Option<u32> {
        if self.run_ends.is_empty() {
            return Some(head);
        }
        let end = self.run_ends[segment as usize];
        (end != NONE).then_some(end)
    }

    /// Whether a face, by its place among the cut faces of its side, is cut together with an earlier one.
    pub(crate) fn belongs_to_earlier(&self, side: usize, place: u32) -> bool {
        self.first[side].get(place as usize).is_some_and(|&first| first != place)
    }

    /// The faces that are cut together with the first of them, itself included, ascending.
    pub(crate) fn members(&self, side: usize, first: u32) -> impl Iterator<Item = u32> {
        let next = &self.next[side];
        std::iter::successors(Some(first), |&place| {
            next.get(place as usize).copied().filter(|&next| next != NONE)
        })
    }
}

impl Borders {
    fn new(
        planes: &Planes<'_>,
        edges: &CutEdges,
        faces: &[CutFaces; 2],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let mut beside = vec![[NONE; 2]; edges.edges.len()];
        for faces in faces {
            for (place, face) in faces.faces.iter().enumerate() {
                for &edge in face.edges.iter().filter(|&&edge| edge != UNCUT) {
                    let slots = &mut beside[edge as usize];
                    // Where a result counts pieces twice, it has more than two faces at an edge when it is an operand.
                    *slots = match *slots {
                        [NONE, _] => [place as u32, NONE],
                        [first, NONE] => [first, place as u32],
                        [first, _] => [first, MANY],
                    };
                }
            }
        }
        let beside = runner
            .pieces(beside.len(), 4096, |range| {
                let mut found = Vec::with_capacity(range.len());
                for index in range {
                    let side = planes.operands.side_of(edges.edges[index].low);
                    let [f, g] = beside[index];
                    let triangle = |place: u32| faces[side].faces[place as usize].triangle;
                    let means_nothing =
                        ![NONE, MANY].contains(&g) && planes.are_mergeable(side, triangle(f), triangle(g));
                    found.push(if means_nothing { [f, g] } else { [NONE; 2] });
                }
                found
            })?
            .concat();
        Ok(Self { beside })
    }

    /// Whether an edge passes through a triangle where no vertex is, nor another crossing.
    fn passes_plainly(
        &self,
        operands: &Operands<'_>,
        crossings: &Crossings,
        edges: &CutEdges,
        node: u32,
    ) -> bool {
        let crossing = &crossings.nodes[node as usize];
        let other = 1 - operands.side_of(crossing.low);
        let [p, q] = [crossing.low, crossing.high].map(|vertex| operands.position(vertex));
        let corners = operands.corners(other, crossing.triangle);
        let [a, b, c] = corners.map(|corner| corner.position);
        if [p, q].iter().any(|end| orient3d(&a, &b, &c, end) == Sign::Zero) {
            return false;
        }
        let mut on_outline = (0..3).filter(|&k| {
            let (from, to) = (&corners[k], &corners[(k + 1) % 3]);
            orient3d(p, q, &from.position, &to.position) == Sign::Zero
        });
        match (on_outline.next(), on_outline.next()) {
            (None, _) => true,
            (Some(k), None) => {
                let (u, v) = (corners[k].id, corners[(k + 1) % 3].id);
                edges.find(u.min(v), u.max(v)).is_none_or(|edge| {
                    self.beside[edge as usize][0] != NONE
                        || !edges.has_node_at(operands, crossings, edge, &locate(operands, crossing))
                })
            }
            _ => false,
        }
    }
}

/// Joins faces by pairs: for each face the first of its class, and the next one.
fn join(count: usize, pairs: impl Iterator<Item = [u32; 2]>) -> (Vec<u32>, Vec<u32>) {
    let mut classes = UnionFind::new(count);
    pairs.for_each(|[f, g]| classes.join(f, g));
    let first: Vec<u32> = (0..count as u32).map(|place| classes.root(place)).collect();
    let mut next = vec![NONE; count];
    // The last one met so far of each class, at the place of its first.
    let mut last: Vec<u32> = (0..count as u32).collect();
    for (place, &first) in (0..).zip(&first) {
        if first != place {
            next[last[first as usize] as usize] = place;
            last[first as usize] = place;
        }
    }
    (first, next)
}

/// For each segment that starts at a node that stays the next such node along the curve; [`NONE`] for the others. (A run
/// that closes without one lies on a line and encloses nothing: it goes altogether.)
fn run_ends(crossings: &Crossings, dropped: &BitSet) -> Vec<u32> {
    let mut after = vec![NONE; crossings.nodes.len()];
    for segment in &crossings.segments {
        if dropped.contains(segment.tail) {
            after[segment.tail as usize] = segment.head;
        }
    }
    crossings
        .segments
        .iter()
        .map(|segment| {
            if dropped.contains(segment.tail) {
                return NONE;
            }
            let mut head = segment.head;
            while dropped.contains(head) {
                head = after[head as usize];
            }
            head
        })
        .collect()
}

//! Where edges of one operand cross faces of the other (Vyatkin 2019, step 1: the intersection curve).
//!
//! In general position that is the only kind of event. Two faces that intersect have exactly two crossings, which bound one
//! segment of the intersection curve.

use std::ops::Index;

use super::nearly_flush::NearlyFlush;
use crate::Error;
use crate::boolean::candidates::Candidates;
use crate::boolean::complex::ids::{FaceId, NodeId, SegmentId, VertexId};
use crate::boolean::complex::meeting::Meeting;
use crate::boolean::complex::predicates::{KnownSides, Plane, Predicates};
use crate::boolean::complex::{Complex, Corner};
use crate::parallel::{Runner, read_ahead};
use crate::spatial::radix_sort;

/// A crossing of an edge of one operand with a face of the other. Every cut edge runs from `low` to `high`, its vertices in
/// ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crossing {
    /// The edge's vertices; they tell which operand it belongs to.
    pub(crate) low: VertexId,
    pub(crate) high: VertexId,
    /// The face of the other operand.
    pub(crate) face: FaceId,
    /// Whether the edge, from `low` to `high`, leaves the face's owner (else it enters it).
    pub(crate) leaves: bool,
}

impl Crossing {
    /// By how much the winding number of the face's owner changes along the edge, from `low` to `high`.
    #[inline]
    pub(crate) fn winding_step(&self) -> i32 {
        if self.leaves { -1 } else { 1 }
    }
}

/// One segment of the intersection curve: on `faces[0]` of A, seen from outside, B's outside is to the left of the way from
/// `tail` to `head`; on `faces[1]` of B, A's outside is to the left of the way back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub(crate) faces: [FaceId; 2],
    pub(crate) tail: NodeId,
    pub(crate) head: NodeId,
}

/// All crossings, and the segments between them.
#[derive(Debug, Default)]
pub(crate) struct Crossings {
    /// By node: sorted by edge, then by face.
    nodes: Vec<Crossing>,
    /// How many nodes lie on edges of A; the others lie on edges of B.
    nodes_of_a: u32,
    /// The segments, sorted by face of A, then of B.
    segments: Vec<Segment>,
    /// How many decisions plain coordinates left open.
    pub(crate) contacts: u64,
}

impl Index<NodeId> for Crossings {
    type Output = Crossing;

    #[inline]
    fn index(&self, node: NodeId) -> &Crossing {
        &self.nodes[node.index()]
    }
}

impl Index<SegmentId> for Crossings {
    type Output = Segment;

    #[inline]
    fn index(&self, segment: SegmentId) -> &Segment {
        &self.segments[segment.index()]
    }
}

/// Memory for one intersecting pair while its crossings are numbered, in bytes.
const BYTES_PER_PAIR: u64 = (size_of::<PairCrossing>()
    + 6 * size_of::<u128>()
    + 2 * size_of::<u32>()
    + 2 * size_of::<Crossing>()
    + size_of::<Segment>()) as u64;

/// The most vertices and nodes that are numbered: 2^32 less 2^28 for points that are added later (in the largest case
/// measured, a 4th Menger sponge by itself, these were less than a hundredth of all).
const MOST_POINTS: usize = 0xf000_0000;

/// Pairs whose corners are read before the first is decided, so that cache misses overlap; their copies (144 bytes each)
/// fit the first-level cache.
const PAIRS_AT_ONCE: usize = 64;

/// On more threads than this, sorting by comparisons in parallel is faster than by digits on one.
const RADIX_THREADS: usize = 4;

/// The two crossings of a pair of faces.
#[derive(Clone, Copy, Debug)]
struct PairCrossing {
    faces: [FaceId; 2],
    tail: Crossing,
    head: Crossing,
}

impl Crossings {
    /// Finds the crossings of all candidate pairs, and which are nearly flush where that is asked for.
    ///
    /// # Errors
    /// Limits, and [`Error::TooLarge`] where the points cannot be numbered.
    pub(crate) fn find(
        complex: &Complex<'_>,
        candidates: &Candidates,
        flush: Option<&NearlyFlush>,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let search =
            Search { complex, predicates: Predicates::new(complex), known: KnownSides::new(complex), flush };
        let found = candidates.visit_batches(runner, |pairs, found| search.add_crossings(pairs, found))?;
        let _tables = runner.control.reserve(found.len() as u64 * BYTES_PER_PAIR)?;
        let points = complex.vertex_count() as usize + 2 * found.len();
        if points > MOST_POINTS {
            return Err(Error::TooLarge {
                what: format!("{points} vertices and crossings in one operation"),
            });
        }
        number_nodes(complex, &found, search.predicates.into_contacts(), runner)
    }

    /// How many nodes there are.
    pub(crate) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// All nodes, ascending.
    pub(crate) fn nodes(&self) -> impl ExactSizeIterator<Item = (NodeId, &Crossing)> {
        (0..self.nodes.len() as u32).map(NodeId::new).zip(&self.nodes)
    }

    /// All segments, ascending.
    pub(crate) fn segments(&self) -> impl ExactSizeIterator<Item = (SegmentId, &Segment)> {
        (0..self.segments.len() as u32).map(SegmentId::new).zip(&self.segments)
    }

    /// The operand whose edge a node lies on.
    #[inline]
    pub(crate) fn owner_of_node(&self, node: NodeId) -> usize {
        usize::from(node.number() >= self.nodes_of_a)
    }
}

/// What deciding about pairs needs.
struct Search<'a> {
    complex: &'a Complex<'a>,
    predicates: Predicates<'a>,
    known: Option<KnownSides>,
    flush: Option<&'a NearlyFlush>,
}

impl Search<'_> {
    /// Appends the crossings of those pairs, of a triangle of A and one of B, that intersect.
    fn add_crossings(&self, pairs: &[[u32; 2]], found: &mut Vec<PairCrossing>) {
        let mut corners = Vec::with_capacity(PAIRS_AT_ONCE);
        for pairs in pairs.chunks(PAIRS_AT_ONCE) {
            // First which corners, then where they are.
            for operand in 0..2 {
                let triangles = self.complex.operands[operand].triangles;
                read_ahead(pairs.iter().map(|pair| triangles[pair[operand] as usize][0]));
            }
            corners.clear();
            corners.extend(pairs.iter().map(|&[s, t]| {
                [self.complex.corners_of_triangle(0, s), self.complex.corners_of_triangle(1, t)]
            }));
            if let Some(flush) = self.flush {
                let both = pairs.iter().zip(&corners);
                both.for_each(|(&pair, corners)| flush.look_at(self.complex, pair, corners));
            }
            found.extend(
                pairs.iter().zip(&corners).filter_map(|(&pair, corners)| self.intersect(pair, corners)),
            );
        }
    }

    /// Decides whether two triangles intersect and where: at most ten signs.
    #[inline]
    fn intersect(&self, triangles: [u32; 2], corners: &[[Corner; 3]; 2]) -> Option<PairCrossing> {
        let [a, b] = corners;
        // 1. How they meet.
        let a_inside = self.inside(1, triangles[1], b, a);
        let Meeting { alone, inside: [p_inside, u_inside], pierces } =
            Meeting::of(&self.predicates, a, b, a_inside, || self.inside(0, triangles[0], a, b))?;
        let [p, q, r] = [0, 1, 2].map(|k| &a[(alone[0] + k) % 3]);
        let [u, v, w] = [0, 1, 2].map(|k| &b[(alone[1] + k) % 3]);
        // 2. The crossings, directed: along the boundary of its own triangle an edge of A that leaves B ends the segment,
        //    one of B that leaves A starts it.
        let faces = [0, 1].map(|operand| self.complex.face(operand, triangles[operand]));
        let crossing = |x: &Corner, y: &Corner, x_inside: bool, face: FaceId| {
            let (low, high) = if x.id < y.id { (x.id, y.id) } else { (y.id, x.id) };
            Crossing { low, high, face, leaves: x_inside == (x.id < y.id) }
        };
        let (mut tail, mut head) = (None, None);
        let mut place = |crossing: Crossing, is_head: bool| {
            *(if is_head { &mut head } else { &mut tail }) = Some(crossing);
        };
        let [[by_pq, by_pr], [by_uv, by_uw]] = pierces;
        if by_pq {
            place(crossing(p, q, p_inside, faces[1]), p_inside);
        }
        if by_pr {
            place(crossing(p, r, p_inside, faces[1]), !p_inside);
        }
        if by_uv {
            place(crossing(u, v, u_inside, faces[0]), !u_inside);
        }
        if by_uw {
            place(crossing(u, w, u_inside, faces[0]), u_inside);
        }
        debug_assert_eq!(
            tail.is_some(),
            head.is_some(),
            "an intersecting pair has one crossing of each direction"
        );
        Some(PairCrossing { faces, tail: tail?, head: head? })
    }

    /// Which of three corners of the other operand lie inside the plane of a triangle.
    #[inline]
    fn inside(
        &self,
        operand: usize,
        triangle: u32,
        corners: &[Corner; 3],
        others: &[Corner; 3],
    ) -> [bool; 3] {
        if let Some(known) = &self.known {
            return known.inside(&self.predicates, operand, triangle, corners, others);
        }
        let [a, b, c] = corners;
        let plane = Plane::new(a, b, c);
        let [u, v, w] = others;
        [u, v, w].map(|other| self.predicates.is_inside(&plane, other))
    }
}

/// Gives every crossing one number: each is met in the pairs of all faces beside its edge.
fn number_nodes(
    complex: &Complex<'_>,
    found: &[PairCrossing],
    contacts: u64,
    runner: Runner<'_>,
) -> Result<Crossings, Error> {
    let number = || numbered_nodes(complex, found, runner);
    let ((nodes, node_of), order) = runner.both(number, || ordered_pairs(complex, found, runner));
    runner.control.check()?;
    let segments = order
        .iter()
        .map(|&pair| {
            let PairCrossing { faces, .. } = found[pair as usize];
            let [tail, head] = [0, 1].map(|end| node_of[2 * pair as usize + end]);
            Segment { faces, tail, head }
        })
        .collect();
    let nodes_of_a = nodes.partition_point(|node| complex.owner(node.low) == 0) as u32;
    Ok(Crossings { nodes, nodes_of_a, segments, contacts })
}

/// The crossings, each once, in the order of their edges and faces; and the node of every end: the tail and the head of each
/// pair.
fn numbered_nodes(
    complex: &Complex<'_>,
    found: &[PairCrossing],
    runner: Runner<'_>,
) -> (Vec<Crossing>, Vec<NodeId>) {
    // Edge, face, direction, and place among all ends of segments, from the highest bits to the lowest: vertices have 31
    // bits, and the direction follows from edge and face.
    let key = |crossing: &Crossing, place: u32| {
        u128::from(crossing.low.number()) << 97
            | u128::from(crossing.high.number()) << 65
            | u128::from(crossing.face.number()) << 33
            | u128::from(crossing.leaves) << 32
            | u128::from(place)
    };
    let mut order: Vec<u128> = Vec::with_capacity(2 * found.len());
    for (pair, place) in found.iter().zip((0u32..).step_by(2)) {
        order.extend([key(&pair.tail, place), key(&pair.head, place + 1)]);
    }
    sort(&mut order, 97, complex.vertex_count(), runner);
    let mut nodes: Vec<Crossing> = Vec::with_capacity(order.len() / 2);
    let mut node_of = vec![NodeId::NONE; order.len()];
    let mut last = None;
    for &key in &order {
        if last != Some(key >> 32) {
            last = Some(key >> 32);
            nodes.push(Crossing {
                low: VertexId::new((key >> 97) as u32),
                high: VertexId::new((key >> 65) as u32),
                face: FaceId::new((key >> 33) as u32),
                leaves: key >> 32 & 1 == 1,
            });
        }
        node_of[key as u32 as usize] = NodeId::new(nodes.len() as u32 - 1);
    }
    (nodes, node_of)
}

/// The pairs by their faces, each once: a pair may have been found more than once.
fn ordered_pairs(complex: &Complex<'_>, found: &[PairCrossing], runner: Runner<'_>) -> Vec<u32> {
    // Face of A, face of B, and place.
    let keys = found.iter().zip(0u64..).map(|(pair, place)| {
        let [a, b] = pair.faces.map(|face| u128::from(face.number()));
        a << 96 | b << 64 | u128::from(place)
    });
    let mut order: Vec<u128> = keys.collect();
    sort(&mut order, 96, complex.operands[0].triangles.len() as u32, runner);
    order.dedup_by_key(|key| *key >> 64);
    order.iter().map(|&key| key as u32).collect()
}

/// Sorts keys that differ. The bits from `shift` on are a number below `limit`, which few keys have in common.
fn sort(keys: &mut Vec<u128>, shift: u32, limit: u32, runner: Runner<'_>) {
    if runner.threads() > RADIX_THREADS {
        runner.sort(keys);
        return;
    }
    radix_sort(keys, &mut Vec::new(), |&key| (key >> shift) as u32, u32::BITS - limit.leading_zeros());
    for group in keys.chunk_by_mut(|x, y| x >> shift == y >> shift) {
        group.sort_unstable();
    }
}

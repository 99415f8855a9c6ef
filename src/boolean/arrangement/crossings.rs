//! Where edges of one operand cross triangles of the other (Vyatkin 2019, step 1: the intersection curve).
//!
//! In general position that is the only kind of event. Two triangles that intersect have exactly two crossings, which
//! bound one segment of the intersection curve.

use crate::Error;
use crate::boolean::candidates::Candidates;
use crate::boolean::complex::operands::{Corner, Operands, Plane};
use crate::parallel::Runner;
use crate::spatial::{radix_sort, read_ahead};

/// A crossing of an edge of one operand with a triangle of the other. Every cut edge runs from `low` to `high`, its
/// vertices in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Crossing {
    /// The edge's vertices, by number; they tell which operand it belongs to.
    pub(crate) low: u32,
    pub(crate) high: u32,
    /// The triangle of the other operand.
    pub(crate) triangle: u32,
    /// Whether the edge, from `low` to `high`, leaves the triangle's operand (else it enters it).
    pub(crate) leaves: bool,
}

/// One segment of the intersection curve: on triangle `triangles[0]` of A, seen from outside, B's outside is to the left
/// of the way from `tail` to `head`; on `triangles[1]` of B, A's outside is to the left of the way back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub(crate) triangles: [u32; 2],
    pub(crate) tail: u32,
    pub(crate) head: u32,
}

/// All crossings, and the segments between them.
#[derive(Debug, Default)]
pub(crate) struct Crossings {
    /// The crossings, sorted by edge, then by triangle. A crossing's index here is its node number.
    pub(crate) nodes: Vec<Crossing>,
    /// So many of them lie on edges of A; the others on edges of B.
    nodes_of_a: u32,
    /// The segments, sorted by triangle of A, then of B.
    pub(crate) segments: Vec<Segment>,
}

impl Crossings {
    /// The operand whose edge a node lies on.
    #[inline]
    pub(crate) fn side_of_node(&self, node: u32) -> usize {
        usize::from(node >= self.nodes_of_a)
    }
}

/// Memory for one intersecting pair while its crossings are numbered.
const BYTES_PER_PAIR: u64 = (size_of::<PairCrossing>()
    + 6 * size_of::<u128>()
    + 2 * size_of::<u32>()
    + 2 * size_of::<Crossing>()
    + size_of::<Segment>()) as u64;

/// So many vertices and nodes can be numbered by 32 bits, with room for copies.
const MOST_POINTS: usize = 0xf000_0000;

/// Pairs whose corners are read before the first is decided, so that cache misses overlap; the copies fit the cache.
const PAIRS_AT_ONCE: usize = 64;
/// On more threads, sorting by comparisons side by side is faster than digit by digit.
const RADIX_THREADS: usize = 4;

/// The two crossings of a pair of triangles, tail first.
#[derive(Clone, Copy, Debug)]
struct PairCrossing {
    triangles: [u32; 2],
    tail: Crossing,
    head: Crossing,
}

/// Finds the crossings of all candidate pairs.
pub(crate) fn find(
    operands: &Operands<'_>,
    candidates: &Candidates,
    runner: Runner<'_>,
) -> Result<Crossings, Error> {
    let found = candidates.visit_batches(runner, |pairs, found| {
        let mut corners = Vec::with_capacity(PAIRS_AT_ONCE);
        for pairs in pairs.chunks(PAIRS_AT_ONCE) {
            // First which corners, then where they are.
            for side in 0..2 {
                let triangles = operands.sides[side].triangles;
                read_ahead(pairs.iter().map(|pair| triangles[pair[side] as usize][0]));
            }
            corners.clear();
            corners.extend(pairs.iter().map(|&[s, t]| [operands.corners(0, s), operands.corners(1, t)]));
            found.extend(
                pairs.iter().zip(&corners).filter_map(|(&pair, corners)| cross(operands, pair, corners)),
            );
        }
    })?;
    let _tables = runner.control.reserve(found.len() as u64 * BYTES_PER_PAIR)?;
    let points = operands.vertex_count() as usize + 2 * found.len();
    if points > MOST_POINTS {
        return Err(Error::TooLarge { what: format!("{points} vertices and crossings in one operation") });
    }
    number_nodes(operands, &found, runner)
}

/// Decides whether two triangles intersect and where: at most ten signs.
#[inline]
fn cross(operands: &Operands<'_>, triangles: [u32; 2], corners: &[[Corner; 3]; 2]) -> Option<PairCrossing> {
    let [a, b] = corners;
    // Which corners lie inside the other triangle's plane.
    let a_inside = operands.inside(1, triangles[1], b, a);
    let lone_a = lone(a_inside)?;
    let b_inside = operands.inside(0, triangles[0], a, b);
    let lone_b = lone(b_inside)?;
    let [p, q, r] = [0, 1, 2].map(|i| &a[(lone_a + i) % 3]);
    let [u, v, w] = [0, 1, 2].map(|i| &b[(lone_b + i) % 3]);
    // Both triangles cut the line in which their planes meet in an interval; the edges at the lone corners bound it. An
    // edge crosses the other triangle iff it passes its two edges at the lone corner on different sides.
    let (pqu, pru) = (Plane::new(p, q, u), Plane::new(p, r, u));
    let qv = operands.positive_of_plane(&pqu, v);
    let qw = operands.positive_of_plane(&pqu, w);
    let rv = operands.positive_of_plane(&pru, v);
    let rw = operands.positive_of_plane(&pru, w);
    let crossing = |x: &Corner, y: &Corner, x_inside: bool, triangle: u32| {
        let (low, high) = if x.id < y.id { (x.id, y.id) } else { (y.id, x.id) };
        Crossing { low, high, triangle, leaves: x_inside == (x.id < y.id) }
    };
    // Along the boundary of its own triangle an edge of A that leaves B ends the segment, one of B that leaves A starts it.
    let (mut tail, mut head) = (None, None);
    let mut place =
        |crossing: Crossing, is_head: bool| *(if is_head { &mut head } else { &mut tail }) = Some(crossing);
    let (p_inside, u_inside) = (a_inside[lone_a], b_inside[lone_b]);
    if qv != qw {
        place(crossing(p, q, p_inside, triangles[1]), p_inside);
    }
    if rv != rw {
        place(crossing(p, r, p_inside, triangles[1]), !p_inside);
    }
    if qv != rv {
        place(crossing(u, v, u_inside, triangles[0]), !u_inside);
    }
    if qw != rw {
        place(crossing(u, w, u_inside, triangles[0]), u_inside);
    }
    debug_assert_eq!(
        tail.is_some(),
        head.is_some(),
        "an intersecting pair has one crossing of each direction"
    );
    Some(PairCrossing { triangles, tail: tail?, head: head? })
}

/// The index of the one that differs from the other two.
#[inline]
fn lone(inside: [bool; 3]) -> Option<usize> {
    match inside {
        [a, b, c] if a == b && b == c => None,
        [a, b, _] if a == b => Some(2),
        [a, _, c] if a == c => Some(1),
        _ => Some(0),
    }
}

/// Gives every crossing one number: each is met in the pairs of all triangles beside its edge.
fn number_nodes(
    operands: &Operands<'_>,
    found: &[PairCrossing],
    runner: Runner<'_>,
) -> Result<Crossings, Error> {
    // Edge, triangle, direction, and place among all ends of segments, from the highest bits to the lowest: vertices have 31
    // bits, and the direction follows from edge and triangle.
    let key = |crossing: &Crossing, place: u32| {
        u128::from(crossing.low) << 97
            | u128::from(crossing.high) << 65
            | u128::from(crossing.triangle) << 33
            | u128::from(crossing.leaves) << 32
            | u128::from(place)
    };
    let number = || {
        let mut order: Vec<u128> = Vec::with_capacity(2 * found.len());
        for (pair, place) in found.iter().zip((0u32..).step_by(2)) {
            order.extend([key(&pair.tail, place), key(&pair.head, place + 1)]);
        }
        sort(&mut order, 97, operands.vertex_count(), runner);
        let mut nodes: Vec<Crossing> = Vec::with_capacity(order.len() / 2);
        let mut node_of = vec![0u32; order.len()];
        let mut last = None;
        for &key in &order {
            if last != Some(key >> 32) {
                last = Some(key >> 32);
                nodes.push(Crossing {
                    low: (key >> 97) as u32,
                    high: (key >> 65) as u32,
                    triangle: (key >> 33) as u32,
                    leaves: key >> 32 & 1 == 1,
                });
            }
            node_of[key as u32 as usize] = nodes.len() as u32 - 1;
        }
        (nodes, node_of)
    };
    // Triangle of A, triangle of B, and place.
    let order_pairs = || {
        let keys = found.iter().zip(0u64..).map(|(pair, i)| {
            u128::from(pair.triangles[0]) << 96 | u128::from(pair.triangles[1]) << 64 | u128::from(i)
        });
        let mut order: Vec<u128> = keys.collect();
        sort(&mut order, 96, operands.sides[0].triangles.len() as u32, runner);
        // A pair may have been found more than once.
        order.dedup_by_key(|key| *key >> 64);
        order
    };
    let ((nodes, node_of), order) = runner.both(number, order_pairs);
    runner.control.check()?;
    let segments = order
        .iter()
        .map(|&key| {
            let i = key as u64 as usize;
            let triangles = [(key >> 96) as u32, (key >> 64) as u32];
            Segment { triangles, tail: node_of[2 * i], head: node_of[2 * i + 1] }
        })
        .collect();
    let nodes_of_a = nodes.partition_point(|node| operands.side_of(node.low) == 0) as u32;
    Ok(Crossings { nodes, nodes_of_a, segments })
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

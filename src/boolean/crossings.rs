//! Where edges of one operand cross triangles of the other (Vyatkin 2019, step 1: the intersection curve).
//!
//! In general position that is the only kind of event. Two triangles that intersect have exactly two crossings, which
//! bound one segment of the intersection curve.

use super::candidates::Candidates;
use super::operands::{Corner, Operands};
use crate::Error;
use crate::parallel::Runner;

/// A crossing of an edge of one operand with a triangle of the other. Every cut edge runs from `low` to `high`, its
/// vertices in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Crossing {
    /// The edge's vertices, by number; they tell which operand it belongs to.
    pub(super) low: u32,
    pub(super) high: u32,
    /// The triangle of the other operand.
    pub(super) triangle: u32,
    /// Whether the edge, from `low` to `high`, leaves the triangle's operand (else it enters it).
    pub(super) leaves: bool,
}

/// One segment of the intersection curve: on triangle `triangles[0]` of A, seen from outside, B's outside is to the left
/// of the way from `tail` to `head`; on `triangles[1]` of B, A's outside is to the left of the way back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) triangles: [u32; 2],
    pub(super) tail: u32,
    pub(super) head: u32,
}

/// All crossings, and the segments between them.
#[derive(Debug, Default)]
pub(super) struct Crossings {
    /// The crossings, sorted by edge, then by triangle. A crossing's index here is its node number.
    pub(super) nodes: Vec<Crossing>,
    /// The segments, sorted by triangle of A, then of B.
    pub(super) segments: Vec<Segment>,
}

/// Memory for one intersecting pair while its crossings are numbered.
const BYTES_PER_PAIR: u64 = (size_of::<PairCrossing>()
    + 2 * size_of::<u128>()
    + 2 * size_of::<u32>()
    + 2 * size_of::<Crossing>()
    + size_of::<Segment>()) as u64;

/// So many vertices and nodes can be numbered by 32 bits, with room for copies.
const MOST_POINTS: usize = 0xf000_0000;

/// The two crossings of a pair of triangles, tail first.
#[derive(Clone, Copy, Debug)]
struct PairCrossing {
    triangles: [u32; 2],
    tail: Crossing,
    head: Crossing,
}

/// Finds the crossings of all candidate pairs.
pub(super) fn find(
    operands: &Operands<'_>,
    candidates: &Candidates,
    runner: Runner<'_>,
) -> Result<Crossings, Error> {
    let found = candidates.visit(runner, |s, t, found| found.extend(cross(operands, [s, t])))?;
    let _tables = runner.control.reserve(found.len() as u64 * BYTES_PER_PAIR)?;
    let points = operands.vertex_count() as usize + 2 * found.len();
    if points > MOST_POINTS {
        return Err(Error::TooLarge { what: format!("{points} vertices and crossings in one operation") });
    }
    number_nodes(&found, runner)
}

/// Decides whether two triangles intersect and where: at most ten signs.
fn cross(operands: &Operands<'_>, triangles: [u32; 2]) -> Option<PairCrossing> {
    let a = operands.corners(0, triangles[0]);
    let b = operands.corners(1, triangles[1]);
    // Which corners lie inside the other triangle's plane.
    let a_inside = operands.inside(1, triangles[1], &b, &a);
    let lone_a = lone(a_inside)?;
    let b_inside = operands.inside(0, triangles[0], &a, &b);
    let lone_b = lone(b_inside)?;
    let [p, q, r] = [0, 1, 2].map(|i| &a[(lone_a + i) % 3]);
    let [u, v, w] = [0, 1, 2].map(|i| &b[(lone_b + i) % 3]);
    // Both triangles cut the line in which their planes meet in an interval; the edges at the lone corners bound it. An
    // edge crosses the other triangle iff it passes its two edges at the lone corner on different sides.
    let qv = operands.positive(p, q, u, v);
    let qw = operands.positive(p, q, u, w);
    let rv = operands.positive(p, r, u, v);
    let rw = operands.positive(p, r, u, w);
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
fn number_nodes(found: &[PairCrossing], runner: Runner<'_>) -> Result<Crossings, Error> {
    // Edge, triangle, and place among all ends of segments, from the highest bits to the lowest.
    let key = |crossing: &Crossing, place: u32| {
        u128::from(crossing.low) << 96
            | u128::from(crossing.high) << 64
            | u128::from(crossing.triangle) << 32
            | u128::from(place)
    };
    let mut order: Vec<u128> = found
        .iter()
        .zip((0u32..).step_by(2))
        .flat_map(|(pair, place)| [key(&pair.tail, place), key(&pair.head, place + 1)])
        .collect();
    runner.sort(&mut order);
    runner.control.check()?;
    let mut nodes: Vec<Crossing> = Vec::with_capacity(order.len() / 2);
    let mut node_of = vec![0u32; order.len()];
    let mut last = None;
    for &key in &order {
        let place = key as u32 as usize;
        if last != Some(key >> 32) {
            last = Some(key >> 32);
            let pair = &found[place / 2];
            nodes.push(if place.is_multiple_of(2) { pair.tail } else { pair.head });
        }
        node_of[place] = nodes.len() as u32 - 1;
    }
    drop(order);
    // Triangle of A, triangle of B, and place.
    let mut order: Vec<u128> = found
        .iter()
        .enumerate()
        .map(|(i, pair)| {
            u128::from(pair.triangles[0]) << 96 | u128::from(pair.triangles[1]) << 64 | i as u128
        })
        .collect();
    runner.sort(&mut order);
    let segments = order
        .iter()
        .map(|&key| {
            let i = key as u64 as usize;
            Segment { triangles: found[i].triangles, tail: node_of[2 * i], head: node_of[2 * i + 1] }
        })
        .collect();
    Ok(Crossings { nodes, segments })
}

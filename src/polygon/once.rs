//! Whether directed edges are the boundary of a region and wind around it once: a sweep, exact.

use crate::exact::{Sign, orient2d};

/// Whether directed edges wind once around what is on their left and not at all around the rest of the plane, and have no points in
/// common but ends of the same number. Where that is so it is so with room to spare: the smallest of moves change nothing. Every
/// vertex must be left as often as it is entered. O(n log n), and n times what a vertical line meets.
///
/// (The line goes from left to right. What is between the edges that it meets is outside and inside in turn, and an edge runs to the
/// right where the inside is above it. Edges that would meet further on are beside each other before they do.)
pub(crate) fn winds_once(points: &[[f64; 2]], edges: &[[u32; 2]]) -> bool {
    Sweep::new(points, edges).is_some_and(Sweep::run)
}

/// An edge from left to right, between places in the order of the sweep.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Span {
    left: u32,
    right: u32,
    /// Whether the directed edge runs to the right.
    is_forward: bool,
}

struct Sweep {
    /// Points in the order of the sweep: from left to right, and upwards where several are in a line.
    points: Vec<[f64; 2]>,
    /// By left end.
    spans: Vec<Span>,
    /// How many end at each point.
    ending: Vec<u32>,
    /// What the line meets, from below.
    met: Vec<Span>,
}

impl Sweep {
    /// `None` where two vertices are in one place.
    fn new(points: &[[f64; 2]], edges: &[[u32; 2]]) -> Option<Self> {
        // 1. The vertices in order.
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let at = |v: u32| points[v as usize];
        order.sort_unstable_by(|&p, &q| {
            let ([a, b], [c, d]) = (at(p), at(q));
            a.partial_cmp(&c).zip(b.partial_cmp(&d)).map_or(std::cmp::Ordering::Equal, |(x, y)| x.then(y))
        });
        if order.windows(2).any(|pair| at(pair[0]) == at(pair[1])) {
            return None;
        }
        let mut place = vec![0; points.len()];
        (0u32..).zip(&order).for_each(|(k, &v)| place[v as usize] = k);
        // 2. The edges by their left ends.
        let mut ending = vec![0; points.len()];
        let mut spans: Vec<Span> = edges
            .iter()
            .map(|edge| {
                let [from, to] = edge.map(|v| place[v as usize]);
                ending[from.max(to) as usize] += 1;
                Span { left: from.min(to), right: from.max(to), is_forward: from < to }
            })
            .collect();
        spans.sort_unstable();
        Some(Self { points: order.into_iter().map(at).collect(), spans, ending, met: Vec::new() })
    }

    fn run(mut self) -> bool {
        let mut next = 0;
        for point in 0..self.points.len() as u32 {
            let count = self.spans[next..].iter().take_while(|span| span.left == point).count();
            if !self.pass(point, next..next + count) {
                return false;
            }
            next += count;
        }
        self.met.is_empty()
    }

    /// Moves the line past a point where some edges begin; false where that shows a fault.
    fn pass(&mut self, point: u32, beginning: std::ops::Range<usize>) -> bool {
        // 1. Those that end there are one above the other, with nothing else through the point.
        let side = |span: &Span| self.turn(span.left, span.right, point);
        let low = self.met.partition_point(|span| span.right != point && side(span) == Sign::Positive);
        let count = self.met[low..].iter().take_while(|span| span.right == point).count();
        let above = self.met.get(low + count);
        if count != self.ending[point as usize] as usize
            || above.is_some_and(|span| side(span) != Sign::Negative)
        {
            return false;
        }
        // 2. Those that begin there, from below, no two in one direction.
        let mut new = self.spans[beginning].to_vec();
        new.sort_unstable_by(|a, b| match self.turn(point, a.right, b.right) {
            Sign::Positive => std::cmp::Ordering::Less,
            Sign::Zero => std::cmp::Ordering::Equal,
            Sign::Negative => std::cmp::Ordering::Greater,
        });
        if new.windows(2).any(|pair| self.turn(point, pair[0].right, pair[1].right) != Sign::Positive) {
            return false;
        }
        // 3. Inside and outside take turns.
        let is_in_turn = |(place, span): (usize, &Span)| span.is_forward == (place % 2 == 0);
        if new.len() % 2 != count % 2 || !(low..).zip(&new).all(is_in_turn) {
            return false;
        }
        let end = low + new.len();
        self.met.splice(low..low + count, new);
        // 4. What is beside each other now never meets.
        let are_apart = |upper: usize| {
            let lower = upper.checked_sub(1).and_then(|lower| self.met.get(lower));
            lower.zip(self.met.get(upper)).is_none_or(|(lower, upper)| self.stay_apart(lower, upper))
        };
        are_apart(low) && (end == low || are_apart(end))
    }

    /// Whether of two edges that the line meets, one beside the other, the lower one stays below.
    fn stay_apart(&self, lower: &Span, upper: &Span) -> bool {
        match lower.right.cmp(&upper.right) {
            std::cmp::Ordering::Less => self.turn(upper.left, upper.right, lower.right) == Sign::Negative,
            std::cmp::Ordering::Equal => true,
            std::cmp::Ordering::Greater => self.turn(lower.left, lower.right, upper.right) == Sign::Positive,
        }
    }

    fn turn(&self, a: u32, b: u32, c: u32) -> Sign {
        let [a, b, c] = [a, b, c].map(|point| self.points[point as usize]);
        orient2d(a, b, c)
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn ring(first: u32, count: u32) -> Vec<[u32; 2]> {
        (0..count).map(|k| [first + k, first + (k + 1) % count]).collect()
    }

    fn turned(edges: &[[u32; 2]]) -> Vec<[u32; 2]> {
        edges.iter().map(|&[u, v]| [v, u]).collect()
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    fn square(low: f64, high: f64) -> [[f64; 2]; 4] {
        SQUARE.map(|point| point.map(|x| low + (high - low) * x))
    }

    #[test]
    fn one_outline_runs_counter_clockwise() {
        assert!(winds_once(&[], &[]));
        assert!(winds_once(&SQUARE, &ring(0, 4)));
        assert!(!winds_once(&SQUARE, &turned(&ring(0, 4))));
        // A bow tie, and a spike.
        assert!(!winds_once(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], &ring(0, 4)));
        assert!(!winds_once(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]], &ring(0, 4)));
        // The same place twice; a side through a corner.
        assert!(!winds_once(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 0.0]], &ring(0, 4)));
        assert!(!winds_once(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]], &ring(0, 5)));
    }

    #[test]
    fn holes_and_islands_take_turns() {
        let both = |inner: [[f64; 2]; 4]| [square(0.0, 8.0), inner].concat();
        let edges = |second: Vec<[u32; 2]>| [ring(0, 4), second].concat();
        assert!(winds_once(&both(square(2.0, 4.0)), &edges(turned(&ring(4, 4)))));
        assert!(!winds_once(&both(square(2.0, 4.0)), &edges(ring(4, 4))));
        assert!(winds_once(&both(square(9.0, 10.0)), &edges(ring(4, 4))));
        assert!(!winds_once(&both(square(9.0, 10.0)), &edges(turned(&ring(4, 4)))));
        // Crossing, and touching from inside, at a corner and along a side.
        assert!(!winds_once(&both(square(7.0, 9.0)), &edges(ring(4, 4))));
        assert!(!winds_once(&both(square(2.0, 8.0)), &edges(turned(&ring(4, 4)))));
        let touching = [[0.0, 4.0], [2.0, 3.0], [4.0, 4.0], [2.0, 5.0]];
        assert!(!winds_once(&both(touching), &edges(turned(&ring(4, 4)))));
    }

    #[test]
    fn regions_may_touch_in_a_common_vertex() {
        // Two triangles that share the middle, side by side; then one inside the other's corner.
        let points = [[0.0, 0.0], [-1.0, 0.5], [-1.0, -0.5], [1.0, -0.5], [1.0, 0.5]];
        let edges = [[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]];
        assert!(winds_once(&points, &edges));
        let points = [[0.0, 0.0], [3.0, 0.1], [3.0, 0.2], [4.0, -1.0], [4.0, 1.0]];
        assert!(!winds_once(&points, &edges));
    }

    /// Triangles of a grid that are laid down at random, none over another, wind once; with one that lies over others they do not.
    #[test]
    fn unions_of_triangles_of_a_grid_wind_once() {
        let mut random = ChaCha8Rng::seed_from_u64(1_628);
        const N: u32 = 7;
        for round in 0..300 {
            let mut points: Vec<[f64; 2]> =
                (0..N * N).map(|v| [f64::from(v % N), f64::from(v / N)]).collect();
            let shear = [0.0, 0.3, 1.0][round % 3];
            let wild = [0.0, 0.2][round % 2];
            for point in &mut points {
                *point = [point[0] + shear * point[1], point[1]]
                    .map(|x| x + wild * random.random_range(-1.0..1.0));
            }
            let mut chosen: Vec<[u32; 3]> = Vec::new();
            for v in (0..N * N - N).filter(|v| v % N + 1 < N) {
                for corners in [[v, v + 1, v + N + 1], [v, v + N + 1, v + N]] {
                    let [a, b, c] = corners.map(|v| points[v as usize]);
                    if random.random_bool(0.6) && orient2d(a, b, c) == Sign::Positive {
                        chosen.push(corners);
                    }
                }
            }
            let boundary = |chosen: &[[u32; 3]]| {
                let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
                let all: Vec<[u32; 2]> = chosen.iter().flat_map(sides).collect();
                all.iter().copied().filter(|&[u, v]| !all.contains(&[v, u])).collect::<Vec<_>>()
            };
            let is_grid = wild == 0.0;
            assert!(!is_grid || winds_once(&points, &boundary(&chosen)), "{round}");
            // One more triangle over others, with corners of its own.
            let first = points.len() as u32;
            let Some(&under) = chosen.get(random.random_range(0..chosen.len())) else { continue };
            let [x, y] = under
                .map(|v| points[v as usize])
                .iter()
                .fold([0.0; 2], |s, p| [s[0] + p[0] / 3.0, s[1] + p[1] / 3.0]);
            let size = random.random_range(0.1..3.0);
            points.extend([[x - size, y - size], [x + size, y - size], [x, y + size]]);
            chosen.push([first, first + 1, first + 2]);
            assert!(!winds_once(&points, &boundary(&chosen)), "{round}");
        }
    }
}

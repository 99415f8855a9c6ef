//! Directed edges to closed loops.

use crate::exact::{Sign, orient2d};

/// Traces loops; keeps its scratch memory.
#[derive(Debug, Default)]
pub(super) struct Tracer {
    sorted: Vec<[u32; 2]>,
    used: Vec<bool>,
}

impl Tracer {
    /// The loops of edges that bound a region to their left. Where a vertex is left more than once, the loop takes the
    /// tightest turn to the left, so that parts which touch in a vertex become loops of their own.
    pub(super) fn trace(&mut self, points: &[[f64; 2]], edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
        self.sorted.clear();
        self.sorted.extend_from_slice(edges);
        self.sorted.sort_unstable();
        self.used.clear();
        self.used.resize(edges.len(), false);
        let mut loops = Vec::new();
        for start in 0..self.sorted.len() {
            if self.used[start] {
                continue;
            }
            let mut ring = Vec::new();
            let mut edge = start;
            loop {
                self.used[edge] = true;
                let [from, to] = self.sorted[edge];
                ring.push(from);
                let next = self.next(points, from, to);
                match next {
                    // Back at the start: the starting edge is the tightest turn among the remaining ones, too.
                    _ if to == self.sorted[start][0] && self.closes(points, from, to, start, next) => break,
                    Some(next) => edge = next,
                    None => break,
                }
            }
            loops.push(ring);
        }
        loops
    }

    /// The unused edge leaving `to` with the tightest left turn for somebody coming from `from`.
    fn next(&self, points: &[[f64; 2]], from: u32, to: u32) -> Option<usize> {
        let first = self.sorted.partition_point(|edge| edge[0] < to);
        let mut best: Option<usize> = None;
        for i in first..self.sorted.len() {
            if self.sorted[i][0] != to {
                break;
            }
            if self.used[i] {
                continue;
            }
            best = match best {
                Some(b) if !tighter(points, from, to, self.sorted[i][1], self.sorted[b][1]) => Some(b),
                _ => Some(i),
            };
        }
        best
    }

    /// Whether the loop closes here: no other edge turns tighter than the one it started with.
    fn closes(&self, points: &[[f64; 2]], from: u32, to: u32, start: usize, next: Option<usize>) -> bool {
        next.is_none_or(|next| !tighter(points, from, to, self.sorted[next][1], self.sorted[start][1]))
    }
}

/// Whether, coming from `from` to `at`, the way on to `x` turns further left than the way to `y`: it comes earlier when
/// turning clockwise from the way back.
fn tighter(points: &[[f64; 2]], from: u32, at: u32, x: u32, y: u32) -> bool {
    if x == y {
        return false;
    }
    // The way straight back encloses nothing to the left.
    if x == from || y == from {
        return x == from;
    }
    let [from, at, x, y] = [from, at, x, y].map(|v| points[v as usize]);
    // Left of the incoming direction first, then straight on, then right.
    let class = |p: [f64; 2]| match orient2d(from, at, p) {
        Sign::Positive => 0,
        Sign::Zero => {
            let ahead = (at[0] - from[0]) * (p[0] - at[0]) + (at[1] - from[1]) * (p[1] - at[1]) > 0.0;
            if ahead { 1 } else { -1 }
        }
        Sign::Negative => 2,
    };
    match class(x) - class(y) {
        0 => orient2d(at, y, x) == Sign::Positive,
        difference => difference < 0,
    }
}

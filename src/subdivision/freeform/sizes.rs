//! How large faces are to be: small beside the curve, as the smaller operand has it there, growing away from it.

use glam::DVec3;

use super::curve::Chain;

/// Faces may be this much longer than asked for before they are split.
const ROOM: f64 = 1.45;
/// Within this many edge lengths of the curve faces are all of its size.
const BAND: f64 = 1.2;
/// How fast the size grows with the distance from the curve beyond that.
const GROWTH: f64 = 0.7;
/// How fast it may change along the curve.
const SLOPE: f64 = 0.5;
/// A closed chain has at least this many nodes: with four, a round handle's root is 4e-2 off.
const LEAST_NODES: f64 = 8.0;
/// Vertices nearer to the curve than this share of its size go.
const TOO_NEAR: f64 = 0.45;

/// The wanted size at each point of each chain.
pub(super) struct Sizes {
    /// Points of the curve with the size there.
    points: Vec<(DVec3, f64)>,
    /// The same at its features alone.
    features: Vec<(DVec3, f64)>,
    /// For each chain the size at each of its points.
    pub(super) of_chain: Vec<Vec<f64>>,
}

impl Sizes {
    /// Sizes from those of the control faces under each point of each chain.
    pub(super) fn new(chains: &[Chain], mut of_chain: Vec<Vec<f64>>) -> Self {
        for (chain, sizes) in chains.iter().zip(&mut of_chain) {
            let most = if chain.closed { chain.length() / LEAST_NODES } else { f64::INFINITY };
            sizes.iter_mut().for_each(|size| *size = size.min(most));
            let n = sizes.len();
            let step = |i: usize, j: usize| chain.points[i].distance(chain.points[j]) * SLOPE;
            // Twice around, forwards and backwards, is enough for the smallest size to reach everywhere.
            for i in 1..2 * n {
                let (a, b) = ((i - 1) % n, i % n);
                if chain.closed || b != 0 {
                    sizes[b] = sizes[b].min(sizes[a] + step(a, b));
                }
            }
            for i in (1..2 * n).rev() {
                let (a, b) = ((i - 1) % n, i % n);
                if chain.closed || b != 0 {
                    sizes[a] = sizes[a].min(sizes[b] + step(a, b));
                }
            }
        }
        let points = chains.iter().zip(&of_chain).flat_map(|(chain, sizes)| {
            // Neighbours closer than an eighth of the size say the same.
            let mut last = f64::NEG_INFINITY;
            let mut kept = Vec::new();
            for i in 0..chain.points.len() {
                if chain.lengths[i] - last >= sizes[i] / 8.0 {
                    kept.push((chain.points[i], sizes[i]));
                    last = chain.lengths[i];
                }
            }
            kept
        });
        let points = points.collect();
        let features = chains.iter().zip(&of_chain).flat_map(|(chain, sizes)| {
            chain.features.iter().map(|&i| (chain.points[i], sizes[i])).collect::<Vec<_>>()
        });
        let features = features.collect();
        Self { points, features, of_chain }
    }

    /// The size asked for at `x`; infinite without a curve.
    pub(super) fn at(&self, x: DVec3) -> f64 {
        let grown =
            |&(point, size): &(DVec3, f64)| size + (x.distance(point) - BAND * size).max(0.0) * GROWTH;
        self.points.iter().map(grown).fold(f64::INFINITY, f64::min)
    }

    /// How often a face with these corners and this length of edges is to be split.
    pub(super) fn steps(&self, corners: [DVec3; 3], length: f64) -> u32 {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let wanted = corners.into_iter().chain([middle]).map(|x| self.at(x)).fold(f64::INFINITY, f64::min);
        let ratio = length / (ROOM * wanted);
        if ratio > 1.0 { ratio.log2().ceil() as u32 } else { 0 }
    }

    /// Whether a vertex is so near to the curve that it has to go. One on a crease goes only where the curve crosses the
    /// crease: beside a curve that runs along it, it holds the crease.
    pub(super) fn is_too_near(&self, x: DVec3, on_crease: bool) -> bool {
        let points = if on_crease { &self.features } else { &self.points };
        points.iter().any(|&(point, size)| x.distance(point) < TOO_NEAR * size)
    }

    /// Lengths along a chain at which nodes are to stand: its features, and between them as many as the size asks for.
    pub(super) fn nodes(&self, chain: &Chain, number: usize) -> Vec<f64> {
        let sizes = &self.of_chain[number];
        let n = chain.points.len();
        // 1. The number of nodes up to each point.
        let mut counts = vec![0.0];
        for i in 1..chain.lengths.len() {
            let size = 0.5 * (sizes[i - 1] + sizes[i % n]);
            counts.push(counts[i - 1] + (chain.lengths[i] - chain.lengths[i - 1]) / size);
        }
        let total = counts.last().copied().unwrap_or(0.0);
        let length_at = |count: f64| {
            let i = counts.partition_point(|&c| c <= count).clamp(1, counts.len() - 1);
            let t = if counts[i] > counts[i - 1] {
                (count - counts[i - 1]) / (counts[i] - counts[i - 1])
            } else {
                0.0
            };
            chain.lengths[i - 1] + t.clamp(0.0, 1.0) * (chain.lengths[i] - chain.lengths[i - 1])
        };
        // 2. Stretches between features, each in equal parts.
        let mut ends: Vec<f64> = chain.features.iter().map(|&i| counts[i]).collect();
        if ends.is_empty() {
            ends.push(0.0);
        }
        if chain.closed {
            ends.push(ends[0] + total);
        }
        let mut nodes = Vec::new();
        for pair in ends.windows(2) {
            let whole = chain.closed && ends.len() == 2;
            let least = if whole {
                LEAST_NODES
            } else if chain.closed && ends.len() == 3 {
                2.0
            } else {
                1.0
            };
            let parts = (pair[1] - pair[0]).round().max(least) as usize;
            for k in 0..parts {
                let count = pair[0] + (pair[1] - pair[0]) * k as f64 / parts as f64;
                nodes.push(length_at(if count >= total { count - total } else { count }));
            }
        }
        if !chain.closed {
            nodes.push(chain.length());
        }
        nodes
    }
}

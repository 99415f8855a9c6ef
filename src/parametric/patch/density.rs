//! Where a patch needs nodes: an estimate from samples, to start refinement from a good place. It decides nothing: the
//! deviation of every triangle is bounded afterwards.

use std::ops::Range;

use glam::DVec3;

use super::deviation::Deviation;

/// Intervals of the sampling grid along each direction.
const STEPS: usize = 32;

/// Side of the lattice's triangles in units of edges. Equilateral triangles of side 1.22 just meet the tolerance where
/// the estimate is right; these are coarser, so that a halving, where it is needed, lands well inside.
const LATTICE_SIDE: f64 = 1.8 * 1.224_744_871_391_589;

/// A block is cut into quarters if that saves this part of its nodes.
const WORTHWHILE_SAVING: f64 = 0.1;

/// Sampled need for nodes over the unit square of a patch's parameters.
#[derive(Clone, Debug)]
pub(crate) struct Density {
    /// For each direction `k` and sampling interval `[k][i][j]`: how many edges along it the interval is worth.
    worth: [Vec<[f64; STEPS]>; 2],
    /// Mean lengths of the patch's lines along u and v.
    lengths: [f64; 2],
    /// Edges along u and v, where most are needed.
    edges: [f64; 2],
}

/// Sampled points, row by row along u.
struct PatchSamples(Vec<DVec3>);

impl PatchSamples {
    fn new(patch: &Deviation) -> Self {
        let at = |i: usize| i as f64 / STEPS as f64;
        let grid = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| [at(i), at(j)]));
        Self(grid.map(|at| DVec3::from(patch.point(at))).collect())
    }

    fn at(&self, i: usize, j: usize) -> DVec3 {
        self.0[i * (STEPS + 1) + j]
    }
}

impl Density {
    pub(crate) fn new(patch: &Deviation, tolerance: f64) -> Self {
        let samples = PatchSamples::new(patch);
        let mut worth = [vec![[0.0; STEPS]; STEPS], vec![[0.0; STEPS]; STEPS]];
        let mut lengths = [0.0; 2];
        for i in 0..STEPS {
            for j in 0..STEPS {
                let need = add_twist(edges_for_bending(&samples, i, j, tolerance), &samples, i, j, tolerance);
                for k in 0..2 {
                    worth[k][i][j] = need[k];
                }
                lengths[0] += samples.at(i, j).distance(samples.at(i + 1, j)) / STEPS as f64;
                lengths[1] += samples.at(i, j).distance(samples.at(i, j + 1)) / STEPS as f64;
            }
        }
        let mut density = Self { worth, lengths, edges: [0.0; 2] };
        density.edges = density.edges_of(&ParameterBlock::whole());
        density
    }

    /// Along direction `k` of a block, for every interval the most edges that any of its lines needs.
    fn profile(&self, block: &ParameterBlock, k: usize) -> Vec<f64> {
        let ParameterBlock([us, vs]) = block;
        let worth = |i: usize, j: usize| self.worth[k][i][j];
        if k == 0 {
            us.clone().map(|i| vs.clone().map(|j| worth(i, j)).fold(0.0, f64::max)).collect()
        } else {
            vs.clone().map(|j| us.clone().map(|i| worth(i, j)).fold(0.0, f64::max)).collect()
        }
    }

    fn edges_of(&self, block: &ParameterBlock) -> [f64; 2] {
        [0, 1].map(|k| self.profile(block, k).iter().sum())
    }

    /// Edges along `u` and along `v`, where most are needed.
    pub(crate) fn edges(&self) -> [f64; 2] {
        self.edges
    }

    /// Scales of the parameter plane in which one unit is about one edge. A direction that needs hardly any edges is
    /// stretched somewhat, so that the plane does not degenerate.
    pub(crate) fn metric(&self) -> [f64; 2] {
        let most = self.edges[0].max(self.edges[1]);
        if most < 1.0 {
            let longest = self.lengths[0].max(self.lengths[1]);
            return self.lengths.map(|length| if longest > 0.0 { (length / longest).max(1e-3) } else { 1.0 });
        }
        self.edges.map(|n| (n / most).max(0.02))
    }

    /// Inner nodes to start from, as parameters in the unit square: a triangular lattice in every block of a
    /// subdivision that follows the need.
    pub(crate) fn nodes(&self) -> Vec<[f64; 2]> {
        let mut nodes = Vec::new();
        self.fill(&ParameterBlock::whole(), &mut nodes);
        nodes
    }

    fn fill(&self, block: &ParameterBlock, nodes: &mut Vec<[f64; 2]>) {
        let count = |block: &ParameterBlock| self.lines(block).iter().product::<f64>();
        let saves = |quarters: &[ParameterBlock; 4]| {
            let whole = count(block);
            whole > 4.0 && quarters.iter().map(count).sum::<f64>() < (1.0 - WORTHWHILE_SAVING) * whole
        };
        if let Some(quarters) = block.quarters().filter(saves) {
            quarters.iter().for_each(|quarter| self.fill(quarter, nodes));
            return;
        }
        let columns = [-0.25, 0.25].map(|shift| self.places(block, 0, shift));
        for (row, &v) in self.places(block, 1, 0.0).iter().enumerate() {
            nodes.extend(columns[row % 2].iter().map(|&u| [u, v]));
        }
    }

    /// Lines of the lattice across u and across v.
    fn lines(&self, block: &ParameterBlock) -> [f64; 2] {
        let [n, m] = self.edges_of(block);
        let row_height = 0.75_f64.sqrt();
        [n / LATTICE_SIDE, m / (LATTICE_SIDE * row_height)]
    }

    /// Parameters of the lattice's lines across direction `k` of a block: one step away from the border of the patch,
    /// half a step from that of a neighbouring block; all moved by `shift` steps.
    fn places(&self, block: &ParameterBlock, k: usize, shift: f64) -> Vec<f64> {
        let range = &block.0[k];
        let margin = |on_border: bool| if on_border { 1.0 } else { 0.5 };
        let (first, last) = (margin(range.start == 0), margin(range.end == STEPS));
        let count = (self.lines(block)[k] + 1.0 - first - last).round().max(0.0);
        let steps = count - 1.0 + first + last;
        let profile = self.profile(block, k);
        let sum: f64 = profile.iter().sum();
        let mut places = Vec::new();
        let (mut interval, mut below) = (0, 0.0);
        for place in 0..count as usize {
            let target = sum * (place as f64 + first + shift) / steps;
            while interval + 1 < profile.len() && below + profile[interval] < target {
                below += profile[interval];
                interval += 1;
            }
            let width = profile[interval];
            let local = if width > 0.0 { ((target - below) / width).clamp(0.0, 1.0) } else { 0.5 };
            places.push(((range.start + interval) as f64 + local) / STEPS as f64);
        }
        places
    }
}

/// Edges that the interval `(i, j)` is worth along u and v for the bending of its lines: two steps are worth the root
/// of what they deviate in units of the tolerance's share, one step half of that; the mean of the four corners.
///
/// A triangle's deviation is the sum of what both directions give where they bend alike (each gets half the
/// tolerance), and the greater of the two where they bend against each other, as on a saddle.
fn edges_for_bending(samples: &PatchSamples, i: usize, j: usize, tolerance: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for [p, q] in [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]] {
        // Second differences at the border are those of the next inner sample.
        let (inner_p, inner_q) = (p.clamp(1, STEPS - 1), q.clamp(1, STEPS - 1));
        let along_u = [inner_p - 1, inner_p, inner_p + 1].map(|p| samples.at(p, q));
        let along_v = [inner_q - 1, inner_q, inner_q + 1].map(|q| samples.at(p, q));
        let bends = [along_u, along_v].map(bend_vector);
        let sizes = bends.map(DVec3::length);
        let product = sizes[0] * sizes[1];
        let cosine = if product > 0.0 { bends[0].dot(bends[1]) / product } else { -1.0 };
        let share = (2.0 + 2.0 * cosine).max(1.0).sqrt().recip();
        for k in 0..2 {
            sums[k] += (sizes[k] / (share * tolerance)).sqrt() / 8.0;
        }
    }
    sums
}

/// The same with the twist: a cell that is straight along both directions deviates by a quarter of its mixed second
/// difference. Where that asks for more cells than the bending does, the direction that needs fewer edges gets more.
fn add_twist([n, m]: [f64; 2], samples: &PatchSamples, i: usize, j: usize, tolerance: f64) -> [f64; 2] {
    let [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| samples.at(i, j));
    let mixed = (a - b) + (c - d);
    // Only the twist out of the surface counts; within it, lines merely spread.
    let normal = (c - a).cross(d - b);
    let length = normal.length();
    let cells = if length > 0.0 { mixed.dot(normal).abs() / length / (2.0 * tolerance) } else { 0.0 };
    if cells <= n * m {
        return [n, m];
    }
    let lengths = [a.distance(b), a.distance(d)];
    let ratio = (lengths[0] / lengths[1].max(1e-300)).clamp(0.03, 30.0);
    if n * n > cells * ratio {
        [n, cells / n]
    } else if m * m > cells / ratio {
        [cells / m, m]
    } else {
        [(cells * ratio).sqrt(), (cells / ratio).sqrt()]
    }
}

/// How far the middle point is from the segment between the others, as a vector.
fn bend_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    let edge = c - a;
    let square = edge.length_squared();
    let along = if square > 0.0 { (b - a).dot(edge) / square } else { 0.0 };
    b - (a + edge * along.clamp(0.0, 1.0))
}

/// A rectangle of sampling intervals.
#[derive(Clone, Debug)]
struct ParameterBlock([Range<usize>; 2]);

impl ParameterBlock {
    fn whole() -> Self {
        Self([0..STEPS, 0..STEPS])
    }

    /// The four quarters of a block that is not too small.
    fn quarters(&self) -> Option<[Self; 4]> {
        let [us, vs] = &self.0;
        if us.len() <= 4 {
            return None;
        }
        let (u, v) = (us.start + us.len() / 2, vs.start + vs.len() / 2);
        Some([
            Self([us.start..u, vs.start..v]),
            Self([u..us.end, vs.start..v]),
            Self([us.start..u, v..vs.end]),
            Self([u..us.end, v..vs.end]),
        ])
    }
}

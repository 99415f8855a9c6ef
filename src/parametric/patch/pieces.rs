//! Patches taken apart: into parts without creases, and into Bezier pieces.

use super::surface::Patch;
use crate::parametric::curve::nurbs::insert_knot;
use crate::parametric::numeric::domain::interval;
use crate::parametric::numeric::knots;
use crate::parametric::numeric::vector::{self, Point};

type Homogeneous = (Point<3>, f64);

impl Patch {
    fn homogeneous_rows(&self) -> Vec<Vec<Homogeneous>> {
        let weight = |i: usize| self.weights.as_ref().map_or(1.0, |weights| weights[i]);
        let all: Vec<Homogeneous> = (0..self.points.len())
            .map(|i| {
                if weight(i) == 1.0 {
                    (self.points[i], 1.0)
                } else {
                    (vector::scale(self.points[i], weight(i)), weight(i))
                }
            })
            .collect();
        all.chunks(self.counts[1]).map(<[_]>::to_vec).collect()
    }

    /// Rows of homogeneous control points and knots, with every knot of `repeat` as often as the degree.
    fn with_full_knots(&self, repeat: [&[f64]; 2]) -> (Vec<Vec<Homogeneous>>, [Vec<f64>; 2]) {
        let mut rows = self.homogeneous_rows();
        let mut knots = self.knots.clone();
        for along in [1, 0] {
            let p = self.degrees[along];
            // Along u the columns are refined: transposed rows.
            let mut lines = if along == 0 { transposed(&rows) } else { rows };
            for &knot in repeat[along] {
                while knots::multiplicity(&knots[along], knot) < p {
                    let mut finer = Vec::new();
                    for line in &mut lines {
                        (finer, *line) = insert_knot(p, &knots[along], line, knot);
                    }
                    knots[along] = finer;
                }
            }
            rows = if along == 0 { transposed(&lines) } else { lines };
        }
        (rows, knots)
    }

    /// The patch cut along its creases (inner knots repeated as often as the degree), each part clamped. Parts carry
    /// the parameters of the whole.
    pub(crate) fn smooth_parts(&self) -> Vec<Self> {
        let domain = self.domain();
        let cuts = [0, 1].map(|k| {
            let mut cuts = vec![domain[k][0]];
            cuts.extend(knots::corners(self.degrees[k], &self.knots[k]));
            cuts.push(domain[k][1]);
            cuts
        });
        let (rows, knots) = self.with_full_knots([&cuts[0], &cuts[1]]);
        let mut parts = Vec::new();
        for us in cuts[0].windows(2) {
            for vs in cuts[1].windows(2) {
                let range =
                    |k: usize, ends: &[f64]| extract_part(self.degrees[k], &knots[k], ends[0], ends[1]);
                let ((u_range, u_knots), (v_range, v_knots)) = (range(0, us), range(1, vs));
                let control: Vec<Homogeneous> =
                    rows[u_range.clone()].iter().flat_map(|row| row[v_range.clone()].to_vec()).collect();
                let rational = self.weights.is_some();
                parts.push(Self {
                    degrees: self.degrees,
                    knots: [u_knots, v_knots],
                    counts: [u_range.len(), v_range.len()],
                    points: control
                        .iter()
                        .map(|(p, w)| if *w == 1.0 { *p } else { p.map(|x| x / w) })
                        .collect(),
                    weights: rational.then(|| control.iter().map(|h| h.1).collect()),
                });
            }
        }
        parts
    }

    /// The Bezier pieces between all knots.
    pub(crate) fn pieces(&self) -> PatchPieces {
        let breaks = [0, 1].map(|k| knots::distinct(self.degrees[k], &self.knots[k]));
        let (rows, knots) = self.with_full_knots([&breaks[0], &breaks[1]]);
        let mut nets = Vec::new();
        for us in breaks[0].windows(2) {
            for vs in breaks[1].windows(2) {
                let (u_range, _) = extract_part(self.degrees[0], &knots[0], us[0], us[1]);
                let (v_range, _) = extract_part(self.degrees[1], &knots[1], vs[0], vs[1]);
                let control = rows[u_range].iter().flat_map(|row| row[v_range.clone()].to_vec());
                nets.push(control.map(|(p, w)| [p[0], p[1], p[2], w]).collect());
            }
        }
        let domain = self.domain();
        let unit = [0, 1].map(|k| {
            let [start, end] = domain[k];
            breaks[k].iter().map(|t| (t - start) / (end - start)).collect()
        });
        PatchPieces { degrees: self.degrees, breaks: unit, nets }
    }
}

fn transposed(rows: &[Vec<Homogeneous>]) -> Vec<Vec<Homogeneous>> {
    (0..rows[0].len()).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
}

/// Indices of the control points and the clamped knots of the part between two full knots.
fn extract_part(p: usize, knots: &[f64], start: f64, end: f64) -> (std::ops::Range<usize>, Vec<f64>) {
    let last_of_start = knots.partition_point(|&k| k <= start) - 1;
    let first_of_end = knots.partition_point(|&k| k < end);
    let mut part = vec![start; p + 1];
    part.extend_from_slice(&knots[last_of_start + 1..first_of_end]);
    part.extend(vec![end; p + 1]);
    (last_of_start - p..first_of_end, part)
}

/// The Bezier pieces of a patch, over the unit square.
#[derive(Clone, Debug)]
pub(crate) struct PatchPieces {
    pub(crate) degrees: [usize; 2],
    /// Ascending parameters from 0 to 1 between the pieces, along u and v.
    pub(crate) breaks: [Vec<f64>; 2],
    /// Control points times weights, and weights, row by row; the pieces in rows along u.
    nets: Vec<Vec<[f64; 4]>>,
}

impl PatchPieces {
    /// Number of the interval of `breaks[k]` that holds `t`.
    pub(crate) fn interval(&self, k: usize, t: f64) -> usize {
        interval(&self.breaks[k], t)
    }

    /// Control net of the piece in the given intervals, and the map of its parameters: `(t - start) * scale`.
    pub(crate) fn piece(&self, [i, j]: [usize; 2]) -> (&[[f64; 4]], [[f64; 2]; 2]) {
        let net = &self.nets[i * (self.breaks[1].len() - 1) + j];
        let map = [(0, i), (1, j)].map(|(k, i)| {
            let [start, end] = [self.breaks[k][i], self.breaks[k][i + 1]];
            [start, 1.0 / (end - start)]
        });
        (net, map)
    }

    /// The point at `(s, t)` of the unit square.
    pub(crate) fn point(&self, [s, t]: [f64; 2]) -> Point<3> {
        let (net, [[s0, ds], [t0, dt]]) = self.piece([self.interval(0, s), self.interval(1, t)]);
        let (bu, bv) = (
            bernstein_basis(self.degrees[0], (s - s0) * ds),
            bernstein_basis(self.degrees[1], (t - t0) * dt),
        );
        let mut sum = [0.0; 4];
        for (row, bu) in net.chunks(self.degrees[1] + 1).zip(&bu) {
            for (point, bv) in row.iter().zip(&bv) {
                sum = vector::add_scaled(sum, *point, bu * bv);
            }
        }
        [sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3]]
    }
}

/// The Bernstein polynomials of one degree at `t`.
fn bernstein_basis(degree: usize, t: f64) -> smallvec::SmallVec<[f64; 12]> {
    let mut basis = smallvec::smallvec![0.0; degree + 1];
    basis[0] = 1.0;
    for level in 1..=degree {
        let mut saved = 0.0;
        for b in basis.iter_mut().take(level) {
            let value = *b;
            *b = saved + (1.0 - t) * value;
            saved = t * value;
        }
        basis[level] = saved;
    }
    basis
}

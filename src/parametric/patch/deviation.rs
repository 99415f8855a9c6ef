//! How far a patch leaves a flat triangle: decided by hulls, not by samples.
//!
//! Over a triangle of its parameter domain a Bezier piece of degrees p, q is a triangular Bezier patch of degree
//! p + q, and lies in the convex hull of that patch's control points. The distance to a flat triangle is a convex
//! function, so its greatest value over the hull is taken in a control point. Control points come from the blossom of
//! the tensor product: the blossom takes each corner as often as the control point's index says, in every split
//! between u and v arguments, and averages (Goldman and Filip 1987; Lasser 2002).

use smallvec::SmallVec;

use super::flat_triangle::FlatTriangle;
use super::pieces::PatchPieces;
use crate::parametric::numeric::bernstein::binomial;
use crate::parametric::numeric::vector::{self, Point};

/// A triangle of the parameter domain.
pub(crate) type ParameterTriangle = [[f64; 2]; 3];

/// Halvings before an undecided triangle counts as too far. Each brings the hulls four times closer to the patch; a
/// triangle wrongly divided costs a node, one more level four hulls for every undecided triangle.
const DECISION_DEPTH: u32 = 3;

/// Decides about triangles of one patch.
#[derive(Clone, Debug)]
pub(crate) struct Deviation {
    pieces: PatchPieces,
    /// Exponent triples of the blossoms along u and along v.
    splits: [Vec<[usize; 3]>; 2],
    /// For every pair of them the index of the control point it adds to, and its share.
    shares: Vec<(usize, f64)>,
    control_points: usize,
}

impl Deviation {
    pub(crate) fn new(pieces: PatchPieces) -> Self {
        let [p, q] = pieces.degrees;
        let splits = [exponent_triples(p), exponent_triples(q)];
        let total = p + q;
        let targets = exponent_triples(total);
        let multinomial = |n: usize, t: &[usize; 3]| binomial(n, t[0]) * binomial(n - t[0], t[1]);
        let mut shares = Vec::new();
        for a in &splits[0] {
            for c in &splits[1] {
                let sum = [a[0] + c[0], a[1] + c[1], a[2] + c[2]];
                let index = targets.iter().position(|t| *t == sum).unwrap_or(0);
                shares.push((index, multinomial(p, a) * multinomial(q, c) / multinomial(total, &sum)));
            }
        }
        Self { pieces, splits, shares, control_points: targets.len() }
    }

    /// The point at parameters of the unit square.
    pub(crate) fn point(&self, at: [f64; 2]) -> Point<3> {
        self.pieces.point(at)
    }

    /// Whether the patch over the parameter triangle may leave `flat` by more than `tolerance`.
    pub(crate) fn exceeds(
        &self,
        parameters: &ParameterTriangle,
        flat: &FlatTriangle,
        tolerance: f64,
    ) -> bool {
        self.exceeds_across_knots(parameters, flat, tolerance, DECISION_DEPTH)
    }

    /// Cuts the parameter triangle along the first knot line that runs through it, until its parts lie in one piece.
    fn exceeds_across_knots(
        &self,
        parameters: &ParameterTriangle,
        flat: &FlatTriangle,
        tolerance: f64,
        depth: u32,
    ) -> bool {
        let mut cell = [0; 2];
        for k in 0..2 {
            let low = parameters.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
            let high = parameters.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
            cell[k] = self.pieces.interval(k, low);
            let line = self.pieces.breaks[k][cell[k] + 1];
            if line < high && low < high {
                return cut_triangle(parameters, k, line)
                    .iter()
                    .any(|part| self.exceeds_across_knots(part, flat, tolerance, depth));
            }
        }
        self.piece_exceeds(cell, parameters, flat, tolerance, depth)
    }

    fn piece_exceeds(
        &self,
        cell: [usize; 2],
        parameters: &ParameterTriangle,
        flat: &FlatTriangle,
        tolerance: f64,
        depth: u32,
    ) -> bool {
        let control = self.control_points(cell, parameters);
        if control.iter().all(|p| flat.distance(*p) <= tolerance) {
            return false;
        }
        // Control points at the corners are on the patch.
        let last = control.len() - 1;
        let first_of_last_row = last - (self.pieces.degrees[0] + self.pieces.degrees[1]);
        let corners = [0, first_of_last_row, last];
        if depth == 0 || corners.iter().any(|&i| flat.distance(control[i]) > tolerance) {
            return true;
        }
        let [a, b, c] = *parameters;
        let middle = |x: [f64; 2], y: [f64; 2]| [0.5 * (x[0] + y[0]), 0.5 * (x[1] + y[1])];
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            .iter()
            .any(|part| self.piece_exceeds(cell, part, flat, tolerance, depth - 1))
    }

    /// Control points of the triangular patch over `parameters`, which lie in one cell.
    fn control_points(&self, cell: [usize; 2], parameters: &ParameterTriangle) -> SmallVec<[Point<3>; 32]> {
        let (net, map) = self.pieces.piece(cell);
        let columns = self.pieces.degrees[1] + 1;
        let local = |k: usize| parameters.map(|p| ((p[k] - map[k][0]) * map[k][1]).clamp(0.0, 1.0));
        let (blossoms_u, blossoms_v) =
            (blossom_weights(&self.splits[0], local(0)), blossom_weights(&self.splits[1], local(1)));
        let mut sums: SmallVec<[[f64; 4]; 32]> = smallvec::smallvec![[0.0; 4]; self.control_points];
        let mut share = self.shares.iter();
        for bu in &blossoms_u {
            let mut row: SmallVec<[[f64; 4]; 12]> = smallvec::smallvec![[0.0; 4]; columns];
            for (points, weight) in net.chunks(columns).zip(bu) {
                for (sum, point) in row.iter_mut().zip(points) {
                    *sum = vector::add_scaled(*sum, *point, *weight);
                }
            }
            for bv in &blossoms_v {
                let value = row.iter().zip(bv).fold([0.0; 4], |sum, (p, w)| vector::add_scaled(sum, *p, *w));
                if let Some(&(index, share)) = share.next() {
                    sums[index] = vector::add_scaled(sums[index], value, share);
                }
            }
        }
        sums.iter().map(|h| [h[0] / h[3], h[1] / h[3], h[2] / h[3]]).collect()
    }
}

/// All `[i, j, k]` with `i + j + k = n`, `i` falling, then `j` falling: the corners come first, at the start of the
/// last row, and last.
fn exponent_triples(n: usize) -> Vec<[usize; 3]> {
    (0..=n).rev().flat_map(|i| (0..=n - i).rev().map(move |j| [i, j, n - i - j])).collect()
}

/// For every triple, the weights of the Bernstein coefficients in the blossom that takes each of the three arguments as
/// often as its exponent says.
fn blossom_weights(splits: &[[usize; 3]], arguments: [f64; 3]) -> Vec<SmallVec<[f64; 12]>> {
    splits
        .iter()
        .map(|split| {
            let mut weights: SmallVec<[f64; 12]> = smallvec::smallvec![1.0];
            for (argument, times) in arguments.iter().zip(split) {
                for _ in 0..*times {
                    weights.push(0.0);
                    for m in (0..weights.len()).rev() {
                        let below = if m > 0 { weights[m - 1] * argument } else { 0.0 };
                        weights[m] = weights[m] * (1.0 - argument) + below;
                    }
                }
            }
            weights
        })
        .collect()
}

/// The parts of a parameter triangle on both sides of the line where coordinate `k` is `at`.
fn cut_triangle(parameters: &ParameterTriangle, k: usize, at: f64) -> SmallVec<[ParameterTriangle; 4]> {
    let mut parts = SmallVec::new();
    for sign in [1.0, -1.0] {
        let mut polygon: SmallVec<[[f64; 2]; 4]> = SmallVec::new();
        for i in 0..3 {
            let (p, q) = (parameters[i], parameters[(i + 1) % 3]);
            let (side_p, side_q) = (sign * (p[k] - at), sign * (q[k] - at));
            if side_p >= 0.0 {
                polygon.push(p);
            }
            if side_p * side_q < 0.0 {
                let mut crossing = vector::lerp(p, q, side_p / (side_p - side_q));
                crossing[k] = at;
                polygon.push(crossing);
            }
        }
        for i in 2..polygon.len() {
            parts.push([polygon[0], polygon[i - 1], polygon[i]]);
        }
    }
    parts
}

//! Rewriting NURBS curves: higher degree, finer knots, several with one basis, several end to end.

use super::nurbs::{BezierPiece, NurbsCurve};
use super::param_curve::SharedCurve;
use crate::parametric::numeric::bernstein;
use crate::parametric::numeric::knots;
use crate::parametric::numeric::vector::{self, Point};

/// Control points of one Bezier piece, raised to `degree`.
fn raised<const D: usize>(piece: &BezierPiece<D>, degree: usize) -> (Vec<Point<D>>, Option<Vec<f64>>) {
    let mut points = piece.points.clone();
    let mut weights = piece.weights.clone();
    while points.len() <= degree {
        points = bernstein::elevate(&points);
        weights = weights.map(|w| bernstein::elevate(&w));
    }
    (points, weights.map(|w| w.iter().map(|w| w[0]).collect()))
}

/// A curve of Bezier pieces end to end (their breaks given), as one NURBS curve with full knots between them.
fn from_pieces<const D: usize>(
    breaks: &[f64],
    pieces: &[(Vec<Point<D>>, Option<Vec<f64>>)],
) -> NurbsCurve<D> {
    let degree = pieces[0].0.len() - 1;
    let rational = pieces.iter().any(|piece| piece.1.is_some());
    let mut knots = vec![breaks[0]];
    for &knot in breaks {
        knots.extend(vec![knot; degree]);
    }
    knots.push(breaks[breaks.len() - 1]);
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    // Pieces are scaled so that the weights agree where they meet.
    let mut factor = 1.0;
    for (index, (homogeneous, piece_weights)) in pieces.iter().enumerate() {
        let weight = |j: usize| piece_weights.as_ref().map_or(1.0, |w| w[j]);
        if index > 0 {
            factor = weights[weights.len() - 1] / weight(0);
        }
        for j in usize::from(index > 0)..=degree {
            points.push(vector::scale(homogeneous[j], 1.0 / weight(j)));
            weights.push(weight(j) * factor);
        }
    }
    NurbsCurve::trusted(degree, knots, points, rational.then_some(weights))
}

/// Segments end to end, segment `i` over `starts[i]..starts[i + 1]`.
pub(crate) fn concatenate<const D: usize>(segments: &[SharedCurve<D>], starts: &[f64]) -> NurbsCurve<D> {
    let curves: Vec<NurbsCurve<D>> = segments.iter().map(|s| s.to_nurbs()).collect();
    let degree = curves.iter().map(NurbsCurve::degree).max().unwrap_or(1);
    let mut breaks = vec![starts[0]];
    let mut pieces = Vec::new();
    for (i, curve) in curves.iter().enumerate() {
        let [start, end] = curve.domain();
        for piece in curve.pieces() {
            pieces.push(raised(piece, degree));
            let local = (piece.domain[1] - start) / (end - start);
            breaks.push(vector::mix(starts[i], starts[i + 1], local));
        }
    }
    from_pieces(&breaks, &pieces)
}

/// The same curve with the degree raised to `degree`; inner knots become full.
pub(crate) fn elevated<const D: usize>(curve: &NurbsCurve<D>, degree: usize) -> NurbsCurve<D> {
    if degree <= curve.degree() {
        return curve.clone();
    }
    let pieces: Vec<_> = curve.pieces().iter().map(|piece| raised(piece, degree)).collect();
    from_pieces(&knots::distinct(curve.degree(), curve.knots()), &pieces)
}

/// The same curve over 0..1, clamped: its ends are its first and last control point.
pub(crate) fn rescaled_to_unit<const D: usize>(curve: &NurbsCurve<D>) -> NurbsCurve<D> {
    let [start, end] = curve.domain();
    let p = curve.degree();
    let unit = |knot: f64| ((knot - start) / (end - start)).clamp(0.0, 1.0);
    let clamped = [start, end].iter().all(|&end| knots::multiplicity(curve.knots(), end) > p);
    if clamped {
        let knots = curve.knots().iter().map(|&k| unit(k)).collect();
        return NurbsCurve::trusted(p, knots, curve.control().to_vec(), curve.weights().map(<[f64]>::to_vec));
    }
    let pieces: Vec<_> = curve.pieces().iter().map(|piece| raised(piece, p)).collect();
    let breaks: Vec<f64> = knots::distinct(p, curve.knots()).into_iter().map(unit).collect();
    from_pieces(&breaks, &pieces)
}

/// Both curves over 0..1 with one degree, one knot vector and, if one is rational, weights for both.
pub(crate) fn compatible<const D: usize>(a: &NurbsCurve<D>, b: &NurbsCurve<D>) -> [NurbsCurve<D>; 2] {
    let degree = a.degree().max(b.degree());
    let [mut a, mut b] = [a, b].map(|curve| elevated(&rescaled_to_unit(curve), degree));
    add_knots(&mut a, b.knots());
    add_knots(&mut b, a.knots());
    if a.weights().is_some() != b.weights().is_some() {
        [a, b] = [a, b].map(|curve| {
            let weights = curve.weights().map_or_else(|| vec![1.0; curve.control().len()], <[f64]>::to_vec);
            NurbsCurve::trusted(degree, curve.knots().to_vec(), curve.control().to_vec(), Some(weights))
        });
    }
    [a, b]
}

/// Inserts the knots of `others` that `curve` has less often.
fn add_knots<const D: usize>(curve: &mut NurbsCurve<D>, others: &[f64]) {
    let mut wanted = others.to_vec();
    wanted.dedup();
    for knot in wanted {
        for _ in knots::multiplicity(curve.knots(), knot)..knots::multiplicity(others, knot) {
            // Refused only at the ends, where both are clamped already.
            if let Ok(finer) = curve.with_knot(knot) {
                *curve = finer;
            }
        }
    }
}

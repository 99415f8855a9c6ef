//! B-spline and NURBS curves (Piegl and Tiller, "The NURBS Book").

use crate::parametric::error::{GeometryError, Result, check_points};
use crate::parametric::numeric::bernstein::{self, binomial};
use crate::parametric::numeric::domain::clamped;
use crate::parametric::numeric::knots;
use crate::parametric::numeric::vector::{self, Point};

/// A B-spline curve, or a rational one with positive weights.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve<const D: usize> {
    degree: usize,
    knots: Vec<f64>,
    points: Vec<Point<D>>,
    weights: Option<Vec<f64>>,
    /// The analytic pieces, in homogeneous form, for bounds.
    pieces: Vec<BezierPiece<D>>,
}

/// One Bezier piece: control points and, if rational, weights.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BezierPiece<const D: usize> {
    pub(crate) domain: [f64; 2],
    /// Control points, multiplied by their weights if there are any.
    pub(crate) points: Vec<Point<D>>,
    pub(crate) weights: Option<Vec<[f64; 1]>>,
}

impl<const D: usize> NurbsCurve<D> {
    /// A B-spline of the given degree. The domain is from knot number `degree` to the one `degree` before the
    /// last; knots at the ends need not be repeated.
    ///
    /// # Errors
    /// [`GeometryError::TooFewPoints`], [`GeometryError::CountMismatch`] (knots must number points + degree + 1),
    /// [`GeometryError::BadKnots`], [`GeometryError::NotFinite`].
    pub fn bspline(degree: usize, knots: &[f64], points: &[[f64; D]]) -> Result<Self> {
        check_points("B-spline", points)?;
        knots::check(degree, knots, points.len())?;
        Ok(Self::trusted(degree, knots.to_vec(), points.to_vec(), None))
    }

    /// A rational B-spline with one positive weight per control point.
    ///
    /// # Errors
    /// As [`bspline`](Self::bspline); [`GeometryError::BadWeight`].
    pub fn nurbs(degree: usize, knots: &[f64], points: &[[f64; D]], weights: &[f64]) -> Result<Self> {
        check_weights(weights, points.len())?;
        let spline = Self::bspline(degree, knots, points)?;
        let weights = weights.to_vec();
        Ok(Self::trusted(degree, spline.knots, spline.points, Some(weights)))
    }

    /// A B-spline over 0..1 with equal inner knot steps that starts and ends in its first and last control point.
    ///
    /// # Errors
    /// As [`bspline`](Self::bspline).
    pub fn clamped_uniform(degree: usize, points: &[[f64; D]]) -> Result<Self> {
        if points.len() <= degree {
            let (needed, found) = (degree + 1, points.len());
            return Err(GeometryError::TooFewPoints { what: "B-spline", needed, found });
        }
        let inner = points.len() - degree;
        let mut knots = vec![0.0; degree];
        knots.extend((0..=inner).map(|i| i as f64 / inner as f64));
        knots.extend(vec![1.0; degree]);
        Self::bspline(degree, &knots, points)
    }

    /// From data known to be sound.
    pub(crate) fn trusted(
        degree: usize,
        knots: Vec<f64>,
        points: Vec<Point<D>>,
        weights: Option<Vec<f64>>,
    ) -> Self {
        let mut curve = Self { degree, knots, points, weights, pieces: Vec::new() };
        curve.pieces = curve.decompose();
        curve
    }

    /// The degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The knots.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The control points.
    #[must_use]
    pub fn control(&self) -> &[[f64; D]] {
        &self.points
    }

    /// The weights; `None` if the curve is not rational.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    pub(crate) fn pieces(&self) -> &[BezierPiece<D>] {
        &self.pieces
    }

    fn weight(&self, i: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[i])
    }

    /// The curve traversed the other way, over the same domain.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let [start, end] = self.domain();
        let knots = self.knots.iter().rev().map(|&k| start + (end - k)).collect();
        let points = self.points.iter().rev().copied().collect();
        let weights = self.weights.as_ref().map(|weights| weights.iter().rev().copied().collect());
        Self::trusted(self.degree, knots, points, weights)
    }

    /// The same curve with `knot` inserted once more (Boehm 1980).
    ///
    /// # Errors
    /// [`GeometryError::BadKnots`] if the knot lies outside the domain or is already repeated as often as the
    /// degree allows.
    pub fn with_knot(&self, knot: f64) -> Result<Self> {
        let [start, end] = self.domain();
        let place = self.knots.partition_point(|&k| k < knot);
        if knots::multiplicity(&self.knots, knot) >= self.degree || !(start < knot && knot < end) {
            let reason = format!("{knot} cannot be inserted: outside the domain, or there already");
            return Err(GeometryError::BadKnots { index: place, reason });
        }
        let (knots, homogeneous) = insert_knot(self.degree, &self.knots, &self.homogeneous(), knot);
        let (points, weights) = self.projected(&homogeneous);
        Ok(Self::trusted(self.degree, knots, points, weights))
    }

    /// Control points times weights, with the weights.
    fn homogeneous(&self) -> Vec<(Point<D>, f64)> {
        (0..self.points.len())
            .map(|i| (vector::scale(self.points[i], self.weight(i)), self.weight(i)))
            .collect()
    }

    fn projected(&self, homogeneous: &[(Point<D>, f64)]) -> (Vec<Point<D>>, Option<Vec<f64>>) {
        if self.weights.is_none() {
            return (homogeneous.iter().map(|h| h.0).collect(), None);
        }
        let points = homogeneous.iter().map(|(p, w)| vector::scale(*p, 1.0 / w)).collect();
        (points, Some(homogeneous.iter().map(|h| h.1).collect()))
    }

    /// The analytic pieces: every knot of the domain inserted until it is repeated `degree` times.
    fn decompose(&self) -> Vec<BezierPiece<D>> {
        let p = self.degree;
        let breaks = knots::distinct(p, &self.knots);
        let (mut knots, mut control) = (self.knots.clone(), self.homogeneous());
        for &knot in &breaks {
            while knots::multiplicity(&knots, knot) < p {
                (knots, control) = insert_knot(p, &knots, &control, knot);
            }
        }
        breaks
            .windows(2)
            .map(|ends| {
                // With the start repeated `p` times, the piece's points follow the last of these knots.
                let last = knots.partition_point(|&k| k <= ends[0]) - 1;
                let part = &control[last - p..=last];
                let weights = self.weights.as_ref().map(|_| part.iter().map(|h| [h.1]).collect());
                BezierPiece {
                    domain: [ends[0], ends[1]],
                    points: part.iter().map(|h| h.0).collect(),
                    weights,
                }
            })
            .collect()
    }
}

/// One knot inserted into homogeneous control points.
pub(crate) fn insert_knot<const D: usize>(
    p: usize,
    knots: &[f64],
    control: &[(Point<D>, f64)],
    knot: f64,
) -> (Vec<f64>, Vec<(Point<D>, f64)>) {
    let span = knots.partition_point(|&k| k <= knot) - 1;
    let mut result = Vec::with_capacity(control.len() + 1);
    for i in 0..=control.len() {
        if i + p <= span {
            result.push(control[i]);
        } else if i > span || i == control.len() {
            result.push(control[i - 1]);
        } else {
            let width = knots[i + p] - knots[i];
            let ratio = if width > 0.0 { ((knot - knots[i]) / width).clamp(0.0, 1.0) } else { 0.0 };
            let (a, b) = (control[i - 1], control[i]);
            result.push((vector::lerp(a.0, b.0, ratio), vector::mix(a.1, b.1, ratio)));
        }
    }
    let mut knots = knots.to_vec();
    knots.insert(span + 1, knot);
    (knots, result)
}

/// Refuses weights that are not positive and finite, or not as many as there are points.
pub(crate) fn check_weights(weights: &[f64], expected: usize) -> Result<()> {
    if weights.len() != expected {
        return Err(GeometryError::CountMismatch { what: "weights", expected, found: weights.len() });
    }
    match weights.iter().position(|&w| !(w > 0.0 && w.is_finite())) {
        Some(index) => Err(GeometryError::BadWeight { index, value: weights[index] }),
        None => Ok(()),
    }
}

/// Derivatives of `A / w` from those of `A` and `w` (Piegl and Tiller, equation 4.8).
pub(crate) fn quotient_derivatives<const D: usize>(numerator: &[Point<D>], weight: &[f64]) -> Vec<Point<D>> {
    let mut result: Vec<Point<D>> = Vec::with_capacity(numerator.len());
    for k in 0..numerator.len() {
        let mut value = numerator[k];
        for i in 1..=k {
            value = vector::add_scaled(value, result[k - i], -binomial(k, i) * weight[i]);
        }
        result.push(vector::scale(value, 1.0 / weight[0]));
    }
    result
}

/// Direction in which a curve with this control polygon starts.
pub(crate) fn start_direction<const D: usize>(polygon: &[Point<D>]) -> Point<D> {
    let next = polygon.iter().find(|p| **p != polygon[0]);
    next.map_or([0.0; D], |p| vector::sub(*p, polygon[0]))
}

/// Direction in which a curve with this control polygon ends.
pub(crate) fn end_direction<const D: usize>(polygon: &[Point<D>]) -> Point<D> {
    let end = polygon[polygon.len() - 1];
    let before = polygon.iter().rev().find(|p| **p != end);
    before.map_or([0.0; D], |p| vector::sub(end, *p))
}

impl<const D: usize> NurbsCurve<D> {
    /// First and last parameter.
    pub(crate) fn domain(&self) -> [f64; 2] {
        knots::domain(self.degree, &self.knots)
    }

    /// The point at a parameter, clamped to the domain.
    pub(crate) fn evaluate(&self, t: f64) -> Point<D> {
        let domain = self.domain();
        // The ends come from the pieces, so that clamped curves meet their control points and closed ones close.
        let t = clamped(t, domain);
        if t == domain[1] || t == domain[0] {
            let (piece, at) = if t == domain[0] {
                (&self.pieces[0], 0)
            } else {
                (&self.pieces[self.pieces.len() - 1], self.degree)
            };
            let weight = piece.weights.as_ref().map_or(1.0, |weights| weights[at][0]);
            return piece.points[at].map(|x| x / weight);
        }
        self.evaluate_derivatives(t, 0)[0]
    }

    /// The point and the derivatives up to `order` (Piegl and Tiller, sections 3.3 and 4.3).
    pub(crate) fn evaluate_derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        let t = clamped(t, self.domain());
        let span = knots::span(self.degree, &self.knots, t);
        let basis = knots::basis_derivatives(self.degree, &self.knots, span, t, order);
        let first = span - self.degree;
        let mut numerator = vec![[0.0; D]; order + 1];
        let mut denominator = vec![0.0; order + 1];
        for k in 0..=order {
            for (j, &value) in basis[k].iter().enumerate() {
                let weight = self.weight(first + j) * value;
                numerator[k] = vector::add_scaled(numerator[k], self.points[first + j], weight);
                denominator[k] += weight;
            }
        }
        if self.weights.is_none() { numerator } else { quotient_derivatives(&numerator, &denominator) }
    }

    /// Inner knots where the direction jumps.
    pub(crate) fn kinks(&self) -> Vec<f64> {
        let mut corners = knots::corners(self.degree, &self.knots);
        corners.retain(|&knot| {
            let after = self.pieces.partition_point(|piece| piece.domain[0] < knot);
            let [left, right] = [&self.pieces[after - 1], &self.pieces[after]].map(|piece| {
                let mut polygon = Vec::new();
                piece.restrict(piece.domain[0], piece.domain[1], &mut polygon);
                polygon
            });
            !vector::same_direction(end_direction(&left), start_direction(&right))
        });
        corners
    }

    /// Appends the control polygon of the part `a..b` of one piece.
    pub(crate) fn restrict(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        let middle = 0.5 * (a + b);
        let i = self.pieces.partition_point(|piece| piece.domain[0] <= middle).max(1) - 1;
        self.pieces[i].restrict(a, b, polygon);
    }
}

impl<const D: usize> BezierPiece<D> {
    /// Appends the control polygon of the part `a..b` of this piece.
    fn restrict(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        let [start, end] = self.domain;
        let local = |t: f64| ((t - start) / (end - start)).clamp(0.0, 1.0);
        let first = polygon.len();
        bernstein::restrict(&self.points, local(a), local(b), polygon);
        if let Some(weights) = &self.weights {
            let mut part = Vec::with_capacity(weights.len());
            bernstein::restrict(weights, local(a), local(b), &mut part);
            for (point, weight) in polygon[first..].iter_mut().zip(&part) {
                *point = point.map(|x| x / weight[0]);
            }
        }
    }
}

//! Cubic Hermite splines.

use super::parameters::Spacing;
use super::piecewise::{PiecewiseBezier, curve_of_pieces};
use crate::parametric::error::{GeometryError, Result, check_count, check_points};
use crate::parametric::numeric::vector::{self, Point};

/// How a Hermite spline finds its tangents (Al-Athamneh 2016). The printed rules are for unit parameter steps;
/// for other steps they are applied to the divided differences, which is the same when the steps are equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TangentRule {
    /// `(P_i+1 - P_i-1) / (t_i+1 - t_i-1)`.
    #[default]
    Central,
    /// `[s_i+1 D_i + s_i D_i+1] / (s_i + s_i+1)`: the nearer neighbour counts more.
    NearerNeighbour,
    /// `[s_i D_i + s_i+1 D_i+1] / (s_i + s_i+1)`: the farther neighbour counts more.
    FartherNeighbour,
}

/// A once continuously differentiable curve of cubic pieces through given points with given or found tangents.
#[derive(Clone, Debug, PartialEq)]
pub struct HermiteSpline<const D: usize> {
    spline: PiecewiseBezier<D>,
    tangents: Vec<Point<D>>,
}

impl<const D: usize> HermiteSpline<D> {
    /// The spline through `points` with the given `tangents` (first derivatives with respect to the parameter),
    /// one per point. A closed spline returns to its first point by itself.
    ///
    /// # Errors
    /// [`GeometryError::CountMismatch`], [`GeometryError::TooFewPoints`] (2; closed: 2),
    /// [`GeometryError::CoincidentPoints`], [`GeometryError::NotFinite`], and those of given parameters.
    pub fn with_tangents(
        points: &[[f64; D]],
        tangents: &[[f64; D]],
        spacing: &Spacing,
        closed: bool,
    ) -> Result<Self> {
        check_count("Hermite spline", points, 2)?;
        check_points("Hermite spline", tangents)?;
        if tangents.len() != points.len() {
            let (expected, found) = (points.len(), tangents.len());
            return Err(GeometryError::CountMismatch { what: "tangents", expected, found });
        }
        let parameters = spacing.parameters("Hermite spline", points, closed)?;
        Ok(Self::assemble(parameters, points.to_vec(), tangents.to_vec(), closed))
    }

    /// The spline through `points` with tangents by `rule`; at the ends of an open one
    /// `Q_0 = 2 (P_1 - P_0) - Q_1` and its mirror image.
    ///
    /// # Errors
    /// [`GeometryError::TooFewPoints`] (3 are needed), [`GeometryError::CoincidentPoints`],
    /// [`GeometryError::NotFinite`], and those of given parameters.
    pub fn through(points: &[[f64; D]], rule: TangentRule, spacing: &Spacing, closed: bool) -> Result<Self> {
        check_count("Hermite spline", points, 3)?;
        let parameters = spacing.parameters("Hermite spline", points, closed)?;
        let count = points.len();
        let steps = parameters.len() - 1;
        let chord = |i: usize| vector::sub(points[(i + 1) % count], points[i % count]);
        let step = |i: usize| parameters[i + 1] - parameters[i];
        let slope = |i: usize| vector::scale(chord(i), 1.0 / step(i));
        let tangent = |before: usize, after: usize| {
            let mean = |w0: f64, w1: f64| {
                vector::scale(
                    vector::add(vector::scale(slope(before), w0), vector::scale(slope(after), w1)),
                    1.0 / (w0 + w1),
                )
            };
            let (s0, s1) = (vector::norm(chord(before)), vector::norm(chord(after)));
            match rule {
                TangentRule::Central => mean(step(before), step(after)),
                TangentRule::NearerNeighbour => mean(s1, s0),
                TangentRule::FartherNeighbour => mean(s0, s1),
            }
        };
        let mut tangents = vec![[0.0; D]; count];
        for i in 0..count {
            if closed {
                tangents[i] = tangent((i + steps - 1) % steps, i);
            } else if i > 0 && i + 1 < count {
                tangents[i] = tangent(i - 1, i);
            }
        }
        if !closed {
            let end = |slope: Point<D>, inner: Point<D>| vector::sub(vector::scale(slope, 2.0), inner);
            tangents[0] = end(slope(0), tangents[1]);
            tangents[count - 1] = end(slope(count - 2), tangents[count - 2]);
        }
        Ok(Self::assemble(parameters, points.to_vec(), tangents, closed))
    }

    fn assemble(
        parameters: Vec<f64>,
        mut points: Vec<Point<D>>,
        mut tangents: Vec<Point<D>>,
        closed: bool,
    ) -> Self {
        if closed {
            points.push(points[0]);
            tangents.push(tangents[0]);
        }
        Self { spline: PiecewiseBezier::cubic(parameters, &points, &tangents), tangents }
    }

    /// The tangents at the points, with respect to the parameter; a closed spline repeats the first at the end.
    #[must_use]
    pub fn tangents(&self) -> &[[f64; D]] {
        &self.tangents
    }
}

curve_of_pieces!(HermiteSpline);

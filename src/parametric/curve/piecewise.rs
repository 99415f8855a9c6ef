//! Bezier pieces end to end: what the interpolating splines are made of.

use super::nurbs::NurbsCurve;
use crate::parametric::numeric::bernstein;
use crate::parametric::numeric::domain::{clamped, interval};
use crate::parametric::numeric::vector::{self, Point};

/// Bezier pieces end to end over ascending parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PiecewiseBezier<const D: usize> {
    pub(crate) parameters: Vec<f64>,
    /// Control points of each piece.
    pub(crate) pieces: Vec<Vec<Point<D>>>,
}

impl<const D: usize> PiecewiseBezier<D> {
    /// Cubic pieces from points and first derivatives with respect to the parameter.
    pub(crate) fn cubic(parameters: Vec<f64>, points: &[Point<D>], tangents: &[Point<D>]) -> Self {
        let pieces = (0..parameters.len() - 1)
            .map(|i| {
                let third = (parameters[i + 1] - parameters[i]) / 3.0;
                let (start, end) = (points[i], points[i + 1]);
                vec![
                    start,
                    vector::add_scaled(start, tangents[i], third),
                    vector::add_scaled(end, tangents[i + 1], -third),
                    end,
                ]
            })
            .collect();
        Self { parameters, pieces }
    }

    fn locate(&self, t: f64) -> (usize, f64, f64) {
        let t = clamped(t, self.domain());
        let i = interval(&self.parameters, t);
        let length = self.parameters[i + 1] - self.parameters[i];
        (i, (t - self.parameters[i]) / length, length)
    }

    pub(crate) fn domain(&self) -> [f64; 2] {
        [self.parameters[0], self.parameters[self.parameters.len() - 1]]
    }

    pub(crate) fn point(&self, t: f64) -> Point<D> {
        let (i, w, _) = self.locate(t);
        bernstein::point(&self.pieces[i], w)
    }

    pub(crate) fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        let (i, w, length) = self.locate(t);
        let mut derivatives = bernstein::derivatives(&self.pieces[i], w, order);
        for (k, derivative) in derivatives.iter_mut().enumerate().skip(1) {
            *derivative = vector::scale(*derivative, length.powi(-(k as i32)));
        }
        derivatives
    }

    pub(crate) fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        let (i, _, length) = self.locate(0.5 * (a + b));
        let local = |t: f64| ((t - self.parameters[i]) / length).clamp(0.0, 1.0);
        bernstein::restrict(&self.pieces[i], local(a), local(b), polygon);
    }

    /// The pieces as one B-spline with full knots between them.
    pub(crate) fn to_nurbs(&self) -> NurbsCurve<D> {
        let degree = self.pieces[0].len() - 1;
        let mut knots = vec![self.parameters[0]];
        for &parameter in &self.parameters {
            knots.extend(vec![parameter; degree]);
        }
        knots.push(self.domain()[1]);
        let mut points = vec![self.pieces[0][0]];
        for piece in &self.pieces {
            points.extend_from_slice(&piece[1..]);
        }
        NurbsCurve::trusted(degree, knots, points, None)
    }
}

/// Implements [`Curve`](super::Curve) for a spline whose field `spline` is a [`PiecewiseBezier`].
macro_rules! curve_of_pieces {
    ($spline:ident) => {
        impl<const D: usize> $crate::parametric::Curve<D> for $spline<D> {
            fn domain(&self) -> [f64; 2] {
                self.spline.domain()
            }

            fn point(&self, t: f64) -> [f64; D] {
                self.spline.point(t)
            }

            fn derivatives(&self, t: f64, order: usize) -> Vec<[f64; D]> {
                self.spline.derivatives(t, order)
            }

            fn breaks(&self) -> Vec<f64> {
                self.spline.parameters.clone()
            }

            fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<[f64; D]>) {
                self.spline.control_polygon(a, b, polygon);
            }

            fn to_nurbs(&self) -> $crate::parametric::NurbsCurve<D> {
                self.spline.to_nurbs()
            }
        }
    };
}
pub(crate) use curve_of_pieces;

//! Curves of straight edges.

use super::nurbs::NurbsCurve;
use super::param_curve::Curve;
use super::parameters::Spacing;
use crate::parametric::error::{Result, check_count};
use crate::parametric::numeric::domain::{clamped, interval};
use crate::parametric::numeric::vector::{self, Point};

/// Straight edges through given points (Al-Athamneh 2016). A closed polyline repeats its first point at the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline<const D: usize> {
    points: Vec<Point<D>>,
    parameters: Vec<f64>,
}

impl<const D: usize> Polyline<D> {
    /// The polyline through `points`; a closed one returns to the first point by itself.
    ///
    /// # Errors
    /// [`TooFewPoints`](crate::parametric::GeometryError::TooFewPoints) (2 are needed, 3 for a closed one),
    /// [`CoincidentPoints`](crate::parametric::GeometryError::CoincidentPoints) for equal neighbours,
    /// [`NotFinite`](crate::parametric::GeometryError::NotFinite), and those of given parameters.
    pub fn new(points: &[[f64; D]], spacing: &Spacing, closed: bool) -> Result<Self> {
        check_count("polyline", points, if closed { 3 } else { 2 })?;
        let parameters = spacing.parameters("polyline", points, closed)?;
        let mut points = points.to_vec();
        if closed {
            points.push(points[0]);
        }
        Ok(Self { points, parameters })
    }

    /// The points, in order; the first is repeated at the end if the polyline is closed.
    #[must_use]
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }
}

impl<const D: usize> Curve<D> for Polyline<D> {
    fn domain(&self) -> [f64; 2] {
        [self.parameters[0], self.parameters[self.parameters.len() - 1]]
    }

    fn point(&self, t: f64) -> Point<D> {
        let t = clamped(t, self.domain());
        let i = interval(&self.parameters, t);
        let [start, end] = [self.parameters[i], self.parameters[i + 1]];
        vector::lerp(self.points[i], self.points[i + 1], (t - start) / (end - start))
    }

    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        let mut derivatives = vec![[0.0; D]; order + 1];
        derivatives[0] = self.point(t);
        if let Some(first) = derivatives.get_mut(1) {
            let i = interval(&self.parameters, clamped(t, self.domain()));
            let length = self.parameters[i + 1] - self.parameters[i];
            *first = vector::scale(vector::sub(self.points[i + 1], self.points[i]), 1.0 / length);
        }
        derivatives
    }

    fn breaks(&self) -> Vec<f64> {
        self.parameters.clone()
    }

    fn corners(&self) -> Vec<f64> {
        self.parameters[1..self.parameters.len() - 1].to_vec()
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        polygon.extend([self.point(a), self.point(b)]);
    }

    fn to_nurbs(&self) -> NurbsCurve<D> {
        let [start, end] = self.domain();
        let mut knots = self.parameters.clone();
        knots.insert(0, start);
        knots.push(end);
        NurbsCurve::trusted(1, knots, self.points.clone(), None)
    }
}

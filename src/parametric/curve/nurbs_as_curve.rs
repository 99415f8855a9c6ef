//! NURBS curves as curves. Apart from their data and algorithms in `nurbs`, which the trait itself names: every curve
//! can be written as one.

use super::nurbs::NurbsCurve;
use super::param_curve::Curve;
use crate::parametric::numeric::knots;
use crate::parametric::numeric::vector::Point;

impl<const D: usize> Curve<D> for NurbsCurve<D> {
    fn domain(&self) -> [f64; 2] {
        Self::domain(self)
    }

    fn point(&self, t: f64) -> Point<D> {
        self.evaluate(t)
    }

    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        self.evaluate_derivatives(t, order)
    }

    fn breaks(&self) -> Vec<f64> {
        knots::distinct(self.degree(), self.knots())
    }

    fn corners(&self) -> Vec<f64> {
        self.kinks()
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        self.restrict(a, b, polygon);
    }

    fn to_nurbs(&self) -> Self {
        self.clone()
    }
}

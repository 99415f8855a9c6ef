//! A curve from its end to its start.

use super::nurbs::NurbsCurve;
use super::param_curve::{Curve, SharedCurve};
use crate::parametric::numeric::domain::clamped;
use crate::parametric::numeric::vector::{self, Point};

/// A curve traversed the other way, over the same domain.
#[derive(Clone, Debug)]
pub struct Reversed<const D: usize> {
    curve: SharedCurve<D>,
}

impl<const D: usize> Reversed<D> {
    /// `curve` from its end to its start.
    #[must_use]
    pub fn new(curve: SharedCurve<D>) -> Self {
        Self { curve }
    }

    fn mirrored(&self, t: f64) -> f64 {
        let [start, end] = self.curve.domain();
        // Both ends must map onto each other exactly.
        if t == start {
            end
        } else if t == end {
            start
        } else {
            start + (end - t)
        }
    }
}

impl<const D: usize> Curve<D> for Reversed<D> {
    fn domain(&self) -> [f64; 2] {
        self.curve.domain()
    }

    fn point(&self, t: f64) -> Point<D> {
        self.curve.point(self.mirrored(clamped(t, self.domain())))
    }

    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        // The one-sided rule needs the derivative from the other side at an inner break.
        let t = clamped(t, self.domain());
        let mirrored = self.mirrored(t);
        let nudged = if self.curve.breaks().contains(&mirrored) && t != self.domain()[1] {
            mirrored.next_down().max(self.domain()[0])
        } else {
            mirrored
        };
        let mut derivatives = self.curve.derivatives(nudged, order);
        for odd in derivatives.iter_mut().skip(1).step_by(2) {
            *odd = vector::scale(*odd, -1.0);
        }
        derivatives
    }

    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks().iter().rev().map(|&t| self.mirrored(t)).collect()
    }

    fn corners(&self) -> Vec<f64> {
        self.curve.corners().iter().rev().map(|&t| self.mirrored(t)).collect()
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        let first = polygon.len();
        self.curve.control_polygon(self.mirrored(b), self.mirrored(a), polygon);
        polygon[first..].reverse();
    }

    fn to_nurbs(&self) -> NurbsCurve<D> {
        self.curve.to_nurbs().reversed()
    }
}

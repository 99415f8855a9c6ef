//! Straight lines and segments.

use super::nurbs::NurbsCurve;
use super::param_curve::Curve;
use crate::parametric::error::{GeometryError, Result, check_points};
use crate::parametric::numeric::domain::clamped;
use crate::parametric::numeric::vector::{self, Point};

/// A segment from one point to another: `(1 - t) P + t Q` over 0..1, or the part `t0..t1` of the line
/// `P + t a` (Al-Athamneh 2016).
#[derive(Clone, Debug, PartialEq)]
pub struct Segment<const D: usize> {
    ends: [Point<D>; 2],
    domain: [f64; 2],
}

impl<const D: usize> Segment<D> {
    /// The segment from `start` to `end`, over 0..1.
    ///
    /// # Errors
    /// [`GeometryError::CoincidentPoints`] if both are the same, [`GeometryError::NotFinite`].
    pub fn new(start: [f64; D], end: [f64; D]) -> Result<Self> {
        Self::over(start, end, [0.0, 1.0])
    }

    /// The part of the line `point + t direction` with `t` in `domain`.
    ///
    /// # Errors
    /// [`GeometryError::Degenerate`] for a zero direction, [`GeometryError::ParametersNotIncreasing`] for an
    /// empty domain, [`GeometryError::NotFinite`].
    pub fn on_line(point: [f64; D], direction: [f64; D], domain: [f64; 2]) -> Result<Self> {
        check_points("line", &[point, direction])?;
        if direction == [0.0; D] {
            return Err(GeometryError::Degenerate { what: "line", reason: "its direction is zero" });
        }
        let at = |t| vector::add_scaled(point, direction, t);
        Self::over(at(domain[0]), at(domain[1]), domain)
    }

    fn over(start: Point<D>, end: Point<D>, domain: [f64; 2]) -> Result<Self> {
        check_points("segment", &[start, end])?;
        if domain[0] >= domain[1] || !vector::is_finite(domain) {
            return Err(GeometryError::ParametersNotIncreasing { index: 1 });
        }
        if start == end {
            return Err(GeometryError::CoincidentPoints { what: "segment", first: 0, second: 1 });
        }
        Ok(Self { ends: [start, end], domain })
    }
}

impl<const D: usize> Curve<D> for Segment<D> {
    fn domain(&self) -> [f64; 2] {
        self.domain
    }

    fn point(&self, t: f64) -> Point<D> {
        let [start, end] = self.domain;
        vector::lerp(self.ends[0], self.ends[1], (clamped(t, self.domain) - start) / (end - start))
    }

    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        let mut derivatives = vec![[0.0; D]; order + 1];
        derivatives[0] = self.point(t);
        if let Some(first) = derivatives.get_mut(1) {
            let length = self.domain[1] - self.domain[0];
            *first = vector::scale(vector::sub(self.ends[1], self.ends[0]), 1.0 / length);
        }
        derivatives
    }

    fn breaks(&self) -> Vec<f64> {
        self.domain.to_vec()
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        polygon.extend([self.point(a), self.point(b)]);
    }

    fn to_nurbs(&self) -> NurbsCurve<D> {
        let [a, b] = self.domain;
        NurbsCurve::trusted(1, vec![a, a, b, b], self.ends.to_vec(), None)
    }
}

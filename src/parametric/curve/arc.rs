//! Circles, ellipses and their arcs.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::nurbs::NurbsCurve;
use super::param_curve::{Curve, CurveForm};
use crate::parametric::error::{GeometryError, Result, check_points, check_positive};
use crate::parametric::numeric::domain::clamped;
use crate::parametric::numeric::vector::{self, Point};

/// An arc of an ellipse: `C + a cos(start + s t) + b sin(start + s t)`, `0 <= t <= |sweep|`, where `s` is the
/// sign of the sweep (Al-Athamneh 2016). Circles, whole ellipses and slanted ones (any `a` and `b` that span a
/// plane) are special cases. The parameter is an angle in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct EllipticArc<const D: usize> {
    centre: Point<D>,
    a: Point<D>,
    b: Point<D>,
    start: f64,
    sweep: f64,
}

impl EllipticArc<2> {
    /// A circle, counter-clockwise from `centre + (radius, 0)`.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] if `radius` is not positive, [`GeometryError::NotFinite`].
    pub fn circle(centre: [f64; 2], radius: f64) -> Result<Self> {
        Self::ellipse(centre, [radius, radius], 0.0)
    }

    /// An ellipse with the given half axes, turned by `rotation` radians.
    ///
    /// # Errors
    /// As [`circle`](Self::circle).
    pub fn ellipse(centre: [f64; 2], half_axes: [f64; 2], rotation: f64) -> Result<Self> {
        for radius in half_axes {
            check_positive("radius", radius)?;
        }
        let (sin, cos) = if rotation == 0.0 { (0.0, 1.0) } else { rotation.sin_cos() };
        let direction = [cos, sin];
        Self::new(
            centre,
            vector::scale(direction, half_axes[0]),
            vector::scale(vector::turned(direction), half_axes[1]),
            0.0,
            TAU,
        )
    }

    /// The arc of a circle from the angle `start` over `sweep` radians (negative: clockwise).
    ///
    /// # Errors
    /// As [`circle`](Self::circle), and for a zero sweep or one beyond a full turn.
    pub fn arc(centre: [f64; 2], radius: f64, start: f64, sweep: f64) -> Result<Self> {
        check_positive("radius", radius)?;
        Self::new(centre, [radius, 0.0], [0.0, radius], start, sweep)
    }
}

impl<const D: usize> EllipticArc<D> {
    /// The arc `centre + a cos(angle) + b sin(angle)`, the angle from `start` over `sweep` (at most a full turn).
    ///
    /// # Errors
    /// [`GeometryError::Degenerate`] if `a` and `b` are parallel, [`GeometryError::OutOfRange`] for the sweep,
    /// [`GeometryError::NotFinite`].
    pub fn new(centre: [f64; D], a: [f64; D], b: [f64; D], start: f64, sweep: f64) -> Result<Self> {
        check_points("arc", &[centre, a, b])?;
        check_points("arc", &[[start, sweep]])?;
        if sweep == 0.0 || sweep.abs() > TAU {
            return Err(GeometryError::OutOfRange {
                what: "sweep of the arc",
                value: sweep,
                range: "at most a full turn, and not zero",
            });
        }
        let (aa, bb, ab) = (vector::dot(a, a), vector::dot(b, b), vector::dot(a, b));
        if aa * bb - ab * ab <= 1e-24 * aa * bb {
            return Err(GeometryError::Degenerate { what: "arc", reason: "its axes are parallel or zero" });
        }
        Ok(Self { centre, a, b, start, sweep })
    }

    /// The centre, and the two half diameters that carry the cosine and the sine.
    #[must_use]
    pub fn axes(&self) -> [[f64; D]; 3] {
        [self.centre, self.a, self.b]
    }

    /// Angle of the start, and the signed angle to the end, in radians.
    #[must_use]
    pub fn angles(&self) -> [f64; 2] {
        [self.start, self.sweep]
    }

    /// Cosine and sine at parameter `t`, exact at quarter turns.
    fn cos_sin(&self, t: f64) -> [f64; 2] {
        let t = clamped(t, self.domain());
        // The end of a full turn is its start, whatever the rounding of the angle.
        let t = if self.is_full() && t == TAU { 0.0 } else { t };
        cos_sin(self.start + self.sweep.signum() * t)
    }

    fn is_full(&self) -> bool {
        self.sweep.abs() == TAU
    }

    fn at(&self, [cos, sin]: [f64; 2]) -> Point<D> {
        vector::add_scaled(vector::add_scaled(self.centre, self.a, cos), self.b, sin)
    }

    /// The arc's pieces of at most a quarter turn, equal in angle.
    fn pieces(&self) -> u32 {
        // The subtraction keeps a quarter turn written with rounding from counting as two pieces.
        ((self.sweep.abs() / FRAC_PI_2 - 1e-12).ceil() as u32).clamp(1, 4)
    }

    /// The third corner of the triangle around the arc between two parameters less than half a turn apart: where
    /// its end tangents meet.
    fn corner(&self, t0: f64, t1: f64) -> Point<D> {
        let [cos, sin] = self.cos_sin(0.5 * (t0 + t1));
        let stretch = 1.0 / (0.5 * (t1 - t0)).cos();
        self.at([cos * stretch, sin * stretch])
    }
}

/// Cosine and sine of `angle`, exact where the angle is a whole number of quarter turns.
pub(crate) fn cos_sin(angle: f64) -> [f64; 2] {
    let quarters = (angle / FRAC_PI_2).round();
    if quarters * FRAC_PI_2 == angle && quarters.abs() < 1e6 {
        return [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][(quarters as i64).rem_euclid(4) as usize];
    }
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

impl<const D: usize> Curve<D> for EllipticArc<D> {
    fn domain(&self) -> [f64; 2] {
        [0.0, self.sweep.abs()]
    }

    fn point(&self, t: f64) -> Point<D> {
        self.at(self.cos_sin(t))
    }

    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        let [mut cos, mut sin] = self.cos_sin(t);
        let sign = self.sweep.signum();
        let mut derivatives = vec![self.point(t)];
        for _ in 0..order {
            [cos, sin] = [-sin * sign, cos * sign];
            derivatives.push(vector::add_scaled(vector::scale(self.a, cos), self.b, sin));
        }
        derivatives
    }

    fn breaks(&self) -> Vec<f64> {
        let pieces = self.pieces();
        let end = self.sweep.abs();
        (0..=pieces).map(|k| if k == pieces { end } else { end * f64::from(k) / f64::from(pieces) }).collect()
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        polygon.extend([self.point(a), self.corner(a, b), self.point(b)]);
    }

    /// Quadratic pieces of at most a quarter turn (Piegl and Tiller, section 7.5).
    fn to_nurbs(&self) -> NurbsCurve<D> {
        let breaks = self.breaks();
        let (mut knots, mut points, mut weights) = (vec![0.0], vec![self.point(0.0)], vec![1.0]);
        for piece in breaks.windows(2) {
            knots.extend([piece[0]; 2]);
            points.extend([self.corner(piece[0], piece[1]), self.point(piece[1])]);
            weights.extend([(0.5 * (piece[1] - piece[0])).cos(), 1.0]);
        }
        knots.extend([self.sweep.abs(); 3]);
        NurbsCurve::trusted(2, knots, points, Some(weights))
    }

    fn form(&self) -> CurveForm<'_, D> {
        CurveForm::EllipticArc { axes: self.axes(), sweep: self.sweep }
    }
}

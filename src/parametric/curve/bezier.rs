//! Bezier curves of any degree.

use super::nurbs::NurbsCurve;
use super::param_curve::Curve;
use crate::parametric::error::{Result, check_count};
use crate::parametric::numeric::bernstein;
use crate::parametric::numeric::domain::clamped;
use crate::parametric::numeric::vector::Point;

/// A Bezier curve `sum P_i B_i(t)` over 0..1, of degree one less than the number of its control points.
///
/// ```
/// use trisect::parametric::{Bezier, Curve};
///
/// let parabola = Bezier::new(&[[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]])?;
/// assert_eq!(parabola.point(0.5), [1.0, 1.0]);
/// assert_eq!(parabola.raised().point(0.5), [1.0, 1.0]);
/// # Ok::<(), trisect::parametric::GeometryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Bezier<const D: usize> {
    control: Vec<Point<D>>,
}

impl<const D: usize> Bezier<D> {
    /// The curve with these control points.
    ///
    /// # Errors
    /// [`TooFewPoints`](crate::parametric::GeometryError::TooFewPoints) for fewer than 2,
    /// [`NotFinite`](crate::parametric::GeometryError::NotFinite),
    /// [`CoincidentPoints`](crate::parametric::GeometryError::CoincidentPoints) if all are the same point.
    pub fn new(control: &[[f64; D]]) -> Result<Self> {
        check_count("Bezier curve", control, 2)?;
        if control.iter().all(|p| *p == control[0]) {
            return Err(crate::parametric::GeometryError::CoincidentPoints {
                what: "Bezier curve",
                first: 0,
                second: control.len() - 1,
            });
        }
        Ok(Self { control: control.to_vec() })
    }

    pub(crate) fn trusted(control: Vec<Point<D>>) -> Self {
        Self { control }
    }

    /// The degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.control.len() - 1
    }

    /// The control points.
    #[must_use]
    pub fn control(&self) -> &[[f64; D]] {
        &self.control
    }

    /// The same curve with one degree more.
    #[must_use]
    pub fn raised(&self) -> Self {
        Self { control: bernstein::elevate(&self.control) }
    }

    /// The same curve raised to `degree`; itself if that is not above its own.
    #[must_use]
    pub fn raised_to(&self, degree: usize) -> Self {
        let mut raised = self.clone();
        while raised.degree() < degree {
            raised = raised.raised();
        }
        raised
    }

    /// The parts before and after `t`, each over 0..1.
    #[must_use]
    pub fn split(&self, t: f64) -> [Self; 2] {
        bernstein::split(&self.control, clamped(t, [0.0, 1.0])).map(Self::trusted)
    }

    /// The curve traversed the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { control: self.control.iter().rev().copied().collect() }
    }

    /// The derivative with respect to `t` as a curve of one degree less; for degree 1 a constant, as degree 1.
    #[must_use]
    pub fn hodograph(&self) -> Self {
        let control = bernstein::hodograph(&self.control);
        if control.len() == 1 { Self { control: vec![control[0]; 2] } } else { Self { control } }
    }
}

impl<const D: usize> Curve<D> for Bezier<D> {
    fn domain(&self) -> [f64; 2] {
        [0.0, 1.0]
    }

    fn point(&self, t: f64) -> Point<D> {
        bernstein::point(&self.control, clamped(t, [0.0, 1.0]))
    }

    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        bernstein::derivatives(&self.control, clamped(t, [0.0, 1.0]), order)
    }

    fn breaks(&self) -> Vec<f64> {
        vec![0.0, 1.0]
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        bernstein::restrict(&self.control, a, b, polygon);
    }

    fn to_nurbs(&self) -> NurbsCurve<D> {
        let degree = self.degree();
        let knots = [0.0, 1.0].iter().flat_map(|&knot| vec![knot; degree + 1]).collect();
        NurbsCurve::trusted(degree, knots, self.control.clone(), None)
    }
}

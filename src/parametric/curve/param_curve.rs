//! What every curve can do.

use std::fmt::Debug;
use std::sync::Arc;

use super::arc::EllipticArc;
use super::composite::Composite;
use super::nurbs::NurbsCurve;
use crate::parametric::numeric::vector::{self, Point};

/// A parametric curve in the plane (`D = 2`) or in space (`D = 3`).
///
/// A curve is continuous on its whole domain and analytic between consecutive [`breaks`](Curve::breaks).
/// Parameters outside the domain are moved to its nearer end, so that evaluation never fails and never
/// returns NaN.
pub trait Curve<const D: usize>: Debug + Send + Sync {
    /// First and last parameter, the first smaller.
    fn domain(&self) -> [f64; 2];

    /// The point at parameter `t`. The ends of a closed curve are the same point, bit for bit.
    fn point(&self, t: f64) -> [f64; D];

    /// The point and the derivatives with respect to `t`, up to `order`: `order + 1` vectors. At a break the
    /// derivatives from the right, at the end of the domain those from the left.
    fn derivatives(&self, t: f64, order: usize) -> Vec<[f64; D]>;

    /// Ascending parameters, the ends of the domain included, between which the curve is analytic.
    fn breaks(&self) -> Vec<f64>;

    /// Those inner breaks where the direction of the curve may jump. Every mesh has a node there.
    fn corners(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Appends a control polygon of the part between parameters `a < b`, which must lie between two consecutive
    /// breaks. The polygon starts and ends on the curve, its convex hull contains that part, no line (plane)
    /// meets the part more often than the polygon, and it closes up on the curve quadratically as `b - a` shrinks.
    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<[f64; D]>);

    /// The same set of points as a NURBS curve, exactly. The parameter may run differently.
    fn to_nurbs(&self) -> NurbsCurve<D>;

    /// Whether the end is the start.
    fn is_closed(&self) -> bool {
        let [start, end] = self.domain();
        self.point(start) == self.point(end)
    }

    /// Lower and upper corner of a box that contains the curve: the box of control polygons of sixteenths of
    /// the analytic pieces, larger than the smallest box by little.
    fn bounds(&self) -> [[f64; D]; 2] {
        const PARTS: u32 = 16;
        let mut polygon = Vec::new();
        for piece in self.breaks().windows(2) {
            for part in 0..PARTS {
                let at = |k: u32| vector::mix(piece[0], piece[1], f64::from(k) / f64::from(PARTS));
                self.control_polygon(at(part), at(part + 1), &mut polygon);
            }
        }
        let start = self.point(self.domain()[0]);
        vector::bounding_box(polygon).unwrap_or([start; 2])
    }

    /// This curve as a composite, if it is one; composites of composites are spliced flat by this.
    fn as_composite(&self) -> Option<&Composite<D>> {
        None
    }

    /// This curve as an elliptic arc, if it is one; files that know arcs keep them exactly by this.
    fn as_arc(&self) -> Option<&EllipticArc<D>> {
        None
    }
}

/// A curve shared between the things built from it.
pub type SharedCurve<const D: usize> = Arc<dyn Curve<D>>;

/// `t` moved into the domain; the start for NaN.
pub(crate) fn clamped(t: f64, domain: [f64; 2]) -> f64 {
    if t > domain[0] { t.min(domain[1]) } else { domain[0] }
}

/// Index of the interval of ascending `nodes` that contains `t`: the last one whose start is not above `t`.
pub(crate) fn interval(nodes: &[f64], t: f64) -> usize {
    nodes.partition_point(|&node| node <= t).clamp(1, nodes.len() - 1) - 1
}

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

//! What every curve can do.

use std::fmt::Debug;
use std::sync::Arc;

use super::nurbs::NurbsCurve;
use crate::parametric::numeric::vector;

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

    /// What the curve is made of, for code that keeps some forms as they are: composites of composites are spliced
    /// flat, files that know arcs write them exactly.
    fn form(&self) -> CurveForm<'_, D> {
        CurveForm::General
    }
}

/// A curve shared between the things built from it.
pub type SharedCurve<const D: usize> = Arc<dyn Curve<D>>;

/// The forms of curve that some code keeps as they are.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum CurveForm<'a, const D: usize> {
    /// These curves end to end.
    Chain(&'a [SharedCurve<D>]),
    /// An arc of an ellipse over `0 <= t <= |sweep|`.
    EllipticArc {
        /// The centre, and the two half diameters that carry the cosine and the sine.
        axes: [[f64; D]; 3],
        /// The signed angle (radians) from the start to the end.
        sweep: f64,
    },
    /// Any other.
    General,
}

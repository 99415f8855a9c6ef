//! Plane regions bounded by curves.

use super::membership::{self, Membership};
use super::overlay::FillRule;
use super::polygons::Polygons;
use crate::parametric::curve::composite::Composite;
use crate::parametric::curve::discretise::CurveMeshing;
use crate::parametric::curve::param_curve::{Curve, SharedCurve};
use crate::parametric::error::Result;
use crate::parametric::numeric::gauss::gauss_legendre;

/// A bounded plane region: the points around which closed curves wind an odd number of times (parity rule), so that
/// contours inside others are holes, whatever their direction.
#[derive(Clone, Debug)]
pub struct Region {
    contours: Vec<Composite<2>>,
}

impl Region {
    /// The region bounded by `contours`, each closed.
    ///
    /// # Errors
    /// [`NotClosed`](crate::parametric::GeometryError::NotClosed) for a contour that does not end where it starts.
    pub fn new(contours: &[SharedCurve<2>]) -> Result<Self> {
        let contours = contours.iter().map(|c| Composite::closed(std::slice::from_ref(c)));
        Ok(Self { contours: contours.collect::<Result<_>>()? })
    }

    /// The contours.
    #[must_use]
    pub fn contours(&self) -> &[Composite<2>] {
        &self.contours
    }

    /// Where `point` lies, by the parity of the crossings of a ray with the curves themselves; a ray that touches
    /// them is turned (Al-Athamneh 2016). A point within rounding of a contour is on the boundary.
    #[must_use]
    pub fn membership(&self, point: [f64; 2]) -> Membership {
        let curves: Vec<&dyn Curve<2>> = self.contours.iter().map(|c| c as &dyn Curve<2>).collect();
        membership::classify_by_parity(&curves, point)
    }

    /// The area by Green's theorem along the curves: exact for polynomial pieces up to degree 16, to rounding for
    /// arcs. The contours must not cross one another or themselves.
    #[must_use]
    pub fn area(&self) -> f64 {
        let rule = gauss_legendre(16);
        let enclosed: Vec<f64> = self.contours.iter().map(|c| enclosed_area(c, &rule).abs()).collect();
        let depth = |i: usize| {
            let start = self.contours[i].point(0.0);
            let others = self.contours.iter().enumerate().filter(|(j, _)| *j != i);
            others
                .filter(|(_, other)| {
                    membership::classify_by_parity(&[*other as &dyn Curve<2>], start) == Membership::Inside
                })
                .count()
        };
        (0..enclosed.len()).map(|i| if depth(i) % 2 == 0 { enclosed[i] } else { -enclosed[i] }).sum()
    }

    /// The region as polygons with holes, every contour meshed by `meshing`. Contours that cross are resolved by
    /// the parity rule.
    ///
    /// # Errors
    /// Those of [`CurveMeshing::mesh`].
    pub fn polygons(&self, meshing: &CurveMeshing) -> Result<Polygons> {
        let mut contours = Vec::new();
        for contour in &self.contours {
            let mut points = meshing.mesh(contour)?.points;
            points.pop();
            contours.push(points);
        }
        Polygons::new(&contours, FillRule::EvenOdd)
    }
}

/// Signed area inside a closed curve, positive counter-clockwise.
fn enclosed_area(curve: &dyn Curve<2>, rule: &[[f64; 2]]) -> f64 {
    // Areas are taken from a point of the curve, so that a far origin costs no digits.
    let origin = curve.point(curve.domain()[0]);
    let mut area = 0.0;
    for piece in curve.breaks().windows(2) {
        let length = piece[1] - piece[0];
        for [x, weight] in rule {
            let d = curve.derivatives(piece[0] + x * length, 1);
            let p = [d[0][0] - origin[0], d[0][1] - origin[1]];
            area += 0.5 * weight * length * (p[0] * d[1][1] - p[1] * d[1][0]);
        }
    }
    area
}

//! Polygons with holes.

use super::membership::Membership;
use crate::exact::{Sign, orient2d};
use crate::parametric::error::{GeometryError, Result, check_points};
use crate::parametric::numeric::vector::{self, Point};

/// A bounded plane region with straight edges: polygons with holes that neither cross nor overlap. Outer contours
/// run counter-clockwise, holes with it; no contour repeats its first point at the end.
///
/// How regions are made of contours and combined is in `overlay`, how they are filled in `triangulate`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygons {
    shapes: Vec<Vec<Vec<Point<2>>>>,
}

impl Polygons {
    pub(crate) fn trusted(shapes: Vec<Vec<Vec<Point<2>>>>) -> Self {
        Self { shapes }
    }

    /// The axis-aligned rectangle between two corners.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`], [`GeometryError::Degenerate`] if it has no area.
    pub fn rectangle(low: [f64; 2], high: [f64; 2]) -> Result<Self> {
        check_points("rectangle", &[low, high])?;
        if low[0] >= high[0] || low[1] >= high[1] {
            return Err(GeometryError::Degenerate { what: "rectangle", reason: "it has no area" });
        }
        Ok(Self { shapes: vec![vec![vec![low, [high[0], low[1]], high, [low[0], high[1]]]]] })
    }

    /// The polygons: each an outer contour and its holes.
    #[must_use]
    pub fn shapes(&self) -> &[Vec<Vec<[f64; 2]>>] {
        &self.shapes
    }

    /// All contours, outer ones and holes.
    pub fn contours(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        self.shapes.iter().flatten().map(Vec::as_slice)
    }

    /// Whether the region is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// All edges, the interior on their left.
    pub(crate) fn edges(&self) -> impl Iterator<Item = [Point<2>; 2]> {
        self.contours().flat_map(|c| (0..c.len()).map(|i| [c[i], c[(i + 1) % c.len()]]))
    }

    /// The area.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.contours().map(signed_area).sum()
    }

    /// Where `point` lies, decided exactly: parity of the crossings of the ray in +x, an edge counting if one end
    /// is below the ray and the other on or above it (Choporov 2017), sides by an exact predicate.
    #[must_use]
    pub fn membership(&self, point: [f64; 2]) -> Membership {
        let mut inside = false;
        for [a, b] in self.edges() {
            if on_segment(point, a, b) {
                return Membership::Boundary;
            }
            if (a[1] < point[1]) != (b[1] < point[1]) {
                let [low, high] = if a[1] < b[1] { [a, b] } else { [b, a] };
                // The edge meets the ray if the point is to its left, seen upwards.
                inside ^= orient2d(low, high, point) == Sign::Positive;
            }
        }
        if inside { Membership::Inside } else { Membership::Outside }
    }

    /// Distance to the boundary, positive inside and negative outside (Choporov 2017, equations 3 and 6);
    /// minus infinity for an empty region. Linear in the number of edges.
    #[must_use]
    pub fn signed_distance(&self, point: [f64; 2]) -> f64 {
        let distance =
            self.edges().map(|[a, b]| vector::distance_to_segment(point, a, b)).fold(f64::INFINITY, f64::min);
        match self.membership(point) {
            Membership::Inside => distance,
            Membership::Boundary => 0.0,
            Membership::Outside => -distance,
        }
    }

    /// Every edge cut into as many equal parts as `parts` says.
    pub(crate) fn refined(&self, parts: impl Fn(Point<2>, Point<2>) -> usize) -> Self {
        let contour = |c: &Vec<Point<2>>| {
            let mut refined = Vec::new();
            for (i, &a) in c.iter().enumerate() {
                let b = c[(i + 1) % c.len()];
                let count = parts(a, b).max(1);
                refined.extend((0..count).map(|k| vector::lerp(a, b, k as f64 / count as f64)));
            }
            refined
        };
        Self { shapes: self.shapes.iter().map(|shape| shape.iter().map(contour).collect()).collect() }
    }
}

/// The polygons of a section: in coordinates of its plane, for the operations on regions.
impl From<&crate::Section> for Polygons {
    fn from(section: &crate::Section) -> Self {
        Self::trusted(section.shapes().to_vec())
    }
}

/// Area inside a closed polygon, positive counter-clockwise.
pub(crate) fn signed_area(contour: &[Point<2>]) -> f64 {
    let origin = contour[0];
    let twice: f64 = contour
        .windows(2)
        .map(|edge| vector::cross2(vector::sub(edge[0], origin), vector::sub(edge[1], origin)))
        .sum();
    0.5 * twice
}

fn on_segment(p: Point<2>, a: Point<2>, b: Point<2>) -> bool {
    let within = |i: usize| p[i] >= a[i].min(b[i]) && p[i] <= a[i].max(b[i]);
    within(0) && within(1) && orient2d(a, b, p) == Sign::Zero
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn membership_is_exact_at_any_magnitude() {
        let membership =
            |points: [[f64; 2]; 3], point| Polygons::trusted(vec![vec![points.to_vec()]]).membership(point);
        for scale in [1e-300, 1.0, 1e300] {
            let wedge = [[0.0, 0.0], [3.0 * scale, scale], [0.0, scale]];
            let [x, y] = [3.0, 1.0].map(|x| 0.25 * scale * x);
            assert_eq!(membership(wedge, [x, y]), Membership::Boundary, "{scale}");
            assert_eq!(membership(wedge, [x, y.next_up()]), Membership::Inside, "{scale}");
            assert_eq!(membership(wedge, [x, y.next_down()]), Membership::Outside, "{scale}");
        }
        let huge = [[0.0, 0.0], [1e300, 1e300], [-1e300, 1e300]];
        assert_eq!(membership(huge, [1e-300, 1e-300]), Membership::Boundary);
        assert_eq!(membership(huge, [1e-300, 1e-300f64.next_up()]), Membership::Inside);
    }
}

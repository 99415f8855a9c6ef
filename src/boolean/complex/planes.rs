//! Which faces lie in one plane, exactly.

use glam::DVec3;

use super::Complex;
use super::ids::FaceId;
use super::origin::Origin;
use super::rounding::Rounding;
use crate::exact::{PlaneFilter, Projection, Sign, collinear, orient2d, orient3d, orient3d_filter};

impl Complex<'_> {
    /// The corners of the face a triangle comes from, turned over if it was.
    pub(crate) fn source(&self, origin: Origin) -> [[f64; 3]; 3] {
        let [a, b, c] = self.positions(self.face_of(origin));
        if origin.reversed { [a, c, b] } else { [a, b, c] }
    }

    /// Whether two sources look the same way from the same plane and belong to the same group, so that the border between
    /// them is no edge of the solid.
    pub(crate) fn are_mergeable(&self, x: Origin, y: Origin) -> bool {
        if self.group(x) != self.group(y) {
            return false;
        }
        if x.operand == y.operand && x.triangle == y.triangle {
            return x.reversed == y.reversed;
        }
        self.are_coplanar(x, y)
            && look_same_way(&self.source(x), &self.source(y))
            && self.class(x) == self.class(y)
    }

    /// Whether two sources lie in the same plane, exactly; false for triangles without area.
    pub(crate) fn are_coplanar(&self, x: Origin, y: Origin) -> bool {
        lie_in_one_plane(&self.source(x), &self.source(y))
    }

    /// Whether two faces of an operand are mergeable; fast where they are visibly not coplanar, as nearly all are.
    pub(crate) fn are_faces_mergeable(&self, f: FaceId, g: FaceId) -> bool {
        let [a, b, c] = self.positions(f);
        let is_off_plane = |d: &[f64; 3]| {
            let (determinant, bound) = orient3d_filter(&a, &b, &c, d);
            determinant.abs() > bound
        };
        !self.positions(g).iter().any(is_off_plane)
            && self.are_mergeable(self.origin(f, false), self.origin(g, false))
    }

    fn group(&self, origin: Origin) -> u32 {
        self.groups[origin.operand as usize].get(origin.triangle as usize).copied().unwrap_or(0)
    }

    /// The class of the face a triangle comes from, where attributes have to be kept, else 0.
    fn class(&self, origin: Origin) -> u32 {
        let Some(attributed) = &self.attributed else { return 0 };
        let classes =
            self.classes.get_or_init(|| attributed.classes(&self.operands, self.groups, &self.near));
        classes[origin.operand as usize].get(origin.triangle as usize).copied().unwrap_or(0)
    }

    /// Whether two faces of one plane belong to one group and one class.
    pub(crate) fn belong_together(&self, x: Origin, y: Origin) -> bool {
        self.group(x) == self.group(y) && self.class(x) == self.class(y)
    }
}

/// Whether two triangles lie in the same plane, exactly; false for triangles without area.
pub(crate) fn lie_in_one_plane(x: &[[f64; 3]; 3], y: &[[f64; 3]; 3]) -> bool {
    let [a, b, c] = x;
    // Nearly always they have corners in common, and those need no test.
    y.iter().filter(|d| !x.contains(d)).all(|d| orient3d(a, b, c, d) == Sign::Zero)
        && !collinear(a, b, c)
        && !collinear(&y[0], &y[1], &y[2])
}

/// Whether the normals of two triangles of one plane point the same way.
pub(crate) fn look_same_way(x: &[[f64; 3]; 3], y: &[[f64; 3]; 3]) -> bool {
    let seen = Projection::of(x);
    let [a, b, c] = y.map(|p| seen.project(&p));
    orient2d(a, b, c) == Sign::Positive
}

/// The unit normal of a triangle; `None` where it has none.
pub(crate) fn unit_normal([a, b, c]: &[[f64; 3]; 3]) -> Option<DVec3> {
    let [a, b, c] = [a, b, c].map(|corner| DVec3::from_array(*corner));
    let (u, v) = (b - a, c - a);
    let size = u.abs().max_element().max(v.abs().max_element());
    (u / size).cross(v / size).try_normalize()
}

/// A normal of a triangle as long as twice its area, as it comes out.
#[inline]
fn area_normal(triangle: [&[f64; 3]; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|corner| DVec3::from_array(*corner));
    (b - a).cross(c - a)
}

/// Whether two triangles have normals that differ, or are opposite, by no more than what rounding turns faces by that were
/// flush: an angle of a millionth, in radians.
pub(crate) fn are_nearly_parallel(x: &[[f64; 3]; 3], y: &[[f64; 3]; 3]) -> bool {
    const ANGLE: f64 = 1e-6;
    let (n, m) = (area_normal(x.each_ref()), area_normal(y.each_ref()));
    n.cross(m).length_squared() <= ANGLE * ANGLE * n.length_squared() * m.length_squared()
}

/// Whether the smaller of two triangles has all corners within twice the rounding of the other's plane, but not all of them in it, exactly:
/// they were flush, perhaps, before their bodies were turned.
#[inline]
pub(crate) fn are_nearly_flush(x: [&[f64; 3]; 3], y: [&[f64; 3]; 3], rounding: Rounding) -> bool {
    let (n, m) = (area_normal(x), area_normal(y));
    let (of_x, of_y) = (n.length_squared(), m.length_squared());
    let (plane, normal, squared, points) = if of_x >= of_y { (x, n, of_x, y) } else { (y, m, of_y, x) };
    // Nearly always the first point says no, however large the coordinates at hand.
    let height_of = |p: &[f64; 3]| normal.dot(DVec3::from_array(*p) - DVec3::from_array(*plane[0]));
    let (height, most) = (height_of(points[0]), 2.0 * rounding.longest());
    height * height <= most * most * squared
        && are_flush_at_hand([x, y], points, height_of, squared, rounding)
}

/// The same of triangles that may have corners in common: those lie in one plane everywhere, and must have area in common.
pub(crate) fn are_nearly_flush_contact(
    x: &[[f64; 3]; 3],
    y: &[[f64; 3]; 3],
    are_joined: bool,
    rounding: Rounding,
) -> bool {
    are_nearly_flush(x.each_ref(), y.each_ref(), rounding) && (!are_joined || overlap(x, y))
}

/// The same by the coordinates at hand, given the heights of points over the larger one's plane, times its normal's length.
#[cold]
fn are_flush_at_hand(
    both: [[&[f64; 3]; 3]; 2],
    points: [&[f64; 3]; 3],
    height_of: impl Fn(&[f64; 3]) -> f64,
    squared: f64,
    rounding: Rounding,
) -> bool {
    let most = 2.0 * points.iter().map(|p| rounding.length_at(p)).fold(0.0, f64::max);
    let is_near = |p: &[f64; 3]| height_of(p).powi(2) <= most * most * squared;
    let [x, y] = both.map(|corners| corners.map(|corner| *corner));
    let has_area = |[a, b, c]: &[[f64; 3]; 3]| !collinear(a, b, c);
    points.into_iter().all(is_near)
        && are_nearly_parallel(&x, &y)
        && has_area(&x)
        && has_area(&y)
        && !lie_in_one_plane(&x, &y)
}

/// Whether two triangles that lie in one plane, exactly, have area in common.
fn overlap(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> bool {
    if collinear(&a[0], &a[1], &a[2]) || collinear(&b[0], &b[1], &b[2]) {
        return false;
    }
    let seen = Projection::of(a);
    let upright = |t: &[[f64; 3]; 3]| {
        let [p, q, r] = t.each_ref().map(|p| seen.project(p));
        if orient2d(p, q, r) == Sign::Positive { [p, q, r] } else { [p, r, q] }
    };
    let (a, b) = (upright(a), upright(b));
    // Two triangles are apart iff a side of one of them has the whole of the other on its outer side.
    let separates = |s: &[[f64; 2]; 3], t: &[[f64; 2]; 3]| {
        (0..3).any(|k| t.iter().all(|&p| orient2d(s[k], s[(k + 1) % 3], p) != Sign::Positive))
    };
    !separates(&a, &b) && !separates(&b, &a)
}

/// Whether two triangles lie in one plane, exactly, and have area in common.
pub(crate) fn lie_on_each_other(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> bool {
    let filter = PlaneFilter::new(&a[0], &a[1], &a[2]);
    let is_off = |p: &[f64; 3]| {
        let (determinant, bound) = filter.determinant(p);
        determinant.abs() > bound
    };
    !b.iter().any(is_off) && b.iter().all(|p| orient3d(&a[0], &a[1], &a[2], p) == Sign::Zero) && overlap(a, b)
}

//! Projection of a face along one axis: dropping a coordinate rounds nothing, so what is exact in space stays exact in
//! the plane.

/// Two axes onto which a face is projected, such that it is seen from the front: its corners turn counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Projection {
    /// The axis that becomes the first coordinate in the plane.
    pub(crate) x: usize,
    /// The axis that becomes the second.
    pub(crate) y: usize,
}

impl Projection {
    /// Along the axis that the normal of a triangle is largest in, seen from the side its normal points to. Any axis will
    /// do for a triangle without area.
    #[inline]
    pub(crate) fn of(corners: &[[f64; 3]; 3]) -> Self {
        let (axis, looks_along) = dominant_axis(corners);
        let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
        if looks_along { Self { x, y } } else { Self { x: y, y: x } }
    }

    /// The same for a small part of the time; but where products vanish or overflow, and for a triangle that is nearly a line, it may be
    /// seen from behind.
    #[inline]
    pub(crate) fn roughly_of([a, b, c]: &[[f64; 3]; 3]) -> Self {
        let edge = |p: &[f64; 3], q: &[f64; 3]| [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
        let ([ux, uy, uz], [vx, vy, vz]) = (edge(a, b), edge(a, c));
        let normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
        let size = normal.map(f64::abs);
        let axis = if size[0] >= size[1].max(size[2]) {
            0
        } else if size[1] >= size[2] {
            1
        } else {
            2
        };
        Self::seen_from(axis, normal[axis] >= 0.0)
    }

    /// Along an axis, seen from its positive end, or else from its negative one.
    pub(crate) fn seen_from(axis: usize, positive_end: bool) -> Self {
        let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
        if positive_end { Self { x, y } } else { Self { x: y, y: x } }
    }

    /// The axis that is dropped.
    pub(crate) fn axis(self) -> usize {
        3 - self.x - self.y
    }

    /// The same projection seen from the axis's positive end, whichever way the face looks.
    pub(crate) fn along_axis(self) -> Self {
        let axis = self.axis();
        Self { x: (axis + 1) % 3, y: (axis + 2) % 3 }
    }

    /// The projection of the same face turned over.
    #[must_use]
    pub(crate) fn reversed(self) -> Self {
        Self { x: self.y, y: self.x }
    }

    /// A point's place in the plane.
    #[inline]
    pub(crate) fn project(self, point: &[f64; 3]) -> [f64; 2] {
        [point[self.x], point[self.y]]
    }
}

/// The axis the normal of a triangle is largest along, and whether it looks along it (or against it).
fn dominant_axis(corners: &[[f64; 3]; 3]) -> (usize, bool) {
    let [a, b, c] = corners;
    let edge = |p: &[f64; 3], q: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| q[k] - p[k]) };
    let (mut u, mut v) = (edge(a, b), edge(a, c));
    let size_of = |u: &[f64; 3], v: &[f64; 3]| u.iter().chain(v).fold(0.0f64, |size, x| size.max(x.abs()));
    let mut size = size_of(&u, &v);
    if !size.is_finite() {
        // The corners are further apart than the largest number: halves of them are not.
        let half = |p: &[f64; 3]| p.map(|x| 0.5 * x);
        (u, v) = (edge(&half(a), &half(b)), edge(&half(a), &half(c)));
        size = size_of(&u, &v);
    }
    // To unit size, so that products neither vanish nor overflow.
    if size > 0.0 {
        u = u.map(|x| x / size);
        v = v.map(|x| x / size);
    }
    let normal: [f64; 3] = std::array::from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        u[l] * v[m] - u[m] * v[l]
    });
    let axis = (1..3).fold(0, |best, k| if normal[k].abs() > normal[best].abs() { k } else { best });
    (axis, normal[axis] >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{Sign, orient2d};

    #[test]
    fn a_face_is_seen_counter_clockwise_at_any_scale() {
        let base = [[0.0, 0.0, 0.0], [1.0, 0.25, 0.5], [-0.25, 1.0, -0.5]];
        for scale in [1e-300, 1.0, 1e300, 1.5e308] {
            for turn in 0..3 {
                for flip in [false, true] {
                    let mut corners = base.map(|p| [0, 1, 2].map(|k| scale * p[(k + turn) % 3]));
                    if flip {
                        corners.swap(1, 2);
                    }
                    let projection = Projection::of(&corners);
                    let [a, b, c] = corners.map(|p| projection.project(&p));
                    assert_eq!(orient2d(a, b, c), Sign::Positive, "{scale} {turn} {flip}");
                    assert!(scale != 1.0 || Projection::roughly_of(&corners) == projection);
                    let axis = projection.axis();
                    assert!(axis != projection.x && axis != projection.y);
                    assert_ne!(projection.reversed(), projection);
                    assert_eq!(projection.reversed().along_axis(), projection.along_axis());
                }
            }
        }
    }
}

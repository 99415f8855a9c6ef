//! Triangles that are plainly apart: no perturbation can make them cross.
//!
//! Seen along an axis, two triangles that a line separates have nothing in common, whether they lie in one plane or not. That is
//! decided by plane coordinates, for a small part of what a tie of four coplanar points costs.

use crate::boolean::complex::Corner;
use crate::exact::{Projection, Sign, orient2d};

/// Whether two triangles without a common corner have no point in common; false where no side of one separates them along the
/// axis that it, or the other, looks along most.
pub(super) fn are_apart(a: &[Corner; 3], b: &[Corner; 3]) -> bool {
    let (of_a, of_b) = (a.map(|corner| corner.position), b.map(|corner| corner.position));
    has_separating_side(&of_a, &of_b) || has_separating_side(&of_b, &of_a)
}

/// Whether all of `other` lies strictly beyond a side of a triangle, seen along the axis that it looks along most.
fn has_separating_side(triangle: &[[f64; 3]; 3], other: &[[f64; 3]; 3]) -> bool {
    let seen = Projection::of(triangle);
    let (t, o) = (triangle.map(|p| seen.project(&p)), other.map(|p| seen.project(&p)));
    // (Turned over by rounding, a triangle lies on the other side of its own sides.)
    orient2d(t[0], t[1], t[2]) != Sign::Negative
        && (0..3).any(|k| {
            let (p, q) = (t[k], t[(k + 1) % 3]);
            o.iter().all(|x| orient2d(p, q, *x) == Sign::Negative)
        })
}

/// Whether two triangles with the corner `i` of `a` and `j` of `b` in common, and no other, have nothing else in common; false
/// where no side at that corner separates them.
pub(super) fn meet_in_corner_alone(a: &[Corner; 3], i: usize, b: &[Corner; 3], j: usize) -> bool {
    let turned = |t: &[Corner; 3], k: usize| [0, 1, 2].map(|l| t[(k + l) % 3].position);
    let (of_a, of_b) = (turned(a, i), turned(b, j));
    has_separating_side_at_corner(&of_a, &of_b) || has_separating_side_at_corner(&of_b, &of_a)
}

/// The same for triangles whose first corner is the common one: the others of the one lie strictly beyond a side of the other.
fn has_separating_side_at_corner(triangle: &[[f64; 3]; 3], other: &[[f64; 3]; 3]) -> bool {
    let seen = Projection::of(triangle);
    let ([v, p, q], [_, r, s]) = (triangle.map(|p| seen.project(&p)), other.map(|p| seen.project(&p)));
    let is_beyond = |from: [f64; 2], to: [f64; 2]| {
        orient2d(from, to, r) == Sign::Negative && orient2d(from, to, s) == Sign::Negative
    };
    // A triangle that is seen as a line separates nothing.
    orient2d(v, p, q) == Sign::Positive && (is_beyond(v, p) || is_beyond(q, v))
}

//! Triangles that are plainly apart: no perturbation can make them cross.
//!
//! Seen along an axis, two triangles that a line separates have nothing in common, whether they lie in one plane or not. That is
//! decided by plane coordinates, for a small part of what a tie of four coplanar points costs.

use smallvec::SmallVec;

use crate::boolean::complex::Corner;
use crate::boolean::complex::predicates::Predicates;
use crate::exact::{Projection, Sign, orient2d};

/// Whether two triangles plainly have nothing in common but a corner: one lies on one side of the other's plane, or seen along an
/// axis they lie on different sides of a line. Nearly all pairs are apart, and most ties are of faces in one plane.
#[inline]
pub(crate) fn are_plainly_apart(predicates: &Predicates<'_>, a: &[Corner; 3], b: &[Corner; 3]) -> bool {
    let beside = |plane, corners: &[Corner]| predicates.are_plainly_on_one_side(plane, corners);
    match common_corners(a, b).as_slice() {
        [] => beside(b, a) || beside(a, b) || are_apart(a, b),
        &[(i, j)] => {
            // (The common corner lies in both planes.)
            let others = |t: &[Corner; 3], k: usize| [t[(k + 1) % 3], t[(k + 2) % 3]];
            beside(b, &others(a, i)) || beside(a, &others(b, j)) || meet_in_corner_alone(a, i, b, j)
        }
        _ => false,
    }
}

/// The corners that two triangles have in common, by their places in both.
pub(crate) fn common_corners(a: &[Corner; 3], b: &[Corner; 3]) -> SmallVec<[(usize, usize); 3]> {
    let places = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    places.filter(|&(i, j)| a[i].id == b[j].id).collect()
}

/// Whether two triangles without a common corner have no point in common; false where no side of one separates them along the
/// axis that it, or the other, looks along most.
fn are_apart(a: &[Corner; 3], b: &[Corner; 3]) -> bool {
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
fn meet_in_corner_alone(a: &[Corner; 3], i: usize, b: &[Corner; 3], j: usize) -> bool {
    let turned = |t: &[Corner; 3], k: usize| [0, 1, 2].map(|l| t[(k + l) % 3].position);
    let (of_a, of_b) = (turned(a, i), turned(b, j));
    has_separating_side_at_corner(&of_a, &of_b) || has_separating_side_at_corner(&of_b, &of_a)
}

/// The same for triangles whose first corner is the common one: the others of the one lie beyond a side of the other, one of them
/// perhaps in the line of that side, past the corner.
fn has_separating_side_at_corner(triangle: &[[f64; 3]; 3], other: &[[f64; 3]; 3]) -> bool {
    let seen = Projection::of(triangle);
    let ([v, p, q], [_, r, s]) = (triangle.map(|p| seen.project(&p)), other.map(|p| seen.project(&p)));
    let is_beyond = |from: [f64; 2], to: [f64; 2], end: [f64; 2]| {
        let [x, y] = [r, s].map(|point| (orient2d(from, to, point), point));
        let is_past = |(side, point): (Sign, [f64; 2])| {
            side == Sign::Negative || (side == Sign::Zero && are_opposite(v, end, point))
        };
        is_past(x) && is_past(y) && (x.0 == Sign::Negative || y.0 == Sign::Negative)
    };
    // A triangle that is seen as a line separates nothing.
    orient2d(v, p, q) == Sign::Positive && (is_beyond(v, p, p) || is_beyond(q, v, q))
}

/// Whether two points of a line through v lie on different sides of v.
fn are_opposite(v: [f64; 2], x: [f64; 2], y: [f64; 2]) -> bool {
    (0..2).any(|k| (x[k] > v[k] && y[k] < v[k]) || (x[k] < v[k] && y[k] > v[k]))
}

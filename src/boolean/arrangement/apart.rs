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

/// Whether two triangles certainly have no point in common: as [`are_apart`], and where they touch the same line from its two sides,
/// as faces in one plane do, at different places of it.
pub(super) fn are_disjoint(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> bool {
    has_side_that_keeps_off(a, b) || has_side_that_keeps_off(b, a)
}

/// Whether all of `other` lies beyond a side of a triangle, or on its line beyond its ends, seen along the axis that the triangle looks
/// along most.
fn has_side_that_keeps_off(triangle: &[[f64; 3]; 3], other: &[[f64; 3]; 3]) -> bool {
    let seen = Projection::of(triangle);
    let (t, o) = (triangle.map(|p| seen.project(&p)), other.map(|p| seen.project(&p)));
    // One that is seen as a line reaches beyond the ends of its sides.
    orient2d(t[0], t[1], t[2]) == Sign::Positive
        && (0..3).any(|k| {
            let (p, q) = (t[k], t[(k + 1) % 3]);
            let sides = o.map(|x| orient2d(p, q, x));
            let axis = usize::from(p[0] == q[0]);
            let (low, high) = (p[axis].min(q[axis]), p[axis].max(q[axis]));
            let on_line =
                || o.iter().zip(sides).filter(|(_, side)| *side == Sign::Zero).map(|(x, _)| x[axis]);
            sides.iter().all(|&side| side != Sign::Positive)
                && (on_line().all(|x| x < low) || on_line().all(|x| x > high))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_of_one_plane_on_two_sides_of_a_line_keep_off() {
        let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let below = |x: f64, width: f64| [[x, 0.0, 0.0], [x + 0.5 * width, -1.0, 0.0], [x + width, 0.0, 0.0]];
        // On the line of a side: beyond its end, from its end on, along it.
        for (other, expected) in [
            (below(1.5, 1.0), true),
            (below(-2.0, 1.0), true),
            (below(1.0, 1.0), false),
            (below(-1.0, 1.0), false),
            (below(0.25, 0.5), false),
            (below(-1.0, 3.0), false),
        ] {
            assert_eq!(are_disjoint(&triangle, &other), expected, "{other:?}");
            assert_eq!(are_disjoint(&other, &triangle), expected, "{other:?}");
        }
        // Over one another, and one that is seen as a line.
        let over = triangle.map(|[x, y, _]| [x, y, 1.0]);
        assert!(!are_disjoint(&triangle, &over));
        let wall = [[1.5, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 0.0, 1.0]];
        assert!(are_disjoint(&triangle, &wall));
    }
}

//! Triangles that are plainly apart: no perturbation can make them cross.
//!
//! Seen along an axis, two triangles that a line separates have nothing in common, whether they lie in one plane or not. That is
//! decided by plane coordinates, for a small part of what a tie of four coplanar points costs.

use smallvec::SmallVec;

use crate::boolean::complex::Corner;
use crate::boolean::complex::predicates::Predicates;
use crate::exact::{Projection, Sign, orient2d, orient3d};

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
/// as faces in one plane do, or the one touches the plane of the other, at different places of it.
pub(super) fn are_disjoint(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> bool {
    let seen_a = View::new(a);
    if seen_a.has_side_that_keeps_off(b) {
        return true;
    }
    let seen_b = View::new(b);
    seen_b.has_side_that_keeps_off(a)
        || seen_a.has_plane_that_keeps_off(b)
        || seen_b.has_plane_that_keeps_off(a)
}

/// A triangle seen along an axis that it looks along.
struct View<'a> {
    corners: &'a [[f64; 3]; 3],
    seen: Projection,
    /// Its corners as they are seen.
    t: [[f64; 2]; 3],
    /// Whether it is seen from the front. One that is seen as a line reaches beyond the ends of its sides.
    is_front: bool,
}

impl<'a> View<'a> {
    #[inline]
    fn new(corners: &'a [[f64; 3]; 3]) -> Self {
        let seen = Projection::roughly_of(corners);
        let [a, b, c] = corners;
        let t = [seen.project(a), seen.project(b), seen.project(c)];
        Self { corners, seen, t, is_front: orient2d(t[0], t[1], t[2]) == Sign::Positive }
    }

    /// Whether all of `other` lies beyond a side of the triangle, or on its line beyond its ends.
    fn has_side_that_keeps_off(&self, other: &[[f64; 3]; 3]) -> bool {
        let [x, y, z] = other;
        let o = [self.seen.project(x), self.seen.project(y), self.seen.project(z)];
        let keeps_off = |k: usize| {
            let (p, q) = (self.t[k], self.t[(k + 1) % 3]);
            let mut on_line = SmallVec::<[[f64; 2]; 3]>::new();
            for x in o {
                match orient2d(p, q, x) {
                    Sign::Positive => return false,
                    Sign::Zero => on_line.push(x),
                    Sign::Negative => {}
                }
            }
            let axis = usize::from(p[0] == q[0]);
            let (low, high) = (p[axis].min(q[axis]), p[axis].max(q[axis]));
            on_line.iter().all(|x| x[axis] < low) || on_line.iter().all(|x| x[axis] > high)
        };
        self.is_front && (0..3).any(keeps_off)
    }

    /// Whether all of `other` lies on one side of the triangle's plane, and what of it lies in the plane beside the triangle: as a wall on
    /// a floor does, whose corner is no corner of the floor's triangle.
    fn has_plane_that_keeps_off(&self, other: &[[f64; 3]; 3]) -> bool {
        let ([a, b, c], t) = (self.corners, &self.t);
        if !self.is_front {
            return false;
        }
        // (Nearly always the first two tell.)
        let (mut sides, mut seen) = ([Sign::Zero; 3], Sign::Zero);
        for (side, x) in sides.iter_mut().zip(other) {
            *side = orient3d(a, b, c, x);
            if *side != Sign::Zero && seen != Sign::Zero && *side != seen {
                return false;
            }
            seen = if *side == Sign::Zero { seen } else { *side };
        }
        let in_plane = other.iter().zip(sides).filter(|(_, side)| *side == Sign::Zero);
        let in_plane: SmallVec<[[f64; 2]; 3]> = in_plane.map(|(x, _)| self.seen.project(x)).collect();
        // (Nothing lies beyond every line.)
        let beyond = |p: [f64; 2], q: [f64; 2]| in_plane.iter().all(|x| orient2d(p, q, *x) == Sign::Negative);
        let is_beyond_side = || (0..3).any(|k| beyond(t[k], t[(k + 1) % 3]));
        match in_plane.as_slice() {
            &[p, q] => {
                let sides = t.map(|corner| orient2d(p, q, corner));
                (sides[0] != Sign::Zero && sides == [sides[0]; 3]) || is_beyond_side()
            }
            // In one plane, sides alone tell.
            [_, _, _] => false,
            _ => is_beyond_side(),
        }
    }
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
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    type Point = [i64; 3];

    fn difference(a: Point, b: Point) -> Point {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }

    fn cross(u: Point, v: Point) -> Point {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    }

    fn dot(u: Point, v: Point) -> i64 {
        u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    }

    /// Whether a triangle of integers has the point `x / d` of its plane in it.
    fn contains(t: &[Point; 3], x: Point, d: i64) -> bool {
        let n = cross(difference(t[1], t[0]), difference(t[2], t[0]));
        (0..3).all(|k| {
            let (p, q) = (t[k], t[(k + 1) % 3]);
            let from = difference(x, p.map(|c| c * d));
            dot(cross(difference(q, p), from), n) * d.signum() >= 0
        })
    }

    /// Whether a segment and a triangle, both of integers, have a point in common.
    fn meets(t: &[Point; 3], p: Point, q: Point) -> bool {
        let n = cross(difference(t[1], t[0]), difference(t[2], t[0]));
        let [from, to] = [p, q].map(|end| dot(n, difference(end, t[0])));
        if from == 0 && to == 0 {
            // In the plane: an end in the triangle, or a side of it is crossed.
            let crosses = |k: usize| {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                let side = |u: Point, v: Point, x: Point| dot(cross(difference(v, u), difference(x, u)), n);
                // (Where all lie in one line, their places on it tell.)
                let overlap =
                    (0..3).all(|k| a[k].min(b[k]) <= p[k].max(q[k]) && p[k].min(q[k]) <= a[k].max(b[k]));
                overlap
                    && side(a, b, p).signum() * side(a, b, q).signum() <= 0
                    && side(p, q, a).signum() * side(p, q, b).signum() <= 0
            };
            return contains(t, p, 1) || contains(t, q, 1) || (0..3).any(crosses);
        }
        if from.signum() * to.signum() > 0 {
            return false;
        }
        let x = std::array::from_fn(|k| from * q[k] - to * p[k]);
        contains(t, x, from - to)
    }

    #[test]
    fn what_is_disjoint_has_nothing_in_common() {
        let mut random = ChaCha8Rng::seed_from_u64(2_811);
        let (mut disjoint, mut apart, mut meeting) = (0, 0, 0);
        for round in 0..60_000 {
            let size = [2, 3, 5][round % 3];
            let mut triangle = || loop {
                let t: [Point; 3] =
                    std::array::from_fn(|_| std::array::from_fn(|_| random.random_range(0..size)));
                if cross(difference(t[1], t[0]), difference(t[2], t[0])) != [0; 3] {
                    return t;
                }
            };
            let (s, t) = (triangle(), triangle());
            let meet = (0..3).any(|k| meets(&s, t[k], t[(k + 1) % 3]) || meets(&t, s[k], s[(k + 1) % 3]));
            let [a, b] = [s, t].map(|t| t.map(|p| p.map(|x| x as f64)));
            let found = are_disjoint(&a, &b);
            assert!(!found || !meet, "{s:?} {t:?}");
            (disjoint, apart, meeting) =
                (disjoint + u32::from(found), apart + u32::from(!meet), meeting + u32::from(meet));
        }
        assert!(disjoint > apart * 9 / 10 && meeting > 10_000, "{disjoint} of {apart}, {meeting} meet");
    }

    #[test]
    fn a_wall_beside_a_triangle_of_its_floor_keeps_off() {
        let floor = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 2.0, 0.0]];
        let wall = |x: f64, to: f64| [[x, 0.5, 0.0], [x, 0.5, 3.0], [to, 0.0, 3.0]];
        assert!(are_disjoint(&floor, &wall(2.0, 0.5)) && are_disjoint(&wall(2.0, 0.5), &floor));
        assert!(!are_disjoint(&floor, &wall(0.5, 2.0)) && !are_disjoint(&wall(0.5, 2.0), &floor));
        // Standing on an edge, beside it and across.
        let standing = |x: f64| [[x, -1.0, 0.0], [x, 3.0, 0.0], [0.5, 1.0, 3.0]];
        assert!(are_disjoint(&floor, &standing(2.5)) && !are_disjoint(&floor, &standing(1.0)));
    }

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
        // Over one another: apart, but through one another; and one that is seen as a line.
        let over = |z: f64| triangle.map(|[x, y, _]| [x, y, z + 0.5 * x]);
        assert!(are_disjoint(&triangle, &over(1.0)) && !are_disjoint(&triangle, &over(-0.25)));
        let wall = [[1.5, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 0.0, 1.0]];
        assert!(are_disjoint(&triangle, &wall));
    }
}

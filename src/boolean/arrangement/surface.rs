//! How two triangles of one surface meet: whether they cross, how deep, and what counts as rounding there.

use std::sync::OnceLock;

use super::apart::{are_plainly_apart, common_corners};
use super::penetration;
use super::self_pairs::tree_of;
use crate::Mesh;
use crate::boolean::complex::planes;
use crate::boolean::complex::predicates::Predicates;
use crate::boolean::complex::{Complex, Corner};
use crate::exact::at_hand::{largest_coordinate, size_at_hand};
use crate::exact::{Sign, orient3d};
use crate::mesh::{Bounds, SelfCrossing};
use crate::parallel::get_or_compute;
use crate::spatial::{BoxTree, Frame};

/// Units in the last place of the coordinates at hand that a rounding-level crossing may be deep. Each of two rounded
/// surfaces is off by less than one in every direction.
const TOLERATED_ULPS: f64 = 8.0;
/// A crossing up to so many times deeper than what is tolerated is shallow. (Chains of twenty operations on real models have
/// left crossings of 5.7e-15 at coordinates of size one, three times the tolerance.)
const SHALLOW: f64 = 64.0;
/// The depth up to which a crossing counts as rounding, as a part of the coordinates there.
pub(super) fn tolerance_of_one(positions: &[[f64; 3]]) -> f64 {
    let single = positions.iter().flatten().all(|&x| f64::from(x as f32) == x);
    let epsilon = if single { f64::from(f32::EPSILON) } else { f64::EPSILON };
    TOLERATED_ULPS * epsilon
}

/// What two triangles have in common.
pub(super) enum Found {
    Crossing(Crossing),
    /// They lie on each other in one plane.
    Touching,
}

/// A crossing of two triangles.
pub(super) struct Crossing {
    pub(super) crossing: SelfCrossing,
    /// What both triangles have in common, roughly; `None` where they are one and the same.
    pub(super) segment: Option<[[f64; 3]; 2]>,
    /// The depth that counts as rounding there.
    pub(super) tolerance: f64,
}

impl Crossing {
    /// Whether it is deeper than what a chain of operations may leave.
    pub(super) fn is_deep(&self) -> bool {
        self.segment.is_none() || self.crossing.depth > SHALLOW * self.tolerance
    }

    /// Whether it is deeper than what is tolerated.
    pub(super) fn is_deeper_than_rounding(&self) -> bool {
        self.segment.is_none() || self.crossing.depth > self.tolerance
    }
}

/// A surface to be tested against itself.
pub(super) struct Surface<'a> {
    pub(super) complex: &'a Complex<'a>,
    pub(super) predicates: Predicates<'a>,
    mesh: &'a Mesh,
    /// The boxes of all triangles, made when first asked for.
    tree: OnceLock<BoxTree>,
    pub(super) frame: Frame,
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// What is tolerated at coordinates of size one.
    part: f64,
    /// The largest coordinate.
    largest: f64,
}

impl<'a> Surface<'a> {
    /// The complex is of that mesh alone.
    pub(super) fn new(complex: &'a Complex<'a>, mesh: &'a Mesh, bounds: &Bounds, part: f64) -> Self {
        Self {
            complex,
            predicates: Predicates::new(complex),
            mesh,
            tree: OnceLock::new(),
            frame: Frame::of(bounds.low, bounds.high),
            low: bounds.low,
            high: bounds.high,
            part,
            largest: bounds.largest(),
        }
    }

    /// With the boxes of all triangles, if they are there.
    pub(super) fn with_tree(self, tree: Option<BoxTree>) -> Self {
        Self { tree: tree.map_or_else(OnceLock::new, OnceLock::from), ..self }
    }

    /// The boxes of all triangles. (Asked for before loops over threads, of which each would make its own.)
    pub(super) fn tree(&self) -> &BoxTree {
        get_or_compute(&self.tree, || tree_of(self.mesh, &self.frame))
    }

    /// The crossing of a pair of triangles, if they cross.
    pub(super) fn examine(&self, pair: [u32; 2]) -> Option<Found> {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t));
        if are_plainly_apart(&self.predicates, &a, &b) {
            return None;
        }
        if let Some(crossing) = self.examine_closely(pair, &a, &b) {
            return Some(Found::Crossing(crossing));
        }
        self.lie_on_each_other(pair).then_some(Found::Touching)
    }

    /// Whether two triangles cross or lie on each other, however little.
    pub(super) fn has_crossing(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t));
        if are_plainly_apart(&self.predicates, &a, &b) {
            return false;
        }
        let crosses = match common_corners(&a, &b).as_slice() {
            [] => self.crossing(&a, &b).is_some(),
            &[corners] => self.crossing_at_common_corner(&a, &b, corners).is_some(),
            corners => corners.len() > 2,
        };
        crosses || self.lie_on_each_other(pair)
    }

    /// Whether two triangles have a point in common that is inside both, or area, just as they are: nothing is moved, not by the smallest of moves.
    pub(super) fn crosses_as_given(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t).map(|corner| corner.position));
        interiors_cross(&a, &b) || planes::lie_on_each_other(&a, &b)
    }

    /// Whether two triangles lie in one plane and overlap.
    fn lie_on_each_other(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t).map(|corner| corner.position));
        planes::lie_on_each_other(&a, &b)
    }

    /// The crossing of a pair that is not plainly apart, if they cross.
    pub(super) fn examine_closely(
        &self,
        pair: [u32; 2],
        a: &[Corner; 3],
        b: &[Corner; 3],
    ) -> Option<Crossing> {
        let segment = match common_corners(a, b).as_slice() {
            [] => self.crossing(a, b)?,
            &[corners] => self.crossing_at_common_corner(a, b, corners)?,
            corners if corners.len() == 2 => return None,
            _ => {
                // The same triangle twice. (Opposite copies are left out of every solid.)
                let place = a[0].position;
                let crossing = SelfCrossing { triangles: pair, place, depth: 0.0 };
                return Some(Crossing { crossing, segment: None, tolerance: 0.0 });
            }
        };
        let depth = penetration::penetration(&positions(a), &positions(b)).max(0.0);
        let depth = depth.min(distance(&segment[0], &segment[1]));
        let place = std::array::from_fn(|k| 0.5 * segment[0][k] + 0.5 * segment[1][k]);
        let own = largest_coordinate(&segment[0]).max(largest_coordinate(&segment[1]));
        let tolerance = self.part * size_at_hand(self.largest, own);
        let rounding = penetration::rounding(&positions(a), &positions(b));
        let tolerance = rounding.map_or(tolerance, |moved| tolerance.max(TOLERATED_ULPS * moved));
        let crossing = SelfCrossing { triangles: pair, place, depth };
        Some(Crossing { crossing, segment: Some(segment), tolerance })
    }

    /// The ends of the segment in which two triangles without common corners meet, roughly.
    fn crossing(&self, a: &[Corner; 3], b: &[Corner; 3]) -> Option<[[f64; 3]; 2]> {
        let a_inside = [0, 1, 2].map(|i| self.predicates.is_positive(&b[0], &b[1], &b[2], &a[i]));
        if a_inside == [a_inside[0]; 3] {
            return None;
        }
        let b_inside = [0, 1, 2].map(|i| self.predicates.is_positive(&a[0], &a[1], &a[2], &b[i]));
        if b_inside == [b_inside[0]; 3] {
            return None;
        }
        let mut ends = Vec::with_capacity(2);
        for (t, inside, plane) in [(a, a_inside, b), (b, b_inside, a)] {
            for k in 0..3 {
                let (p, q) = (&t[k], &t[(k + 1) % 3]);
                if inside[k] != inside[(k + 1) % 3] && self.predicates.passes(p, q, plane) {
                    ends.push(meeting(&p.position, &q.position, plane));
                }
            }
        }
        ends.try_into().ok()
    }

    /// As [`crossing`](Self::crossing), for triangles with one corner in common: one of the sides opposite it must pass the
    /// other triangle.
    fn crossing_at_common_corner(
        &self,
        a: &[Corner; 3],
        b: &[Corner; 3],
        (i, j): (usize, usize),
    ) -> Option<[[f64; 3]; 2]> {
        for (t, k, plane) in [(a, i, b), (b, j, a)] {
            let (p, q) = (&t[(k + 1) % 3], &t[(k + 2) % 3]);
            let inside = |x: &Corner| self.predicates.is_positive(&plane[0], &plane[1], &plane[2], x);
            if inside(p) != inside(q) && self.predicates.passes(p, q, plane) {
                return Some([t[k].position, meeting(&p.position, &q.position, plane)]);
            }
        }
        None
    }
}

/// Whether two triangles that do not lie in one plane have a point in common that is inside both, exactly.
fn interiors_cross(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> bool {
    // 1. Each passes the plane of the other: some corner is alone on its side, and two edges leave it.
    let alone = |t: &[[f64; 3]; 3], plane: &[[f64; 3]; 3]| {
        let sides = t.map(|corner| orient3d(&plane[0], &plane[1], &plane[2], &corner));
        if !(sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative)) {
            return None;
        }
        let is_alone = |&k: &usize| {
            sides[k] != Sign::Zero && sides[(k + 1) % 3] != sides[k] && sides[(k + 2) % 3] != sides[k]
        };
        (0..3).find(is_alone)
    };
    let (Some(i), Some(j)) = (alone(a, b), alone(b, a)) else { return false };
    // 2. In the line of both planes each has an interval between its two edges. How an end of the one lies to an end of the other is how
    //    the two edges wind around each other, all four ways alike; the intervals overlap where it is not the same for all.
    let (mut before, mut after) = (false, false);
    for p in [a[(i + 1) % 3], a[(i + 2) % 3]] {
        for q in [b[(j + 1) % 3], b[(j + 2) % 3]] {
            match orient3d(&a[i], &p, &b[j], &q) {
                Sign::Positive => before = true,
                Sign::Negative => after = true,
                Sign::Zero => {}
            }
        }
    }
    before && after
}

pub(super) fn height(normal: &[f64; 3], origin: &[f64; 3], point: &[f64; 3]) -> f64 {
    (0..3).map(|k| normal[k] * (point[k] - origin[k])).sum()
}

pub(super) fn norm(v: &[f64; 3]) -> f64 {
    let size = v.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    if size == 0.0 { 0.0 } else { size * v.iter().map(|x| (x / size).powi(2)).sum::<f64>().sqrt() }
}

fn distance(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    norm(&std::array::from_fn(|k| q[k] - p[k]))
}

pub(super) fn unit_normal(t: &[Corner; 3]) -> Option<[f64; 3]> {
    penetration::unit_normal(&positions(t))
}

pub(super) fn positions(t: &[Corner; 3]) -> [[f64; 3]; 3] {
    t.each_ref().map(|corner| corner.position)
}

/// Where a line passes a plane, roughly.
fn meeting(p: &[f64; 3], q: &[f64; 3], plane: &[Corner; 3]) -> [f64; 3] {
    let Some(normal) = unit_normal(plane) else { return *p };
    let (from, to) = (height(&normal, &plane[0].position, p), height(&normal, &plane[0].position, q));
    let t = if from == to { 0.5 } else { (from / (from - to)).clamp(0.0, 1.0) };
    std::array::from_fn(|k| p[k] + t * (q[k] - p[k]))
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    type Vector = [i128; 3];

    fn minus(p: Vector, q: Vector) -> Vector {
        std::array::from_fn(|k| p[k] - q[k])
    }

    fn cross(u: Vector, v: Vector) -> Vector {
        std::array::from_fn(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3])
    }

    fn dot(u: Vector, v: Vector) -> i128 {
        (0..3).map(|k| u[k] * v[k]).sum()
    }

    /// Where a triangle meets a plane that it passes, along a direction: the ends, as fractions with positive denominators.
    fn interval(t: [Vector; 3], origin: Vector, normal: Vector, along: Vector) -> Option<[(i128, i128); 2]> {
        let heights = t.map(|corner| dot(normal, minus(corner, origin)));
        if !(heights.iter().any(|&h| h > 0) && heights.iter().any(|&h| h < 0)) {
            return None;
        }
        let mut ends: Vec<(i128, i128)> = Vec::new();
        for k in 0..3 {
            let (p, q, hp, hq) = (t[k], t[(k + 1) % 3], heights[k], heights[(k + 1) % 3]);
            if hp == 0 {
                ends.push((dot(along, p), 1));
            } else if hp * hq < 0 {
                // p + (q - p) hp / (hp - hq)
                let (n, d) = (dot(along, p) * (hp - hq) + dot(along, minus(q, p)) * hp, hp - hq);
                ends.push(if d > 0 { (n, d) } else { (-n, -d) });
            }
        }
        ends.sort_by(|x, y| (x.0 * y.1).cmp(&(y.0 * x.1)));
        Some([ends[0], ends[ends.len() - 1]])
    }

    #[test]
    fn interiors_cross_as_fractions_say() {
        let mut random = ChaCha8Rng::seed_from_u64(1_519);
        let (mut crossing, mut touching) = (0, 0);
        for round in 0..60_000 {
            // On so few places that corners, edges and planes coincide often.
            let size = [2, 3, 5][round % 3];
            let mut triangle = || [0; 3].map(|_| [0; 3].map(|_| random.random_range(0..=size)));
            let (a, b): ([Vector; 3], [Vector; 3]) = (triangle(), triangle());
            let normal = |t: [Vector; 3]| cross(minus(t[1], t[0]), minus(t[2], t[0]));
            let (m, n) = (normal(a), normal(b));
            if m == [0; 3] || n == [0; 3] {
                continue;
            }
            let along = cross(m, n);
            let both = interval(a, b[0], n, along).zip(interval(b, a[0], m, along));
            let less = |x: (i128, i128), y: (i128, i128)| x.0 * y.1 < y.0 * x.1;
            let expected = both.is_some_and(|([a, b], [c, d])| less(a, d) && less(c, b));
            let places = |t: [Vector; 3]| t.map(|corner| corner.map(|x| x as f64));
            assert_eq!(interiors_cross(&places(a), &places(b)), expected, "{a:?} {b:?}");
            crossing += u32::from(expected);
            touching +=
                u32::from(both.is_some_and(|([a, b], [c, d])| {
                    !less(a, d) && !less(d, a) || !less(c, b) && !less(b, c)
                }));
        }
        assert!(crossing > 2_000 && touching > 200, "{crossing} {touching}");
    }
}

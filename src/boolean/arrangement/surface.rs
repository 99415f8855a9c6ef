//! How two triangles of one surface meet: whether they cross, how deep, and what counts as rounding there.

use super::apart::{are_plainly_apart, common_corners};
use super::penetration;
use crate::boolean::complex::planes;
use crate::boolean::complex::predicates::Predicates;
use crate::boolean::complex::{Complex, Corner};
use crate::exact::at_hand::{largest_coordinate, size_at_hand};
use crate::mesh::{Bounds, SelfCrossing};
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
    pub(super) tree: BoxTree,
    pub(super) frame: Frame,
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    /// What is tolerated at coordinates of size one.
    part: f64,
    /// The largest coordinate.
    largest: f64,
}

impl<'a> Surface<'a> {
    pub(super) fn new(
        complex: &'a Complex<'a>,
        tree: BoxTree,
        frame: Frame,
        bounds: &Bounds,
        part: f64,
    ) -> Self {
        Self {
            complex,
            predicates: Predicates::new(complex),
            tree,
            frame,
            low: bounds.low,
            high: bounds.high,
            part,
            largest: bounds.largest(),
        }
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

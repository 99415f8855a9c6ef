//! What rounding can have done to edges and triangles, by the sizes of their own coordinates.

use glam::DVec3;

use crate::exact::at_hand::{ROUNDING_ULPS, largest_beside, largest_coordinate, size_at_hand};
use crate::mesh::scale;

/// Lengths and heights that rounding alone can give to edges and triangles: up to [`ROUNDING_ULPS`] units in the last place of
/// the coordinates at hand.
///
/// The largest coordinate of all says no at once, nearly always; only what is left is looked at where it is. All of this holds
/// for any finite coordinates: squares neither overflow nor vanish.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rounding {
    /// The largest coordinate of both operands.
    largest: f64,
    /// The distance from 1 to the next number that coordinates are rounded to.
    unit: f64,
}

/// A question about the height of a triangle.
pub(crate) type IsLow = fn(&Rounding, [&[f64; 3]; 3]) -> bool;

impl Rounding {
    /// For points whose coordinates are no larger than this.
    pub(crate) fn up_to(largest: f64) -> Self {
        Self { largest, unit: f64::EPSILON }
    }

    /// The same for coordinates that are rounded to a coarser grid: `unit` is the distance from 1 to the next number there.
    pub(crate) fn in_units_of(self, unit: f64) -> Self {
        Self { unit, ..self }
    }

    /// Whether two points are no further apart along each axis than rounding.
    #[inline]
    pub(crate) fn is_short(&self, p: &[f64; 3], q: &[f64; 3]) -> bool {
        let longest = (0..3).fold(0.0f64, |longest, k| longest.max((p[k] - q[k]).abs()));
        let length = |size: f64| ROUNDING_ULPS * self.unit * size;
        let own = || largest_coordinate(p).max(largest_coordinate(q));
        longest <= length(self.largest) && longest <= length(size_at_hand(self.largest, own()))
    }

    /// The length that rounding can give to anything.
    #[inline]
    pub(crate) fn longest(&self) -> f64 {
        ROUNDING_ULPS * self.unit * self.largest
    }

    /// The length that rounding can give to something at a point.
    #[inline]
    pub(crate) fn length_at(&self, point: &[f64; 3]) -> f64 {
        ROUNDING_ULPS * self.unit * size_at_hand(self.largest, largest_coordinate(point))
    }

    /// Whether a triangle is no higher over its longest side than rounding.
    #[inline]
    pub(crate) fn is_low(&self, corners: [&[f64; 3]; 3]) -> bool {
        self.is_lower(corners, ROUNDING_ULPS)
    }

    /// Whether a triangle has no height in `f64` arithmetic.
    #[inline]
    pub(crate) fn has_no_height(&self, corners: [&[f64; 3]; 3]) -> bool {
        self.is_lower(corners, 0.0)
    }

    /// Whether a triangle is no higher over its longest side than so many units in the last place.
    #[inline]
    fn is_lower(&self, corners: [&[f64; 3]; 3], ulps: f64) -> bool {
        // 1. Nearly always no, by the largest coordinate there is. (What is not a number is looked at again.)
        let corners = corners.map(|corner| DVec3::from_array(*corner));
        let (area, longest) = twice_area_and_longest_side(corners);
        let height = ulps * self.unit * self.largest;
        if area > height * height * longest {
            return false;
        }
        self.is_lower_where_it_is(corners, ulps)
    }

    /// The same by the coordinates at the corner over the longest side.
    #[inline(never)]
    fn is_lower_where_it_is(&self, corners: [DVec3; 3], ulps: f64) -> bool {
        let (factor, [a, b, c]) = near_one(corners);
        let (area, longest) = twice_area_and_longest_side([a, b, c]);
        let [from, middle, to] = match longest {
            side if side == a.distance_squared(b) => [a, c, b],
            side if side == b.distance_squared(c) => [b, a, c],
            _ => [c, b, a],
        };
        let size = self.size_beside(from, middle, to, factor);
        let height = ulps * self.unit * size;
        if is_far(longest, size) {
            return is_within(height, from, middle, to);
        }
        area <= height * height * longest
    }

    /// Whether a point is no further from the line through two others than rounding can move all three.
    pub(crate) fn is_near_line(&self, p: &[f64; 3], at: &[f64; 3], q: &[f64; 3]) -> bool {
        let (factor, [from, middle, to]) = near_one([p, at, q].map(|point| DVec3::from_array(*point)));
        let (size, longest) = (self.size_beside(from, middle, to, factor), from.distance_squared(to));
        let distance = 2.0 * ROUNDING_ULPS * self.unit * size;
        if is_far(longest, size) {
            return is_within(distance, from, middle, to);
        }
        (to - from).cross(middle - from).length_squared() <= distance * distance * longest
    }

    /// The size that rounding is measured by beside a point near the line between two others, all multiplied by `factor`.
    fn size_beside(&self, from: DVec3, middle: DVec3, to: DVec3, factor: f64) -> f64 {
        let along = to - from;
        let part = (middle - from).dot(along) / along.length_squared();
        let [from, middle, to] = [from, middle, to].map(|point| point.to_array());
        size_at_hand(self.largest * factor, largest_beside(&from, &middle, &to, part))
    }
}

/// A number that rises with the distance of two points, for comparing distances: the bits of its square, or of the distance
/// itself where an `f64` cannot hold the square.
pub(crate) fn distance_order(p: &[f64; 3], q: &[f64; 3]) -> u128 {
    const TINY: f64 = f64::MIN_POSITIVE / f64::EPSILON;
    let squared = DVec3::from_array(*p).distance_squared(DVec3::from_array(*q));
    let ordered = |class: u128, x: f64| class << 64 | u128::from(x.to_bits());
    if (TINY..f64::INFINITY).contains(&squared) {
        return ordered(1, squared);
    }
    // Quarters of huge numbers, so that the distance of two is finite.
    let (class, part) = if squared < TINY { (0, 1.0) } else { (2, 0.25) };
    let [x, y, z] = [0, 1, 2].map(|k| part * p[k] - part * q[k]);
    ordered(class, x.hypot(y).hypot(z))
}

/// The power of two that brings the corners of a triangle near one in size, where they are far from it, and the corners so.
fn near_one(corners: [DVec3; 3]) -> (f64, [DVec3; 3]) {
    let largest = corners.iter().fold(0.0f64, |largest, corner| largest.max(corner.abs().max_element()));
    let factor = scale::factor(largest);
    (factor, corners.map(|corner| corner * factor))
}

/// Whether the longest side, squared, is so long beside the size of coordinates that a far corner takes the digits of a near one.
fn is_far(longest: f64, size: f64) -> bool {
    longest > 16.0 * size * size
}

/// Whether the third corner of a triangle is within a distance of its longest side, where that is long beside the size of the
/// coordinates at the third corner. From the end that is nearer to that corner, and without squares, which would vanish.
fn is_within(distance: f64, from: DVec3, middle: DVec3, to: DVec3) -> bool {
    let (before, after) = (middle - from, to - middle);
    let shorter = if length(before) <= length(after) { before } else { after };
    length((to - from).cross(shorter)) <= distance * length(to - from)
}

/// The length of a vector whose square an `f64` need not hold.
fn length(vector: DVec3) -> f64 {
    let [x, y, z] = vector.to_array();
    x.hypot(y).hypot(z)
}

/// The squares of the doubled area of a triangle, and of its longest side.
#[inline]
fn twice_area_and_longest_side([a, b, c]: [DVec3; 3]) -> (f64, f64) {
    let (u, v, w) = (b - a, c - b, a - c);
    (u.cross(v).length_squared(), u.length_squared().max(v.length_squared()).max(w.length_squared()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: [f64; 7] = [1e-300, 1e-160, 1e-80, 1.0, 1e80, 1e160, 1e300];

    #[test]
    fn heights_are_measured_where_the_triangle_is() {
        for scale in SCALES {
            let triangle =
                |apex: [f64; 3]| [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], apex].map(|p| p.map(|x| x * scale));
            let (low, high) = (triangle([1.5, 1e-16, 0.0]), triangle([1.5, 1e-13, 0.0]));
            let rounding = Rounding::up_to(2.0 * scale);
            assert!(rounding.is_low(low.each_ref()) && !rounding.is_low(high.each_ref()), "{scale:e}");
            assert!(!rounding.has_no_height(low.each_ref()), "{scale:e}");
            // Beside something huge it is what it was.
            let rounding = Rounding::up_to(f64::MAX);
            assert!(rounding.is_low(low.each_ref()) && !rounding.is_low(high.each_ref()), "{scale:e}");
        }
    }

    #[test]
    fn a_far_corner_does_not_make_a_triangle_low() {
        // A hole of one unit in a face of 1e38.
        let [far, p, q] = [[-1e38, -1e38, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let rounding = Rounding::up_to(1e38);
        assert!(!rounding.is_low([&far, &p, &q]));
        assert!(!rounding.is_short(&p, &q));
        assert!(!rounding.is_near_line(&far, &p, &q));
        assert!(rounding.is_low([&far, &p, &[1.0, 1e-16, 0.0]]));
        assert!(rounding.is_near_line(&[-1e38, 0.0, 0.0], &[0.5, 1e-16, 0.0], &[1.0, 0.0, 0.0]));
    }

    #[test]
    fn a_corner_so_far_that_squares_vanish_does_not_either() {
        // Between the near corners the squares of heights are below the smallest number beside the square of the side.
        for far in [1e160, 1e189, 1e300] {
            let [far, p, q] = [[-2.0 * far, far, -far], [-0.3, 0.5, -0.8], [-0.4, 0.1, -0.7]];
            let rounding = Rounding::up_to(2.0 * far[1]);
            for corners in [[&far, &p, &q], [&p, &far, &q], [&q, &p, &far]] {
                assert!(!rounding.is_low(corners) && !rounding.has_no_height(corners), "{far:?}");
            }
            assert!(!rounding.is_near_line(&far, &p, &q));
            assert!(rounding.is_low([&far, &p, &p.map(|x| x * (1.0 + 2e-16))]));
        }
    }

    #[test]
    fn distances_are_in_order_at_any_size() {
        let mut before = 0;
        for scale in SCALES {
            for length in [1.0, 1.5, 2.0] {
                let order =
                    distance_order(&[-0.5 * length * scale, 0.0, 0.0], &[0.5 * length * scale, 0.0, 0.0]);
                assert!(order > before, "{scale:e} {length}");
                before = order;
            }
        }
        assert_eq!(distance_order(&[3.0; 3], &[3.0; 3]), 0);
    }
}

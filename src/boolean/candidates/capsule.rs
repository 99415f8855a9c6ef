//! Capsules round long triangles: two needles whose boxes meet hardly ever meet themselves.

use glam::Vec3A;

/// A triangle is a needle if its longest side is more than this many times its height.
const SLENDER: f32 = 8.0;
/// Widening of a capsule, in units of its largest coordinate: more than single precision loses in all steps together.
const MARGIN: f32 = 1e-4;
/// Widening of a capsule around two, in the same units.
const ROUNDING: f32 = 16.0 * f32::EPSILON;
/// Lines at an angle whose sine squared is less are taken for parallel.
const PARALLEL: f32 = 1e-4;
/// Coordinates count as at least this large, so that squares do not vanish unnoticed.
const TINY: f32 = 1e-12;

/// All within some distance of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    middle: Vec3A,
    /// Along the segment, of length 1.
    direction: Vec3A,
    radius: f32,
    half_length: f32,
}

impl Capsule {
    /// The capsule around the longest side of a triangle.
    pub(crate) fn of(corners: &[Vec3A; 3]) -> Self {
        let (length, p, q, r) = longest_side(corners);
        let largest = corners.iter().fold(0.0f32, |most, corner| most.max(corner.abs().max_element()));
        let direction = if length > 0.0 { (q - p) / length } else { Vec3A::X };
        Self {
            middle: 0.5 * p + 0.5 * q,
            direction,
            radius: (r - p).cross(direction).length() + MARGIN * largest.max(TINY),
            half_length: 0.5 * length,
        }
    }

    pub(crate) fn middle(&self) -> Vec3A {
        self.middle
    }

    pub(crate) fn direction(&self) -> Vec3A {
        self.direction
    }

    #[cfg(test)]
    pub(crate) fn radius(&self) -> f32 {
        self.radius
    }

    /// Whether this is much longer than wide.
    pub(crate) fn is_slender(&self) -> bool {
        2.0 * self.half_length > SLENDER * self.radius
    }

    /// How far it reaches from its middle.
    pub(crate) fn reach(&self) -> f32 {
        self.half_length + self.radius
    }

    /// A capsule around both.
    pub(crate) fn united(&self, other: &Self) -> Self {
        let longer = if self.half_length >= other.half_length { self } else { other };
        let between = (other.middle - self.middle).normalize_or(longer.direction);
        let (first, second) = (self.around(other, longer.direction), self.around(other, between));
        // The one with less room in it.
        let room = |capsule: &Self| capsule.radius * capsule.radius * capsule.reach();
        if room(&second) < room(&first) { second } else { first }
    }

    /// The capsule around both along a direction.
    fn around(&self, other: &Self, direction: Vec3A) -> Self {
        let ends = [self, other].map(|capsule| {
            let half = capsule.half_length * capsule.direction;
            [capsule.middle - half, capsule.middle + half]
        });
        let middle = 0.25 * ((ends[0][0] + ends[0][1]) + (ends[1][0] + ends[1][1]));
        let along = ends.map(|of_one| of_one.map(|end| (end - middle).dot(direction)));
        let low = along.iter().flatten().copied().fold(f32::INFINITY, f32::min);
        let high = along.iter().flatten().copied().fold(f32::NEG_INFINITY, f32::max);
        let mut radius = 0.0;
        for (capsule, ends) in [self, other].into_iter().zip(ends) {
            for end in ends {
                let needed = (end - middle).cross(direction).length() + capsule.radius;
                // What is undefined reaches everywhere.
                radius = if needed <= radius {
                    radius
                } else if needed.is_nan() {
                    f32::INFINITY
                } else {
                    needed
                };
            }
        }
        let middle = middle + 0.5 * (low + high) * direction;
        let half_length = 0.5 * (high - low);
        let largest = middle.abs().max_element() + half_length + radius;
        Self { middle, direction, radius: radius + ROUNDING * largest, half_length }
    }

    /// Whether two capsules are certainly apart. (What overflows or is undefined is not.)
    #[inline]
    pub(crate) fn is_apart(&self, other: &Self) -> bool {
        let between = self.middle - other.middle;
        let radii = self.radius + other.radius;
        // As far as two lines.
        let across = self.direction.cross(other.direction);
        let (distance, scale) = (between.dot(across), across.length_squared());
        if scale > PARALLEL && distance * distance > radii * radii * scale {
            return true;
        }
        // As far as a line and a ball around the other.
        let off_line = |direction: Vec3A, half_length: f32| {
            let reach = radii + half_length;
            between.cross(direction).length_squared() > reach * reach
        };
        off_line(self.direction, other.half_length) || off_line(other.direction, self.half_length)
    }
}

/// Whether a triangle is long and narrow and lies askew, so that its box is much wider than itself.
pub(crate) fn is_needle(corners: &[Vec3A; 3]) -> bool {
    let (length, p, q, r) = longest_side(corners);
    let area = (q - p).cross(r - p).length();
    let [x, y, z] = (p.max(q).max(r) - p.min(q).min(r)).to_array();
    // The second longest side of the box.
    let width = x.min(y).max(x.max(y).min(z));
    area * SLENDER < length * length && area * SLENDER < 2.0 * width * length
}

/// The length of the longest side, its ends, and the corner opposite.
fn longest_side(corners: &[Vec3A; 3]) -> (f32, Vec3A, Vec3A, Vec3A) {
    let length = |k: usize| (corners[(k + 1) % 3] - corners[k]).length();
    let lengths = [0, 1, 2].map(length);
    let k = (1..3).fold(0, |best, k| if lengths[k] > lengths[best] { k } else { best });
    (lengths[k], corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn what_is_apart_has_no_near_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let (mut apart, mut met) = (0, 0);
        for round in 0..3_000 {
            let mut point =
                |size: f32| Vec3A::from_array([(); 3].map(|()| size * rng.random_range(-1.0f32..1.0)));
            let mut triangle = || -> [Vec3A; 3] {
                let (p, along) = (point(1.0), point(1.0));
                [p, p + along, p + 0.3 * along + point(0.02)]
            };
            let (a, mut b) = (triangle(), triangle());
            if round % 2 == 0 {
                // They share a point.
                let moved = a[0] + 0.4 * (a[1] - a[0]) - (b[0] + 0.5 * (b[1] - b[0]));
                b = b.map(|corner| corner + moved);
            }
            let is_apart = Capsule::of(&a).is_apart(&Capsule::of(&b));
            assert!(round % 2 == 1 || !is_apart, "round {round}");
            // Nor has a capsule around others.
            let (united, third) = (Capsule::of(&a).united(&Capsule::of(&triangle())), Capsule::of(&b));
            assert!(is_apart || !united.is_apart(&third), "round {round}");
            assert!(is_apart || !united.united(&Capsule::of(&triangle())).is_apart(&third), "round {round}");
            apart += u32::from(is_apart);
            met += u32::from(!is_apart);
        }
        assert!(apart > 1_000 && met > 1_500, "{apart} {met}");
    }

    #[test]
    fn points_and_infinities_are_not_apart_from_themselves() {
        for corners in [[Vec3A::ONE; 3], [Vec3A::splat(1e30), Vec3A::splat(-1e30), Vec3A::ZERO]] {
            let capsule = Capsule::of(&corners);
            assert!(!capsule.is_apart(&capsule));
        }
    }

    #[test]
    fn needles_are_long_and_askew() {
        let triangle = |height: f32| [Vec3A::ZERO, Vec3A::ONE, Vec3A::new(0.5, 0.5 + height, 0.5)];
        assert!(is_needle(&triangle(0.1)) && !is_needle(&triangle(0.5)));
        // The box of one along an axis is as narrow as itself.
        assert!(!is_needle(&[Vec3A::ZERO, Vec3A::X, Vec3A::new(0.5, 0.1, 0.0)]));
    }
}

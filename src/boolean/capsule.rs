//! Capsules round long triangles: two needles whose boxes meet hardly ever meet themselves.

use glam::Vec3A;

/// A triangle is a needle if it is so many times as long as high.
const SLENDER: f32 = 8.0;
/// Widening of a capsule, in units of its largest coordinate: far more than single precision loses below.
const MARGIN: f32 = 1e-4;
/// Lines at an angle whose sine squared is less are taken for parallel.
const PARALLEL: f32 = 1e-4;
/// Coordinates count as at least this large, so that squares do not vanish unnoticed.
const TINY: f32 = 1e-12;

/// All within some distance of a segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capsule {
    middle: Vec3A,
    /// Along the segment, of length 1.
    direction: Vec3A,
    radius: f32,
    half_length: f32,
}

impl Capsule {
    /// The capsule round the longest side of a triangle.
    pub(super) fn of(corners: &[Vec3A; 3]) -> Self {
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

    /// Whether two capsules are certainly apart. (What overflows or is undefined is not.)
    #[inline]
    pub(super) fn is_apart(&self, other: &Self) -> bool {
        let between = self.middle - other.middle;
        let radii = self.radius + other.radius;
        // As far as two lines.
        let across = self.direction.cross(other.direction);
        let (distance, scale) = (between.dot(across), across.length_squared());
        if scale > PARALLEL && distance * distance > radii * radii * scale {
            return true;
        }
        // As far as a line and a ball round the other.
        let off_line = |direction: Vec3A, half_length: f32| {
            let reach = radii + half_length;
            between.cross(direction).length_squared() > reach * reach
        };
        off_line(self.direction, other.half_length) || off_line(other.direction, self.half_length)
    }
}

/// Whether a triangle is long and narrow.
pub(super) fn is_needle(corners: &[Vec3A; 3]) -> bool {
    let (length, p, q, r) = longest_side(corners);
    (q - p).cross(r - p).length() * SLENDER < length * length
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
    fn needles_are_long() {
        let triangle = |height: f32| [Vec3A::ZERO, Vec3A::X, Vec3A::new(0.5, height, 0.0)];
        assert!(is_needle(&triangle(0.1)) && !is_needle(&triangle(0.5)));
    }
}

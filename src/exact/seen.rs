//! Triangles seen along a direction, which may be any: in `f64` with bounds on the errors, for answers that are certain or none.

use super::filter::{ORIENT2D_BOUND, ORIENT3D_BOUND, UNDERFLOW_FLOOR};

/// A direction to look against. Right for coordinates within [`FILTER_RANGE`](super::FILTER_RANGE).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// No component is larger than 1.
    direction: [f64; 3],
    /// Exactly at a right angle to it: two of its components, changed over, one of them with the other sign.
    across: [f64; 3],
}

impl Seen {
    /// Seen from where a vector points to; `None` for one that has no direction in `f64`.
    #[inline]
    pub(crate) fn from(vector: [f64; 3]) -> Option<Self> {
        let size = vector.map(f64::abs);
        let largest = size[0].max(size[1]).max(size[2]);
        if largest == 0.0 || !vector.iter().all(|x| x.is_finite()) {
            return None;
        }
        // Rounding makes this another direction, which is as good.
        let direction = vector.map(|x| x / largest);
        let (i, j) = if size[0] <= size[1].min(size[2]) {
            (1, 2)
        } else if size[1] <= size[2] {
            (2, 0)
        } else {
            (0, 1)
        };
        let mut across = [0.0; 3];
        (across[i], across[j]) = (-direction[j], direction[i]);
        Some(Self { direction, across })
    }

    /// Whether a triangle certainly runs counter-clockwise.
    #[inline(always)]
    pub(crate) fn is_counter_clockwise(&self, v: &[f64; 3], a: &[f64; 3], b: &[f64; 3]) -> bool {
        let ([ux, uy, uz], [wx, wy, wz]) =
            ([a[0] - v[0], a[1] - v[1], a[2] - v[2]], [b[0] - v[0], b[1] - v[1], b[2] - v[2]]);
        let [dx, dy, dz] = self.direction;
        let (uywz, uzwy) = (uy * wz, uz * wy);
        let (uzwx, uxwz) = (uz * wx, ux * wz);
        let (uxwy, uywx) = (ux * wy, uy * wx);
        let determinant = dx * (uywz - uzwy) + dy * (uzwx - uxwz) + dz * (uxwy - uywx);
        let permanent = dx.abs() * (uywz.abs() + uzwy.abs())
            + dy.abs() * (uzwx.abs() + uxwz.abs())
            + dz.abs() * (uxwy.abs() + uywx.abs());
        determinant > ORIENT3D_BOUND * permanent + UNDERFLOW_FLOOR
    }

    /// On which side of a plane through `v`, which looks like a line, a point lies; and whether that is certain. The plane is the
    /// same for every `v`, but for its place. A point in it counts to the first side, where it differs from `v` along no axis that
    /// matters.
    #[inline(always)]
    pub(crate) fn side(&self, v: &[f64; 3], point: &[f64; 3]) -> (bool, bool) {
        let terms: [f64; 3] = std::array::from_fn(|k| self.across[k] * (point[k] - v[k]));
        // One of them is 0.
        let sum = terms[0] + terms[1] + terms[2];
        let bound = ORIENT2D_BOUND * (terms[0].abs() + terms[1].abs() + terms[2].abs()) + UNDERFLOW_FLOOR;
        let is_in_plane = (0..3).all(|k| self.across[k] == 0.0 || point[k] == v[k]);
        (sum >= 0.0, is_in_plane || sum.abs() > bound)
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::exact::{Sign, orient3d};

    #[test]
    fn what_is_certain_is_right() {
        let mut random = ChaCha8Rng::seed_from_u64(18);
        let mut certain = 0;
        for round in 0..20_000 {
            let scale = [1e-120, 1e-9, 1.0, 1e90][round % 4];
            let mut point =
                || -> [f64; 3] { std::array::from_fn(|_| scale * random.random_range(-1.0..1.0)) };
            let (v, a, mut b, d) = (point(), point(), point(), point());
            if round % 3 == 0 {
                b = std::array::from_fn(|k| a[k] + 1e-15 * (b[k] - a[k]));
            }
            let Some(seen) = Seen::from(d) else { panic!("{d:?}") };
            // From far away the eye is over the triangle that is seen counter-clockwise.
            let eye = std::array::from_fn(|k| v[k] + seen.direction[k] * scale);
            if seen.is_counter_clockwise(&v, &a, &b) {
                certain += 1;
                assert!(orient3d(&v, &a, &b, &eye) != Sign::Positive || round % 3 == 0, "{round}");
            }
            let (side, is_certain) = seen.side(&v, &a);
            let sum: f64 = (0..3).map(|k| seen.across[k] * (a[k] - v[k])).sum();
            assert!(!is_certain || side == (sum >= 0.0));
        }
        assert!(certain > 5_000, "{certain}");
    }

    #[test]
    fn the_line_contains_the_direction() {
        for d in [[0.0, 0.0, 1.0], [0.0, -2.0, 0.0], [3.0, 0.0, 0.0], [1.0, 2.0, 3.0], [0.0, 1e300, -1e299]] {
            let seen = Seen::from(d).expect("a direction");
            assert!(seen.across.iter().any(|&x| x != 0.0));
            // Exactly: the two products are the same.
            let products: Vec<f64> =
                (0..3).map(|k| seen.across[k] * seen.direction[k]).filter(|&x| x != 0.0).collect();
            assert!(products.is_empty() || (products.len() == 2 && products[0] == -products[1]), "{d:?}");
        }
        let seen = Seen::from([0.0, 0.0, 1.0]).expect("a direction");
        let sides = [[1.0, 0.0, 5.0], [-1.0, 0.0, 0.0]].map(|point| seen.side(&[0.0; 3], &point));
        assert!(sides.contains(&(true, true)), "{sides:?}");
        assert!(Seen::from([0.0; 3]).is_none() && Seen::from([f64::NAN, 1.0, 1.0]).is_none());
    }
}

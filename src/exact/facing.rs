//! From which ends of the axes a triangle is seen from the front.

use super::filter::{ORIENT2D_BOUND, UNDERFLOW_FLOOR};

/// The ends of the axes from which a triangle certainly runs counter-clockwise: bit 2k is the positive end of axis k, bit 2k + 1 the
/// negative one. Right for all finite coordinates, but not complete: no bit where rounding leaves a doubt.
#[inline(always)]
pub(crate) fn facing([a, b, c]: &[&[f64; 3]; 3]) -> u8 {
    let u = [a[0] - c[0], a[1] - c[1], a[2] - c[2]];
    let v = [b[0] - c[0], b[1] - c[1], b[2] - c[2]];
    let mut ends = 0;
    for k in 0..3 {
        let (x, y) = ((k + 1) % 3, (k + 2) % 3);
        let (left, right) = (u[x] * v[y], u[y] * v[x]);
        let (area, bound) = (left - right, ORIENT2D_BOUND * (left.abs() + right.abs()) + UNDERFLOW_FLOOR);
        ends |= u8::from(area > bound) << (2 * k) | u8::from(area < -bound) << (2 * k + 1);
    }
    ends
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::exact::{Projection, Sign, orient2d};

    #[test]
    fn ends_are_those_of_the_exact_test() {
        let mut random = ChaCha8Rng::seed_from_u64(1_629);
        let mut seen = 0;
        for round in 0..20_000 {
            let scale = [1e-170, 1e-9, 1.0, 1e200][round % 4];
            let mut point =
                || -> [f64; 3] { std::array::from_fn(|_| scale * random.random_range(-1.0..1.0)) };
            let (a, b, mut c) = (point(), point(), point());
            if round % 3 == 0 {
                c = std::array::from_fn(|k| a[k] + 1e-16 * (b[k] - a[k]));
            }
            let ends = facing(&[&a, &b, &c]);
            for axis in 0..3 {
                for (bit, positive) in [(2 * axis, true), (2 * axis + 1, false)] {
                    let view = Projection::seen_from(axis, positive);
                    let [a, b, c] = [a, b, c].map(|point| view.project(&point));
                    let is_front = orient2d(a, b, c) == Sign::Positive;
                    assert!(ends >> bit & 1 == 0 || is_front, "{round}");
                    seen += u32::from(ends >> bit & 1);
                }
            }
        }
        // (A quarter of them are too small for the filter, and a third of the others are needles.)
        assert!(seen > 25_000, "{seen}");
    }
}

//! Where in a triangle a point is: the point of the triangle nearest to it, as weights of the corners.
//!
//! Plain `f64` where the triangle is well shaped, else unevaluated sums of two `f64`: a needle a millionth of a millionth as
//! high as it is long still gets its weights to some ten digits. What is found depends on the triangle and the point
//! alone, and on an edge on nothing but the edge and the point, so that the triangles on both sides of it agree to the bit.

use std::ops::Div;

use super::double_double::{DoubleDouble, power_of_two, scaled_difference};
use super::vector::{Number, cross, dot};

/// The nearest point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// Inside, by the weights of the corners: none negative, their sum 1 but for rounding.
    Inside([f64; 3]),
    /// On a side: the corners at its ends, that with the lower coordinates first (x, then y, then z), and how far it is from
    /// the first to the second, in 0..=1.
    Side {
        /// Corners 0, 1 or 2.
        ends: [usize; 2],
        /// 0 at the first, 1 at the second.
        at: f64,
    },
}

impl Place {
    /// The weights of the three corners.
    pub(crate) fn weights(self) -> [f64; 3] {
        match self {
            Self::Inside(weights) => weights,
            Self::Side { ends: [from, to], at } => {
                let mut weights = [0.0; 3];
                weights[from] = 1.0 - at;
                weights[to] += at;
                weights
            }
        }
    }
}

/// Below this sine of the angle between two sides (the squares are compared) weights are computed in two `f64` instead of one:
/// plain ones are off by some ten times 2^-53 divided by the sine, so by less than 1e-12.
const PLAIN_SINE_SQUARED: f64 = 1e-6;
/// Squared lengths of sides for which products of four of them neither under- nor overflow.
const PLAIN_SQUARES: std::ops::Range<f64> = 1e-140..1e140;
/// The largest weight that a corner may have and yet the point be taken for one of the opposite side, if coordinates are
/// `f64`, else so many units in the last place. (Only where the point is within rounding of that side, but in a needle
/// everything is.)
const NO_WEIGHT: f64 = 1e-8;
const NO_WEIGHT_ULPS: f64 = 8.0;
/// How far from a side a point may be that is meant to lie on it, in units in the last place of its coordinates: it is rounded,
/// by half a unit in each coordinate, and the clean-up may have moved it by as much again.
const ON_SIDE_ULPS: f64 = 4.0;

/// The point of a triangle nearest to `p`, and how far that is, where it is not straight above or below its inside. `unit` is
/// the distance from 1 to the next number that coordinates were rounded to.
pub(crate) fn nearest_place(corners: &[[f64; 3]; 3], p: &[f64; 3], unit: f64) -> (Place, f64) {
    let (corners, p, scale) = within_range(corners, p);
    let inside = weights_in_plane(&corners, &p);
    if let Some((weights, heights)) = inside
        && weights.iter().all(|&w| w >= 0.0)
    {
        let size = p.iter().fold(0.0f64, |size, x| size.max(x.abs()));
        let reach = ON_SIDE_ULPS * unit * size;
        let no_weight = NO_WEIGHT.max(NO_WEIGHT_ULPS * unit);
        // The side that it is nearest to, if it is meant to lie on one.
        let near = (0..3).filter(|&k| weights[k] <= no_weight && weights[k] * heights[k] <= reach);
        let nearest = near.min_by(|&i, &j| (weights[i] * heights[i]).total_cmp(&(weights[j] * heights[j])));
        return match nearest {
            None => (Place::Inside(weights), 0.0),
            Some(k) => (on_side(&corners, &p, k).0, 0.0),
        };
    }
    let sides = [0, 1, 2].map(|k| on_side(&corners, &p, k));
    let best = (1..3).fold(0, |best, k| if sides[k].1 < sides[best].1 { k } else { best });
    (sides[best].0, sides[best].1.sqrt() / scale)
}

/// The weights of the corners at a place in the triangle's plane, inside or not; `None` for a triangle without area.
pub(crate) fn weights_in_plane_of(corners: &[[f64; 3]; 3], p: &[f64; 3]) -> Option<[f64; 3]> {
    let (corners, p, _) = within_range(corners, p);
    weights_in_plane(&corners, &p).map(|(weights, _)| weights)
}

/// Coordinates so near the largest number that differences overflow are divided by 2^8; returns what they were multiplied by.
fn within_range(corners: &[[f64; 3]; 3], p: &[f64; 3]) -> ([[f64; 3]; 3], [f64; 3], f64) {
    const SCALE: f64 = 1.0 / 256.0;
    let largest = corners.as_flattened().iter().chain(p).fold(0.0f64, |largest, x| largest.max(x.abs()));
    if largest < f64::MAX * SCALE {
        return (*corners, *p, 1.0);
    }
    (corners.map(|corner| corner.map(|x| x * SCALE)), p.map(|x| x * SCALE), SCALE)
}

/// The weights of the corners at the foot of `p` in the triangle's plane, and the heights of the corners above the opposite
/// sides; `None` for a triangle without area.
fn weights_in_plane(corners: &[[f64; 3]; 3], p: &[f64; 3]) -> Option<([f64; 3], [f64; 3])> {
    let [a, b, c] = corners;
    let plain = |x: &[f64; 3], y: &[f64; 3]| [0, 1, 2].map(|k| x[k] - y[k]);
    let (u, v) = (plain(b, a), plain(c, a));
    let (uu, vv) = (dot(&u, &u), dot(&v, &v));
    let normal = cross(&u, &v);
    let squared = dot(&normal, &normal);
    let is_plain = PLAIN_SQUARES.contains(&uu)
        && PLAIN_SQUARES.contains(&vv)
        && squared > PLAIN_SINE_SQUARED * (uu * vv);
    let side = |k: usize| {
        let side = plain(&corners[(k + 2) % 3], &corners[(k + 1) % 3]);
        side.iter().fold(0.0, |length: f64, x| length.hypot(*x))
    };
    if is_plain {
        let [wb, wc] = two_weights(&u, &v, &plain(p, a), &normal, squared);
        let area = squared.sqrt();
        // (Squares of such sides neither under- nor overflow, and `hypot` takes several times as long.)
        let plain_side = |k: usize| {
            let side = plain(&corners[(k + 2) % 3], &corners[(k + 1) % 3]);
            dot(&side, &side).sqrt()
        };
        return Some(([1.0 - wb - wc, wb, wc], [0, 1, 2].map(|k| area / plain_side(k))));
    }
    let longest = [0, 1, 2].map(side).into_iter().fold(0.0, f64::max);
    let power = power_of_two(longest);
    let exact = |x: &[f64; 3], y: &[f64; 3]| scaled_difference(x, y, power);
    let (u, v) = (exact(b, a), exact(c, a));
    let normal = cross(&u, &v);
    let squared = dot(&normal, &normal);
    if squared.high <= 0.0 || !squared.high.is_normal() {
        return None;
    }
    let [wb, wc] = two_weights(&u, &v, &exact(p, a), &normal, squared);
    let wa = DoubleDouble::from(1.0) - wb - wc;
    let area = squared.high.sqrt() * power;
    let weights = [wa, wb, wc].map(|w| w.high);
    weights.iter().all(|w| w.is_finite()).then(|| (weights, [0, 1, 2].map(|k| area / (side(k) / power))))
}

/// The weights of the ends of `u` and `v`, at `d` from where both begin.
fn two_weights<T: Number + Div<Output = T>>(
    u: &[T; 3],
    v: &[T; 3],
    d: &[T; 3],
    normal: &[T; 3],
    squared: T,
) -> [T; 2] {
    [dot(&cross(d, v), normal) / squared, dot(&cross(u, d), normal) / squared]
}

/// The point nearest to `p` on the side opposite corner `k`, and the square of its distance.
fn on_side(corners: &[[f64; 3]; 3], p: &[f64; 3], k: usize) -> (Place, f64) {
    let mut ends = [(k + 1) % 3, (k + 2) % 3];
    let is_lower = |x: &[f64; 3], y: &[f64; 3]| {
        let differing = (0..3).find(|&k| x[k] != y[k]);
        differing.map_or(ends[0] < ends[1], |k| x[k] < y[k])
    };
    if !is_lower(&corners[ends[0]], &corners[ends[1]]) {
        ends.swap(0, 1);
    }
    let [from, to] = ends.map(|end| &corners[end]);
    let along: [f64; 3] = [0, 1, 2].map(|k| to[k] - from[k]);
    let way: [f64; 3] = [0, 1, 2].map(|k| p[k] - from[k]);
    // By a power of two, so that squares neither under- nor overflow.
    let power = power_of_two(along.iter().fold(0.0f64, |size, x| size.max(x.abs())));
    let (along, way) = (along.map(|x| x / power), way.map(|x| x / power));
    let squared = dot(&along, &along);
    let at = if squared > 0.0 { (dot(&way, &along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let off: [f64; 3] = [0, 1, 2].map(|k| (way[k] - at * along[k]) * power);
    (Place::Side { ends, at }, dot(&off, &off))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu::rational::RBig;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).expect("finite")
    }

    /// The weights at the foot of a point in the plane of a triangle, exactly.
    fn exact_weights(corners: &[[f64; 3]; 3], p: &[f64; 3]) -> Option<[f64; 3]> {
        let [a, b, c] = corners;
        let minus = |x: &[f64; 3], y: &[f64; 3]| [0, 1, 2].map(|k| exact(x[k]) - exact(y[k]));
        let dot = |x: &[RBig; 3], y: &[RBig; 3]| &x[0] * &y[0] + &x[1] * &y[1] + &x[2] * &y[2];
        let (u, v, d) = (minus(b, a), minus(c, a), minus(p, a));
        // From the normal equations, which know nothing of cross products.
        let (uu, uv, vv, ud, vd) = (dot(&u, &u), dot(&u, &v), dot(&v, &v), dot(&u, &d), dot(&v, &d));
        let determinant = &uu * &vv - &uv * &uv;
        if determinant == RBig::ZERO {
            return None;
        }
        let wb = (&vv * &ud - &uv * &vd) / &determinant;
        let wc = (&uu * &vd - &uv * &ud) / &determinant;
        let wa = RBig::ONE - &wb - &wc;
        Some([wa, wb, wc].map(|w| w.to_f64().value()))
    }

    fn random_point(rng: &mut ChaCha8Rng, size: f64) -> [f64; 3] {
        [0; 3].map(|_| rng.random_range(-size..size))
    }

    fn mixed(corners: &[[f64; 3]; 3], weights: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum())
    }

    #[test]
    fn weights_are_those_of_exact_arithmetic() {
        let mut rng = ChaCha8Rng::seed_from_u64(17);
        let mut inside = 0;
        for round in 0..6_000 {
            let scale = [1e-150, 1e-3, 1.0, 1e6, 1e150][round % 5];
            let [a, b, mut c] = [0; 3].map(|_| random_point(&mut rng, scale));
            if round % 3 > 0 {
                // A needle: the third corner beside the first side, by down to a few units in the last place.
                let height = 10f64.powi(-rng.random_range(3..15));
                let off = random_point(&mut rng, scale);
                let at: f64 = rng.random_range(-0.2..1.2);
                c = [0, 1, 2].map(|k| a[k] + at * (b[k] - a[k]) + height * off[k]);
            }
            let corners = [a, b, c];
            let [x, y]: [f64; 2] = [rng.random(), rng.random()];
            let p = mixed(
                &corners,
                if x + y < 1.0 { [1.0 - x - y, x, y] } else { [x + y - 1.0, 1.0 - x, 1.0 - y] },
            );
            let Some(expected) = exact_weights(&corners, &p) else { continue };
            let (place, off) = nearest_place(&corners, &p, f64::EPSILON);
            if expected.iter().all(|&w| w >= 0.0) {
                inside += 1;
                let found = place.weights();
                let error = (0..3).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
                // A point taken for one of a side has no weight at the opposite corner.
                let bound = if matches!(place, Place::Inside(_)) { 1e-11 } else { 1.01e-8 };
                assert!(error <= bound && off == 0.0, "round {round}: {found:?} {expected:?}");
            }
        }
        assert!(inside > 3_000, "{inside}");
    }

    #[test]
    fn both_sides_of_an_edge_agree() {
        let mut rng = ChaCha8Rng::seed_from_u64(18);
        let mut met = 0;
        for _ in 0..2_000 {
            let [a, b, c, d] = [0; 4].map(|_| random_point(&mut rng, 3.0));
            let at: f64 = rng.random();
            let p = [0, 1, 2].map(|k| a[k] + at * (b[k] - a[k]));
            let (one, _) = nearest_place(&[a, b, c], &p, f64::EPSILON);
            let (other, _) = nearest_place(&[d, b, a], &p, f64::EPSILON);
            if let (Place::Side { ends, at }, Place::Side { ends: others, at: other }) = (one, other) {
                met += 1;
                assert_eq!(at.to_bits(), other.to_bits());
                assert_eq!(ends.map(|k| [a, b, c][k]), others.map(|k| [d, b, a][k]));
            }
        }
        // (The others are rounded more than once, in places where coordinates are small.)
        assert!(met > 1_950, "{met}");
    }

    #[test]
    fn what_is_outside_is_pulled_in() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let place = |p| nearest_place(&corners, &p, f64::EPSILON);
        assert_eq!(place([0.5, 0.5, 7.0]), (Place::Inside([0.5, 0.25, 0.25]), 0.0));
        assert_eq!(place([1.0, -3.0, 0.0]), (Place::Side { ends: [0, 1], at: 0.5 }, 3.0));
        assert_eq!(place([-3.0, -4.0, 0.0]).0.weights(), [1.0, 0.0, 0.0]);
        assert_eq!(place([-3.0, -4.0, 0.0]).1, 5.0);
        // Triangles without area, and without extent.
        let flat = [[0.0; 3], [1.0, 1.0, 0.0], [2.0, 2.0, 0.0]];
        assert_eq!(nearest_place(&flat, &[1.5, 1.5, 0.0], f64::EPSILON).1, 0.0);
        assert_eq!(nearest_place(&[[1.0; 3]; 3], &[1.0, 1.0, 3.0], f64::EPSILON).1, 2.0);
        // The largest numbers there are.
        let huge = corners.map(|corner| corner.map(|x| (x - 1.0) * f64::MAX));
        let (place, _) = nearest_place(&huge, &[-0.5 * f64::MAX, -0.5 * f64::MAX, -f64::MAX], f64::EPSILON);
        assert_eq!(place, Place::Inside([0.5, 0.25, 0.25]));
    }
}

//! Orientation of points, exactly: `orient3d`, `orient2d`, collinearity.

use super::double_double::DoubleDouble;
use super::filter::{FILTER_RANGE, orient2d_filter, orient3d_filter};
use super::integer::Integer;
use super::lattice::{Lattice, has_many_bits};

/// The sign of an exact value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(i8)]
pub enum Sign {
    /// Below zero.
    Negative = -1,
    /// Exactly zero.
    Zero = 0,
    /// Above zero.
    Positive = 1,
}

impl Sign {
    pub(super) fn of_i32(value: i32) -> Self {
        match value {
            0 => Self::Zero,
            v if v < 0 => Self::Negative,
            _ => Self::Positive,
        }
    }

    #[inline]
    fn of_f64(value: f64) -> Self {
        if value > 0.0 {
            Self::Positive
        } else if value < 0.0 {
            Self::Negative
        } else {
            Self::Zero
        }
    }
}

/// The sign of the determinant of `a-d, b-d, c-d`, exact for all finite coordinates.
///
/// Positive if `d` lies below the plane through `a, b, c`, where *above* is the side from which they appear
/// counter-clockwise. For a triangle of a solid, seen counter-clockwise from outside, positive means inside.
///
/// ```
/// use trisect::exact::{Sign, orient3d};
/// let (a, b, c) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// assert_eq!(orient3d(&a, &b, &c, &[0.0, 0.0, -1e-300]), Sign::Positive);
/// assert_eq!(orient3d(&a, &b, &c, &[0.3, 0.3, 0.0]), Sign::Zero);
/// ```
///
/// Costs a few nanoseconds where the filter decides, up to some hundred where the points are nearly or exactly in one
/// plane, up to some microseconds for coordinates of magnitudes so different that only integers of any size hold them.
#[inline]
#[must_use]
pub fn orient3d(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> Sign {
    let (determinant, bound) = orient3d_filter(a, b, c, d);
    // Of the coordinates only differences in z multiply what an underflow may have spoilt (see `FILTER_RANGE`).
    let reach = (a[2] - d[2]).abs().max((b[2] - d[2]).abs()).max((c[2] - d[2]).abs());
    if determinant.abs() > bound && reach <= FILTER_RANGE {
        return Sign::of_f64(determinant);
    }
    orient3d_exact(a, b, c, d)
}

/// The exact stage of [`orient3d`].
#[inline(never)]
pub(super) fn orient3d_exact(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> Sign {
    // All in one plane across an axis: the commonest tie.
    if (0..3).any(|k| a[k] == d[k] && b[k] == d[k] && c[k] == d[k]) {
        return Sign::Zero;
    }
    // Two of them at one place: the commonest tie of surfaces that lie on each other.
    if a == d || b == d || c == d || a == b || b == c || c == a {
        return Sign::Zero;
    }
    let points = [a, b, c, d];
    // In a plane along an axis, above one another in pairs: the commonest tie of extruded bodies.
    if (0..3).any(|axis| are_above_two_places(&points, axis)) {
        return Sign::Zero;
    }
    let lattice = || Lattice::of(points.into_iter().flatten());
    let has_small = !points.iter().any(|point| has_many_bits(*point));
    if let Some(lattice) = has_small.then(lattice).filter(|lattice| lattice.is_small()) {
        let row = |p: &[f64; 3]| -> [i128; 3] {
            std::array::from_fn(|k| i128::from(lattice.small(p[k]) - lattice.small(d[k])))
        };
        let (u, v, w) = (row(a), row(b), row(c));
        let determinant = u[0] * (v[1] * w[2] - v[2] * w[1])
            + u[1] * (v[2] * w[0] - v[0] * w[2])
            + u[2] * (v[0] * w[1] - v[1] * w[0]);
        return Sign::of_i32(determinant.signum() as i32);
    }
    // Expansions are faster than integers of any size; they are exact while no product can leave the range.
    if are_in_range(&points) {
        if let Some(sign) = orient3d_in_double_double(a, b, c, d) {
            return sign;
        }
        let coordinate = |p: &[f64; 3]| robust::Coord3D { x: p[0], y: p[1], z: p[2] };
        return Sign::of_f64(robust::orient3d(coordinate(a), coordinate(b), coordinate(c), coordinate(d)));
    }
    let lattice = lattice();
    let row = |p: &[f64; 3]| -> [Integer; 3] {
        std::array::from_fn(|k| lattice.integer(p[k]).minus(&lattice.integer(d[k])))
    };
    Sign::of_i32(determinant(&row(a), &row(b), &row(c)).signum())
}

/// Whether points seen along an axis are at two places at most.
fn are_above_two_places(points: &[&[f64; 3]; 4], axis: usize) -> bool {
    let place = |point: &[f64; 3]| [point[(axis + 1) % 3], point[(axis + 2) % 3]];
    let first = place(points[0]);
    let mut others = points[1..].iter().map(|point| place(point)).filter(|&other| other != first);
    others.next().is_none_or(|second| others.all(|other| other == second))
}

/// The sign in twice the precision, where that tells: for nearly all points that are off a plane by rounding alone, a tenth of
/// what expansions take. All magnitudes must be within those of expansions.
fn orient3d_in_double_double(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> Option<Sign> {
    let (determinant, bound) = near_orient3d(a, b, c, d);
    (determinant.high.abs() > bound).then(|| Sign::of_f64(determinant.high))
}

/// The determinant in twice the precision, and a bound on its error. All magnitudes must be within those of expansions.
fn near_orient3d(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> (DoubleDouble, f64) {
    // Every operation is off by less than 2^-101 of its result, and there are five between a difference and the determinant.
    const ERROR: f64 = f64::from_bits((1023 - 97) << 52);
    let row = |p: &[f64; 3]| [0, 1, 2].map(|k| DoubleDouble::difference(p[k], d[k]));
    let (u, v, w) = (row(a), row(b), row(c));
    let (mut determinant, mut permanent) = (DoubleDouble::from(0.0), 0.0);
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        determinant = determinant + u[i] * (v[j] * w[k] - v[k] * w[j]);
        permanent += u[i].high.abs() * ((v[j].high * w[k].high).abs() + (v[k].high * w[j].high).abs());
    }
    (determinant, ERROR * permanent)
}

/// The heights of both ends of an edge over a triangle, times twice its area, in twice the precision, and bounds on their errors; `None`
/// where magnitudes leave the range in which that holds.
pub(super) fn near_heights(
    ends: [&[f64; 3]; 2],
    triangle: [&[f64; 3]; 3],
) -> Option<[(DoubleDouble, f64); 2]> {
    let ([a, b, c], [p, q]) = (triangle, ends);
    are_in_range(&[a, b, c, p, q]).then(|| ends.map(|end| near_orient3d(a, b, c, end)))
}

/// Within these magnitudes (2^-240 and 2^240) every product of three coordinate differences and its last bit stay far
/// inside the range of `f64`, which is what expansion arithmetic needs.
const EXPANSION_LOW: f64 = f64::from_bits((1023 - 240) << 52);
const EXPANSION_HIGH: f64 = f64::from_bits((1023 + 240) << 52);

/// Whether all coordinates of some points that are not zero have such magnitudes.
#[inline]
fn are_in_range(points: &[&[f64; 3]]) -> bool {
    let is_in_range = |x: f64| x == 0.0 || (EXPANSION_LOW < x && x < EXPANSION_HIGH);
    points.iter().all(|point| point.iter().all(|x| is_in_range(x.abs())))
}

/// The determinant of three rows.
pub(super) fn determinant(u: &[Integer; 3], v: &[Integer; 3], w: &[Integer; 3]) -> Integer {
    let minor = |i: usize, j: usize| v[i].times(&w[j]).minus(&v[j].times(&w[i]));
    u[0].times(&minor(1, 2)).plus(&u[1].times(&minor(2, 0))).plus(&u[2].times(&minor(0, 1)))
}

/// The sign of the determinant of `a-c, b-c`: positive if `a, b, c` turn counter-clockwise. Exact for all finite
/// coordinates.
#[inline]
#[must_use]
pub fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Sign {
    let (determinant, bound) = orient2d_filter(a, b, c);
    if determinant.abs() > bound {
        return Sign::of_f64(determinant);
    }
    orient2d_exact(a, b, c)
}

/// The exact stage of [`orient2d`].
#[inline(never)]
fn orient2d_exact(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Sign {
    // Both products have a factor that is exactly zero.
    if (a[0] == c[0] || b[1] == c[1]) && (a[1] == c[1] || b[0] == c[0]) {
        return Sign::Zero;
    }
    let points = [a, b, c];
    let high = points.iter().flatten().fold(0.0f64, |high, x| x.abs().max(high));
    let low = points.iter().flatten().map(|x| x.abs()).filter(|&x| x != 0.0).fold(f64::INFINITY, f64::min);
    if low > EXPANSION_LOW && high < EXPANSION_HIGH {
        let coordinate = |p: [f64; 2]| robust::Coord { x: p[0], y: p[1] };
        return Sign::of_f64(robust::orient2d(coordinate(a), coordinate(b), coordinate(c)));
    }
    let lattice = Lattice::of(points.iter().flatten());
    let difference = |p: [f64; 2], k: usize| lattice.integer(p[k]).minus(&lattice.integer(c[k]));
    let left = difference(a, 0).times(&difference(b, 1));
    let right = difference(a, 1).times(&difference(b, 0));
    Sign::of_i32(left.minus(&right).signum())
}

/// Whether three points lie on one line (or coincide), exactly.
#[must_use]
pub fn collinear(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> bool {
    let project = |p: &[f64; 3], i: usize, j: usize| [p[i], p[j]];
    [(0, 1), (1, 2), (2, 0)]
        .iter()
        .all(|&(i, j)| orient2d(project(a, i, j), project(b, i, j), project(c, i, j)) == Sign::Zero)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::PlaneFilter;
    use dashu::rational::RBig;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn reference(points: [&[f64; 3]; 4]) -> Sign {
        let exact = |x: f64| RBig::try_from(x).expect("finite");
        let row = |p: &[f64; 3]| -> [RBig; 3] { std::array::from_fn(|k| exact(p[k]) - exact(points[3][k])) };
        let (u, v, w) = (row(points[0]), row(points[1]), row(points[2]));
        let minor = |i: usize, j: usize| &v[i] * &w[j] - &v[j] * &w[i];
        let value = &u[0] * minor(1, 2) + &u[1] * minor(2, 0) + &u[2] * minor(0, 1);
        Sign::of_i32(if value == RBig::ZERO {
            0
        } else if value < RBig::ZERO {
            -1
        } else {
            1
        })
    }

    /// A coordinate of a random kind: small grid, unit interval, near-coincident, tiny, huge, subnormal.
    pub(crate) fn wild(rng: &mut ChaCha8Rng, kind: u32) -> f64 {
        match kind {
            0 => f64::from(rng.random_range(-3i32..4)),
            1 => rng.random_range(-1.0..1.0),
            2 => 0.5 + f64::from(rng.random_range(-2i32..3)) * f64::EPSILON,
            3 => rng.random_range(-1.0..1.0) * 1e-110,
            4 => rng.random_range(-1.0..1.0) * 1e110,
            5 => f64::from_bits(rng.random_range(0..1 << 20)),
            6 => rng.random_range(-1.0..1.0) * f64::MAX / 4.0,
            _ => rng.random_range(-1.0..1.0) * 10f64.powi(rng.random_range(-300..300)),
        }
    }

    #[test]
    fn orient3d_agrees_with_rationals_everywhere() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let (mut zeros, mut decided) = (0, 0);
        for round in 0..20_000 {
            let kind = round % 9;
            let point = |rng: &mut ChaCha8Rng| -> [f64; 3] {
                std::array::from_fn(|_| {
                    let kind = if kind == 8 { rng.random_range(0..8) } else { kind };
                    wild(rng, kind)
                })
            };
            let [a, b, c, d] = std::array::from_fn(|_| point(&mut rng));
            let expected = reference([&a, &b, &c, &d]);
            zeros += u32::from(expected == Sign::Zero);
            assert_eq!(orient3d(&a, &b, &c, &d), expected, "{a:?} {b:?} {c:?} {d:?}");
            assert_eq!(orient3d_exact(&a, &b, &c, &d), expected, "exact stage: {a:?} {b:?} {c:?} {d:?}");
            let largest = [a, b, c, d].as_flattened().iter().fold(0.0f64, |largest, x| x.abs().max(largest));
            for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
                let (determinant, bound) = PlaneFilter::new(&a, &b, &c).determinant(&d);
                if determinant.abs() > bound && largest <= FILTER_RANGE {
                    decided += 1;
                    assert_eq!(Sign::of_f64(determinant), expected, "filter: {a:?} {b:?} {c:?} {d:?}");
                }
            }
        }
        assert!(zeros > 300, "the sample must hold ties: {zeros}");
        assert!(decided > 10_000, "the filter must decide most: {decided}");
    }

    #[test]
    fn points_above_two_places_are_in_one_plane() {
        let mut rng = ChaCha8Rng::seed_from_u64(16);
        for round in 0..3_000 {
            let (kind, axis) = (round % 8, round as usize % 3);
            let places: [[f64; 2]; 2] =
                std::array::from_fn(|_| std::array::from_fn(|_| wild(&mut rng, kind)));
            let [a, b, c, d]: [[f64; 3]; 4] = std::array::from_fn(|i| {
                let [x, y] = places[i % 2];
                let mut point = [0.0; 3];
                (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (wild(&mut rng, kind), x, y);
                point
            });
            let orders = [[&a, &b, &c, &d], [&a, &c, &b, &d], [&b, &d, &c, &a]];
            for [a, b, c, d] in orders {
                assert_eq!(orient3d(a, b, c, d), Sign::Zero, "{a:?} {b:?} {c:?} {d:?}");
                assert!(are_above_two_places(&[a, b, c, d], axis));
            }
            // One of them elsewhere: no plane, unless by chance.
            let mut away = d;
            away[(axis + 1) % 3] = wild(&mut rng, kind);
            assert_eq!(
                orient3d(&a, &b, &c, &away),
                reference([&a, &b, &c, &away]),
                "{a:?} {b:?} {c:?} {away:?}"
            );
        }
    }

    #[test]
    fn points_off_a_plane_by_rounding_agree_with_rationals() {
        let mut rng = ChaCha8Rng::seed_from_u64(15);
        let (mut told, mut zeros) = (0, 0);
        for round in 0..10_000 {
            let scale = 10f64.powi(rng.random_range(-60..60));
            let far = if round % 2 == 0 { 0.0 } else { scale * 10f64.powi(rng.random_range(0..9)) };
            let [a, b, c]: [[f64; 3]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|_| far + scale * rng.random_range(-1.0..1.0)));
            let (s, t) = (rng.random_range(-1.0..2.0), rng.random_range(-1.0..2.0));
            let d: [f64; 3] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
            let expected = reference([&a, &b, &c, &d]);
            assert_eq!(orient3d_exact(&a, &b, &c, &d), expected, "{a:?} {b:?} {c:?} {d:?}");
            if let Some(sign) = orient3d_in_double_double(&a, &b, &c, &d) {
                told += 1;
                assert_eq!(sign, expected, "{a:?} {b:?} {c:?} {d:?}");
            }
            zeros += u32::from(expected == Sign::Zero);
        }
        assert!(told > 9_000, "twice the precision must tell nearly all: {told}, {zeros} are zero");
    }

    #[test]
    fn orient2d_agrees_with_rationals_everywhere() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut zeros = 0;
        for round in 0..20_000 {
            let kind = round % 9;
            let [a, b, c]: [[f64; 2]; 3] = std::array::from_fn(|_| {
                std::array::from_fn(|_| {
                    let kind = if kind == 8 { rng.random_range(0..8) } else { kind };
                    wild(&mut rng, kind)
                })
            });
            // The determinant in space, relative to a point above the third.
            let lift = |p: [f64; 2]| [p[0], p[1], 0.0];
            let expected = reference([&lift(a), &lift(b), &[c[0], c[1], -1.0], &lift(c)]);
            let expected = [Sign::Positive, Sign::Zero, Sign::Negative][(expected as i8 + 1) as usize];
            zeros += u32::from(expected == Sign::Zero);
            assert_eq!(orient2d(a, b, c), expected, "{a:?} {b:?} {c:?}");
            assert_eq!(orient2d_exact(a, b, c), expected, "exact stage: {a:?} {b:?} {c:?}");
        }
        assert!(zeros > 300, "the sample must hold ties: {zeros}");
    }

    #[test]
    fn scales_at_which_expansions_alone_fail() {
        for scale in [1e-110, 1e-320, 1e110, 1e300] {
            let (a, b, c) = ([0.0; 3], [scale, 0.0, 0.0], [0.0, scale, 0.0]);
            assert_eq!(orient3d(&a, &b, &c, &[0.0, 0.0, scale]), Sign::Negative, "{scale}");
            assert_eq!(orient3d(&a, &b, &c, &[scale, scale, 0.0]), Sign::Zero, "{scale}");
            assert_eq!(orient2d([0.0, 0.0], [scale, 0.0], [0.0, scale]), Sign::Positive, "{scale}");
        }
    }

    #[test]
    fn collinear_is_exact() {
        assert!(collinear(&[0.0; 3], &[0.5, 0.5, 0.25], &[1.0, 1.0, 0.5]));
        assert!(!collinear(&[0.0; 3], &[0.5, 0.5, 0.25], &[1.0, 1.0, 0.5 + f64::EPSILON]));
        assert!(collinear(&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0], &[5.0, 1.0, 0.0]));
    }
}

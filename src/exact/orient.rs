//! Orientation of points, exactly: `orient3d`, `orient2d`, collinearity.

use super::Integer;
use super::lattice::Lattice;

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

/// Relative error bound of `orient3d` in `f64`: (7 + 56 u) u with u = 2^-53 (Shewchuk 1997, section 4.3).
const ORIENT3D_BOUND: f64 = (7.0 + 56.0 * HALF_ULP) * HALF_ULP;
/// Relative error bound of `orient2d` in `f64`: (3 + 16 u) u (Shewchuk 1997, section 4.3).
const ORIENT2D_BOUND: f64 = (3.0 + 16.0 * HALF_ULP) * HALF_ULP;
const HALF_ULP: f64 = f64::EPSILON / 2.0;
/// A determinant must exceed this for its filter to count: 2^-700. Products that underflow lose at most 2^-1074 each, and
/// are multiplied by at most one further factor, which is below 2^350 or else the permanent has overflowed or the term
/// concerned is not the one that underflowed.
const UNDERFLOW_FLOOR: f64 = f64::from_bits((1023 - 700) << 52);
/// Above this the reasoning about [`UNDERFLOW_FLOOR`] fails: 2^350.
const FILTER_LIMIT: f64 = f64::from_bits((1023 + 350) << 52);

/// The determinant of `a-d, b-d, c-d` in `f64` and a bound: where its absolute value is larger than the bound its sign is
/// right. Never wrong for finite coordinates of absolute value up to 2^350.
#[inline(always)]
pub(crate) fn orient3d_filter(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> (f64, f64) {
    let (adx, ady, adz) = (a[0] - d[0], a[1] - d[1], a[2] - d[2]);
    let (bdx, bdy, bdz) = (b[0] - d[0], b[1] - d[1], b[2] - d[2]);
    let (cdx, cdy, cdz) = (c[0] - d[0], c[1] - d[1], c[2] - d[2]);
    let (bdxcdy, cdxbdy) = (bdx * cdy, cdx * bdy);
    let (cdxady, adxcdy) = (cdx * ady, adx * cdy);
    let (adxbdy, bdxady) = (adx * bdy, bdx * ady);
    let determinant = adz * (bdxcdy - cdxbdy) + bdz * (cdxady - adxcdy) + cdz * (adxbdy - bdxady);
    let permanent = (bdxcdy.abs() + cdxbdy.abs()) * adz.abs()
        + (cdxady.abs() + adxcdy.abs()) * bdz.abs()
        + (adxbdy.abs() + bdxady.abs()) * cdz.abs();
    (determinant, ORIENT3D_BOUND * permanent + UNDERFLOW_FLOOR)
}

/// [`orient3d_filter`] of many points against one plane: what depends on the plane alone is computed once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaneFilter {
    origin: [f64; 3],
    normal: [f64; 3],
    /// The sums of the absolute values of the products in the normal.
    permanent: [f64; 3],
}

impl PlaneFilter {
    /// The plane through three points.
    #[inline(always)]
    pub(crate) fn new(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> Self {
        let (ux, uy, uz) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        let (vx, vy, vz) = (c[0] - a[0], c[1] - a[1], c[2] - a[2]);
        let (uyvz, uzvy) = (uy * vz, uz * vy);
        let (uzvx, uxvz) = (uz * vx, ux * vz);
        let (uxvy, uyvx) = (ux * vy, uy * vx);
        Self {
            origin: *a,
            normal: [uzvy - uyvz, uxvz - uzvx, uyvx - uxvy],
            permanent: [uyvz.abs() + uzvy.abs(), uzvx.abs() + uxvz.abs(), uxvy.abs() + uyvx.abs()],
        }
    }

    /// `orient3d` of the plane's points and `d` in `f64`, and a bound as that of [`orient3d_filter`]: the same determinant,
    /// relative to another of the points and transposed.
    #[inline(always)]
    pub(crate) fn determinant(&self, d: &[f64; 3]) -> (f64, f64) {
        let (x, y, z) = (d[0] - self.origin[0], d[1] - self.origin[1], d[2] - self.origin[2]);
        let determinant = x * self.normal[0] + y * self.normal[1] + z * self.normal[2];
        let permanent =
            x.abs() * self.permanent[0] + y.abs() * self.permanent[1] + z.abs() * self.permanent[2];
        (determinant, ORIENT3D_BOUND * permanent + UNDERFLOW_FLOOR)
    }
}

/// As [`orient3d_filter`], for `orient2d`.
#[inline(always)]
pub(crate) fn orient2d_filter(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> (f64, f64) {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    (left - right, ORIENT2D_BOUND * (left.abs() + right.abs()) + UNDERFLOW_FLOOR)
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
#[must_use]
pub fn orient3d(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> Sign {
    let (determinant, bound) = orient3d_filter(a, b, c, d);
    if determinant.abs() > bound && largest([a, b, c, d]) <= FILTER_LIMIT {
        return Sign::of_f64(determinant);
    }
    orient3d_exact(a, b, c, d)
}

fn largest<const N: usize>(points: [&[f64; 3]; N]) -> f64 {
    points
        .iter()
        .flat_map(|point| point.iter())
        .fold(0.0, |largest, coordinate| coordinate.abs().max(largest))
}

/// The exact stage of [`orient3d`].
pub(super) fn orient3d_exact(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> Sign {
    // All in one plane across an axis: the commonest tie.
    if (0..3).any(|k| a[k] == d[k] && b[k] == d[k] && c[k] == d[k]) {
        return Sign::Zero;
    }
    let lattice = Lattice::of([a, b, c, d].into_iter().flatten());
    if lattice.is_small() {
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
    let magnitudes = [a, b, c, d].into_iter().flatten().map(|x| x.abs()).filter(|&x| x != 0.0);
    let (low, high) = magnitudes.fold((f64::INFINITY, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
    if low > EXPANSION_LOW && high < EXPANSION_HIGH {
        let coordinate = |p: &[f64; 3]| robust::Coord3D { x: p[0], y: p[1], z: p[2] };
        return Sign::of_f64(robust::orient3d(coordinate(a), coordinate(b), coordinate(c), coordinate(d)));
    }
    let row = |p: &[f64; 3]| -> [Integer; 3] {
        std::array::from_fn(|k| lattice.integer(p[k]).minus(&lattice.integer(d[k])))
    };
    Sign::of_i32(determinant(&row(a), &row(b), &row(c)).signum())
}

/// Within these magnitudes (2^-240 and 2^240) every product of three coordinate differences and its last bit stay far
/// inside the range of `f64`, which is what expansion arithmetic needs.
const EXPANSION_LOW: f64 = f64::from_bits((1023 - 240) << 52);
const EXPANSION_HIGH: f64 = f64::from_bits((1023 + 240) << 52);

/// The determinant of three rows.
pub(super) fn determinant(u: &[Integer; 3], v: &[Integer; 3], w: &[Integer; 3]) -> Integer {
    let minor = |i: usize, j: usize| v[i].times(&w[j]).minus(&v[j].times(&w[i]));
    u[0].times(&minor(1, 2)).plus(&u[1].times(&minor(2, 0))).plus(&u[2].times(&minor(0, 1)))
}

/// The sign of the determinant of `a-c, b-c`: positive if `a, b, c` turn counter-clockwise. Exact for all finite
/// coordinates.
#[must_use]
pub fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Sign {
    let (determinant, bound) = orient2d_filter(a, b, c);
    if determinant.abs() > bound && [a, b, c].iter().flatten().all(|x| x.abs() <= FILTER_LIMIT) {
        return Sign::of_f64(determinant);
    }
    orient2d_exact(a, b, c)
}

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
            for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
                let (determinant, bound) = PlaneFilter::new(&a, &b, &c).determinant(&d);
                if determinant.abs() > bound && largest([&a, &b, &c, &d]) <= FILTER_LIMIT {
                    decided += 1;
                    assert_eq!(Sign::of_f64(determinant), expected, "filter: {a:?} {b:?} {c:?} {d:?}");
                }
            }
        }
        assert!(zeros > 300, "the sample must hold ties: {zeros}");
        assert!(decided > 10_000, "the filter must decide most: {decided}");
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

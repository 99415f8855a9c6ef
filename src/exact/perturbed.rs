//! `orient3d` of symbolically perturbed points: a sign that is never zero (Vyatkin 2019, step 1: perturbation).
//!
//! Every point moves along `p(eps) = p + eps r + eps^16 h`, where `eps` is a positive infinitesimal. The determinant is
//! then a polynomial in `eps`, and its sign is that of its lowest non-zero coefficient. The first direction `r` expresses
//! what a tie *should* mean (it is chosen by the boolean operation: see [`crate::boolean`](mod@crate::boolean)); the second direction `h` is a
//! hash of the point's identity and breaks whatever ties the first leaves. The exponent 16 keeps the two apart: no predicate
//! (the highest has degree 9: four planes, see `planes`) mixes powers of `r` with powers of `h`, so every coefficient is homogeneous in both, and the
//! decisions do not depend on the unit the coordinates are measured in.
//!
//! Coefficients are computed one after the other, exactly; the lowest has an `f64` filter of its own, since it decides
//! nearly every contact between flat faces.

use std::cell::OnceCell;

use super::Sign;
use super::filter::{ORIENT3D_BOUND, UNDERFLOW_FLOOR};
use super::integer::Integer;
use super::lattice::Lattice;
use super::orient::orient3d_exact;

/// Powers of `eps` in a coordinate: the position itself, the first direction, the second.
pub(super) const POWERS: [usize; 3] = [0, 1, 16];
/// Number of coefficients of a perturbed `orient3d` that can be non-zero.
pub(super) const COEFFICIENTS: usize = EXPONENTS.len();
/// Their powers of `eps`: three factors of powers 0, 1 or 16.
pub(super) const EXPONENTS: [usize; 10] = [0, 1, 2, 3, 16, 17, 18, 32, 33, 48];

/// A point that moves infinitesimally: `position + eps first + eps^16 second`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PerturbedPoint {
    /// Where the point is; finite.
    pub(crate) position: [f64; 3],
    /// The first direction; components of at most 16 bits and a sign.
    pub(crate) first: [i32; 3],
    /// The second direction; components of at most 20 bits and a sign.
    pub(crate) second: [i32; 3],
}

/// A second direction from the identity of a point: 20 pseudo-random bits and a sign for each component, by the
/// splitmix64 finaliser, so that no three of them are dependent but with a probability of about 2^-60.
#[must_use]
pub(crate) fn jitter(identity: u64) -> [i32; 3] {
    let mut bits = identity.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    std::array::from_fn(|k| (bits >> (21 * k) & 0x1f_ffff) as i32 - 0x10_0000)
}

/// The sign of `orient3d` of four perturbed points (see [`super::orient3d`] for what it means). It is zero only if the
/// polynomial vanishes identically: for points with different [`jitter`] that has a probability below 2^-55.
#[must_use]
pub(crate) fn orient3d(points: [&PerturbedPoint; 4]) -> Sign {
    let [a, b, c, d] = points;
    let unperturbed = orient3d_exact(&a.position, &b.position, &c.position, &d.position);
    if unperturbed != Sign::Zero { unperturbed } else { orient3d_of_tie(points) }
}

/// The sign of [`orient3d`](super::orient3d) of four points that each move by an infinitesimal in a given direction, whose
/// components have at most 10 bits and a sign. Where that leaves a tie, further directions break it that depend on the
/// place of a point among the four alone: the sign is never zero (but with a probability below 2^-55).
///
/// ```
/// use trisect::exact::{Sign, orient3d, orient3d_perturbed};
/// let (a, b, c) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// let d = [0.3, 0.3, 0.0];
/// assert_eq!(orient3d(&a, &b, &c, &d), Sign::Zero);
/// // The triangle moves up, and the point is below it then.
/// let (up, still) = ([0, 0, 1], [0; 3]);
/// assert_eq!(orient3d_perturbed([&a, &b, &c, &d], [up, up, up, still]), Sign::Positive);
/// ```
#[must_use]
pub fn orient3d_perturbed(points: [&[f64; 3]; 4], directions: [[i32; 3]; 4]) -> Sign {
    let moving: [PerturbedPoint; 4] = std::array::from_fn(|i| PerturbedPoint {
        position: *points[i],
        first: directions[i],
        second: jitter(i as u64),
    });
    orient3d(moving.each_ref())
}

/// [`orient3d`] of points whose unperturbed determinant is known to be zero.
pub(crate) fn orient3d_of_tie(points: [&PerturbedPoint; 4]) -> Sign {
    let positions = points.map(|point| &point.position);
    linear_filter(positions, points.map(|point| point.first), |i| points[i].second)
        .unwrap_or_else(|| orient3d_of_tie_exact(points))
}

/// The exact stage of [`orient3d_of_tie`].
pub(crate) fn orient3d_of_tie_exact(points: [&PerturbedPoint; 4]) -> Sign {
    let lattice = Lattice::of(points.iter().flat_map(|point| &point.position));
    if lattice.is_small() {
        lowest_sign(&rows(points, |x| i128::from(lattice.small(x)), i128::from))
    } else {
        lowest_sign(&rows(points, |x| lattice.integer(x), |x| Integer::from(i64::from(x))))
    }
}

/// The sign of [`orient3d_of_tie`], if `f64` can tell. `second` gives the second direction of a point, if it is needed: where
/// all points move alike at first.
#[inline]
pub(crate) fn linear_filter(
    positions: [&[f64; 3]; 4],
    first: [[i32; 3]; 4],
    second: impl Fn(usize) -> [i32; 3],
) -> Option<Sign> {
    let alike = first[..3].iter().all(|direction| *direction == first[3]);
    linear_coefficient(positions, if alike { [0, 1, 2, 3].map(second) } else { first })
}

/// The perturbed determinant as a polynomial in the infinitesimal, which is scaled by `2^e`: its coefficients are in units of
/// `2^(3 e)` where `2^e` is the spacing of a lattice, and computed when they are asked for.
pub(super) struct Polynomial {
    rows: Rows<Integer>,
    coefficients: [OnceCell<Integer>; COEFFICIENTS],
}

impl Polynomial {
    pub(super) fn new(points: [&PerturbedPoint; 4], lattice: Lattice) -> Self {
        let rows = rows(points, |x| lattice.integer(x), |x| Integer::from(i64::from(x)));
        Self { rows, coefficients: Default::default() }
    }

    /// The coefficient of the power of that place in [`EXPONENTS`].
    pub(super) fn coefficient(&self, place: usize) -> &Integer {
        self.coefficients[place].get_or_init(|| coefficient(&self.rows, EXPONENTS[place]))
    }

    /// Whether the lowest coefficient that is not zero is positive.
    pub(super) fn is_positive(&self) -> bool {
        (0..COEFFICIENTS)
            .map(|k| self.coefficient(k).signum())
            .find(|&sign| sign != 0)
            .is_some_and(|sign| sign > 0)
    }
}

/// Number of coefficients that first directions alone give: those of the powers 0 to 3.
pub(super) const LOW_COEFFICIENTS: usize = 4;

/// The low coefficients of the perturbed determinant on a [tiny](Lattice::is_tiny) lattice, in the units of [`Polynomial`].
pub(super) fn low_coefficients(points: [&PerturbedPoint; 4], lattice: Lattice) -> [i128; LOW_COEFFICIENTS] {
    let rows = rows(points, |x| i128::from(lattice.small(x)), i128::from);
    std::array::from_fn(|place| coefficient(&rows, EXPONENTS[place]))
}

/// The sign of the coefficient of the power of `eps` that belongs to some directions, if `f64` is certain: the sum of three
/// determinants with one row of directions each.
fn linear_coefficient(positions: [&[f64; 3]; 4], directions: [[i32; 3]; 4]) -> Option<Sign> {
    // Three determinants with one exact row each: twice the bound of a single `orient3d` covers them and their sum. The
    // third factors are directions of at most 2^22, so that `UNDERFLOW_FLOOR` covers underflow for all coordinates.
    const BOUND: f64 = 2.0 * ORIENT3D_BOUND;
    let [zero, one]: [[[f64; 3]; 3]; 2] = [
        std::array::from_fn(|i| std::array::from_fn(|k| positions[i][k] - positions[3][k])),
        std::array::from_fn(|i| std::array::from_fn(|k| f64::from(directions[i][k] - directions[3][k]))),
    ];
    let (mut sum, mut permanent) = (0.0, 0.0);
    for i in 0..3 {
        let (v, w) = (&zero[(i + 1) % 3], &zero[(i + 2) % 3]);
        for k in 0..3 {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            let (left, right) = (v[l] * w[m], v[m] * w[l]);
            sum += one[i][k] * (left - right);
            permanent += one[i][k].abs() * (left.abs() + right.abs());
        }
    }
    if sum.abs() > BOUND * permanent + UNDERFLOW_FLOOR {
        Some(if sum > 0.0 { Sign::Positive } else { Sign::Negative })
    } else {
        None
    }
}

/// What the coefficients are computed in.
trait Ring: Clone {
    fn zero() -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn signum(&self) -> i32;
}

impl Ring for i128 {
    fn zero() -> Self {
        0
    }
    fn plus(&self, other: &Self) -> Self {
        self + other
    }
    fn minus(&self, other: &Self) -> Self {
        self - other
    }
    fn times(&self, other: &Self) -> Self {
        self * other
    }
    fn signum(&self) -> i32 {
        i128::signum(*self) as i32
    }
}

impl Ring for Integer {
    fn zero() -> Self {
        Self::zero()
    }
    fn plus(&self, other: &Self) -> Self {
        self.plus(other)
    }
    fn minus(&self, other: &Self) -> Self {
        self.minus(other)
    }
    fn times(&self, other: &Self) -> Self {
        self.times(other)
    }
    fn signum(&self) -> i32 {
        self.signum()
    }
}

/// The three rows `a-d, b-d, c-d` of the determinant, each as coefficients of the [`POWERS`] of `eps`.
type Rows<R> = [[[R; 3]; POWERS.len()]; 3];

fn rows<R: Ring>(
    points: [&PerturbedPoint; 4],
    coordinate: impl Fn(f64) -> R,
    component: impl Fn(i32) -> R,
) -> Rows<R> {
    let d = points[3];
    std::array::from_fn(|i| {
        let p = points[i];
        [
            std::array::from_fn(|k| coordinate(p.position[k]).minus(&coordinate(d.position[k]))),
            std::array::from_fn(|k| component(p.first[k] - d.first[k])),
            std::array::from_fn(|k| component(p.second[k] - d.second[k])),
        ]
    })
}

/// The coefficient of `eps^exponent`: the sum of the determinants of one part of each row, of powers that add up to it.
fn coefficient<R: Ring>(rows: &Rows<R>, exponent: usize) -> R {
    let mut sum = R::zero();
    for i in 0..POWERS.len() {
        for j in 0..POWERS.len() {
            for l in 0..POWERS.len() {
                if POWERS[i] + POWERS[j] + POWERS[l] == exponent {
                    add_determinant(&mut sum, &rows[0][i], &rows[1][j], &rows[2][l]);
                }
            }
        }
    }
    sum
}

fn add_determinant<R: Ring>(sum: &mut R, u: &[R; 3], v: &[R; 3], w: &[R; 3]) {
    if [u, v, w].iter().any(|row| row.iter().all(|x| x.signum() == 0)) {
        return;
    }
    for (x, y, z) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        if u[x].signum() != 0 {
            *sum = sum.plus(&u[x].times(&v[y].times(&w[z]).minus(&v[z].times(&w[y]))));
        }
    }
}

fn lowest_sign<R: Ring>(rows: &Rows<R>) -> Sign {
    EXPONENTS[1..]
        .iter()
        .map(|&exponent| coefficient(rows, exponent).signum())
        .find(|&sign| sign != 0)
        .map_or(Sign::Zero, Sign::of_i32)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::collections::BTreeMap;

    use dashu::rational::RBig;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// A polynomial in eps with rational coefficients, by power; no zero coefficients.
    pub(crate) type Polynomial = BTreeMap<usize, RBig>;

    pub(crate) fn times(a: &Polynomial, b: &Polynomial) -> Polynomial {
        let mut product = Polynomial::new();
        for (i, x) in a {
            for (j, y) in b {
                *product.entry(i + j).or_insert(RBig::ZERO) += x * y;
            }
        }
        product.retain(|_, c| *c != RBig::ZERO);
        product
    }

    pub(crate) fn minus(a: &Polynomial, b: &Polynomial) -> Polynomial {
        let mut difference = a.clone();
        for (i, x) in b {
            *difference.entry(*i).or_insert(RBig::ZERO) -= x;
        }
        difference.retain(|_, c| *c != RBig::ZERO);
        difference
    }

    pub(crate) fn coordinate(point: &PerturbedPoint, k: usize) -> Polynomial {
        let position = RBig::try_from(point.position[k]).expect("finite");
        let parts = [position, RBig::from(point.first[k]), RBig::from(point.second[k])];
        POWERS.into_iter().zip(parts).filter(|(_, c)| *c != RBig::ZERO).collect()
    }

    /// The determinant as a polynomial in eps, by rational arithmetic and the definition.
    pub(crate) fn reference(points: [&PerturbedPoint; 4]) -> Polynomial {
        let row = |i: usize| -> Vec<Polynomial> {
            (0..3).map(|k| minus(&coordinate(points[i], k), &coordinate(points[3], k))).collect()
        };
        let (u, v, w) = (row(0), row(1), row(2));
        let minor = |i: usize, j: usize| minus(&times(&v[i], &w[j]), &times(&v[j], &w[i]));
        let plus = |a: &Polynomial, b: &Polynomial| minus(a, &minus(&Polynomial::new(), b));
        plus(&plus(&times(&u[0], &minor(1, 2)), &times(&u[1], &minor(2, 0))), &times(&u[2], &minor(0, 1)))
    }

    pub(crate) fn lowest(polynomial: &Polynomial) -> (usize, Sign) {
        polynomial.first_key_value().map_or((usize::MAX, Sign::Zero), |(&power, coefficient)| {
            (power, if *coefficient < RBig::ZERO { Sign::Negative } else { Sign::Positive })
        })
    }

    /// Points on purpose in special position: a coarse grid, some of them equal, directions from a small set, so that the
    /// decision falls at every order.
    pub(crate) fn degenerate(rng: &mut ChaCha8Rng, identity: u64, scale: f64) -> PerturbedPoint {
        let position = match rng.random_range(0..4) {
            0 => [scale; 3],
            1 => [
                f64::from(rng.random_range(0i32..3)) * scale,
                f64::from(rng.random_range(0i32..3)) * scale,
                scale,
            ],
            _ => std::array::from_fn(|_| f64::from(rng.random_range(0i32..3)) * scale),
        };
        let first = match rng.random_range(0..4) {
            0 | 1 => [0; 3],
            2 => [0, 0, 500],
            _ => std::array::from_fn(|_| rng.random_range(-1i32..2)),
        };
        let second = match rng.random_range(0..3) {
            0 => [0; 3],
            1 => std::array::from_fn(|_| rng.random_range(-1i32..2)),
            _ => jitter(identity),
        };
        PerturbedPoint { position, first, second }
    }

    #[test]
    fn every_order_agrees_with_rationals() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut orders = [0u32; COEFFICIENTS];
        for round in 0..40_000 {
            let scale = [1.0, 0.1, 1e-200, 1e200][round % 4];
            let points: [PerturbedPoint; 4] =
                std::array::from_fn(|i| degenerate(&mut rng, (4 * round + i) as u64, scale));
            let points = points.each_ref();
            let (order, expected) = lowest(&reference(points));
            if let Some(k) = EXPONENTS.iter().position(|&exponent| exponent == order) {
                orders[k] += 1;
            }
            assert_eq!(orient3d(points), expected, "decided at order {order}: {points:?}");
        }
        assert!(orders.iter().all(|&count| count > 10), "every order must decide some cases: {orders:?}");
    }

    #[test]
    fn jitter_breaks_every_tie() {
        for identity in 0..2_000u64 {
            let point = |i| PerturbedPoint { position: [1.0; 3], first: [0; 3], second: jitter(i) };
            let points: [PerturbedPoint; 4] = std::array::from_fn(|i| point(identity + i as u64));
            assert_ne!(orient3d(points.each_ref()), Sign::Zero);
        }
    }
}

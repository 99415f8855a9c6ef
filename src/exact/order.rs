//! The order of two crossings on one edge, which is also the side of a crossing point against a third plane.
//!
//! Let `D(T; x)` be `orient3d` of triangle `T` and point `x`. An edge `(p, q)` that crosses the planes of `T1` and `T2`
//! does so at parameters `t_k = D(Tk; p) / (D(Tk; p) - D(Tk; q))`, and `t1 < t2` is decided by the sign of
//! `N = D(T1; p) D(T2; q) - D(T1; q) D(T2; p)`. The same `N` tells, up to the sign of `D(T1; p) - D(T1; q)`, on which side
//! of the plane of `T2` the crossing with `T1` lies.

use super::Sign;
use super::filter::orient3d_filter;
use super::integer::Integer;
use super::lattice::Lattice;
use super::orient::near_heights;
use super::perturbed::{
    COEFFICIENTS, EXPONENTS, LOW_COEFFICIENTS, PerturbedPoint, Polynomial, low_coefficients,
};

/// The sign of `t1 - t2` from plain positions, if `f64` with an error bound can tell: the filter of [`compare`].
///
/// `p_above_1` and `p_above_2` say whether `D(Tk; p)` is positive (perturbed).
#[inline]
#[must_use]
pub(crate) fn compare_filter(
    p: &[f64; 3],
    q: &[f64; 3],
    first: [&[f64; 3]; 3],
    second: [&[f64; 3]; 3],
    p_above_1: bool,
    p_above_2: bool,
) -> Option<Sign> {
    let (a0, a0_bound) = orient3d_filter(first[0], first[1], first[2], p);
    let (a1, a1_bound) = orient3d_filter(first[0], first[1], first[2], q);
    let (b0, b0_bound) = orient3d_filter(second[0], second[1], second[2], p);
    let (b1, b1_bound) = orient3d_filter(second[0], second[1], second[2], q);
    let (left, right) = (a0 * b1, b0 * a1);
    let n = left - right;
    let bound = (a0.abs() + a0_bound) * b1_bound
        + b1.abs() * a0_bound
        + (b0.abs() + b0_bound) * a1_bound
        + a1.abs() * b0_bound
        + 4.0 * f64::EPSILON * (left.abs() + right.abs());
    // The bounds hold a floor far above what underflow can lose; overflow makes this comparison fail.
    if n.abs() > bound { Some(order_from(n > 0.0, p_above_1, p_above_2)) } else { None }
}

/// The same in twice the precision: for faces nearly in one plane, over which the ends of the edge are as high as rounding made them.
#[must_use]
pub(crate) fn compare_in_double_double(
    p: &[f64; 3],
    q: &[f64; 3],
    first: [&[f64; 3]; 3],
    second: [&[f64; 3]; 3],
    p_above_1: bool,
    p_above_2: bool,
) -> Option<Sign> {
    // A product of two heights keeps all of its digits from here on.
    const LOW: f64 = f64::from_bits((1023 - 900) << 52);
    // Products and their difference are off by less than 2^-100 of themselves.
    const ERROR: f64 = f64::from_bits((1023 - 97) << 52);
    let [(a0, a0_bound), (a1, a1_bound)] = near_heights([p, q], first)?;
    let [(b0, b0_bound), (b1, b1_bound)] = near_heights([p, q], second)?;
    let (left, right) = (a0 * b1, b0 * a1);
    let n = left - right;
    let [a0, a1, b0, b1, left, right] = [a0, a1, b0, b1, left, right].map(|x| x.high.abs());
    if left < LOW || right < LOW {
        return None;
    }
    // (The last factor is for the rounding of the bound itself.)
    let bound = ((a0 + a0_bound) * b1_bound
        + b1 * a0_bound
        + (b0 + b0_bound) * a1_bound
        + a1 * b0_bound
        + ERROR * (left + right))
        * (1.0 + 16.0 * f64::EPSILON);
    (n.high.abs() > bound).then(|| order_from(n.high > 0.0, p_above_1, p_above_2))
}

fn order_from(n_positive: bool, p_above_1: bool, p_above_2: bool) -> Sign {
    // sign(t1 - t2) = -sign(N) sign(D(T1; p)) sign(D(T2; p)).
    if n_positive ^ p_above_1 ^ p_above_2 { Sign::Negative } else { Sign::Positive }
}

/// The sign of `t1 - t2`, exactly, for perturbed points; `p` and `q` must lie on different (perturbed) sides of both
/// triangles. Zero only if the two crossings coincide identically: for the same triangle given twice.
#[must_use]
pub(crate) fn compare(
    p: &PerturbedPoint,
    q: &PerturbedPoint,
    first: [&PerturbedPoint; 3],
    second: [&PerturbedPoint; 3],
) -> Sign {
    let all = [p, q].into_iter().chain(first).chain(second);
    let lattice = Lattice::of(all.flat_map(|point| &point.position));
    if lattice.is_tiny()
        && let Some(sign) = compare_low(p, q, first, second, lattice)
    {
        return sign;
    }
    let height = |t: [&PerturbedPoint; 3], x| Polynomial::new([t[0], t[1], t[2], x], lattice);
    let (a0, a1) = (height(first, p), height(first, q));
    let (b0, b1) = (height(second, p), height(second, q));
    for exponent in 0..=2 * EXPONENTS[COEFFICIENTS - 1] {
        let mut n = Integer::zero();
        for (i, j) in pairs_of_power(exponent) {
            let (left, right) =
                (a0.coefficient(i).times(b1.coefficient(j)), b0.coefficient(i).times(a1.coefficient(j)));
            n = n.plus(&left).minus(&right);
        }
        if !n.is_zero() {
            return order_from(n.signum() > 0, a0.is_positive(), b0.is_positive());
        }
    }
    Sign::Zero
}

/// Places of two coefficients whose product belongs to a power of the infinitesimal.
fn pairs_of_power(exponent: usize) -> impl Iterator<Item = (usize, usize)> {
    let all = (0..COEFFICIENTS).flat_map(|i| (0..COEFFICIENTS).map(move |j| (i, j)));
    all.filter(move |&(i, j)| EXPONENTS[i] + EXPONENTS[j] == exponent)
}

/// [`compare`] for coordinates on a [tiny](Lattice::is_tiny) lattice, if powers that first directions alone give can tell.
fn compare_low(
    p: &PerturbedPoint,
    q: &PerturbedPoint,
    first: [&PerturbedPoint; 3],
    second: [&PerturbedPoint; 3],
    lattice: Lattice,
) -> Option<Sign> {
    let height = |t: [&PerturbedPoint; 3], x| low_coefficients([t[0], t[1], t[2], x], lattice);
    let (a0, a1) = (height(first, p), height(first, q));
    let (b0, b1) = (height(second, p), height(second, q));
    let n = (0..2 * LOW_COEFFICIENTS - 1)
        .map(|power| {
            let places = power.saturating_sub(LOW_COEFFICIENTS - 1)..=power.min(LOW_COEFFICIENTS - 1);
            places.map(|i| a0[i] * b1[power - i] - b0[i] * a1[power - i]).sum::<i128>()
        })
        .find(|&n| n != 0)?;
    let is_positive = |low: &[i128; LOW_COEFFICIENTS]| low.iter().find(|&&x| x != 0).map(|&x| x > 0);
    Some(order_from(n > 0, is_positive(&a0)?, is_positive(&b0)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    use crate::exact::perturbed::tests::{degenerate, lowest, minus, reference, times};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    type Compare = fn(&[f64; 3], &[f64; 3], [&[f64; 3]; 3], [&[f64; 3]; 3], bool, bool) -> Option<Sign>;

    /// What a stage without perturbation tells of an edge and two triangles, given the sides of its ends.
    fn answer(compare: Compare, points: &[PerturbedPoint; 8], sides: [Sign; 4]) -> Option<Sign> {
        let [p, q, a, b, c, d, e, f] = points.each_ref().map(|point| &point.position);
        let above = |sign: Sign| sign == Sign::Positive;
        compare(p, q, [a, b, c], [d, e, f], above(sides[0]), above(sides[2]))
    }

    #[test]
    fn faces_nearly_in_one_plane_with_the_edge_agree_with_integers() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let (mut told, mut tried) = (0, 0);
        for round in 0..4_000 {
            let scale = 10f64.powi(round % 60 - 30);
            // Points of one plane askew, each coordinate rounded.
            let mut point = || {
                let [s, t]: [f64; 2] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
                let position = [s + 0.3 * t + 0.7, 0.2 * s - t + 0.1, 0.6 * s + 0.5 * t - 0.4];
                PerturbedPoint { position: position.map(|x| x * scale), first: [0; 3], second: [0; 3] }
            };
            let points: [PerturbedPoint; 8] = std::array::from_fn(|_| point());
            let [p, q, rest @ ..] = points.each_ref();
            let (first, second) = ([rest[0], rest[1], rest[2]], [rest[3], rest[4], rest[5]]);
            let side = |t: [&PerturbedPoint; 3], x: &PerturbedPoint| {
                crate::exact::orient3d(&t[0].position, &t[1].position, &t[2].position, &x.position)
            };
            let sides = [side(first, p), side(first, q), side(second, p), side(second, q)];
            if sides.contains(&Sign::Zero) || sides[0] == sides[1] || sides[2] == sides[3] {
                continue;
            }
            tried += 1;
            let found = answer(compare_in_double_double, &points, sides);
            if let Some(sign) = found {
                told += 1;
                assert_eq!(sign, compare(p, q, first, second), "{points:?}");
            }
        }
        assert!(tried > 300 && told * 10 > tried * 9, "{told} of {tried}");
    }

    #[test]
    fn agrees_with_rationals_at_every_order() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (mut orders, mut filtered, mut in_double_double, mut tried) = ([0u32; 49], 0, 0, 0);
        for round in 0..60_000 {
            let scale = [1.0, 0.3, 1e-90][round % 3];
            let points: [PerturbedPoint; 8] =
                std::array::from_fn(|i| degenerate(&mut rng, (8 * round + i) as u64, scale));
            let [p, q, rest @ ..] = points.each_ref();
            let (first, second) = ([rest[0], rest[1], rest[2]], [rest[3], rest[4], rest[5]]);
            let height = |t: [&PerturbedPoint; 3], x| reference([t[0], t[1], t[2], x]);
            let (a0, a1, b0, b1) = (height(first, p), height(first, q), height(second, p), height(second, q));
            let sides = [&a0, &a1, &b0, &b1].map(|polynomial| lowest(polynomial).1);
            if sides.contains(&Sign::Zero) || sides[0] == sides[1] || sides[2] == sides[3] {
                continue;
            }
            tried += 1;
            // t1 < t2 by the definition, with the denominators made positive.
            let denominator =
                |x: &_, y: &_| if lowest(x).1 == Sign::Positive { minus(x, y) } else { minus(y, x) };
            let numerator = |x: &BTreeMap<_, _>| {
                if lowest(x).1 == Sign::Positive { x.clone() } else { minus(&BTreeMap::new(), x) }
            };
            let difference = minus(
                &times(&numerator(&a0), &denominator(&b0, &b1)),
                &times(&numerator(&b0), &denominator(&a0, &a1)),
            );
            let (order, expected) = lowest(&difference);
            assert_eq!(compare(p, q, first, second), expected, "order {order}");
            if let Some(count) = orders.get_mut(order) {
                *count += 1;
            }
            if let Some(sign) = answer(compare_filter, &points, sides) {
                filtered += 1;
                assert_eq!(sign, expected, "filter");
            }
            if let Some(sign) = answer(compare_in_double_double, &points, sides) {
                in_double_double += 1;
                assert_eq!(sign, expected, "twice the precision");
            }
        }
        assert!(in_double_double > 100, "{in_double_double}");
        assert!(tried > 10_000 && filtered > 500, "{tried} {filtered}");
        for exponent in [0, 1, 2, 3, 16, 17, 18, 32] {
            assert!(orders[exponent] > 0, "order {exponent} must occur: {orders:?}");
        }
    }
}

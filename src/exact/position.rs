//! Where an edge crosses a triangle, correctly rounded.
//!
//! The crossing of edge `(p, q)` with the plane of `T` is `X = (D(T; p) q - D(T; q) p) / (D(T; p) - D(T; q))`. Each
//! coordinate is rounded once, to the nearest `f64`. So crossings that coincide exactly get the same bits, whichever edge
//! and triangle they come from: identification by position is safe, and results carry no rounding cracks.
//! Double-double arithmetic with an error bound decides most roundings, exact integers the rest. Where the edge lies in the
//! plane, the limit for a vanishing perturbation is taken: the first coefficients of `D(T; p)` and `D(T; q)` that are not
//! both zero take their place.

use super::double_double::DoubleDouble;
use super::integer::Integer;
use super::lattice::Lattice;
use super::near::{Near, round};
use super::orient::determinant;
use super::perturbed::{COEFFICIENTS, PerturbedPoint, Polynomial};
use super::residue::Residue;
use super::vector::{cross, difference, dot};

/// The crossing point of edge `(p, q)` with the plane of the triangle, if double-double arithmetic can round it with
/// certainty; the fast path of [`crossing`].
#[must_use]
pub(crate) fn crossing_filter(p: &[f64; 3], q: &[f64; 3], triangle: [&[f64; 3]; 3]) -> Option<[f64; 3]> {
    round(&near_crossing(p, q, triangle)?)
}

/// The crossing point of edge `(p, q)` with the plane of the triangle up to errors, if double-double arithmetic can tell.
#[inline]
pub(super) fn near_crossing(p: &[f64; 3], q: &[f64; 3], triangle: [&[f64; 3]; 3]) -> Option<[Near; 3]> {
    const LOW: f64 = f64::from_bits((1023 - 300) << 52);
    const HIGH: f64 = f64::from_bits((1023 + 300) << 52);
    let [a, b, c] = triangle;
    let difference = |x: &[f64; 3], y: &[f64; 3]| -> [DoubleDouble; 3] {
        std::array::from_fn(|k| DoubleDouble::difference(x[k], y[k]))
    };
    let size = |v: &[DoubleDouble; 3]| v.iter().fold(0.0f64, |size, x| size.max(x.high.abs()));
    let (u, v) = (difference(b, a), difference(c, a));
    let (to_p, to_q, along) = (difference(p, a), difference(q, a), difference(q, p));
    let (size_u, size_v, size_along) = (size(&u), size(&v), size(&along));
    let reach = size(&to_p).max(size(&to_q));
    if [size_u, size_v, size_along, reach].iter().any(|&s| !(LOW..=HIGH).contains(&s)) {
        return None;
    }
    let normal: [DoubleDouble; 3] = std::array::from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        u[l] * v[m] - u[m] * v[l]
    });
    let height = |x: &[DoubleDouble; 3]| normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2];
    let (height_p, height_q) = (height(&to_p), height(&to_q));
    // Every height is a sum of six products of at most this size, each a few times 2^-104 off: 2^-98 of it is generous.
    between(p, q, [height_p, height_q], size_u * size_v * reach)
}

/// The point of edge `(p, q)` at which a linear function is zero that has the heights at its ends, up to errors. Each height is at
/// most 2^-98 of `scale` off.
#[inline]
pub(super) fn between(
    p: &[f64; 3],
    q: &[f64; 3],
    [height_p, height_q]: [DoubleDouble; 2],
    scale: f64,
) -> Option<[Near; 3]> {
    const TINY: f64 = f64::from_bits((1023 - 900) << 52);
    let along: [DoubleDouble; 3] = std::array::from_fn(|k| DoubleDouble::difference(q[k], p[k]));
    let total = height_p - height_q;
    let condition = scale / total.high.abs();
    if condition.is_nan() || condition > f64::from_bits((1023 + 36) << 52) {
        return None;
    }
    let t = height_p / total;
    let t_error = f64::from_bits((1023 - 94) << 52) * (condition + 1.0);
    let mut position = p.map(Near::exactly);
    for k in 0..3 {
        if along[k].high == 0.0 {
            continue;
        }
        if along[k].high.abs() < TINY {
            return None;
        }
        let error = along[k].high.abs() * t_error
            + f64::from_bits((1023 - 97) << 52) * (p[k].abs() + along[k].high.abs());
        position[k] = Near { value: DoubleDouble::from(p[k]) + along[k] * t, error };
    }
    Some(position)
}

/// The crossing point of edge `(p, q)` with the plane of the triangle, each coordinate correctly rounded (to nearest, ties
/// to even; a zero is positive). `p` and `q` must lie on different (perturbed) sides.
///
/// # Panics
/// If the perturbed points do not lie on different sides (the two heights then may agree identically).
#[must_use]
pub(crate) fn crossing(p: &PerturbedPoint, q: &PerturbedPoint, triangle: [&PerturbedPoint; 3]) -> [f64; 3] {
    let points = [p, q, triangle[0], triangle[1], triangle[2]];
    let lattice = Lattice::of(points.into_iter().flat_map(|point| &point.position));
    let (numerators, denominator) = homogeneous(p, q, triangle, lattice);
    numerators.map(|numerator| numerator.quotient(&denominator, i64::from(lattice.exponent)) + 0.0)
}

/// The crossing point of edge `(p, q)` with the plane of the triangle: three numerators, in units of the lattice, and their
/// denominator.
pub(super) fn homogeneous(
    p: &PerturbedPoint,
    q: &PerturbedPoint,
    triangle: [&PerturbedPoint; 3],
    lattice: Lattice,
) -> ([Integer; 3], Integer) {
    let [a, b, c] = triangle;
    // Nearly always the heights of the unperturbed ends tell.
    let plain = |x: &PerturbedPoint| {
        let [u, v, w] = [a, b, c].map(|point| -> [Integer; 3] {
            std::array::from_fn(|k| lattice.integer(point.position[k]).minus(&lattice.integer(x.position[k])))
        });
        determinant(&u, &v, &w)
    };
    let (height_p, height_q) = (plain(p), plain(q));
    let (height_p, height_q) = if height_p.is_zero() && height_q.is_zero() {
        let [all_p, all_q] = [p, q].map(|end| Polynomial::new([a, b, c, end], lattice));
        let order = (0..COEFFICIENTS)
            .find(|&k| all_p.coefficient(k) != all_q.coefficient(k))
            .expect("the ends of a crossing edge lie on different sides");
        (all_p.coefficient(order).clone(), all_q.coefficient(order).clone())
    } else {
        (height_p, height_q)
    };
    let numerators = std::array::from_fn(|k| {
        height_p
            .times(&lattice.integer(q.position[k]))
            .minus(&height_q.times(&lattice.integer(p.position[k])))
    });
    (numerators, height_p.minus(&height_q))
}

/// The same modulo a prime, where that tells that an end of the edge is off the plane.
pub(super) fn residues(
    p: &PerturbedPoint,
    q: &PerturbedPoint,
    triangle: [&PerturbedPoint; 3],
) -> Option<([Residue; 3], Residue)> {
    let of = |point: &PerturbedPoint| point.position.map(Residue::of);
    let ([a, b, c], [p, q]) = (triangle.map(of), [p, q].map(of));
    let normal = cross(&difference(&b, &a), &difference(&c, &a));
    let [height_p, height_q] = [p, q].map(|end| dot(&normal, &difference(&end, &a)));
    if height_p.is_zero() && height_q.is_zero() {
        return None;
    }
    let numerators = std::array::from_fn(|k| height_p * q[k] - height_q * p[k]);
    Some((numerators, height_p - height_q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    use crate::exact::Sign;
    use crate::exact::perturbed::tests::{degenerate, lowest, reference};
    use dashu::rational::RBig;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn unperturbed(position: [f64; 3]) -> PerturbedPoint {
        PerturbedPoint { position, first: [0; 3], second: [0; 3] }
    }

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).expect("finite")
    }

    /// No `f64` is nearer to `value` than `rounded`; at equal distance the last bit is even.
    fn assert_nearest(rounded: f64, value: &RBig) {
        let distance = |x: f64| (exact(x) - value).max(value - exact(x));
        let here = distance(rounded);
        for neighbour in [rounded.next_up(), rounded.next_down()] {
            let there = distance(neighbour);
            assert!(here < there || (here == there && rounded.to_bits() & 1 == 0), "{rounded} for {value}");
        }
    }

    fn limit(p: &PerturbedPoint, q: &PerturbedPoint, t: [&PerturbedPoint; 3], k: usize) -> Option<RBig> {
        let (hp, hq) = (reference([t[0], t[1], t[2], p]), reference([t[0], t[1], t[2], q]));
        let ((order_p, side_p), (order_q, side_q)) = (lowest(&hp), lowest(&hq));
        if side_p == side_q || side_p == Sign::Zero || side_q == Sign::Zero {
            return None;
        }
        let order = order_p.min(order_q);
        let at = |polynomial: &BTreeMap<usize, RBig>| polynomial.get(&order).cloned().unwrap_or(RBig::ZERO);
        let (hp, hq) = (at(&hp), at(&hq));
        Some((&hp * exact(q.position[k]) - &hq * exact(p.position[k])) / (&hp - &hq))
    }

    #[test]
    fn limits_of_degenerate_crossings_are_correctly_rounded() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut tried = 0;
        for round in 0..20_000 {
            let scale = [1.0, 0.1, 1e-200, 1e250][round % 4];
            let points: [PerturbedPoint; 5] =
                std::array::from_fn(|i| degenerate(&mut rng, (5 * round + i) as u64, scale));
            let [p, q, a, b, c] = points.each_ref();
            for k in 0..3 {
                if let Some(expected) = limit(p, q, [a, b, c], k) {
                    tried += 1;
                    assert_nearest(crossing(p, q, [a, b, c])[k], &expected);
                }
            }
        }
        assert!(tried > 5_000, "{tried}");
    }

    #[test]
    fn generic_crossings_are_correctly_rounded_and_the_filter_decides_most() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let (mut tried, mut decided) = (0, 0);
        for round in 0..20_000 {
            let size = [1.0, 1e-9, 1e6][round % 3];
            let mut point = || unperturbed(std::array::from_fn(|_| 0.7 + size * rng.random_range(-1.0..1.0)));
            let points: [PerturbedPoint; 5] = std::array::from_fn(|_| point());
            let [p, q, a, b, c] = points.each_ref();
            let Some(expected) = limit(p, q, [a, b, c], 0) else { continue };
            tried += 1;
            let rounded = crossing(p, q, [a, b, c]);
            assert_nearest(rounded[0], &expected);
            let fast = crossing_filter(&p.position, &q.position, [&a.position, &b.position, &c.position]);
            if let Some(fast) = fast {
                decided += 1;
                assert_eq!(fast, rounded);
            }
        }
        assert!(tried > 1_000 && decided * 100 > tried * 99, "{decided} of {tried}");
    }

    #[test]
    fn coincident_crossings_get_the_same_bits() {
        // Three planes through one point: each edge of the one crosses the others there.
        let apex = [0.1, 0.2, 0.3];
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        for _ in 0..500 {
            let mut direction =
                || -> [f64; 3] { std::array::from_fn(|_| f64::from(rng.random_range(-8i32..9)) / 8.0) };
            let along = |d: [f64; 3], t: f64| unperturbed(std::array::from_fn(|k| apex[k] + t * d[k]));
            let (d, u, v) = (direction(), direction(), direction());
            let t = [along(u, 1.0), along(v, 1.0), unperturbed(apex)];
            let (p, q) = (along(d, 1.0), unperturbed(apex));
            let sides = reference([&t[0], &t[1], &t[2], &p]);
            if lowest(&sides).1 != Sign::Zero {
                assert_eq!(crossing(&p, &q, t.each_ref()), apex);
            }
        }
    }
}

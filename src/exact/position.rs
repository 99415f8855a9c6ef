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
use super::orient::determinant;
use super::perturbed::{COEFFICIENTS, PerturbedPoint, Polynomial};
use super::planes;

/// The crossing point of edge `(p, q)` with the plane of the triangle, if double-double arithmetic can round it with
/// certainty; the fast path of [`crossing`].
#[must_use]
pub(crate) fn crossing_filter(p: &[f64; 3], q: &[f64; 3], triangle: [&[f64; 3]; 3]) -> Option<[f64; 3]> {
    round(&near_crossing(p, q, triangle)?)
}

/// A number known up to an error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) value: DoubleDouble,
    pub(super) error: f64,
}

impl Near {
    fn exactly(value: f64) -> Self {
        Self { value: DoubleDouble::from(value), error: 0.0 }
    }
}

/// A point, each coordinate rounded to nearest, if the errors leave no doubt.
#[inline]
pub(super) fn round(near: &[Near; 3]) -> Option<[f64; 3]> {
    let mut position = [0.0; 3];
    for (rounded, Near { value: x, error }) in position.iter_mut().zip(near) {
        let error = error + x.low.abs() * 4.0 * f64::EPSILON;
        let (from_above, from_below) = (x.high + (x.low + error), x.high + (x.low - error));
        if from_above != from_below {
            return None;
        }
        *rounded = from_above + 0.0;
    }
    Some(position)
}

/// The crossing point of edge `(p, q)` with the plane of the triangle up to errors, if double-double arithmetic can tell.
#[inline]
fn near_crossing(p: &[f64; 3], q: &[f64; 3], triangle: [&[f64; 3]; 3]) -> Option<[Near; 3]> {
    const LOW: f64 = f64::from_bits((1023 - 300) << 52);
    const HIGH: f64 = f64::from_bits((1023 + 300) << 52);
    const TINY: f64 = f64::from_bits((1023 - 900) << 52);
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
    let total = height_p - height_q;
    // Every height is a sum of six products of at most this size, each a few times 2^-104 off: 2^-98 of it is generous.
    let scale = size_u * size_v * reach;
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
fn homogeneous(
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

/// A point as it was before it was rounded.
#[derive(Clone, Debug)]
pub(crate) enum Unrounded {
    /// A given point.
    Given([f64; 3]),
    /// The crossing point of an edge with the plane of a triangle; see [`crossing`].
    Crossing(Box<([PerturbedPoint; 2], [PerturbedPoint; 3])>),
    /// The point in which the planes of three triangles meet; see [`planes`](super::planes).
    Planes(Box<[[PerturbedPoint; 3]; 3]>),
}

impl Unrounded {
    fn near(&self) -> Option<[Near; 3]> {
        match self {
            Self::Given(position) => Some(position.map(Near::exactly)),
            Self::Crossing(of) => {
                let ([p, q], triangle) = &**of;
                near_crossing(&p.position, &q.position, triangle.each_ref().map(|corner| &corner.position))
            }
            Self::Planes(of) => {
                planes::near_meeting(of.each_ref().map(|face| face.each_ref().map(|corner| &corner.position)))
            }
        }
    }

    /// The given coordinates it is made of.
    fn coordinates(&self) -> Vec<&[f64; 3]> {
        match self {
            Self::Given(position) => vec![position],
            Self::Crossing(of) => of.0.iter().chain(&of.1).map(|p| &p.position).collect(),
            Self::Planes(of) => of.iter().flatten().map(|p| &p.position).collect(),
        }
    }

    /// Three numerators in units of a lattice, and their denominator.
    fn homogeneous(&self, lattice: Lattice) -> ([Integer; 3], Integer) {
        match self {
            Self::Given(position) => (position.map(|x| lattice.integer(x)), Integer::from(1)),
            Self::Crossing(of) => homogeneous(&of.0[0], &of.0[1], of.1.each_ref(), lattice),
            Self::Planes(of) => planes::homogeneous(of.each_ref().map(<[_; 3]>::each_ref), lattice),
        }
    }
}

/// Whether double-double arithmetic is certain that three points do not lie on one line.
fn surely_off_line(points: &[Unrounded; 3]) -> bool {
    /// A sum of two products of differences is a few times 2^-104 of its terms off: this is generous.
    const ROUNDING: f64 = f64::from_bits((1023 - 97) << 52);
    const FLOOR: f64 = f64::from_bits((1023 - 900) << 52);
    let [x, y, z] = points.each_ref().map(Unrounded::near);
    let (Some(x), Some(y), Some(z)) = (x, y, z) else { return false };
    let difference = |from: &[Near; 3], to: &[Near; 3]| -> [Near; 3] {
        std::array::from_fn(|k| {
            let value = to[k].value - from[k].value;
            let size = to[k].value.high.abs() + from[k].value.high.abs();
            Near { value, error: to[k].error + from[k].error + ROUNDING * size }
        })
    };
    let (u, v) = (difference(&x, &y), difference(&x, &z));
    let size = |near: Near| near.value.high.abs() + near.error;
    (0..3).any(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        let cross = u[l].value * v[m].value - u[m].value * v[l].value;
        let error = |a: Near, b: Near| size(a) * b.error + size(b) * a.error + ROUNDING * size(a) * size(b);
        // (Not a number where something overflowed.)
        cross.high.abs() > 2.0 * (error(u[l], v[m]) + error(u[m], v[l])) + FLOOR
    })
}

/// Whether three points lie on one line, exactly.
///
/// # Panics
/// As [`crossing`].
pub(crate) fn on_one_line(points: &[Unrounded; 3]) -> bool {
    if surely_off_line(points) {
        return false;
    }
    let lattice = Lattice::of(points.iter().flat_map(Unrounded::coordinates).flatten());
    let [(x, w), (y, v), (z, u)] = points.each_ref().map(|point| point.homogeneous(lattice));
    let along = |y: &[Integer; 3], v: &Integer| -> [Integer; 3] {
        std::array::from_fn(|k| y[k].times(&w).minus(&x[k].times(v)))
    };
    let (first, second) = (along(&y, &v), along(&z, &u));
    (0..3).all(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        first[l].times(&second[m]) == first[m].times(&second[l])
    })
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
    fn crossings_with_one_line_lie_on_it_before_they_are_rounded() {
        let mut rng = ChaCha8Rng::seed_from_u64(10);
        let (mut seen_rounded_off, mut seen_beside, mut seen_by_filter) = (false, false, false);
        for _ in 0..500 {
            let mut point = || unperturbed(std::array::from_fn(|_| f64::from(rng.random_range(-20i32..21))));
            let line = [point(), point()];
            // Planes through the line, crossed by edges of another plane through it: all crossings lie on the line.
            let [beside, above] = [point(), point()];
            let other = |p: &PerturbedPoint, s: f64| {
                unperturbed(std::array::from_fn(|k| {
                    p.position[k] + s * (above.position[k] - line[0].position[k])
                }))
            };
            let crossing_at = |t: f64, apex: PerturbedPoint| {
                let at = |s: f64| -> [f64; 3] {
                    std::array::from_fn(|k| {
                        let (p, q) = (line[0].position[k], line[1].position[k]);
                        p + (t + s) * (q - p)
                    })
                };
                let edge = [other(&unperturbed(at(-0.5)), 1.0), other(&unperturbed(at(2.0)), -2.0)];
                let height = |p: &PerturbedPoint| {
                    crate::exact::orient3d(&line[0].position, &line[1].position, &apex.position, &p.position)
                };
                let (x, y) = (height(&edge[0]), height(&edge[1]));
                (x != Sign::Zero && y != Sign::Zero && x != y)
                    .then(|| Unrounded::Crossing(Box::new((edge, [line[0], line[1], apex]))))
            };
            let (Some(x), Some(y)) = (crossing_at(1.0, beside), crossing_at(3.0, beside)) else { continue };
            let end = Unrounded::Given(line[0].position);
            assert!(on_one_line(&[end.clone(), x.clone(), y.clone()]));
            let rounded = |point: &Unrounded| match point {
                Unrounded::Given(position) => *position,
                Unrounded::Crossing(of) => crossing(&of.0[0], &of.0[1], of.1.each_ref()),
                Unrounded::Planes(of) => planes::meeting(of.each_ref().map(<[_; 3]>::each_ref)),
            };
            seen_rounded_off |= !crate::exact::collinear(&rounded(&end), &rounded(&x), &rounded(&y));
            let near = Unrounded::Given(rounded(&y).map(|coordinate| coordinate + 1.0));
            if !crate::exact::collinear(&rounded(&end), &line[1].position, &rounded(&near)) {
                seen_beside = true;
                let points = [end, x, near];
                seen_by_filter |= surely_off_line(&points);
                assert!(!on_one_line(&points));
            }
        }
        assert!(seen_rounded_off && seen_beside && seen_by_filter);
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

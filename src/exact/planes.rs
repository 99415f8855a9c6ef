//! Three planes in a point, and the order of such points along the line of two planes.
//!
//! The plane of a triangle (a, b, c) is `n.x = d` with `n = (b - a) x (c - a)` and `d = n.a`. Three of them, f, g and h, meet
//! in
//!
//! ```text
//! X = (d_f (n_g x n_h) + d_g (n_h x n_f) + d_h (n_f x n_g)) / det(n_f, n_g, n_h)
//! ```
//!
//! Each coordinate is rounded once, like every other point (`position`): points that coincide exactly get the same bits,
//! whatever they are made of. Where the determinant vanishes, the limit for a vanishing perturbation is taken: the first power
//! of the infinitesimal whose coefficient of it does not vanish, above and below.
//!
//! The determinant of the four rows `(n, d)` tells on which side of the fourth plane the meeting point of the first three
//! lies: `n_k.X - d_k = -D4(f, g, h, k) / det(n_f, n_g, n_h)`.

use super::Sign;
use super::double_double::DoubleDouble;
use super::integer::Integer;
use super::lattice::Lattice;
use super::near::{Near, round};
use super::perturbed::{POWERS, PerturbedPoint};
use super::residue::Residue;
use super::vector::{cross, difference, dot};

/// The corners of a triangle.
type Triangle<'a> = [&'a PerturbedPoint; 3];

/// Powers of the infinitesimal up to which the polynomials are computed, one after the other, until a coefficient does not
/// vanish: plain coordinates; few first directions; all of them (the degree of D4 is 9); everything.
const STAGES: [usize; 4] = [0, 2, 9, 9 * POWERS[2]];

/// The point in which three triangles' planes meet, if double-double arithmetic can round it with certainty; the fast path of
/// [`meeting`].
#[must_use]
pub(crate) fn meeting_filter(faces: [[&[f64; 3]; 3]; 3]) -> Option<[f64; 3]> {
    round(&near_meeting(faces)?)
}

/// The same up to errors.
pub(super) fn near_meeting(faces: [[&[f64; 3]; 3]; 3]) -> Option<[Near; 3]> {
    const LOW: f64 = f64::from_bits((1023 - 100) << 52);
    const HIGH: f64 = f64::from_bits((1023 + 100) << 52);
    let reference = faces[0][0];
    let difference = |x: &[f64; 3], y: &[f64; 3]| -> [DoubleDouble; 3] {
        std::array::from_fn(|k| DoubleDouble::difference(x[k], y[k]))
    };
    let size = |v: &[DoubleDouble; 3]| v.iter().fold(0.0f64, |size, x| size.max(x.high.abs()));
    let zero = DoubleDouble::from(0.0);
    let mut normals = [[zero; 3]; 3];
    let mut offsets = [zero; 3];
    // The product of all sizes, and the longest way from the reference: both bound every term.
    let (mut scale, mut reach) = (1.0f64, 0.0f64);
    for i in 0..3 {
        let [a, b, c] = faces[i];
        let (u, v, from) = (difference(b, a), difference(c, a), difference(a, reference));
        let (size_u, size_v) = (size(&u), size(&v));
        if ![size_u, size_v].iter().all(|s| (LOW..=HIGH).contains(s)) || size(&from) > HIGH {
            return None;
        }
        normals[i] = cross(&u, &v);
        offsets[i] = dot(&normals[i], &from);
        scale *= 2.0 * size_u * size_v;
        reach = reach.max(size(&from));
    }
    let [f, g, h] = &normals;
    let (gh, hf, fg) = (cross(g, h), cross(h, f), cross(f, g));
    let determinant = dot(f, &gh);
    // Each normal is a few times 2^-104 of its size off, and so are sums of some dozens of products of them: 2^-96 of all
    // sizes is generous.
    let condition = scale / determinant.high.abs();
    if condition.is_nan() || condition > f64::from_bits((1023 + 34) << 52) {
        return None;
    }
    let relative = f64::from_bits((1023 - 92) << 52) * (condition + 1.0);
    let mut near = reference.map(|x| Near { value: DoubleDouble::from(x), error: 0.0 });
    for k in 0..3 {
        let numerator = offsets[0] * gh[k] + offsets[1] * hf[k] + offsets[2] * fg[k];
        let way = numerator / determinant;
        let error = relative * (way.high.abs() + reach)
            + f64::from_bits((1023 - 97) << 52) * (reference[k].abs() + way.high.abs());
        near[k] = Near { value: DoubleDouble::from(reference[k]) + way, error };
    }
    Some(near)
}

/// The point in which three triangles' planes meet, each coordinate correctly rounded (to nearest, ties to even; a zero is
/// positive).
///
/// # Panics
/// If the perturbed planes do not meet in a point.
#[must_use]
pub(crate) fn meeting(faces: [Triangle<'_>; 3]) -> [f64; 3] {
    let lattice = Lattice::of(faces.iter().flatten().flat_map(|point| &point.position));
    let (numerators, denominator) = homogeneous(faces, lattice);
    numerators.map(|numerator| numerator.quotient(&denominator, i64::from(lattice.exponent)) + 0.0)
}

/// The same as three numerators, in units of the lattice, and their denominator.
pub(super) fn homogeneous(faces: [Triangle<'_>; 3], lattice: Lattice) -> ([Integer; 3], Integer) {
    let reference = faces[0][0].position.map(|x| lattice.integer(x));
    for limit in STAGES {
        let [f, g, h] = faces.map(|face| Plane::new(face, &reference, lattice, limit));
        let (gh, hf, fg) = (
            cross_series(&g.normal, &h.normal, limit),
            cross_series(&h.normal, &f.normal, limit),
            cross_series(&f.normal, &g.normal, limit),
        );
        let determinant = dot_series(&f.normal, &gh, limit);
        let Some((power, denominator)) = determinant.lowest() else { continue };
        let numerators = std::array::from_fn(|k| {
            let terms = [(&f.offset, &gh[k]), (&g.offset, &hf[k]), (&h.offset, &fg[k])];
            let way = terms.iter().fold(Series::default(), |sum, (d, n)| sum.plus(&d.times(n, power)));
            let way = way.coefficient(power).cloned().unwrap_or_default();
            way.plus(&reference[k].times(denominator))
        });
        return (numerators, denominator.clone());
    }
    unreachable!("perturbed planes of three faces that cross pairwise meet in a point")
}

/// The same modulo a prime, where that tells that the planes meet in a point as they are.
pub(super) fn residues(faces: [Triangle<'_>; 3]) -> Option<([Residue; 3], Residue)> {
    let faces = faces.map(|face| face.map(|corner| corner.position.map(Residue::of)));
    let reference = faces[0][0];
    let normals = faces.map(|[a, b, c]| cross(&difference(&b, &a), &difference(&c, &a)));
    let [f, g, h] = &normals;
    let around = [cross(g, h), cross(h, f), cross(f, g)];
    let denominator = dot(f, &around[0]);
    if denominator.is_zero() {
        return None;
    }
    let offset = |i: usize| dot(&normals[i], &difference(&faces[i][0], &reference));
    let offsets = [offset(0), offset(1), offset(2)];
    let numerators =
        std::array::from_fn(|k| dot(&offsets, &around.map(|way| way[k])) + reference[k] * denominator);
    Some((numerators, denominator))
}

/// The sign of `D4` of four triangles' planes, perturbed; zero only if it vanishes identically.
#[must_use]
pub(crate) fn order(faces: [Triangle<'_>; 4]) -> Sign {
    let lattice = Lattice::of(faces.iter().flatten().flat_map(|point| &point.position));
    let reference = faces[0][0].position.map(|x| lattice.integer(x));
    for limit in STAGES {
        let planes = faces.map(|face| Plane::new(face, &reference, lattice, limit));
        let normal = |i: usize| &planes[i].normal;
        // By the last column: the cofactor of row i, of four, has the sign of i + 3.
        let minor = |i: usize, j: usize, k: usize| {
            dot_series(normal(i), &cross_series(normal(j), normal(k), limit), limit)
        };
        let term = |i: usize, minor: &Series| planes[i].offset.times(minor, limit);
        let sum = term(3, &minor(0, 1, 2))
            .minus(&term(2, &minor(0, 1, 3)))
            .plus(&term(1, &minor(0, 2, 3)))
            .minus(&term(0, &minor(1, 2, 3)));
        if let Some((_, coefficient)) = sum.lowest() {
            return Sign::of_i32(coefficient.signum());
        }
    }
    Sign::Zero
}

/// A polynomial in the infinitesimal: powers, ascending, with coefficients that are not zero.
#[derive(Clone, Debug, Default)]
struct Series(Vec<(usize, Integer)>);

impl Series {
    fn lowest(&self) -> Option<(usize, &Integer)> {
        self.0.first().map(|(power, coefficient)| (*power, coefficient))
    }

    fn coefficient(&self, power: usize) -> Option<&Integer> {
        self.0.iter().find(|term| term.0 == power).map(|term| &term.1)
    }

    fn combined(&self, other: &Self, combine: impl Fn(&Integer, &Integer) -> Integer) -> Self {
        let zero = Integer::zero();
        let (mut x, mut y) = (self.0.iter().peekable(), other.0.iter().peekable());
        let mut terms = Vec::with_capacity(self.0.len() + other.0.len());
        loop {
            let next = match (x.peek(), y.peek()) {
                (None, None) => break,
                (Some(a), None) => a.0,
                (None, Some(b)) => b.0,
                (Some(a), Some(b)) => a.0.min(b.0),
            };
            let a = x.next_if(|term| term.0 == next).map_or(&zero, |term| &term.1);
            let b = y.next_if(|term| term.0 == next).map_or(&zero, |term| &term.1);
            let sum = combine(a, b);
            if !sum.is_zero() {
                terms.push((next, sum));
            }
        }
        Self(terms)
    }

    fn plus(&self, other: &Self) -> Self {
        self.combined(other, Integer::plus)
    }

    fn minus(&self, other: &Self) -> Self {
        self.combined(other, Integer::minus)
    }

    /// The product without powers above `limit`.
    fn times(&self, other: &Self, limit: usize) -> Self {
        let mut product = Self::default();
        for (power, x) in &self.0 {
            let row = other.0.iter().take_while(|term| power + term.0 <= limit);
            let row = Self(row.map(|(p, y)| (power + p, x.times(y))).collect());
            product = if product.0.is_empty() { row } else { product.plus(&row) };
        }
        product
    }
}

/// The plane of a perturbed triangle, in units of a lattice and from a point of reference.
struct Plane {
    normal: [Series; 3],
    offset: Series,
}

impl Plane {
    fn new(triangle: Triangle<'_>, reference: &[Integer; 3], lattice: Lattice, limit: usize) -> Self {
        let [a, b, c] = triangle;
        let series = |terms: [Integer; 3]| {
            let terms = POWERS.into_iter().zip(terms);
            Series(terms.filter(|(power, x)| *power <= limit && !x.is_zero()).collect())
        };
        let position = |p: &PerturbedPoint, k: usize| lattice.integer(p.position[k]);
        let small = |x: i32| Integer::from(i64::from(x));
        let to = |p: &PerturbedPoint| -> [Series; 3] {
            std::array::from_fn(|k| {
                series([
                    position(p, k).minus(&position(a, k)),
                    small(p.first[k] - a.first[k]),
                    small(p.second[k] - a.second[k]),
                ])
            })
        };
        let normal = cross_series(&to(b), &to(c), limit);
        let from: [Series; 3] = std::array::from_fn(|k| {
            series([position(a, k).minus(&reference[k]), small(a.first[k]), small(a.second[k])])
        });
        let offset = dot_series(&normal, &from, limit);
        Self { normal, offset }
    }
}

fn cross_series(u: &[Series; 3], v: &[Series; 3], limit: usize) -> [Series; 3] {
    std::array::from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        u[l].times(&v[m], limit).minus(&u[m].times(&v[l], limit))
    })
}

fn dot_series(u: &[Series; 3], v: &[Series; 3], limit: usize) -> Series {
    (0..3).fold(Series::default(), |sum, k| sum.plus(&u[k].times(&v[k], limit)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::perturbed::tests::{Polynomial, coordinate, degenerate, lowest, minus, times};
    use dashu::rational::RBig;
    use rand::SeedableRng;
    use rand::rngs::ChaCha8Rng;

    fn plus(a: &Polynomial, b: &Polynomial) -> Polynomial {
        minus(a, &minus(&Polynomial::new(), b))
    }

    /// Normal and offset as polynomials with rational coefficients.
    fn plane(triangle: Triangle<'_>) -> ([Polynomial; 3], Polynomial) {
        let [a, b, c] = triangle;
        let to = |p: &PerturbedPoint| -> [Polynomial; 3] {
            std::array::from_fn(|k| minus(&coordinate(p, k), &coordinate(a, k)))
        };
        let normal = product(&to(b), &to(c));
        let from: [Polynomial; 3] = std::array::from_fn(|k| coordinate(a, k));
        let offset = sum(&normal, &from);
        (normal, offset)
    }

    fn product(u: &[Polynomial; 3], v: &[Polynomial; 3]) -> [Polynomial; 3] {
        std::array::from_fn(|k| {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            minus(&times(&u[l], &v[m]), &times(&u[m], &v[l]))
        })
    }

    fn sum(u: &[Polynomial; 3], v: &[Polynomial; 3]) -> Polynomial {
        (0..3).fold(Polynomial::new(), |sum, k| plus(&sum, &times(&u[k], &v[k])))
    }

    fn points(rng: &mut ChaCha8Rng, count: usize, scale: f64, round: usize) -> Vec<PerturbedPoint> {
        (0..count).map(|i| degenerate(rng, (16 * round + i) as u64, scale)).collect()
    }

    fn triangle(points: &[PerturbedPoint], i: usize) -> Triangle<'_> {
        [&points[3 * i], &points[3 * i + 1], &points[3 * i + 2]]
    }

    #[test]
    fn four_planes_agree_with_rationals() {
        let mut rng = ChaCha8Rng::seed_from_u64(31);
        let mut powers = std::collections::BTreeMap::<usize, u32>::new();
        for round in 0..1_500 {
            let scale = [1.0, 0.1, 1e-200, 1e200][round % 4];
            let points = points(&mut rng, 12, scale, round);
            let faces: [Triangle<'_>; 4] = std::array::from_fn(|i| triangle(&points, i));
            let planes = faces.map(plane);
            let minor =
                |i: usize, j: usize, k: usize| sum(&planes[i].0, &product(&planes[j].0, &planes[k].0));
            let term = |i: usize, minor: Polynomial| times(&planes[i].1, &minor);
            let expected = plus(
                &minus(&term(3, minor(0, 1, 2)), &term(2, minor(0, 1, 3))),
                &minus(&term(1, minor(0, 2, 3)), &term(0, minor(1, 2, 3))),
            );
            let (power, expected) = lowest(&expected);
            *powers.entry(power).or_default() += 1;
            assert_eq!(order(faces), expected, "round {round}");
        }
        assert!(powers.len() > 6, "decided at too few orders: {powers:?}");
    }

    #[test]
    fn meeting_points_are_correctly_rounded_limits() {
        let mut rng = ChaCha8Rng::seed_from_u64(32);
        let (mut limits, mut plain) = (0, 0);
        for round in 0..1_500 {
            let scale = [1.0, 0.1, 1e-100, 1e100][round % 4];
            let points = points(&mut rng, 9, scale, round);
            let faces: [Triangle<'_>; 3] = std::array::from_fn(|i| triangle(&points, i));
            let [f, g, h] = faces.map(plane);
            let (gh, hf, fg) = (product(&g.0, &h.0), product(&h.0, &f.0), product(&f.0, &g.0));
            let determinant = sum(&f.0, &gh);
            let Some((&power, denominator)) = determinant.first_key_value() else { continue };
            let numerators: [Polynomial; 3] = std::array::from_fn(|k| {
                plus(&plus(&times(&f.1, &gh[k]), &times(&g.1, &hf[k])), &times(&h.1, &fg[k]))
            });
            // Else the planes meet at infinity.
            if numerators.iter().any(|n| n.first_key_value().is_some_and(|(&p, _)| p < power)) {
                continue;
            }
            let found = meeting(faces);
            for k in 0..3 {
                let exact = numerators[k].get(&power).cloned().unwrap_or(RBig::ZERO) / denominator;
                assert_eq!(found[k], exact.to_f64().value() + 0.0, "round {round}");
            }
            if power == 0 {
                plain += 1;
                if let Some(near) = meeting_filter(faces.map(|face| face.map(|p| &p.position))) {
                    assert_eq!(near, found);
                }
            } else {
                limits += 1;
            }
        }
        assert!(limits > 100 && plain > 100, "{limits} {plain}");
    }

    #[test]
    fn the_filter_rounds_as_integers_do() {
        use rand::RngExt;
        let mut rng = ChaCha8Rng::seed_from_u64(33);
        let mut decided = 0;
        for _ in 0..3_000 {
            let points: Vec<PerturbedPoint> = (0..9)
                .map(|_| PerturbedPoint {
                    position: std::array::from_fn(|_| rng.random_range(-1.0..1.0)),
                    first: [0; 3],
                    second: [0; 3],
                })
                .collect();
            let faces: [Triangle<'_>; 3] = std::array::from_fn(|i| triangle(&points, i));
            if let Some(near) = meeting_filter(faces.map(|face| face.map(|p| &p.position))) {
                decided += 1;
                assert_eq!(near, meeting(faces));
            }
        }
        assert!(decided > 2_900, "{decided}");
    }
}

//! Points as they were before they were rounded, and whether three of them lie on one line.

use super::integer::Integer;
use super::lattice::Lattice;
use super::perturbed::PerturbedPoint;
use super::residue::Residue;
use super::vector::cross;
use super::{planes, position};

/// A point as it was before it was rounded.
#[derive(Clone, Debug)]
pub(crate) enum Unrounded {
    /// A given point.
    Given([f64; 3]),
    /// The crossing point of an edge with the plane of a triangle; see [`position`].
    Crossing(Box<([PerturbedPoint; 2], [PerturbedPoint; 3])>),
    /// The point in which the planes of three triangles meet; see [`planes`].
    Planes(Box<[[PerturbedPoint; 3]; 3]>),
}

impl Unrounded {
    /// Three numerators and their denominator modulo a prime, if that can tell which they are.
    fn residues(&self) -> Option<([Residue; 3], Residue)> {
        match self {
            Self::Given(point) => Some((point.map(Residue::of), Residue::ONE)),
            Self::Crossing(of) => position::residues(&of.0[0], &of.0[1], of.1.each_ref()),
            Self::Planes(of) => planes::residues(of.each_ref().map(<[_; 3]>::each_ref)),
        }
    }

    /// The given coordinates it is made of.
    fn coordinates(&self) -> Vec<&[f64; 3]> {
        match self {
            Self::Given(point) => vec![point],
            Self::Crossing(of) => of.0.iter().chain(&of.1).map(|p| &p.position).collect(),
            Self::Planes(of) => of.iter().flatten().map(|p| &p.position).collect(),
        }
    }

    /// Three numerators in units of a lattice, and their denominator.
    fn homogeneous(&self, lattice: Lattice) -> ([Integer; 3], Integer) {
        match self {
            Self::Given(point) => (point.map(|x| lattice.integer(x)), Integer::from(1)),
            Self::Crossing(of) => position::homogeneous(&of.0[0], &of.0[1], of.1.each_ref(), lattice),
            Self::Planes(of) => planes::homogeneous(of.each_ref().map(<[_; 3]>::each_ref), lattice),
        }
    }
}

/// Whether three points do not lie on one line for certain: the cross product of two differences is not zero modulo a prime.
fn surely_off_line(points: &[Unrounded; 3]) -> bool {
    let [Some((x, w)), Some((y, v)), Some((z, u))] = points.each_ref().map(Unrounded::residues) else {
        return false;
    };
    let along =
        |y: &[Residue; 3], v: Residue| -> [Residue; 3] { std::array::from_fn(|k| y[k] * w - x[k] * v) };
    cross(&along(&y, v), &along(&z, u)).iter().any(|part| !part.is_zero())
}

/// Whether three points lie on one line, exactly.
///
/// # Panics
/// As [`position::crossing`].
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
    use crate::exact::Sign;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn unperturbed(position: [f64; 3]) -> PerturbedPoint {
        PerturbedPoint { position, first: [0; 3], second: [0; 3] }
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
                Unrounded::Crossing(of) => position::crossing(&of.0[0], &of.0[1], of.1.each_ref()),
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
    fn residues_are_those_of_the_point() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut tried = [0; 2];
        for _ in 0..500 {
            let mut random =
                || -> [f64; 3] { std::array::from_fn(|_| f64::from(rng.random_range(-50i32..51))) };
            let at = random();
            let moved = |by: &[[f64; 3]], times: &[f64]| {
                unperturbed(std::array::from_fn(|k| {
                    at[k] + by.iter().zip(times).map(|(d, t)| d[k] * t).sum::<f64>()
                }))
            };
            let mut plane = || {
                let ways = [random(), random()];
                [[1.0, 0.0], [0.5, -2.0], [-1.0, 3.0]].map(|times| moved(&ways, &times))
            };
            let faces = [plane(), plane(), plane()];
            let way = random();
            let edge = [moved(&[way], &[1.0]), moved(&[way], &[-2.5])];
            let points =
                [Unrounded::Crossing(Box::new((edge, faces[0]))), Unrounded::Planes(Box::new(faces))];
            for (i, point) in points.iter().enumerate() {
                let Some((numerators, denominator)) = point.residues() else { continue };
                tried[i] += 1;
                for k in 0..3 {
                    assert_eq!(numerators[k], Residue::of(at[k]) * denominator, "{point:?}");
                }
            }
        }
        assert!(tried.iter().all(|&count| count > 400), "{tried:?}");
    }
}

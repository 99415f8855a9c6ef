//! Points as they were before they were rounded, and whether three of them lie on one line.

use super::integer::Integer;
use super::lattice::Lattice;
use super::near::Near;
use super::perturbed::PerturbedPoint;
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
    fn near(&self) -> Option<[Near; 3]> {
        match self {
            Self::Given(point) => Some(point.map(Near::exactly)),
            Self::Crossing(of) => {
                let ([p, q], triangle) = &**of;
                position::near_crossing(
                    &p.position,
                    &q.position,
                    triangle.each_ref().map(|corner| &corner.position),
                )
            }
            Self::Planes(of) => {
                planes::near_meeting(of.each_ref().map(|face| face.each_ref().map(|corner| &corner.position)))
            }
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
}

//! Planes, the side of a point against one, and where an edge passes through it, without rounding.

use super::double_double::DoubleDouble;
use super::integer::Integer;
use super::lattice::Lattice;
use super::near::round;
use super::orient::determinant;
use super::perturbed::PerturbedPoint;
use super::{Projection, Sign, collinear, orient2d, orient3d, position};

/// A plane, with an upper side. It has no size and no edges, and is exactly the one that its numbers tell.
///
/// ```
/// use trisect::exact::{Plane, Sign};
/// let level = Plane::across(2, 12.5)?;
/// assert_eq!(level.side(&[3.0, 4.0, 12.5]), Sign::Zero);
/// assert_eq!(level.side(&[3.0, 4.0, 12.5f64.next_up()]), Sign::Positive);
/// let slope = Plane::new([1.0, 0.0, 1.0], 3.0)?;
/// assert_eq!(slope.side(&[1.0, 7.0, 1.0]), Sign::Negative);
/// let same = Plane::through([3.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 3.0])?;
/// assert_eq!(same.side(&[1.0, 7.0, 1.0]), Sign::Negative);
/// # Ok::<(), trisect::exact::PlaneFault>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    given: Given,
    projection: Projection,
}

/// How a plane is given.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Given {
    /// Where one coordinate has a value.
    Across { axis: usize, at: f64 },
    /// `normal . x = offset`.
    Coefficients { normal: [f64; 3], offset: f64 },
    /// By three points, counter-clockwise seen from above.
    Points([[f64; 3]; 3]),
}

/// Why numbers are no plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaneFault {
    /// A number is infinite or not a number.
    #[error("a plane is given by finite numbers")]
    NotFinite,
    /// An axis other than 0, 1 and 2.
    #[error("there is no axis {0}: 0, 1 and 2 are x, y and z")]
    Axis(usize),
    /// All three coefficients are zero.
    #[error("a plane's normal is not 0,0,0")]
    NoNormal,
    /// The three points lie on one line.
    #[error("three points on one line are in many planes")]
    OneLine,
}

impl Plane {
    /// Where the coordinate along an axis (0 for x, 1 for y, 2 for z) is `at`; above is where it is larger.
    ///
    /// # Errors
    /// [`PlaneFault::Axis`], [`PlaneFault::NotFinite`].
    pub fn across(axis: usize, at: f64) -> Result<Self, PlaneFault> {
        if axis > 2 {
            return Err(PlaneFault::Axis(axis));
        }
        check(&[at])?;
        let projection = Projection::seen_from(axis, true);
        Ok(Self { given: Given::Across { axis, at }, projection })
    }

    /// All points `x` with `normal . x = offset`; above is where it is larger. The normal may have any length.
    ///
    /// # Errors
    /// [`PlaneFault::NotFinite`], [`PlaneFault::NoNormal`].
    pub fn new(normal: [f64; 3], offset: f64) -> Result<Self, PlaneFault> {
        check(&normal)?;
        check(&[offset])?;
        let axis = largest(&normal);
        if normal[axis] == 0.0 {
            return Err(PlaneFault::NoNormal);
        }
        let projection = Projection::seen_from(axis, normal[axis] > 0.0);
        // The commonest planes have a faster test.
        if normal.iter().filter(|&&x| x != 0.0).count() == 1 && normal[axis] == 1.0 {
            return Self::across(axis, offset);
        }
        Ok(Self { given: Given::Coefficients { normal, offset }, projection })
    }

    /// Through three points; they are seen counter-clockwise from above.
    ///
    /// # Errors
    /// [`PlaneFault::NotFinite`], [`PlaneFault::OneLine`].
    pub fn through(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> Result<Self, PlaneFault> {
        [a, b, c].iter().try_for_each(|point| check(point))?;
        if collinear(&a, &b, &c) {
            return Err(PlaneFault::OneLine);
        }
        let points = [a, b, c];
        let flat = |axis: usize| {
            let projection = Projection::seen_from(axis, true);
            let [a, b, c] = points.map(|point| projection.project(&point));
            orient2d(a, b, c)
        };
        // The axis that the normal is largest along; for needles, whose normal is rounded away, any that it has a part along.
        let first = Projection::of(&points).axis();
        let axis = [first, (first + 1) % 3, (first + 2) % 3]
            .into_iter()
            .find(|&axis| flat(axis) != Sign::Zero)
            .ok_or(PlaneFault::OneLine)?;
        let projection = Projection::seen_from(axis, flat(axis) == Sign::Positive);
        Ok(Self { given: Given::Points(points), projection })
    }

    /// On which side of the plane a point is, exactly: positive above, negative below.
    #[must_use]
    pub fn side(&self, point: &[f64; 3]) -> Sign {
        match &self.given {
            Given::Across { axis, at } => sign_of(point[*axis], *at),
            Given::Coefficients { normal, offset } => {
                // Three products and three sums, each half a unit in the last place off: this is twice as much. What underflow
                // loses is below the floor.
                const FLOOR: f64 = 8.0 * f64::MIN_POSITIVE;
                let terms = [normal[0] * point[0], normal[1] * point[1], normal[2] * point[2]];
                let height = terms[0] + terms[1] + terms[2] - offset;
                let size = terms[0].abs() + terms[1].abs() + terms[2].abs() + offset.abs();
                if height.abs() > 4.0 * f64::EPSILON * size + FLOOR {
                    return sign_of(height, 0.0);
                }
                let lattice = self.lattice(&[point]);
                Sign::of_i32(self.height(point, lattice).signum())
            }
            Given::Points([a, b, c]) => match orient3d(a, b, c, point) {
                Sign::Positive => Sign::Negative,
                Sign::Zero => Sign::Zero,
                Sign::Negative => Sign::Positive,
            },
        }
    }

    /// A vector of about unit length that is at right angles to the plane and points up.
    #[must_use]
    pub fn normal(&self) -> [f64; 3] {
        let scaled = |v: [f64; 3]| {
            let size = v.iter().fold(0.0f64, |size, x| size.max(x.abs()));
            let v = v.map(|x| x / size);
            let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            v.map(|x| x / length)
        };
        match &self.given {
            Given::Across { axis, .. } => std::array::from_fn(|k| f64::from(u8::from(k == *axis))),
            Given::Coefficients { normal, .. } => scaled(*normal),
            Given::Points([a, b, c]) => {
                let size = [a, b, c].into_iter().flatten().fold(0.0f64, |size, x| size.max(x.abs()));
                let edge = |p: &[f64; 3], q: &[f64; 3]| -> [f64; 3] {
                    std::array::from_fn(|k| q[k] / size - p[k] / size)
                };
                let (u, v) = (edge(a, b), edge(a, c));
                let across: [f64; 3] = std::array::from_fn(|k| {
                    let (l, m) = ((k + 1) % 3, (k + 2) % 3);
                    u[l] * v[m] - u[m] * v[l]
                });
                if across.iter().any(|&x| x != 0.0) { scaled(across) } else { self.axis_direction() }
            }
        }
    }

    /// A point on the plane or a rounding off it: the nearest to the origin, or one that the plane was given by.
    #[must_use]
    pub fn point(&self) -> [f64; 3] {
        match &self.given {
            Given::Across { axis, at } => std::array::from_fn(|k| if k == *axis { *at } else { 0.0 }),
            Given::Coefficients { normal, offset } => {
                let size = normal.iter().fold(0.0f64, |size, x| size.max(x.abs()));
                let unit = normal.map(|x| x / size);
                let square = unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2];
                unit.map(|x| x * (offset / size) / square)
            }
            Given::Points([a, ..]) => *a,
        }
    }

    /// The axis and the value, if the plane is across an axis.
    #[must_use]
    pub fn as_level(&self) -> Option<(usize, f64)> {
        match self.given {
            Given::Across { axis, at } => Some((axis, at)),
            _ => None,
        }
    }

    /// Two axes onto which the plane is projected, seen from above.
    pub(crate) fn projection(&self) -> Projection {
        self.projection
    }

    /// Where an edge whose ends are strictly on different sides passes through, each coordinate correctly rounded.
    ///
    /// # Panics
    /// If the ends are not on different sides.
    pub(crate) fn crossing(&self, p: &[f64; 3], q: &[f64; 3]) -> [f64; 3] {
        let position = self.crossing_filter(p, q).unwrap_or_else(|| self.crossing_exact(p, q));
        match self.given {
            // Exactly, whichever way it is computed.
            Given::Across { axis, at } => {
                std::array::from_fn(|k| if k == axis { at + 0.0 } else { position[k] })
            }
            _ => position,
        }
    }

    /// The same in double-double arithmetic, if that is certain.
    fn crossing_filter(&self, p: &[f64; 3], q: &[f64; 3]) -> Option<[f64; 3]> {
        /// Within 2^-200 and 2^200 no product of two numbers, nor its last bit, leaves the range.
        const RANGE: std::ops::RangeInclusive<f64> =
            f64::from_bits((1023 - 200) << 52)..=f64::from_bits((1023 + 200) << 52);
        let in_range = |x: &f64| *x == 0.0 || RANGE.contains(&x.abs());
        if !p.iter().chain(q).all(in_range) {
            return None;
        }
        let near = match &self.given {
            Given::Across { axis, at } => {
                if !in_range(at) {
                    return None;
                }
                let heights = [p, q].map(|end| DoubleDouble::difference(end[*axis], *at));
                let scale = heights[0].high.abs() + heights[1].high.abs();
                position::between(p, q, heights, scale)
            }
            Given::Coefficients { normal, offset } => {
                if !normal.iter().all(in_range) || !in_range(offset) {
                    return None;
                }
                let height = |x: &[f64; 3]| {
                    let [a, b, c] =
                        [0, 1, 2].map(|k| DoubleDouble::from(normal[k]) * DoubleDouble::from(x[k]));
                    (a + b + c - DoubleDouble::from(*offset), a.high.abs() + b.high.abs() + c.high.abs())
                };
                let (of_p, of_q) = (height(p), height(q));
                position::between(p, q, [of_p.0, of_q.0], of_p.1 + of_q.1 + offset.abs())
            }
            Given::Points([a, b, c]) => position::near_crossing(p, q, [a, b, c]),
        };
        round(&near?)
    }

    /// The same in integers.
    fn crossing_exact(&self, p: &[f64; 3], q: &[f64; 3]) -> [f64; 3] {
        if let Given::Points(points) = &self.given {
            let still =
                |position: &[f64; 3]| PerturbedPoint { position: *position, first: [0; 3], second: [0; 3] };
            let corners = points.each_ref().map(still);
            return position::crossing(&still(p), &still(q), corners.each_ref());
        }
        let lattice = self.lattice(&[p, q]);
        let (height_p, height_q) = (self.height(p, lattice), self.height(q, lattice));
        let total = height_p.minus(&height_q);
        std::array::from_fn(|k| {
            let numerator =
                height_p.times(&lattice.integer(q[k])).minus(&height_q.times(&lattice.integer(p[k])));
            numerator.quotient(&total, i64::from(lattice.exponent)) + 0.0
        })
    }

    /// A lattice of the coordinates of points and of one.
    fn lattice(&self, points: &[&[f64; 3]]) -> Lattice {
        let own = if let Given::Across { at, .. } = &self.given { *at } else { 1.0 };
        Lattice::of(points.iter().copied().flatten().chain([&own]))
    }

    /// How far above a point of a lattice is, in a unit of its own, which depends on the lattice alone.
    fn height(&self, point: &[f64; 3], lattice: Lattice) -> Integer {
        match &self.given {
            Given::Across { axis, at } => lattice.integer(point[*axis]).minus(&lattice.integer(*at)),
            Given::Coefficients { normal, offset } => {
                let own = Lattice::of(normal.iter().chain([offset]));
                let terms = (0..3).map(|k| own.integer(normal[k]).times(&lattice.integer(point[k])));
                let sum = terms.fold(Integer::zero(), |sum, term| sum.plus(&term));
                sum.minus(&own.integer(*offset).times(&lattice.integer(1.0)))
            }
            Given::Points(points) => {
                let [u, v, w] = points.each_ref().map(|corner| -> [Integer; 3] {
                    std::array::from_fn(|k| lattice.integer(point[k]).minus(&lattice.integer(corner[k])))
                });
                determinant(&u, &v, &w)
            }
        }
    }

    fn axis_direction(&self) -> [f64; 3] {
        let axis = self.projection.axis();
        let up = self.projection == self.projection.along_axis();
        std::array::from_fn(|k| if k == axis { if up { 1.0 } else { -1.0 } } else { 0.0 })
    }
}

fn check(numbers: &[f64]) -> Result<(), PlaneFault> {
    if numbers.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(PlaneFault::NotFinite) }
}

/// The axis of the component that is largest by its absolute value.
fn largest(vector: &[f64; 3]) -> usize {
    (1..3).fold(0, |best, k| if vector[k].abs() > vector[best].abs() { k } else { best })
}

fn sign_of(value: f64, against: f64) -> Sign {
    if value > against {
        Sign::Positive
    } else if value < against {
        Sign::Negative
    } else {
        Sign::Zero
    }
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

    /// `normal . x - offset` of a plane as a rational, up to a positive factor.
    fn reference(plane: &Plane, x: &[f64; 3]) -> RBig {
        let x = x.map(exact);
        match &plane.given {
            Given::Across { axis, at } => &x[*axis] - exact(*at),
            Given::Coefficients { normal, offset } => {
                let terms = (0..3).map(|k| exact(normal[k]) * &x[k]);
                terms.fold(RBig::ZERO, |sum, term| sum + term) - exact(*offset)
            }
            Given::Points([a, b, c]) => {
                let edge = |p: &[f64; 3]| -> [RBig; 3] { std::array::from_fn(|k| exact(p[k]) - exact(a[k])) };
                let (u, v) = (edge(b), edge(c));
                (0..3).fold(RBig::ZERO, |sum, k| {
                    let (l, m) = ((k + 1) % 3, (k + 2) % 3);
                    sum + (&u[l] * &v[m] - &u[m] * &v[l]) * (&x[k] - exact(a[k]))
                })
            }
        }
    }

    fn random_plane(rng: &mut ChaCha8Rng, kind: usize, scale: f64, grid: bool) -> Plane {
        let number = |rng: &mut ChaCha8Rng| {
            if grid {
                scale * f64::from(rng.random_range(-3i32..4))
            } else {
                scale * rng.random_range(-1.0..1.0)
            }
        };
        loop {
            let mut point = || -> [f64; 3] { std::array::from_fn(|_| number(rng)) };
            let plane = match kind {
                0 => Plane::across(1, point()[0]),
                1 => Plane::new(point().map(|x| x / scale), point()[0]),
                _ => Plane::through(point(), point(), point()),
            };
            if let Ok(plane) = plane {
                return plane;
            }
        }
    }

    #[test]
    fn sides_and_crossings_agree_with_rationals() {
        let mut rng = ChaCha8Rng::seed_from_u64(190);
        let (mut on, mut crossed) = (0, 0);
        for round in 0..6_000 {
            let scale = [1.0, 0.1, 1e-200, 1e250][round % 4];
            let (kind, grid) = (round / 4 % 3, round % 7 < 3);
            let plane = random_plane(&mut rng, kind, scale, grid);
            let mut point = || -> [f64; 3] {
                std::array::from_fn(|_| {
                    if grid {
                        scale * f64::from(rng.random_range(-3i32..4))
                    } else {
                        scale * rng.random_range(-1.0..1.0)
                    }
                })
            };
            let (p, q) = (point(), point());
            let (hp, hq) = (reference(&plane, &p), reference(&plane, &q));
            let sign = |h: &RBig| {
                Sign::of_i32(if *h == RBig::ZERO {
                    0
                } else if *h < RBig::ZERO {
                    -1
                } else {
                    1
                })
            };
            assert_eq!(plane.side(&p), sign(&hp), "{plane:?} {p:?}");
            on += usize::from(sign(&hp) == Sign::Zero);
            if sign(&hp) as i8 * sign(&hq) as i8 >= 0 {
                continue;
            }
            crossed += 1;
            let found = plane.crossing(&p, &q);
            assert_eq!(found, plane.crossing(&q, &p));
            for k in 0..3 {
                let value = (&hp * exact(q[k]) - &hq * exact(p[k])) / (&hp - &hq);
                let distance = |x: f64| (exact(x) - &value).max(&value - exact(x));
                let here = distance(found[k]);
                for neighbour in [found[k].next_up(), found[k].next_down()] {
                    let there = distance(neighbour);
                    assert!(
                        here < there || here == there && found[k].to_bits() & 1 == 0,
                        "{plane:?} {p:?} {q:?}"
                    );
                }
            }
        }
        assert!(on > 100 && crossed > 1_000, "{on} {crossed}");
    }

    #[test]
    fn a_plane_is_seen_from_above() {
        let mut rng = ChaCha8Rng::seed_from_u64(191);
        for round in 0..300 {
            let plane = random_plane(&mut rng, round % 3, 1.0, round % 2 == 0);
            let (normal, point) = (plane.normal(), plane.point());
            let above: [f64; 3] = std::array::from_fn(|k| point[k] + normal[k]);
            assert_eq!(plane.side(&above), Sign::Positive, "{plane:?}");
            let projection = plane.projection();
            let axis = projection.axis();
            let up = Projection::seen_from(axis, true) == projection;
            assert_eq!(normal[axis] > 0.0, up, "{plane:?}");
        }
    }

    #[test]
    fn what_is_no_plane_is_told() {
        assert_eq!(Plane::across(3, 0.0), Err(PlaneFault::Axis(3)));
        assert_eq!(Plane::across(0, f64::NAN), Err(PlaneFault::NotFinite));
        assert_eq!(Plane::new([0.0; 3], 1.0), Err(PlaneFault::NoNormal));
        let line = [[0.0; 3], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0]];
        assert_eq!(Plane::through(line[0], line[1], line[2]), Err(PlaneFault::OneLine));
        assert_eq!(Plane::new([0.0, 1.0, 0.0], 2.0), Plane::across(1, 2.0));
    }
}

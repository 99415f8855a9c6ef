//! Judges for coordinates of any size: everything in integers, multiples of the smallest positive `f64`.

use std::collections::HashSet;

use dashu::base::{Abs, Signed, UnsignedAbs};
use dashu::integer::IBig;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{Mesh, Operation};

use super::vector::{self, Point};

/// A point, or a vector, in units of 2^-1074.
type Whole = [IBig; 3];

/// Binary digits after the point.
const DIGITS: usize = 1074;

/// A number in units of 2^-1074, exactly.
pub(crate) fn whole(x: f64) -> IBig {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as usize, bits & ((1 << 52) - 1));
    let mantissa = if exponent == 0 { fraction } else { fraction | 1 << 52 };
    let magnitude = IBig::from(mantissa) << exponent.saturating_sub(1);
    if x < 0.0 { -magnitude } else { magnitude }
}

fn point(p: &Point) -> Whole {
    p.map(whole)
}

fn minus(a: &Whole, b: &Whole) -> Whole {
    [0, 1, 2].map(|k| &a[k] - &b[k])
}

fn cross(a: &Whole, b: &Whole) -> Whole {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

fn dot(a: &Whole, b: &Whole) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Six times the enclosed volume, in units of 2^-3222.
pub(crate) fn six_volumes(mesh: &Mesh) -> IBig {
    let at: Vec<Whole> = mesh.positions.iter().map(point).collect();
    let Some(origin) = at.first() else { return IBig::ZERO };
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| minus(&at[corner as usize], origin));
        dot(&a, &cross(&b, &c))
    };
    mesh.triangles.iter().map(of).fold(IBig::ZERO, |sum, x| sum + x)
}

/// How much six times the volume of a result may be off, in units of 2^-3222: every vertex that no operand has may be off by so
/// many units in the last place of its own largest coordinate, along each axis.
pub(crate) fn six_volumes_of_rounding(mesh: &Mesh, operands: &[&Mesh], ulps: u32) -> IBig {
    let bits = |p: &Point| p.map(|x| (x + 0.0).to_bits());
    let old: HashSet<[u64; 3]> =
        operands.iter().flat_map(|operand| operand.positions.iter().map(bits)).collect();
    let at: Vec<Whole> = mesh.positions.iter().map(point).collect();
    let mut gradients = vec![[IBig::ZERO, IBig::ZERO, IBig::ZERO]; at.len()];
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| &at[corner as usize]);
        let normal = cross(&minus(b, a), &minus(c, a));
        for &corner in corners {
            let gradient = &mut gradients[corner as usize];
            (0..3).for_each(|k| gradient[k] += &normal[k]);
        }
    }
    let mut sum = IBig::ZERO;
    for (position, gradient) in mesh.positions.iter().zip(&gradients) {
        if !old.contains(&bits(position)) {
            let size = whole(position.iter().fold(0.0f64, |most, x| most.max(x.abs())));
            let reach = ((size * ulps) >> 52) + 1;
            sum += gradient.iter().map(|x| x.clone().abs()).fold(IBig::ZERO, |sum, x| sum + x) * reach;
        }
    }
    sum
}

/// A difference of volumes as words: its logarithm to the base ten.
pub(crate) fn logarithm(six: &IBig) -> f64 {
    let bits = six.unsigned_abs().bit_len() as f64;
    (bits - 3.0 * DIGITS as f64) * std::f64::consts::LOG10_2
}

trait BitLen {
    fn bit_len(&self) -> usize;
}

impl BitLen for dashu::integer::UBig {
    fn bit_len(&self) -> usize {
        dashu::base::BitTest::bit_len(self)
    }
}

/// Directions of rays; of small integers, so that the next one misses the edges that one meets.
const DIRECTIONS: [[i32; 3]; 4] = [[7, 3, 11], [-5, 13, 2], [3, -17, -8], [-11, -4, 19]];

/// The triangles of a closed mesh.
pub(crate) struct Surface {
    triangles: Vec<[Point; 3]>,
}

impl Surface {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let corners = |t: &[u32; 3]| t.map(|corner| mesh.positions[corner as usize]);
        Self { triangles: mesh.triangles.iter().map(corners).collect() }
    }

    /// How often the surface winds round a point; `None` if the point is on it, or every ray meets an edge.
    pub(crate) fn winding(&self, p: &Point) -> Option<i32> {
        DIRECTIONS.iter().find_map(|direction| self.along(p, direction))
    }

    /// The signed crossings of a ray.
    fn along(&self, p: &Point, direction: &[i32; 3]) -> Option<i32> {
        let mut winding = 0;
        for [a, b, c] in &self.triangles {
            // Positive where the ray passes the edge on its left.
            let sides = [(a, b), (b, c), (c, a)].map(|(u, v)| side_of_ray(p, direction, u, v));
            if sides.contains(&1) && sides.contains(&-1) {
                continue;
            }
            let below = sign_of_height(a, b, c, p);
            // All three on one side: the line meets the triangle. Ahead, if it leaves through the plane.
            let orientation: i32 = sides.iter().sum();
            if sides.contains(&0) {
                // Behind the point, or aside, it does not matter; that is not told apart here.
                return None;
            }
            if below == 0 {
                return None;
            }
            if (orientation > 0) == (below > 0) {
                winding += orientation.signum();
            }
        }
        Some(winding)
    }

    /// Whether the plane of some triangle is no further from a point than so many units in the last place of the point.
    pub(crate) fn is_near_a_plane(&self, p: &Point, ulps: u32) -> bool {
        let size = p.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let reach = ((whole(size) * ulps) >> 52) + 1;
        let at = point(p);
        self.triangles.iter().any(|corners| {
            let [a, b, c] = corners.each_ref().map(point);
            let normal = cross(&minus(&b, &a), &minus(&c, &a));
            let height = dot(&normal, &minus(&at, &a));
            &height * &height <= &reach * &reach * dot(&normal, &normal)
        })
    }
}

/// `count` points beside the smaller operand, and beside what is new, from its size down to a few roundings.
pub(crate) fn points_beside(a: &Mesh, b: &Mesh, results: &[Mesh], count: usize, seed: u64) -> Vec<Point> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let size = |mesh: &Mesh| {
        let [low, high] = vector::extent(&mesh.positions);
        (0..3).map(|k| high[k] - low[k]).fold(0.0f64, f64::max)
    };
    let small = if size(a) <= size(b) { a } else { b };
    let scale = size(small);
    let near: Vec<&Mesh> =
        std::iter::once(small).chain(results.iter().filter(|r| !r.triangles.is_empty())).collect();
    (0..count)
        .map(|index| {
            let mesh = near[index % near.len()];
            let corners = mesh.triangles[random.random_range(0..mesh.triangles.len())];
            let [p, q, r] = corners.map(|corner| mesh.positions[corner as usize]);
            let at = if index % 3 == 0 {
                p
            } else {
                let middle = |k: usize| 0.5 * p[k] + 0.25 * q[k] + 0.25 * r[k];
                [0, 1, 2].map(middle)
            };
            let normal = vector::unit(vector::cross(
                vector::unit(vector::minus(q, p)),
                vector::unit(vector::minus(r, p)),
            ));
            let aside = [0; 3].map(|_| random.random_range(-0.5..0.5));
            let step = scale * 10f64.powf(random.random_range(-12.0..0.0));
            vector::plus(at, vector::plus(normal, aside, 1.0), if random.random() { step } else { -step })
        })
        .filter(|p| p.iter().all(|x| x.is_finite()))
        .collect()
}

/// A point no further from a surface than so many units in its own last place may be on either side.
const ROUNDING_ULPS: u32 = 16;

/// How many points were judged, and those where a result winds otherwise than its operands and the operation say.
pub(crate) fn judge(
    operation: Operation,
    operands: [&Mesh; 2],
    result: &Mesh,
    points: &[Point],
) -> (usize, Vec<Point>) {
    let (surfaces, outcome) = (operands.map(Surface::new), Surface::new(result));
    let (mut judged, mut mistakes) = (0, Vec::new());
    for p in points {
        let [Some(w), Some(v)] = surfaces.each_ref().map(|surface| surface.winding(p)) else { continue };
        let Some(found) = outcome.winding(p) else { continue };
        judged += 1;
        let is_rounding = || surfaces.iter().any(|surface| surface.is_near_a_plane(p, ROUNDING_ULPS));
        if found != super::oracle::expected(operation, &[w, v]) && !is_rounding() {
            mistakes.push(*p);
        }
    }
    (judged, mistakes)
}

/// The sign of a determinant of three vectors in `f64`, where that is certain.
fn certain_sign(u: Point, v: Point, w: Point) -> Option<i32> {
    let (mut sum, mut permanent) = (0.0f64, 0.0f64);
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        sum += w[k] * (u[i] * v[j] - u[j] * v[i]);
        permanent += w[k].abs() * ((u[i] * v[j]).abs() + (u[j] * v[i]).abs());
    }
    (permanent.is_finite() && permanent > 1e-250 && sum.abs() > 1e-14 * permanent).then_some(if sum > 0.0 {
        1
    } else {
        -1
    })
}

fn sign(x: &IBig) -> i32 {
    if *x == IBig::ZERO {
        0
    } else if x.is_negative() {
        -1
    } else {
        1
    }
}

fn side_of_ray(p: &Point, direction: &[i32; 3], u: &Point, v: &Point) -> i32 {
    let from = |q: &Point| [0, 1, 2].map(|k| q[k] - p[k]);
    certain_sign(from(u), from(v), direction.map(f64::from)).unwrap_or_else(|| {
        let p = point(p);
        let (u, v) = (minus(&point(u), &p), minus(&point(v), &p));
        sign(&dot(&direction.map(IBig::from), &cross(&u, &v)))
    })
}

/// Positive where `p` is on the inner side of a triangle.
fn sign_of_height(a: &Point, b: &Point, c: &Point, p: &Point) -> i32 {
    let from = |q: &Point| [0, 1, 2].map(|k| q[k] - p[k]);
    certain_sign(from(a), from(b), from(c)).unwrap_or_else(|| {
        let p = point(p);
        let [a, b, c] = [a, b, c].map(|q| minus(&point(q), &p));
        sign(&dot(&a, &cross(&b, &c)))
    })
}

/// Six times the volume that two convex solids share, in units of 2^-3222 and rounded to 2^-3222 per face.
pub(crate) fn six_shared(a: &Mesh, b: &Mesh) -> IBig {
    let (of_a, of_b) = (faces(a), faces(b));
    let mut sum = IBig::ZERO;
    for (corners, _) in &of_a {
        let clipped = of_b.iter().fold(corners.clone(), |polygon, (_, plane)| clipped(&polygon, plane));
        sum += six_cones(&clipped);
    }
    for (corners, plane) in &of_b {
        // A face that both have counts once.
        if !of_a.iter().any(|(_, other)| are_the_same(plane, other)) {
            let clipped = of_a.iter().fold(corners.clone(), |polygon, (_, plane)| clipped(&polygon, plane));
            sum += six_cones(&clipped);
        }
    }
    sum
}

/// x, y, z over the positive fourth.
type Homogeneous = [IBig; 4];

fn lowest_terms(values: Homogeneous) -> Homogeneous {
    use dashu::base::Gcd;
    let mut divisor = IBig::ONE;
    for (index, value) in values.iter().filter(|value| **value != IBig::ZERO).enumerate() {
        divisor = if index == 0 { value.clone().abs() } else { IBig::from(divisor.gcd(value)) };
    }
    values.map(|x| x / &divisor)
}

/// The triangles, and their planes n x <= d.
fn faces(mesh: &Mesh) -> Vec<(Vec<Homogeneous>, Homogeneous)> {
    let face = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| point(&mesh.positions[corner as usize]));
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let offset = dot(&normal, &a);
        let [x, y, z] = normal;
        let corners = [a, b, c].map(|[x, y, z]| [x, y, z, IBig::ONE]).to_vec();
        (corners, lowest_terms([x, y, z, offset]))
    };
    mesh.triangles.iter().map(face).collect()
}

fn are_the_same(plane: &Homogeneous, other: &Homogeneous) -> bool {
    plane == other
}

fn beyond(plane: &Homogeneous, p: &Homogeneous) -> IBig {
    &plane[0] * &p[0] + &plane[1] * &p[1] + &plane[2] * &p[2] - &plane[3] * &p[3]
}

/// The part of a convex polygon on the inner side of a plane.
fn clipped(polygon: &[Homogeneous], plane: &Homogeneous) -> Vec<Homogeneous> {
    let heights: Vec<IBig> = polygon.iter().map(|p| beyond(plane, p)).collect();
    let mut kept = Vec::new();
    for (i, p) in polygon.iter().enumerate() {
        let j = (i + 1) % polygon.len();
        let (s, t) = (sign(&heights[i]), sign(&heights[j]));
        if s <= 0 {
            kept.push(p.clone());
        }
        if s * t < 0 {
            let crossing = [0, 1, 2, 3].map(|k| &polygon[j][k] * &heights[i] - &p[k] * &heights[j]);
            let crossing = if crossing[3].is_negative() { crossing.map(|x| -x) } else { crossing };
            kept.push(lowest_terms(crossing));
        }
    }
    kept
}

/// Six times the volume of the cone from the origin over a polygon, rounded down to a unit for each triangle.
fn six_cones(polygon: &[Homogeneous]) -> IBig {
    let mut sum = IBig::ZERO;
    for i in 2..polygon.len() {
        let [a, b, c] = [&polygon[0], &polygon[i - 1], &polygon[i]];
        let vector = |p: &Homogeneous| [p[0].clone(), p[1].clone(), p[2].clone()];
        let determinant = dot(&vector(a), &cross(&vector(b), &vector(c)));
        sum += determinant / (&a[3] * &b[3] * &c[3]);
    }
    sum
}

//! Volume, area and centroid.
//!
//! Volume is the sum over triangles (a, b, c) of (a - o) . ((b - a) x (c - a)) / 6, with o the middle of the mesh:
//! edges instead of three long vectors, so that a small triangle adds a small rounding error. Sums are compensated
//! and formed over pieces of fixed length, hence the same bits for any number of threads. The error bound is summed
//! alongside; where it is not far below the result (slivers, sheets, bodies that cancel) the sum is done again
//! without any rounding. Sizes far from one are brought near it by a power of two.

use std::cmp::Ordering;

use super::parallel::map_chunks;
use super::scale::{exponent, power_of_two};
use super::summation::{ExactSum, Sum};
use super::{Bounds, Mesh};

/// A volume with its sign, which holds also where the number itself under- or overflows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SignedVolume {
    pub(super) value: f64,
    pub(super) sign: Ordering,
}

impl Mesh {
    /// The signed volume, in cubed units of the coordinates: the integral of the winding number. Means the
    /// enclosed volume if the triangles are closed and face outwards. Triangles out of range are ignored.
    ///
    /// The relative error is below 1e-9 (usually near 1e-15), and a result that is a float is exact while the
    /// coordinates are small integers. Sizes beyond about 1e102 overflow to infinity. O(n).
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.bounds().map_or(0.0, |bounds| signed_volume(&self.positions, &self.triangles, &bounds).value)
    }

    /// The sign of the volume, exactly.
    pub(crate) fn volume_sign(&self) -> Ordering {
        let volume = |bounds: Bounds| signed_volume(&self.positions, &self.triangles, &bounds).sign;
        self.bounds().map_or(Ordering::Equal, volume)
    }

    /// The total area of the triangles, in squared units of the coordinates. O(n).
    #[must_use]
    pub fn area(&self) -> f64 {
        self.bounds().map_or(0.0, |bounds| area(&self.positions, &self.triangles, &bounds))
    }

    /// The centre of mass of the enclosed volume; `None` if the volume is zero. O(n).
    #[must_use]
    pub fn centroid(&self) -> Option<[f64; 3]> {
        centroid(&self.positions, &self.triangles, &self.bounds()?)
    }

    /// The smallest box round the triangles; `None` if there are none. O(n).
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let corners = self.triangles.iter().flatten();
        Bounds::of(corners.filter_map(|&corner| self.positions.get(corner as usize)))
    }
}

/// The place and unit that lengths are measured in.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// What coordinates are multiplied with: a power of two, one for ordinary sizes.
    scale: f64,
    /// The exponent of `scale`.
    exponent: i32,
    /// The origin, scaled.
    origin: [f64; 3],
}

impl Frame {
    fn new(bounds: &Bounds) -> Self {
        let size = (0..3).map(|axis| 0.5 * bounds.high[axis] - 0.5 * bounds.low[axis]).fold(0.0, f64::max);
        let size_exponent = exponent(size);
        // 2^300 cubed, thousands of times, is far from overflow.
        let exponent = if size_exponent.abs() <= 300 { 0 } else { -size_exponent.clamp(-1000, 1000) };
        let scale = power_of_two(exponent);
        Self { scale, exponent, origin: bounds.center().map(|x| x * scale) }
    }

    /// A volume, area or length (dimension 3, 2, 1) in the frame's unit, in the unit of the coordinates.
    fn unscaled(&self, value: f64, dimension: i32) -> f64 {
        (0..dimension).fold(value, |value, _| value * power_of_two(-self.exponent))
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A triangle as its first corner and the edges from there, in a frame.
#[derive(Clone, Copy)]
struct Spanned {
    corner: [f64; 3],
    edges: [[f64; 3]; 2],
}

/// The triangles that are in range, spanned.
fn spanned<'a>(
    positions: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    frame: &'a Frame,
) -> impl Iterator<Item = Spanned> + 'a {
    triangles.iter().filter_map(|&[a, b, c]| {
        let scaled = |corner: u32| Some(positions.get(corner as usize)?.map(|x| x * frame.scale));
        let (a, b, c) = (scaled(a)?, scaled(b)?, scaled(c)?);
        Some(Spanned { corner: difference(a, frame.origin), edges: [difference(b, a), difference(c, a)] })
    })
}

impl Spanned {
    #[inline]
    fn normal(&self) -> [f64; 3] {
        let [u, v] = self.edges;
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    }

    /// Six times the volume of the tetrahedron with the origin.
    #[inline]
    fn determinant(&self) -> f64 {
        let (a, n) = (self.corner, self.normal());
        a[0] * n[0] + a[1] * n[1] + a[2] * n[2]
    }

    /// The same with all terms positive: the rounding error of the determinant is below a few ulps of this.
    #[inline]
    fn permanent(&self) -> f64 {
        let [u, v] = self.edges.map(|edge| edge.map(f64::abs));
        let a = self.corner.map(f64::abs);
        a[0] * (u[1] * v[2] + u[2] * v[1])
            + a[1] * (u[2] * v[0] + u[0] * v[2])
            + a[2] * (u[0] * v[1] + u[1] * v[0])
    }
}

/// Triangles a piece of work.
const CHUNK: usize = 1 << 13;
/// Triangles summed plainly before the sum is compensated.
const RUN: usize = 16;

/// Six times the volume, and a bound on its rounding error.
fn determinant_sum(positions: &[[f64; 3]], triangles: &[[u32; 3]], frame: &Frame) -> (Sum, f64) {
    let chunks = map_chunks(triangles, CHUNK, |chunk| {
        let (mut sum, mut permanent) = (Sum::default(), 0.0);
        for run in chunk.chunks(RUN) {
            let mut part = 0.0;
            for triangle in spanned(positions, run, frame) {
                part += triangle.determinant();
                permanent += triangle.permanent();
            }
            sum.add(part);
        }
        (sum, permanent)
    });
    let (mut sum, mut permanent) = (Sum::default(), 0.0);
    for (part, part_permanent) in chunks {
        sum.merge(part);
        permanent += part_permanent;
    }
    // Eight roundings in a determinant (the differences, which enter three times, included), RUN in a plain sum.
    (sum, (10 + RUN) as f64 * f64::EPSILON * permanent)
}

/// Six times the volume without any rounding, relative to the coordinates' own origin.
fn exact_determinant_sum(positions: &[[f64; 3]], triangles: &[[u32; 3]], frame: &Frame) -> Sum {
    let mut exact = ExactSum::default();
    for triangle in triangles {
        let corner = |index: u32| Some(positions.get(index as usize)?.map(|x| x * frame.scale));
        let [Some(a), Some(b), Some(c)] = triangle.map(corner) else { continue };
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            exact.add_product(a[axis], b[next], c[last]);
            exact.add_product(-a[axis], b[last], c[next]);
        }
    }
    exact.sum()
}

/// The volume of `triangles`, which lie in `bounds`.
pub(super) fn signed_volume(positions: &[[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds) -> SignedVolume {
    let frame = Frame::new(bounds);
    let (mut sum, bound) = determinant_sum(positions, triangles, &frame);
    if bound > 1e-9 * sum.value().abs() {
        sum = exact_determinant_sum(positions, triangles, &frame);
    }
    let sign = sum.value().partial_cmp(&0.0).unwrap_or(Ordering::Equal);
    SignedVolume { value: frame.unscaled(sum.divided_by(6.0), 3), sign }
}

/// The area of `triangles`, which lie in `bounds`.
pub(super) fn area(positions: &[[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds) -> f64 {
    let frame = Frame::new(bounds);
    let chunks = map_chunks(triangles, CHUNK, |chunk| {
        let mut sum = Sum::default();
        for triangle in spanned(positions, chunk, &frame) {
            let [x, y, z] = triangle.normal();
            sum.add((x * x + y * y + z * z).sqrt());
        }
        sum
    });
    let mut sum = Sum::default();
    chunks.into_iter().for_each(|part| sum.merge(part));
    frame.unscaled(0.5 * sum.value(), 2)
}

fn centroid(positions: &[[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds) -> Option<[f64; 3]> {
    let frame = Frame::new(bounds);
    let mut moments = [Sum::default(); 3];
    for triangle in spanned(positions, triangles, &frame) {
        let determinant = triangle.determinant();
        let (corner, [u, v]) = (triangle.corner, triangle.edges);
        for axis in 0..3 {
            moments[axis].add(determinant * (3.0 * corner[axis] + u[axis] + v[axis]));
        }
    }
    let (sum, bound) = determinant_sum(positions, triangles, &frame);
    if sum.value().abs() <= bound {
        return None;
    }
    let middle = bounds.center();
    Some([0, 1, 2].map(|axis| middle[axis] + frame.unscaled(moments[axis].value() / (4.0 * sum.value()), 1)))
}

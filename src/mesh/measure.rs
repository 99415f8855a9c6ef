//! Volume, area and centroid.
//!
//! Volume is the sum over triangles (a, b, c) of (a - o) . ((b - a) x (c - a)) / 6, with o the middle of the mesh:
//! edges instead of three long vectors, so that a small triangle adds a small rounding error. Sums are compensated
//! and formed over pieces of fixed length, hence the same bits for any number of threads. The error bound is summed
//! alongside; where it is not far below the result (slivers, sheets, bodies that cancel) the sum is done again
//! without any rounding. Sizes far from one are brought near it by a power of two.

use std::borrow::Cow;
use std::cmp::Ordering;

use super::star::{Sight, Star};
use super::summation::{ExactSum, Sum};
use super::{Bounds, Mesh, scale};
use crate::parallel::{map_chunks, read_ahead};

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

    /// The smallest box around the triangles; `None` if there are none. O(n).
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of_corners(&self.positions, &self.triangles)
    }
}

/// The volume that `triangles` over `positions` enclose, as [`Mesh::volume`].
pub(crate) fn enclosed_volume(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    enclosed_volume_within(positions, triangles, Bounds::of_corners(positions, triangles))
}

/// The same given the box around the corners.
pub(crate) fn enclosed_volume_within(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    bounds: Option<Bounds>,
) -> f64 {
    bounds.map_or(0.0, |bounds| signed_volume(positions, triangles, &bounds).value)
}

/// By how much the volume changes where the vertices of these triangles of a closed surface move, all others staying where they are. The
/// triangles lie in `bounds` before and, but for roundings, after.
pub(crate) fn volume_change(
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    triangles: &[[u32; 3]],
    bounds: &Bounds,
) -> f64 {
    // Both in one frame: what an open surface spans depends on where it is seen from.
    let [before, after] = [before, after].map(|positions| Framed::new(positions, triangles, bounds));
    let mut sum = Sum::default();
    for (old, new) in before.spanned(triangles).zip(after.spanned(triangles)) {
        sum.add(new.determinant() - old.determinant());
    }
    before.unscaled(sum.divided_by(6.0), 3)
}

/// Triangles with their coordinates in a frame: multiplied by a power of two where that brings them nearer one, and
/// with an origin in their middle.
struct Framed<'a> {
    positions: Cow<'a, [[f64; 3]]>,
    triangles: &'a [[u32; 3]],
    /// The power of two, one for ordinary sizes.
    scale: f64,
    origin: [f64; 3],
    /// No coordinate relative to the origin is larger.
    reach: f64,
}

impl<'a> Framed<'a> {
    fn new(positions: &'a [[f64; 3]], triangles: &'a [[u32; 3]], bounds: &Bounds) -> Self {
        let scale = scale::factor(bounds.largest());
        let origin = bounds.center().map(|x| x * scale);
        // The middle is rounded, by less than the size.
        let reach =
            (0..3).map(|axis| bounds.high[axis] * scale - bounds.low[axis] * scale).fold(0.0, f64::max);
        Self { positions: scale::multiplied(positions, scale), triangles, scale, origin, reach }
    }

    /// A volume, area or length (dimension 3, 2, 1) in the frame's unit, in the unit of the coordinates.
    fn unscaled(&self, value: f64, dimension: i32) -> f64 {
        (0..dimension).fold(value, |value, _| value / self.scale)
    }

    /// A triangle, if it is in range, spanned.
    #[inline]
    fn span(&self, [a, b, c]: [u32; 3]) -> Option<Spanned> {
        let position = |corner: u32| self.positions.get(corner as usize);
        let (&a, &b, &c) = (position(a)?, position(b)?, position(c)?);
        Some(Spanned { corner: difference(a, self.origin), edges: [difference(b, a), difference(c, a)] })
    }

    /// Those of `triangles` that are in range, spanned.
    #[inline]
    fn spanned(&self, triangles: &[[u32; 3]]) -> impl Iterator<Item = Spanned> {
        triangles.iter().filter_map(|&triangle| self.span(triangle))
    }

    /// Six times the volume and a bound on its rounding error.
    fn determinant_sum(&self) -> (Sum, f64) {
        let (sum, bound, _) = self.determinant_sum_seen([0.0; 3], |(): &mut (), _, _| {});
        (sum, bound)
    }

    /// The same, and what `look` has made of each piece of the triangles, given of each whether it certainly faces outward, strictly, as seen from a place
    /// that is off the origin by so much.
    fn determinant_sum_seen<S: Default + Send>(
        &self,
        off: [f64; 3],
        look: impl Fn(&mut S, [u32; 3], bool) + Sync,
    ) -> (Sum, f64, Vec<S>) {
        /// More than the eight roundings in a determinant and the four in what the place is off, which is a hundredth of the size.
        const ROUNDINGS: f64 = 16.0;
        /// More than products that underflow are off.
        const UNDERFLOW: f64 = 1e-290;
        let doubt = ROUNDINGS * f64::EPSILON * self.reach;
        let chunks = map_chunks(self.triangles, CHUNK, |chunk| {
            let (mut sum, mut products, mut made) = (Sum::default(), 0.0, S::default());
            for run in chunk.chunks(RUN) {
                read_ahead(run.iter().flatten().map(|&corner| {
                    self.positions
                        .get(corner as usize)
                        .map_or(0, |position| (position[0].to_bits() ^ position[2].to_bits()) as u32)
                }));
                let mut part = 0.0;
                for &triangle in run {
                    let Some(spanned) = self.span(triangle) else { continue };
                    let (normal, product) = (spanned.normal(), spanned.edge_product());
                    let determinant = dot(spanned.corner, normal);
                    part += determinant;
                    products += product;
                    let faces_outward = determinant - dot(off, normal) > doubt * product + UNDERFLOW;
                    look(&mut made, triangle, faces_outward);
                }
                sum.add(part);
            }
            (sum, products, made)
        });
        let (mut sum, mut products, mut all_made) = (Sum::default(), 0.0, Vec::with_capacity(chunks.len()));
        for (part, part_products, made) in chunks {
            sum.merge(part);
            products += part_products;
            all_made.push(made);
        }
        // Eight roundings in a determinant (the differences, which enter three times, included), RUN in a plain sum.
        (sum, (10 + RUN) as f64 * f64::EPSILON * self.reach * products, all_made)
    }

    /// The volume of which six times is a sum with such a bound on its error.
    fn signed_volume(&self, (mut sum, bound): (Sum, f64)) -> SignedVolume {
        if bound > 1e-9 * sum.value().abs() {
            sum = self.exact_determinant_sum();
        }
        let sign = sum.value().partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        SignedVolume { value: self.unscaled(sum.divided_by(6.0), 3), sign }
    }

    /// Six times the volume without any rounding, relative to the coordinates' own origin.
    fn exact_determinant_sum(&self) -> Sum {
        let mut exact = ExactSum::default();
        for triangle in self.triangles {
            let [Some(a), Some(b), Some(c)] = triangle.map(|corner| self.positions.get(corner as usize))
            else {
                continue;
            };
            for axis in 0..3 {
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                exact.add_product(a[axis], b[next], c[last]);
                exact.add_product(-a[axis], b[last], c[next]);
            }
        }
        exact.sum()
    }
}

/// Triangles a piece of work.
const CHUNK: usize = 1 << 13;
/// Triangles summed plainly before the sum is compensated.
const RUN: usize = 16;

#[inline]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A triangle as its first corner, relative to the origin, and the edges from there.
#[derive(Clone, Copy)]
struct Spanned {
    corner: [f64; 3],
    edges: [[f64; 3]; 2],
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
        dot(self.corner, self.normal())
    }

    /// Times the reach of the frame this is more than the determinant with all its terms positive; the rounding
    /// error of the determinant is a few ulps of that.
    #[inline]
    fn edge_product(&self) -> f64 {
        let [u, v] = self.edges.map(|edge| edge[0].abs() + edge[1].abs() + edge[2].abs());
        u * v
    }
}

/// The volume of `triangles`, which lie in `bounds`.
pub(super) fn signed_volume(positions: &[[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds) -> SignedVolume {
    let framed = Framed::new(positions, triangles, bounds);
    framed.signed_volume(framed.determinant_sum())
}

/// The same, and whether one point sees every triangle once, if it may.
pub(super) fn signed_volume_and_sight(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    bounds: &Bounds,
    star: &Star<'_>,
) -> (SignedVolume, bool) {
    let framed = Framed::new(positions, triangles, bounds);
    let off = difference(star.point, framed.origin);
    let (sum, bound, parts) = framed.determinant_sum_seen(off, |sight, triangle, faces_outward| {
        star.look(sight, triangle, faces_outward);
    });
    // (Of very large and very small bodies the frame has other coordinates.)
    let is_star = framed.scale == 1.0 && Sight::of_all(parts).is_whole(triangles.len(), positions.len());
    (framed.signed_volume((sum, bound)), is_star)
}

/// The area of `triangles`, which lie in `bounds`.
pub(super) fn area(positions: &[[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds) -> f64 {
    let framed = Framed::new(positions, triangles, bounds);
    let chunks = map_chunks(triangles, CHUNK, |chunk| {
        let mut sum = Sum::default();
        for triangle in framed.spanned(chunk) {
            let [x, y, z] = triangle.normal();
            sum.add((x * x + y * y + z * z).sqrt());
        }
        sum
    });
    let mut sum = Sum::default();
    chunks.into_iter().for_each(|part| sum.merge(part));
    framed.unscaled(0.5 * sum.value(), 2)
}

fn centroid(positions: &[[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds) -> Option<[f64; 3]> {
    let framed = Framed::new(positions, triangles, bounds);
    let mut moments = [Sum::default(); 3];
    for triangle in framed.spanned(triangles) {
        let determinant = triangle.determinant();
        let (corner, [u, v]) = (triangle.corner, triangle.edges);
        for axis in 0..3 {
            moments[axis].add(determinant * (3.0 * corner[axis] + u[axis] + v[axis]));
        }
    }
    let (sum, bound) = framed.determinant_sum();
    if sum.value().abs() <= bound {
        return None;
    }
    let middle = bounds.center();
    Some([0, 1, 2].map(|axis| middle[axis] + framed.unscaled(moments[axis].value() / (4.0 * sum.value()), 1)))
}

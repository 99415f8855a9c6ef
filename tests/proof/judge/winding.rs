//! How often a closed surface winds round a point: the signed crossings of a ray, by exact signs of determinants.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use robust::{Coord3D, orient3d};
use trisect::Mesh;

use super::vector::{Point, distance_to_triangle, extent};

/// Rays that meet an edge or a vertex are thrown away; so many are tried before a point counts as being on the surface.
const RAYS: u32 = 40;

/// The triangles of a mesh with their boxes.
pub(crate) struct Surface {
    triangles: Vec<[Point; 3]>,
    boxes: Vec<[Point; 2]>,
    /// The box round all.
    pub(crate) low: Point,
    pub(crate) high: Point,
}

fn coordinates(p: Point) -> Coord3D<f64> {
    Coord3D { x: p[0], y: p[1], z: p[2] }
}

/// Positive where `d` is on the inner side of the triangle: the one from which its corners run clockwise.
fn side(a: Point, b: Point, c: Point, d: Point) -> f64 {
    orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(d))
}

impl Surface {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let triangles: Vec<[Point; 3]> = mesh
            .triangles
            .iter()
            .map(|corners| corners.map(|corner| mesh.positions[corner as usize]))
            .collect();
        let boxes: Vec<[Point; 2]> = triangles.iter().map(extent).collect();
        let [low, high] = extent(boxes.iter().flatten());
        Self { triangles, boxes, low, high }
    }

    /// The winding number round `point`; `None` if it is on the surface (or every ray tried met an edge).
    pub(crate) fn winding(&self, point: Point) -> Option<i32> {
        let outside = (0..3).any(|k| point[k] < self.low[k] || point[k] > self.high[k]);
        if outside || self.triangles.is_empty() {
            return Some(0);
        }
        let mut random = ChaCha8Rng::seed_from_u64(point[0].to_bits() ^ point[1].to_bits().rotate_left(21));
        (0..RAYS).find_map(|_| {
            let size = (0..3).map(|k| self.high[k] - self.low[k]).fold(0.0, f64::max);
            let mut tilt = || random.random_range(-0.2..0.2) * size;
            // Well beyond the box, so that rounding cannot leave the end inside.
            let end = [self.high[0] + 0.5 * size + tilt(), point[1] + tilt(), point[2] + tilt()];
            self.crossings(point, end)
        })
    }

    /// Signed crossings of the segment from `from` to `to`; `None` if it meets an edge, or begins on the surface.
    fn crossings(&self, from: Point, to: Point) -> Option<i32> {
        let [low, high] = extent(&[from, to]);
        let mut winding = 0;
        for (triangle, bounds) in self.triangles.iter().zip(&self.boxes) {
            if (0..3).any(|k| bounds[1][k] < low[k] || bounds[0][k] > high[k]) {
                continue;
            }
            let &[a, b, c] = triangle;
            let signs = [side(from, to, a, b), side(from, to, b, c), side(from, to, c, a)];
            let (some_left, some_right) = (signs.iter().any(|&s| s > 0.0), signs.iter().any(|&s| s < 0.0));
            if some_left && some_right {
                continue;
            }
            // The whole line meets the closed triangle, or lies in its plane.
            let ends = [side(a, b, c, from), side(a, b, c, to)];
            if ends[0] * ends[1] > 0.0 {
                continue;
            }
            if ends.contains(&0.0) || signs.contains(&0.0) {
                return None;
            }
            winding += if ends[0] > 0.0 { 1 } else { -1 };
        }
        Some(winding)
    }

    /// How far `point` is from the surface.
    pub(crate) fn distance(&self, point: Point) -> f64 {
        let mut least = f64::INFINITY;
        for (triangle, bounds) in self.triangles.iter().zip(&self.boxes) {
            let outside = |k: usize| (bounds[0][k] - point[k]).max(point[k] - bounds[1][k]);
            if outside(0).max(outside(1)).max(outside(2)) < least {
                least = least.min(distance_to_triangle(point, *triangle));
            }
        }
        least
    }

    /// The triangles.
    pub(crate) fn triangles(&self) -> &[[Point; 3]] {
        &self.triangles
    }
}

//! How often a closed surface winds round a point: the signed crossings of a ray, by exact signs of determinants.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use robust::{Coord3D, orient3d};
use trisect::Mesh;

use super::boxes::Boxes;
use super::vector::{Point, distance_to_triangle, extent};

/// Rays that meet an edge or a vertex are thrown away; so many are tried before a point counts as being on the surface.
const RAYS: u32 = 40;

/// The triangles of a mesh with their boxes in a tree.
pub(crate) struct Surface {
    triangles: Vec<[Point; 3]>,
    boxes: Boxes,
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

/// The corners of all triangles.
pub(crate) fn corners(mesh: &Mesh) -> Vec<[Point; 3]> {
    mesh.triangles.iter().map(|corners| corners.map(|corner| mesh.positions[corner as usize])).collect()
}

/// Whether the segment may meet a box: false only where it does not. It runs towards greater x.
fn may_meet(from: Point, to: Point, slack: f64, bounds: &[Point; 2]) -> bool {
    let [low, high] = bounds;
    let length = to[0] - from[0];
    let part = |x: f64| ((x - from[0]) / length).clamp(0.0, 1.0);
    let (enters, leaves) = (part(low[0] - slack), part(high[0] + slack));
    high[0] >= from[0]
        && low[0] <= to[0]
        && (1..3).all(|k| {
            let slope = to[k] - from[k];
            let (a, b) = (from[k] + slope * enters, from[k] + slope * leaves);
            a.min(b) - slack <= high[k] && a.max(b) + slack >= low[k]
        })
}

impl Surface {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let triangles = corners(mesh);
        let boxes = Boxes::new(triangles.iter().map(extent));
        let [low, high] = extent(triangles.iter().flatten());
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
        // Far more than what is lost where it is computed how far aside the segment is.
        let largest = self.low.iter().chain(&self.high).chain(&to).fold(0.0f64, |most, x| most.max(x.abs()));
        let slack = 1e-12 * largest + 1e-9 * (to[0] - from[0]);
        let mut winding = Some(0);
        self.boxes.visit(
            |bounds| may_meet(from, to, slack, bounds),
            |number| {
                winding = crossing(from, to, self.triangles[number]).and_then(|one| Some(winding? + one));
                winding.is_some()
            },
        );
        winding
    }

    /// How far `point` is from the surface.
    pub(crate) fn distance(&self, point: Point) -> f64 {
        let least = std::cell::Cell::new(f64::INFINITY);
        self.boxes.visit(
            |bounds| {
                let outside = |k: usize| (bounds[0][k] - point[k]).max(point[k] - bounds[1][k]);
                outside(0).max(outside(1)).max(outside(2)) < least.get()
            },
            |number| {
                least.set(least.get().min(distance_to_triangle(point, self.triangles[number])));
                true
            },
        );
        least.get()
    }
}

/// How the segment crosses a triangle: 0 if it does not, `None` if it meets an edge, lies in the plane, or begins on it.
fn crossing(from: Point, to: Point, [a, b, c]: [Point; 3]) -> Option<i32> {
    let signs = [side(from, to, a, b), side(from, to, b, c), side(from, to, c, a)];
    let (some_left, some_right) = (signs.iter().any(|&s| s > 0.0), signs.iter().any(|&s| s < 0.0));
    if some_left && some_right {
        return Some(0);
    }
    // The whole line meets the closed triangle, or lies in its plane.
    let ends = [side(a, b, c, from), side(a, b, c, to)];
    if ends[0] * ends[1] > 0.0 {
        return Some(0);
    }
    if ends.contains(&0.0) || signs.contains(&0.0) {
        return None;
    }
    Some(if ends[0] > 0.0 { 1 } else { -1 })
}

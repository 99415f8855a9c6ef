//! What a surface winds around beside a crossing that is no deeper than rounding.

use std::f64::consts::TAU;

use glam::DVec3;

use super::penetration::unit_normal;
use super::surface::{Crossing, Surface, height, norm, positions};
use crate::boolean::complex::Corner;
use crate::boolean::complex::ids::VertexId;
use crate::boolean::complex::rays::{Ray, coordinate_past, signed_crossing};
use crate::mesh::{SelfCrossing, cross};

/// Distance of the sample points from a crossing, in tolerances.
const SAMPLE_DISTANCES: [f64; 2] = [64.0, 4096.0];
/// The narrowest wedge between two faces that is looked into, in radians: farther out the sample of a narrower one is still within two
/// tolerances of a face.
const NARROWEST: f64 = 1.0 / 1024.0;
/// Faces around a crossing that are looked at: at a hub there are many more.
const MOST_FACES: usize = 32;
/// How steep the points beside a face are over it, seen from the crossing.
const BESIDE: [f64; 4] = [0.25, -0.25, 1.0 / 64.0, -1.0 / 64.0];

impl Surface<'_> {
    /// The crossing of a pair that crosses by no more than some roundings, if the surface overlaps beside it all the same.
    pub(super) fn overlap_beside(&self, pair: [u32; 2]) -> Option<SelfCrossing> {
        let [a, b] = pair.map(|t| self.complex.corners_of_triangle(0, t));
        let found = self.examine_closely(pair, &a, &b)?;
        (found.is_deep() || self.leaves_wrong(&found, Look::Everywhere)).then_some(found.crossing)
    }

    /// Whether a shallow crossing leaves something beside it that is enclosed twice, or inside out. (A body whose corner just pierces the
    /// wall of another from inside crosses it by no more than rounding, but is in it.)
    pub(super) fn leaves_wrong(&self, found: &Crossing, look: Look) -> bool {
        let [a, b] = found.crossing.triangles.map(|t| self.complex.corners_of_triangle(0, t));
        found
            .segment
            .is_some_and(|segment| self.leaves_wrong_winding(&segment, &a, &b, found.tolerance, look))
    }

    /// Whether some point beside a shallow crossing, clear of the surface, has a winding number other than 0 and 1. `segment` is what
    /// the two triangles have in common, roughly.
    fn leaves_wrong_winding(
        &self,
        segment: &[[f64; 3]; 2],
        a: &[Corner; 3],
        b: &[Corner; 3],
        tolerance: f64,
        look: Look,
    ) -> bool {
        let [Some(n), Some(m)] = [a, b].map(|t| unit_normal(&positions(t))) else { return false };
        let [from, to] = segment;
        let place = std::array::from_fn(|k| 0.5 * from[k] + 0.5 * to[k]);
        let along: [f64; 3] = std::array::from_fn(|k| 0.5 * to[k] - 0.5 * from[k]);
        let is_point = along.iter().all(|x| x.abs() <= SAMPLE_DISTANCES[1] * tolerance);
        let directions = match look {
            Look::Quadrants => quadrants(n, m),
            Look::Everywhere => {
                let axis = if is_point { cross(n, m) } else { along };
                let Some(plane) = across(axis).or_else(|| across(n)) else { return false };
                let faces = self.faces_at(&place, tolerance);
                let mut directions = wedges(faces.iter().map(|face| face.normal).chain([n, m]), plane);
                if is_point {
                    directions.extend(faces.iter().flat_map(|face| face.beside(&place)));
                }
                directions
            }
        };
        SAMPLE_DISTANCES.iter().any(|&factor| {
            directions.iter().any(|direction| {
                let sample = std::array::from_fn(|k| place[k] + factor * tolerance * direction[k]);
                !(0..=1).contains(&self.winding(&sample)) && self.is_clear(&sample, tolerance)
            })
        })
    }

    /// Triangles within twice the tolerance of a place, [`MOST_FACES`] at most.
    fn faces_at(&self, place: &[f64; 3], tolerance: f64) -> Vec<Face> {
        let (mut faces, reach) = (Vec::new(), 2.0 * tolerance);
        let (low, high) = (place.map(|at| at - reach), place.map(|at| at + reach));
        self.tree().meeting(&self.frame.triangle([&low, &high, &high]), |t| {
            if faces.len() < MOST_FACES {
                let corners = positions(&self.complex.corners_of_triangle(0, t));
                let normal = unit_normal(&corners);
                let near = normal.filter(|normal| height(normal, &corners[0], place).abs() < reach);
                faces.extend(near.map(|normal| Face { normal, corners }));
            }
        });
        faces
    }

    /// The winding number around a point, by a ray in +x.
    fn winding(&self, point: &[f64; 3]) -> i32 {
        let first_free = self.complex.vertex_count();
        let corner = |i: u32, position| Corner { id: VertexId::new(first_free + i), position };
        let end_x = coordinate_past(self.low[0].min(point[0]), self.high[0].max(point[0]));
        let ray = Ray { start: corner(0, *point), end: corner(1, [end_x, point[1], point[2]]) };
        let query = self.frame.triangle([&ray.start.position, &ray.start.position, &ray.end.position]);
        let mut sum = 0;
        self.tree().meeting(&query, |t| {
            sum += signed_crossing(&self.predicates, &self.complex.corners_of_triangle(0, t), &ray);
        });
        sum
    }

    /// Whether no triangle's box is within twice the tolerance.
    fn is_clear(&self, point: &[f64; 3], tolerance: f64) -> bool {
        let reach = 2.0 * tolerance;
        let (low, high) = (point.map(|x| x - reach), point.map(|x| x + reach));
        let mut clear = true;
        self.tree().meeting(&self.frame.triangle([&low, &high, &high]), |t| {
            let corners = self.complex.corners_of_triangle(0, t);
            let near = unit_normal(&positions(&corners))
                .is_none_or(|normal| height(&normal, &corners[0].position, point).abs() < reach);
            let boxed = (0..3).all(|k| {
                let [a, b, c] = corners.map(|corner| corner.position[k]);
                a.min(b).min(c) <= high[k] && low[k] <= a.max(b).max(c)
            });
            clear &= !(near && boxed);
        });
        clear
    }
}

/// Where it is looked beside a crossing.
#[derive(Clone, Copy, Debug)]
pub(super) enum Look {
    /// In each quadrant between the planes of the two triangles.
    Quadrants,
    /// In each wedge between the faces around what the two have in common, however narrow. (A body with a square of its edges in a face
    /// of another has half of itself in it, between that face and its own, which only touch.) Where that is no more than a point, beside each face
    /// as well. (A body in another may touch it from inside with a corner.)
    Everywhere,
}

/// A point in each of the four quadrants between two planes; beside both of them where they are nearly parallel.
fn quadrants(n: [f64; 3], m: [f64; 3]) -> Vec<[f64; 3]> {
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let sums = signs.map(|(s, t)| -> [f64; 3] { std::array::from_fn(|k| s * n[k] + t * m[k]) });
    sums.into_iter().filter(|sum| norm(sum) > 0.1).filter_map(unit).collect()
}

/// A triangle at a place.
struct Face {
    normal: [f64; 3],
    corners: [[f64; 3]; 3],
}

impl Face {
    /// Directions from the place over the middle of the triangle, above it and below.
    fn beside(&self, place: &[f64; 3]) -> impl Iterator<Item = [f64; 3]> {
        let middle = |k: usize| self.corners.iter().map(|corner| corner[k] / 3.0).sum::<f64>();
        let inwards = unit(std::array::from_fn(|k| middle(k) - place[k]));
        let normal = self.normal;
        let turned = |u: [f64; 3], by: f64| unit(std::array::from_fn(|k| u[k] + by * normal[k]));
        let all = inwards.map(|u| BESIDE.map(|by| turned(u, by)));
        all.into_iter().flatten().flatten()
    }
}

/// The middles of the wedges between planes with the given normals, in a plane that goes through all of them. Both sides of the line in which a
/// face is seen count, even where only one is there.
fn wedges(normals: impl Iterator<Item = [f64; 3]>, [x, y]: [[f64; 3]; 2]) -> Vec<[f64; 3]> {
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let mut angles: Vec<f64> = normals
        .map(|normal| (dot(normal, x), dot(normal, y)))
        // (Nothing is seen of a face that lies in the picture.)
        .filter(|(u, v)| u.hypot(*v) > NARROWEST)
        .flat_map(|(u, v)| [(-u).atan2(v), u.atan2(-v)])
        .map(|angle| angle.rem_euclid(TAU))
        .collect();
    angles.sort_unstable_by(f64::total_cmp);
    let next = angles.iter().copied().skip(1).chain(angles.first().map(|first| first + TAU));
    let wedges = angles.iter().zip(next).filter(|(from, to)| to - *from > 2.0 * NARROWEST);
    wedges
        .map(|(from, to)| {
            let (sine, cosine) = (0.5 * (from + to)).sin_cos();
            std::array::from_fn(|k| cosine * x[k] + sine * y[k])
        })
        .collect()
}

/// Two directions at right angles to a vector and to each other; `None` if it has no direction.
fn across(vector: [f64; 3]) -> Option<[[f64; 3]; 2]> {
    let (x, y) = DVec3::from_array(unit(vector)?).any_orthonormal_pair();
    Some([x.to_array(), y.to_array()])
}

/// A vector of any size made one long.
fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let size = vector.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let scaled = vector.map(|x| x / size);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    Some(scaled.map(|x| x / length))
}

//! Faces of different parts that lie in one plane, but for the distance, are moved into one.
//!
//! Parts that are flush in a model and were turned, or written with few digits, have faces in planes that differ by rounding. Were only
//! their vertices made the same, each face would be in one plane up to that rounding alone, and what is cut out of it would not
//! be one face again. So planes come first: a corner goes to where the planes of its faces meet.

use glam::{DMat3, DVec3};
use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use super::near;
use super::surfaces::Surfaces;
use super::weld::apart;
use crate::Error;
use crate::mesh::Buckets;
use crate::parallel::Runner;

/// Sine of the least angle between a plane and those before it whose meeting is a corner: at smaller ones what the distance allows moves the
/// corner too far to tell where it is meant to be.
const LEAST_SINE: f64 = 0.1;
/// A face tells how its plane lies if it is at least so many distances wide. Of a round surface those that may lie in one plane with it are some
/// `1 / (4 * 32 * 32)` of all then, as seen from its middle.
const LEAST_WIDTH: f64 = 32.0;
/// How often a plane is laid anew through what has come to lie in it, at most: each time it reaches some times as far.
const MOST_FITS: u32 = 8;

/// The plane of a set of faces.
#[derive(Clone, Copy, Debug)]
struct Plane {
    at: DVec3,
    normal: DVec3,
    /// Twice the area of the face that it is the plane of.
    size: f64,
    /// By what angle it may be off where each point that it was laid through is off by the distance.
    doubt: f64,
    /// Whether faces lie in it that are near each other and no neighbours.
    is_shared: bool,
}

impl Plane {
    fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.at)
    }

    /// Whether a point may be meant to be in the plane: it is off by the distance, and by what the plane itself is.
    fn may_reach(&self, point: DVec3, distance: f64) -> bool {
        self.height(point).abs() <= distance + self.doubt * (point - self.at).length()
    }
}

/// Moves corners, none further than the distance, to where the planes that several parts have in common meet those of their other
/// faces. Returns the operands of which faces lie on each other then, but for rounding. O(n log n) for the n triangles and pairs that are near.
///
/// # Errors
/// Only limits.
pub(super) fn level(
    surfaces: &mut Surfaces,
    distance: f64,
    runner: Runner<'_>,
) -> Result<FxHashSet<u32>, Error> {
    // 1. Faces near each other that look the same way, or opposite ways.
    let pairs = near::near_pairs(surfaces, distance, runner)?;
    let _pairs = runner.control.reserve((3 * pairs.len() * size_of::<[u32; 2]>()) as u64)?;
    let mut flush: Vec<[u32; 2]> = Vec::new();
    for [s, t] in pairs {
        if are_flush(surfaces, [s, t], distance) {
            flush.extend([[s, t], [t, s]]);
        }
    }
    flush.sort_unstable();
    let flush_with = Buckets::new(surfaces.triangles.len(), flush.iter().map(|&[s, t]| (s, t)));
    // 2. Sets of faces in one plane.
    let (mut planes, plane_of) = sets(surfaces, &flush_with, distance, runner)?;
    // 3. Those that several parts have in common, and operands that lie on themselves.
    let mut on_themselves = FxHashSet::default();
    for &[s, t] in &flush {
        let plane = plane_of[s as usize];
        let [of_s, of_t] = [s, t].map(|t| surfaces.triangles[t as usize]);
        let are_neighbours = of_s.corners.iter().any(|v| of_t.corners.contains(v));
        if plane != NONE && plane == plane_of[t as usize] && !are_neighbours {
            planes[plane as usize].is_shared = true;
            if of_s.operand == of_t.operand {
                on_themselves.insert(of_s.operand);
            }
        }
    }
    if planes.iter().all(|plane| !plane.is_shared) {
        return Ok(on_themselves);
    }
    // 4. Each corner to where its planes meet.
    let mut around: Vec<SmallVec<[u32; 4]>> = vec![SmallVec::new(); surfaces.positions.len()];
    for (triangle, &plane) in surfaces.triangles.iter().zip(&plane_of) {
        for corner in triangle.corners {
            let list = &mut around[corner as usize];
            if plane != NONE && !list.contains(&plane) {
                list.push(plane);
            }
        }
    }
    for (position, mut around) in surfaces.positions.iter_mut().zip(around) {
        if around.iter().any(|&plane| planes[plane as usize].is_shared) {
            let rank = |&plane: &u32| {
                let Plane { is_shared, size, .. } = planes[plane as usize];
                (!is_shared, std::cmp::Reverse(size.to_bits()), plane)
            };
            around.sort_unstable_by_key(rank);
            *position = moved(*position, around.iter().map(|&plane| planes[plane as usize]), distance);
        }
    }
    Ok(on_themselves)
}

/// Of a face that tells no plane.
const NONE: u32 = u32::MAX;

/// Whether two faces that are near each other look the same way or opposite ways, as far as each tells how it lies. One that does not must lie
/// in the plane of the other, but for the distance.
fn are_flush(surfaces: &Surfaces, pair: [u32; 2], distance: f64) -> bool {
    let corners = pair.map(|t| surfaces.corners(t as usize).map(DVec3::from_array));
    let planes = corners.map(|corners| plane_of(corners, distance));
    let lies_in = |corners: [DVec3; 3], plane: &Plane| {
        corners.iter().all(|&corner| plane.height(corner).abs() <= distance)
    };
    match &planes {
        [Some(p), Some(q)] => p.normal.cross(q.normal).length() <= p.doubt + q.doubt,
        [Some(p), None] => lies_in(corners[1], p),
        [None, Some(q)] => lies_in(corners[0], q),
        [None, None] => false,
    }
}

/// The plane of a face, if it is wide enough to tell.
fn plane_of([a, b, c]: [DVec3; 3], distance: f64) -> Option<Plane> {
    let cross = (b - a).cross(c - a);
    let size = cross.length();
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let doubt = 2.0 * distance * longest / size;
    let is_wide = doubt < 2.0 / LEAST_WIDTH;
    is_wide.then(|| Plane { at: a, normal: cross / size, size, doubt, is_shared: false })
}

/// Sets of faces that are flush, one with the next, and lie in one plane, that of the largest of them at first: the planes, and that of each
/// face.
///
/// # Errors
/// Only limits.
fn sets(
    surfaces: &Surfaces,
    flush_with: &Buckets<u32>,
    distance: f64,
    runner: Runner<'_>,
) -> Result<(Vec<Plane>, Vec<u32>), Error> {
    let corners = |t: u32| surfaces.corners(t as usize).map(DVec3::from_array);
    let mut seeds: Vec<(u32, Plane)> = (0..surfaces.triangles.len() as u32)
        .filter_map(|t| Some((t, plane_of(corners(t), distance)?)))
        .collect();
    seeds.sort_by(|(s, p), (t, q)| q.size.total_cmp(&p.size).then(s.cmp(t)));
    let mut planes = Vec::new();
    let mut growing =
        Growing { surfaces, flush_with, distance, plane_of: vec![NONE; surfaces.triangles.len()] };
    for (place, (seed, plane)) in seeds.into_iter().enumerate() {
        if place % 1024 == 0 {
            runner.control.check()?;
        }
        if growing.plane_of[seed as usize] == NONE {
            planes.push(growing.grown(seed, plane, planes.len() as u32));
        }
    }
    Ok((planes, growing.plane_of))
}

/// Sets of faces that grow, one after the other.
struct Growing<'a> {
    surfaces: &'a Surfaces,
    /// By face those that are flush with it.
    flush_with: &'a Buckets<u32>,
    distance: f64,
    /// The number of the plane of each face.
    plane_of: Vec<u32>,
}

impl Growing<'_> {
    fn corners(&self, t: u32) -> [DVec3; 3] {
        self.surfaces.corners(t as usize).map(DVec3::from_array)
    }

    fn is_in(&self, plane: &Plane, t: u32) -> bool {
        self.corners(t).iter().all(|&corner| plane.height(corner).abs() <= self.distance)
    }

    /// Gives all faces that lie in the plane of one, and hang together with it, its number.
    fn grown(&mut self, seed: u32, plane: Plane, number: u32) -> Plane {
        // 1. A narrow face tells little of what is far beside it: the plane is laid through all that may be in it, and then others may be, too.
        let mut members = vec![seed];
        self.plane_of[seed as usize] = number;
        let mut fit = plane;
        for _ in 0..MOST_FITS {
            let before = members.len();
            let distance = self.distance;
            self.add(&mut members, number, |corner| fit.may_reach(corner, distance));
            if members.len() == before || is_across_axis(fit.normal) {
                break;
            }
            fit = fitted(fit, members.iter().flat_map(|&t| self.corners(t)), self.distance);
        }
        self.keep(&mut members, |growing, t| growing.is_in(&fit, t));
        if members.first() == Some(&seed) {
            return fit;
        }
        // 2. What was not meant to be in it spoilt it: as the face itself lies.
        self.keep(&mut members, |_, _| false);
        self.plane_of[seed as usize] = number;
        let mut members = vec![seed];
        let distance = self.distance;
        self.add(&mut members, number, |corner| plane.height(corner).abs() <= distance);
        plane
    }

    /// Adds faces that are flush with members, all of whose corners are `accepted`.
    fn add(&mut self, members: &mut Vec<u32>, number: u32, accepted: impl Fn(DVec3) -> bool) {
        let mut next = 0;
        while let Some(&face) = members.get(next) {
            next += 1;
            for &other in self.flush_with.get(face as usize) {
                let is_accepted = || self.corners(other).iter().all(|&corner| accepted(corner));
                if self.plane_of[other as usize] == NONE && is_accepted() {
                    self.plane_of[other as usize] = number;
                    members.push(other);
                }
            }
        }
    }

    /// Keeps some of the members; the others are free again.
    fn keep(&mut self, members: &mut Vec<u32>, stays: impl Fn(&Self, u32) -> bool) {
        let (kept, gone): (Vec<u32>, Vec<u32>) = members.iter().partition(|&&t| stays(self, t));
        gone.iter().for_each(|&t| self.plane_of[t as usize] = NONE);
        *members = kept;
    }
}

/// Whether a plane has all its points at one coordinate: exact as it is.
fn is_across_axis(normal: DVec3) -> bool {
    normal.to_array().iter().filter(|&&x| x == 0.0).count() == 2
}

/// A plane laid through points near it, so that the squares of their distances are least.
fn fitted(plane: Plane, points: impl Iterator<Item = DVec3> + Clone, distance: f64) -> Plane {
    // 1. The points as seen in the plane: along it from their middle, and over it.
    let count = points.clone().count() as f64;
    let middle = points.clone().map(|point| point - plane.at).sum::<DVec3>() / count + plane.at;
    let (u, v) = plane.normal.any_orthonormal_pair();
    let [mut uu, mut uv, mut vv, mut uh, mut vh] = [0.0; 5];
    for point in points {
        let from = point - middle;
        let (x, y, h) = (from.dot(u), from.dot(v), from.dot(plane.normal));
        (uu, uv, vv, uh, vh) = (uu + x * x, uv + x * y, vv + y * y, uh + x * h, vh + y * h);
    }
    // 2. How wide they lie; those of a rectangle vary by a quarter of its squared width at its corners.
    let determinant = uu * vv - uv * uv;
    let half_sum = 0.5 * (uu + vv);
    let least = determinant / (half_sum + (half_sum * half_sum - determinant).max(0.0).sqrt());
    let width = 2.0 * (least / count).sqrt();
    let doubt = 2.0 * distance / width;
    if doubt.is_nan() || doubt >= plane.doubt {
        return plane;
    }
    // 3. How the plane is tilted.
    let along_u = (vv * uh - uv * vh) / determinant;
    let along_v = (uu * vh - uv * uh) / determinant;
    let normal = (plane.normal - along_u * u - along_v * v).normalize();
    Plane { at: middle, normal, doubt, ..plane }
}

/// Where a corner goes: to the nearest point on the first of some planes, on as many of those after it as lie across it, three at most;
/// on fewer where that is further than the distance.
fn moved(position: [f64; 3], planes: impl Iterator<Item = Plane>, distance: f64) -> [f64; 3] {
    let given = DVec3::from_array(position);
    let mut chosen: SmallVec<[Plane; 3]> = SmallVec::new();
    let mut best = position;
    for plane in planes {
        chosen.push(plane);
        let to = onto(given, &chosen).map(|to| to.to_array());
        match to.filter(|to| apart(&position, to) <= distance) {
            Some(to) => best = to,
            None => drop(chosen.pop()),
        }
        if chosen.len() == 3 {
            break;
        }
    }
    best
}

/// The nearest point on all of one to three planes; nothing where one lies along the others.
fn onto(given: DVec3, planes: &[Plane]) -> Option<DVec3> {
    // What is missing of three are directions along those that are there: nothing moves along these.
    let normals = match *planes {
        [p] => {
            let along = p.normal.any_orthonormal_vector();
            [p.normal, along, p.normal.cross(along)]
        }
        [p, q] => {
            let line = p.normal.cross(q.normal);
            if line.length() < LEAST_SINE {
                return None;
            }
            [p.normal, q.normal, line.normalize()]
        }
        [p, q, r] => {
            let line = p.normal.cross(q.normal).normalize();
            if line.dot(r.normal).abs() < LEAST_SINE {
                return None;
            }
            [p.normal, q.normal, r.normal]
        }
        _ => return None,
    };
    let solve = DMat3::from_cols(normals[0], normals[1], normals[2]).transpose().inverse();
    let mut at = given;
    // The second step takes off the rounding of the first.
    for _ in 0..2 {
        let mut heights = [0.0; 3];
        for (height, plane) in heights.iter_mut().zip(planes) {
            *height = plane.height(at);
        }
        at -= solve * DVec3::from_array(heights);
    }
    Some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Control, Mesh, Solid, primitives};

    /// Surfaces levelled, with the operands that lie on themselves.
    fn levelled(meshes: Vec<Mesh>, distance: f64) -> (Surfaces, Surfaces, FxHashSet<u32>) {
        let solids: Vec<Solid> = meshes.into_iter().map(|mesh| Solid::try_from(mesh).unwrap()).collect();
        let given = || Surfaces::of(&solids.iter().collect::<Vec<_>>()).unwrap();
        let mut surfaces = given();
        let control = Control::new();
        let on_themselves = level(&mut surfaces, distance, Runner::new(&control, false)).unwrap();
        (given(), surfaces, on_themselves)
    }

    /// A box, turned, in single precision.
    fn turned(low: [f64; 3], high: [f64; 3]) -> Mesh {
        let mut mesh = primitives::cuboid(low, high).unwrap().rotated([1.0, 2.0, 3.0], 42.0).unwrap();
        mesh.positions.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
        mesh
    }

    /// How far the upper face of one operand and the lower one of another, before they were turned, are from one plane.
    fn off(surfaces: &Surfaces, low: u32, high: u32) -> f64 {
        let up = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 42f64.to_radians()) * DVec3::Z;
        let face = |operand: u32, side: DVec3| {
            let own = surfaces.triangles.iter().filter(|triangle| triangle.operand == operand);
            let mut vertices: Vec<u32> = own.flat_map(|triangle| triangle.corners).collect();
            vertices.sort_unstable();
            vertices.dedup();
            let mut points: Vec<DVec3> =
                vertices.iter().map(|&v| DVec3::from_array(surfaces.positions[v as usize])).collect();
            points.sort_by(|p, q| q.dot(side).total_cmp(&p.dot(side)));
            points.truncate(4);
            points
        };
        let (top, bottom) = (face(low, up), face(high, -up));
        let normal = (top[1] - top[0]).cross(top[2] - top[0]).normalize();
        bottom.iter().chain(&top).map(|&point| normal.dot(point - top[0]).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn faces_that_were_flush_get_one_plane() {
        let boxes = || vec![turned([0.0; 3], [3.0, 2.0, 1.0]), turned([1.0, -1.0, 1.0], [2.0, 5.0, 4.0])];
        let (given, surfaces, on_themselves) = levelled(boxes(), 1e-5);
        assert!(off(&given, 0, 1) > 1e-8 && off(&surfaces, 0, 1) < 4e-15, "{}", off(&surfaces, 0, 1));
        let moved = given.positions.iter().zip(&surfaces.positions).map(|(p, q)| apart(p, q));
        assert!(moved.fold(0.0, f64::max) < 1e-6 && on_themselves.is_empty());
        // In one mesh they lie on each other.
        let both = Mesh::merged(&boxes()).unwrap();
        assert!(levelled(vec![both], 1e-5).2.contains(&0));
        // By less than what they are apart nothing moves.
        let (given, surfaces, _) = levelled(boxes(), 1e-9);
        assert_eq!(given.positions, surfaces.positions);
    }

    #[test]
    fn round_bodies_stay_but_where_they_touch() {
        // Triangles of a fine ball may lie in one plane by that distance, a narrow one with many, but they are one part.
        let ball = || primitives::icosphere(1.0, 5).unwrap();
        for distance in [1e-5, 2e-4, 1e-3] {
            let (given, surfaces, on_themselves) =
                levelled(vec![ball(), turned([2.0; 3], [3.0; 3])], distance);
            assert!(given.positions == surfaces.positions && on_themselves.is_empty(), "{distance}");
            // Where two cross, hardly any lie in one plane.
            let (given, surfaces, _) = levelled(vec![ball(), ball().translated([0.5, 0.1, 0.2])], distance);
            let moved = given.positions.iter().zip(&surfaces.positions).filter(|(p, q)| p != q).count();
            assert!(moved * 50 < given.positions.len(), "{moved} by {distance}");
        }
    }

    #[test]
    fn a_corner_goes_to_where_planes_meet() {
        let plane = |normal: DVec3, at: DVec3| {
            let normal = normal.normalize();
            Plane { at, normal, size: 1.0, doubt: 1e-6, is_shared: true }
        };
        let given = DVec3::new(1.0, 2.0, 3.0);
        let planes = [DVec3::new(1.0, 0.1, 0.0), DVec3::new(-0.2, 1.0, 0.3), DVec3::new(0.0, 0.5, 1.0)]
            .map(|normal| plane(normal, given + 1e-7 * normal));
        for count in 1..=3 {
            let to = onto(given, &planes[..count]).unwrap();
            for plane in &planes[..count] {
                assert!(plane.height(to).abs() < 2e-15);
            }
            // And no further than it must.
            assert!(to.distance(given) < 4e-7, "{}", to.distance(given));
        }
        // A plane along the others is left out, and one further off than the distance.
        let along = plane(DVec3::new(1.0, 0.1001, 0.0), given);
        assert!(onto(given, &[planes[0], along]).is_none());
        let far = plane(DVec3::Z, given + DVec3::new(0.0, 0.0, 1.0));
        let to = DVec3::from_array(moved(given.to_array(), [planes[0], far, planes[1]].into_iter(), 1e-6));
        assert!(planes[0].height(to).abs() < 2e-15 && planes[1].height(to).abs() < 2e-15);
    }
}

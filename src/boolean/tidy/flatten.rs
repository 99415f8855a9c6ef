//! Points that nobody needs where faces lie in one plane but for rounding.
//!
//! Such faces cross in as many places as rounding likes: what is left of them is a patchwork of pieces that differ by a unit in the
//! last place. A point that the operation made there is merged into a neighbour that is within rounding of all planes it
//! lies in, where all triangles around it stay as they look. So no point moves, points vanish; and the surface stays
//! within twice the rounding of the planes of its faces.

use std::collections::VecDeque;

use super::face::{LocalFace, LocalPoint};
use super::flatness::is_triangle_low;
use super::near_planes::{Looking, NearPlane, NearPlanes};
use super::patch::Patch;
use super::remove_vertices::{Arc, fill, makes_double_edge};
use super::{flip, short_edges};
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::rounding::distance_order;
use crate::mesh::BitSet;
use crate::polygon::Triangulator;
use crate::{Control, Error};

/// What became one plane that was so but for rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Flattening {
    /// Vertices left out because all faces at them lay in one plane, or in two that meet there, but for rounding; or because they were
    /// within rounding of another.
    pub vertices: u64,
    /// The surface moved by no more than this, in units of the coordinates.
    pub displacement: f64,
}

impl Flattening {
    /// Of two parts of one result.
    pub(crate) fn beside(self, other: Self) -> Self {
        Self {
            vertices: self.vertices + other.vertices,
            displacement: self.displacement.max(other.displacement),
        }
    }

    /// Of one thing after another.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            vertices: self.vertices + other.vertices,
            displacement: self.displacement + other.displacement,
        }
    }
}

/// Points tried between checks of the limits: bounds how long a cancelled operation goes on.
const POINTS_BETWEEN_CHECKS: usize = 1024;
/// Times that a point is tried at most, as its neighbours go: bounds the time at points of very many triangles.
const TRIES: u8 = 16;
/// Neighbours that a point may be merged into, nearest first, that are tried.
const NEIGHBOURS: usize = 32;
/// How many roundings from a plane a neighbour may be: the corners of the faces cut are within one, and points are off by
/// another.
const ROUNDINGS: f64 = 2.0;
/// The least angle, in radians, between two planes for a point between them to be left out. Where they meet at a smaller one,
/// rounding along the normal moves the crease too far aside.
const LEAST_ANGLE: f64 = 1e-3;

/// Rounds at most: flips of what is as low as rounding may open the way for further points.
const MOST_ROUNDS: u32 = 4;

/// Leaves out the points that are not needed.
///
/// # Errors
/// Only limits.
pub(super) fn flatten(patch: &mut Patch<'_>, control: &Control) -> Result<(), Error> {
    let planes = NearPlanes::of(patch, Looking::SameWay);
    let mut triangulator = Triangulator::default();
    let mut met = BitSet::new(patch.point_count());
    let representatives = patch.source().representatives();
    representatives
        .into_iter()
        .filter_map(|point| patch.find_point(point))
        .for_each(|point| met.insert(point.0));
    for _ in 0..MOST_ROUNDS {
        let done = leave_out(patch, &planes, &met, &mut triangulator, control)?;
        let collapsed = short_edges::collapse(patch, true);
        patch.note_flattening(done.and(collapsed));
        flip::flip_slivers(patch);
        if done.vertices == 0 {
            break;
        }
    }
    Ok(())
}

/// One round.
fn leave_out(
    patch: &mut Patch<'_>,
    planes: &NearPlanes,
    met: &BitSet,
    triangulator: &mut Triangulator,
    control: &Control,
) -> Result<Flattening, Error> {
    let mut done = Flattening::default();
    // In order, and again as neighbours go.
    let mut queue: VecDeque<LocalPoint> = (0..patch.point_count() as u32).map(LocalPoint).collect();
    let mut tries = vec![0u8; patch.point_count()];
    let mut is_queued = vec![true; patch.point_count()];
    let mut count = 0;
    while let Some(point) = queue.pop_front() {
        is_queued[point.index()] = false;
        if count % POINTS_BETWEEN_CHECKS == 0 {
            control.check()?;
        }
        count += 1;
        if tries[point.index()] == TRIES || !patch.is_complete(point) {
            continue;
        }
        tries[point.index()] += 1;
        let Some(star) = patch.star(point) else { continue };
        if !met.contains(point.0) && !is_of_operation(patch, point, &star) {
            continue;
        }
        if let Some(displacement) = try_leave_out(patch, planes, triangulator, point, &star) {
            done.vertices += 1;
            done.displacement = done.displacement.max(displacement);
            for (_, neighbour) in star {
                if !std::mem::replace(&mut is_queued[neighbour.index()], true) {
                    queue.push_back(neighbour);
                }
            }
        }
    }
    Ok(done)
}

/// Whether the operation made a point, or met it: faces of several operands are there.
fn is_of_operation(patch: &Patch<'_>, point: LocalPoint, star: &[(LocalFace, LocalPoint)]) -> bool {
    let owner = |face: LocalFace| patch.source().owner(patch[face].origin);
    patch.is_new(point) || star.windows(2).any(|pair| owner(pair[0].0) != owner(pair[1].0))
}

/// Merges a point into a neighbour, if it is not needed; returns by how much the surface has moved at most.
fn try_leave_out(
    patch: &mut Patch<'_>,
    planes: &NearPlanes,
    triangulator: &mut Triangulator,
    point: LocalPoint,
    star: &[(LocalFace, LocalPoint)],
) -> Option<f64> {
    let n = star.len();
    let old: Vec<LocalFace> = star.iter().map(|&(face, _)| face).collect();
    if let Some((faces, thickness)) = thin_shell(patch, point, star) {
        patch.replace(&faces, &[]);
        return Some(thickness);
    }
    // 1. The planes of its faces, which must meet at an angle. (Those back to back are a film thinner than rounding.)
    let of_faces: Vec<Option<(u32, &NearPlane)>> =
        star.iter().map(|&(face, _)| planes.of_origin(patch[face].origin)).collect();
    let mut distinct: Vec<(u32, &NearPlane)> = of_faces.iter().flatten().copied().collect();
    distinct.sort_unstable_by_key(|entry| entry.0);
    distinct.dedup_by_key(|entry| entry.0);
    let is_flat_angle = |x: &NearPlane, y: &NearPlane| {
        x.normal.dot(y.normal) > 0.0 && x.normal.cross(y.normal).length() < LEAST_ANGLE
    };
    let has_flat_angle =
        (0..distinct.len()).any(|i| distinct[..i].iter().any(|other| is_flat_angle(other.1, distinct[i].1)));
    if has_flat_angle {
        return None;
    }
    // 2. A neighbour that is in all planes but those of faces that vanish.
    let mut order: Vec<usize> = (0..n).collect();
    let position = *patch.position(point);
    order.sort_by_cached_key(|&j| (distance_order(&position, patch.position(star[j].1)), j));
    for &j in order.iter().take(NEIGHBOURS) {
        let Some(new) = merged(patch, star, &of_faces, point, j) else { continue };
        let target = *patch.position(star[j].1);
        let off = |position: &[f64; 3]| {
            distinct.iter().map(|(_, plane)| plane.distance(position)).fold(0.0, f64::max)
        };
        let of_target = new.iter().filter_map(|(_, origin)| planes.of_origin(*origin));
        let of_target = of_target.map(|(_, plane)| plane.distance(&target)).fold(0.0, f64::max);
        let displacement = off(&position) + of_target;
        patch.replace(&old, &new);
        return Some(displacement);
    }
    // 3. Where none sees all of the hole that the point would leave, that is triangulated.
    let new = filled(patch, star, &of_faces, point, triangulator)?;
    patch.replace(&old, &new);
    Some(distinct.iter().map(|(_, plane)| 2.0 * plane.distance(&position)).fold(0.0, f64::max))
}

/// The faces of a shell of two triangles, or of four that encloses nothing but rounding, and how thick it is; `None` if a point is not of
/// such a one.
fn thin_shell(
    patch: &Patch<'_>,
    point: LocalPoint,
    star: &[(LocalFace, LocalPoint)],
) -> Option<(Vec<LocalFace>, f64)> {
    let mut faces: Vec<LocalFace> = star.iter().map(|&(face, _)| face).collect();
    // What lies beyond the side opposite the point of each.
    let beyond = |i: usize| patch.left_of(star[(i + 1) % star.len()].1, star[i].1);
    match star.len() {
        2 => (beyond(0) == Some(faces[1])).then_some((faces, 0.0)),
        3 => {
            let base = beyond(0).filter(|&base| beyond(1) == Some(base) && beyond(2) == Some(base))?;
            faces.push(base);
            let ring = [0, 1, 2].map(|i| star[i].1);
            let thickness =
                thickness([point, ring[0], ring[1], ring[2]].map(|corner| patch.position(corner)));
            let most = ROUNDINGS * patch.source().rounding.length_at(patch.position(point));
            (thickness <= most).then_some((faces, thickness))
        }
        _ => None,
    }
}

/// The least height of a tetrahedron.
fn thickness(corners: [&[f64; 3]; 4]) -> f64 {
    let height = |i: usize| {
        let [apex, a, b, c] = [0, 1, 2, 3].map(|k| *corners[(i + k) % 4]);
        NearPlane::of([a, b, c]).map_or(0.0, |plane| plane.distance(&apex))
    };
    (0..4).map(height).fold(f64::INFINITY, f64::min)
}

/// The hole that a point inside one plane leaves, or one on the crease between two, triangulated in these; `None` where that is not
/// possible soundly.
fn filled(
    patch: &Patch<'_>,
    star: &[(LocalFace, LocalPoint)],
    of_faces: &[Option<(u32, &NearPlane)>],
    point: LocalPoint,
    triangulator: &mut Triangulator,
) -> Option<Vec<([LocalPoint; 3], Origin)>> {
    let (n, ring) = (star.len(), |i: usize| star[i % star.len()].1);
    let number = |i: usize| of_faces[i % n].map(|of_face| of_face.0);
    if of_faces.iter().any(Option::is_none) || n < 4 {
        return None;
    }
    let changes: Vec<usize> = (0..n).filter(|&i| number(i + n - 1) != number(i)).collect();
    let origin = |i: usize| patch[star[i % n].0].origin;
    let arc = |from: usize, to: usize| {
        let outline = (from..=if to > from { to } else { to + n }).map(ring).collect();
        Arc { outline, origin: origin(from) }
    };
    let arcs = match *changes.as_slice() {
        [] => vec![Arc { outline: (0..n).map(ring).collect(), origin: origin(0) }],
        [i, j] => {
            let [p, at, q] = [ring(i), point, ring(j)].map(|end| patch.position(end));
            let is_straight = patch.source().rounding.is_near_line(p, at, q)
                && distance_order(p, at).max(distance_order(at, q)) < distance_order(p, q);
            if !is_straight {
                return None;
            }
            vec![arc(i, j), arc(j, i)]
        }
        _ => return None,
    };
    let mut new = Vec::with_capacity(n);
    if !arcs.iter().all(|arc| fill(patch, arc, triangulator, &mut new)) {
        return None;
    }
    let ring: Vec<LocalPoint> = (0..n).map(ring).collect();
    let is_low = |&(corners, _): &([LocalPoint; 3], Origin)| is_triangle_low(patch, corners);
    (!new.iter().any(is_low) && !makes_double_edge(patch, &ring, &new)).then_some(new)
}

/// The triangles around a point after it is merged into the `j`-th neighbour; `None` where that must not be.
fn merged(
    patch: &Patch<'_>,
    star: &[(LocalFace, LocalPoint)],
    of_faces: &[Option<(u32, &NearPlane)>],
    point: LocalPoint,
    j: usize,
) -> Option<Vec<([LocalPoint; 3], Origin)>> {
    let (n, ring) = (star.len(), |i: usize| star[i % star.len()].1);
    let target = ring(j);
    let at = patch.position(target);
    let most = ROUNDINGS * patch.source().rounding.length_at(at);
    // 1. The faces that stay are those without the neighbour.
    let staying = (1..n - 1).map(|i| (j + i) % n);
    if !staying.clone().all(|i| of_faces[i].is_some_and(|(_, plane)| plane.distance(at) <= most)) {
        return None;
    }
    // 2. No edge twice.
    let has_edge = |other: LocalPoint| patch.has_edge(target, other) || patch.has_edge(other, target);
    if n < 3 || (2..n - 1).any(|i| has_edge(ring(j + i))) {
        return None;
    }
    if n == 3 && patch.left_of(ring(j + 1), target) == patch.left_of(ring(j + 2), ring(j + 1)) {
        // The last of a body.
        return None;
    }
    // 3. All look the way they did, and none becomes a sliver.
    let mut new = Vec::with_capacity(n - 2);
    for i in staying {
        let [old, corners] = [point, target].map(|first| [first, ring(i), ring(i + 1)]);
        let (_, plane) = of_faces[i]?;
        let sees = |corners: [LocalPoint; 3]| plane.sees(corners.map(|corner| patch.position(corner)));
        if !sees(corners) && sees(old) || is_triangle_low(patch, corners) && !is_triangle_low(patch, old) {
            return None;
        }
        new.push((corners, patch[star[i].0].origin));
    }
    Some(new)
}

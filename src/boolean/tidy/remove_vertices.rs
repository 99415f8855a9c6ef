//! Removing needless vertices: inside a plane face, or on a straight crease between two.
//!
//! Which vertices may go is decided by the exact planes of the source triangles, not by a tolerance; only vertices that the
//! operation made, or met, are asked about. The hole is triangulated anew, in the projection of its plane, and only where
//! all new triangles are sound and no edge would occur twice.

use super::face::{LocalFace, LocalPoint, sides};
use super::patch::Patch;
use crate::boolean::complex::origin::Origin;
use crate::exact::collinear;
use crate::polygon::{Shape, Triangulator};
use crate::{Control, Error};

/// Vertices tried between checks of the limits: bounds how long a cancelled operation goes on.
const VERTICES_BETWEEN_CHECKS: usize = 1024;

/// Removes all candidates that can go.
pub(super) fn remove_vertices(
    patch: &mut Patch<'_>,
    mut candidates: Vec<LocalPoint>,
    control: &Control,
) -> Result<(), Error> {
    let mut triangulator = Triangulator::default();
    candidates.sort_unstable();
    candidates.dedup();
    // What one round removed may open the way for others.
    loop {
        let before = candidates.len();
        let mut blocked = Vec::with_capacity(before);
        for (i, point) in candidates.into_iter().enumerate() {
            if i % VERTICES_BETWEEN_CHECKS == 0 {
                control.check()?;
            }
            if patch.is_complete(point) && try_remove(patch, point, &mut triangulator) == Verdict::Blocked {
                blocked.push(point);
            }
        }
        candidates = blocked;
        if candidates.len() == before || candidates.is_empty() {
            return Ok(());
        }
    }
}

/// What became of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Removed,
    /// It is a corner, or not a plain vertex.
    Needed,
    /// Not needed, but it cannot go as things are.
    Blocked,
}

/// Part of the outline of a hole, and the face whose plane it is to be filled in.
pub(super) struct Arc {
    pub(super) outline: Vec<LocalPoint>,
    pub(super) origin: Origin,
}

fn try_remove(patch: &mut Patch<'_>, point: LocalPoint, triangulator: &mut Triangulator) -> Verdict {
    // 1. The hole that the vertex would leave, in one plane or in two.
    let Some(star) = patch.star(point) else { return Verdict::Needed };
    let ring: Vec<LocalPoint> = star.iter().map(|&(_, vertex)| vertex).collect();
    let Some(arcs) = arcs_of_hole(patch, point, &star, &ring) else { return Verdict::Needed };
    // 2. Its triangulation, plane by plane.
    let mut new = Vec::with_capacity(star.len());
    for arc in &arcs {
        if !fill(patch, arc, triangulator, &mut new) {
            return Verdict::Blocked;
        }
    }
    if makes_double_edge(patch, &ring, &new) {
        return Verdict::Blocked;
    }
    // 3. The exchange.
    let old: Vec<LocalFace> = star.iter().map(|&(face, _)| face).collect();
    patch.replace(&old, &new);
    Verdict::Removed
}

/// The hole around a vertex inside one plane, or on a straight crease between two; `None` if the vertex is needed.
fn arcs_of_hole(
    patch: &Patch<'_>,
    point: LocalPoint,
    star: &[(LocalFace, LocalPoint)],
    ring: &[LocalPoint],
) -> Option<Vec<Arc>> {
    let n = star.len();
    let origin = |i: usize| patch[star[i % n].0].origin;
    // Where the plane changes from one triangle to the next; the ring vertex there is a crease's end.
    let changes: Vec<usize> =
        (0..n).filter(|&i| !patch.source().are_mergeable(origin(i + n - 1), origin(i))).collect();
    match changes.as_slice() {
        [] => Some(vec![Arc { outline: ring.to_vec(), origin: origin(0) }]),
        &[i, j] => {
            if !is_straight(patch, point, [ring[i], ring[j]], [origin(i), origin(j)]) {
                return None;
            }
            let arc = |from: usize, to: usize| {
                let length = (to + n - from) % n;
                let outline = (0..=length).map(|k| ring[(from + k) % n]).collect();
                Arc { outline, origin: origin(from) }
            };
            Some(vec![arc(i, j), arc(j, i)])
        }
        _ => None,
    }
}

/// Whether the crease through a point runs straight on, from one end to the other.
fn is_straight(patch: &Patch<'_>, point: LocalPoint, ends: [LocalPoint; 2], planes: [Origin; 2]) -> bool {
    let [p, q, r] = [ends[0], point, ends[1]].map(|point| *patch.position(point));
    let ahead: f64 =
        (0..3).map(|k| (p[k] - q[k]).signum() * (r[k] - q[k]).signum() * weight(&p, &q, &r, k)).sum();
    // Two different planes meet in one line, which holds all three points; in one plane that must be looked at.
    ahead < 0.0 && (!patch.source().are_coplanar(planes[0], planes[1]) || collinear(&p, &q, &r))
}

/// Triangulates an outline in the plane of its face; false if that is not possible soundly.
pub(super) fn fill(
    patch: &Patch<'_>,
    Arc { outline, origin }: &Arc,
    triangulator: &mut Triangulator,
    new: &mut Vec<([LocalPoint; 3], Origin)>,
) -> bool {
    if outline.len() < 3 {
        return true;
    }
    let points = patch.project(outline, *origin);
    let numbers: Vec<u32> = (0..outline.len() as u32).collect();
    let mut triangles = Vec::new();
    if triangulator.simple(&points, &numbers, &mut triangles) != Shape::Sound {
        return false;
    }
    new.extend(triangles.into_iter().map(|t| (t.map(|i| outline[i as usize]), *origin)));
    true
}

/// Whether the new triangles would use a directed edge that is taken.
pub(super) fn makes_double_edge(
    patch: &Patch<'_>,
    ring: &[LocalPoint],
    new: &[([LocalPoint; 3], Origin)],
) -> bool {
    let n = ring.len();
    let is_freed = |edge: (LocalPoint, LocalPoint)| (0..n).any(|i| (ring[i], ring[(i + 1) % n]) == edge);
    let mut edges: Vec<(LocalPoint, LocalPoint)> =
        new.iter().flat_map(|&(corners, _)| sides(corners)).collect();
    edges.sort_unstable();
    edges.windows(2).any(|pair| pair[0] == pair[1])
        || edges.iter().any(|&(from, to)| patch.has_edge(from, to) && !is_freed((from, to)))
}

/// The share of an axis in the extent of three points; the products of signs above then tell "opposite" robustly.
fn weight(p: &[f64; 3], q: &[f64; 3], r: &[f64; 3], k: usize) -> f64 {
    (p[k] - q[k]).abs().min((r[k] - q[k]).abs())
}

//! Removing vertices that nobody needs: inside a plane face, or on a straight crease between two.
//!
//! Which vertices may go is decided by the exact planes of the source triangles, not by a tolerance; only vertices that the
//! operation made, or met, are asked about. The hole is triangulated anew, in the projection of its plane, and only where
//! all new triangles are sound and no edge would occur twice.

use super::patch::Patch;
use crate::boolean::complex::Complex;
use crate::boolean::complex::origin::Origin;
use crate::exact::collinear;
use crate::polygon::{Shape, Triangulator};
use crate::{Control, Error};

/// Removes all candidates that can go.
pub(super) fn remove(
    patch: &mut Patch<'_>,
    planes: &Complex<'_>,
    mut candidates: Vec<u32>,
    control: &Control,
) -> Result<(), Error> {
    let mut remover = Remover { planes, triangulator: Triangulator::default() };
    candidates.sort_unstable();
    candidates.dedup();
    // What one round removed may open the way for others.
    loop {
        let before = candidates.len();
        let mut kept = Vec::with_capacity(before);
        for (i, point) in candidates.into_iter().enumerate() {
            if i % 1024 == 0 {
                control.check()?;
            }
            if patch.is_complete(point) && remover.try_remove(patch, point) == Verdict::Blocked {
                kept.push(point);
            }
        }
        candidates = kept;
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

struct Remover<'a> {
    planes: &'a Complex<'a>,
    triangulator: Triangulator,
}

impl Remover<'_> {
    fn try_remove(&mut self, patch: &mut Patch<'_>, point: u32) -> Verdict {
        let Some(star) = patch.star(point) else { return Verdict::Needed };
        let n = star.len();
        let origin = |i: usize| patch.faces[star[i % n].0 as usize].origin;
        // Where the plane changes from one triangle to the next; the ring vertex there is a crease's end.
        let changes: Vec<usize> =
            (0..n).filter(|&i| !self.planes.are_mergeable(origin(i + n - 1), origin(i))).collect();
        let ring: Vec<u32> = star.iter().map(|&(_, vertex)| vertex).collect();
        let arcs: Vec<(Vec<u32>, Origin)> = match changes.as_slice() {
            [] => vec![(ring.clone(), origin(0))],
            &[i, j] => {
                if !self.is_straight(patch, point, [ring[i], ring[j]], [origin(i), origin(j)]) {
                    return Verdict::Needed;
                }
                let arc = |from: usize, to: usize| {
                    let length = (to + n - from) % n;
                    (0..=length).map(|k| ring[(from + k) % n]).collect::<Vec<u32>>()
                };
                vec![(arc(i, j), origin(i)), (arc(j, i), origin(j))]
            }
            _ => return Verdict::Needed,
        };
        let mut new = Vec::with_capacity(n);
        for (outline, origin) in &arcs {
            if !self.fill(patch, outline, *origin, &mut new) {
                return Verdict::Blocked;
            }
        }
        if self.makes_double_edge(patch, &ring, &new) {
            return Verdict::Blocked;
        }
        let old: Vec<u32> = star.iter().map(|&(face, _)| face).collect();
        patch.replace(&old, &new);
        Verdict::Removed
    }

    /// Whether the crease through a point runs straight on, from one end to the other.
    fn is_straight(&self, patch: &Patch<'_>, point: u32, ends: [u32; 2], planes: [Origin; 2]) -> bool {
        let [p, q, r] = [ends[0], point, ends[1]].map(|point| *patch.position(point));
        let ahead: f64 =
            (0..3).map(|k| (p[k] - q[k]).signum() * (r[k] - q[k]).signum() * weight(&p, &q, &r, k)).sum();
        // Two different planes meet in one line, which holds all three points; in one plane that must be looked at.
        ahead < 0.0 && (!self.planes.are_coplanar(planes[0], planes[1]) || collinear(&p, &q, &r))
    }

    /// Triangulates an outline in the plane of its face; false if that is not possible soundly.
    fn fill(
        &mut self,
        patch: &Patch<'_>,
        outline: &[u32],
        origin: Origin,
        new: &mut Vec<([u32; 3], Origin)>,
    ) -> bool {
        if outline.len() < 3 {
            return true;
        }
        let points = patch.projected(outline, origin);
        let numbers: Vec<u32> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        if self.triangulator.simple(&points, &numbers, &mut triangles) != Shape::Sound {
            return false;
        }
        new.extend(triangles.into_iter().map(|t| (t.map(|i| outline[i as usize]), origin)));
        true
    }

    /// Whether the new triangles would use a directed edge that is taken.
    fn makes_double_edge(&self, patch: &Patch<'_>, ring: &[u32], new: &[([u32; 3], Origin)]) -> bool {
        let n = ring.len();
        let freed = |edge: (u32, u32)| (0..n).any(|i| (ring[i], ring[(i + 1) % n]) == edge);
        let mut edges: Vec<(u32, u32)> =
            new.iter().flat_map(|(t, _)| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
        edges.sort_unstable();
        edges.windows(2).any(|pair| pair[0] == pair[1])
            || edges.iter().any(|&(from, to)| patch.has_edge(from, to) && !freed((from, to)))
    }
}

/// The share of an axis in the extent of three points; the products of signs above then tell "opposite" robustly.
fn weight(p: &[f64; 3], q: &[f64; 3], r: &[f64; 3], k: usize) -> f64 {
    (p[k] - q[k]).abs().min((r[k] - q[k]).abs())
}

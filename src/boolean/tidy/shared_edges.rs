//! Edges in which surfaces touch: the same subdivision for all faces.
//!
//! Where both operands have the same edge, or part of it, the perturbation may let them cross somewhere along it: some faces
//! then pass along the whole edge and others along its parts. Bodies that touch in an edge only come apart if all faces
//! there meet in the same edges. So every edge gets the vertices of the shorter edges that run along it.

use super::edge_points::{Around, points_along_edges, points_on_edges};
use super::patch::Patch;
use super::split_faces::split_faces;
use super::splits::Splits;
use crate::mesh::{BitSet, HalfEdges};
use crate::{Control, Error};

/// Rounds of splitting: halves may have vertices on them again.
const MOST_ROUNDS: usize = 4;
/// Growth of the number of faces at which splitting ends: bounds the memory where nearly parallel edges keep finding each
/// other's vertices.
const MOST_GROWTH: usize = 4;

/// Splits the edges between faces on which there are vertices, and then those within a face along which edges of the other
/// operand run; nothing where the operands do not touch. Faces of one plane are triangulated together if `merge` says so.
///
/// Returns the half-edges of what has become of the patch.
pub(super) fn subdivide(
    patch: &mut Patch<'_>,
    has_contacts: bool,
    merge: bool,
    control: &Control,
) -> Result<HalfEdges, Error> {
    let mut half_edges = HalfEdges::of(patch);
    if !has_contacts {
        return Ok(half_edges);
    }
    #[cfg(debug_assertions)]
    let boundary = patch.boundary();
    half_edges = split_by(patch, half_edges, merge, |patch, edges, around| {
        points_on_edges(patch, edges, around, control)
    })?;
    half_edges = split_by(patch, half_edges, merge, |patch, edges, around| {
        points_along_edges(patch, edges, around, control)
    })?;
    // (An open surface has a rim of its own, which is split too.)
    #[cfg(debug_assertions)]
    if !boundary.iter().any(|&((u, v), _)| patch.is_complete(u) || patch.is_complete(v)) {
        assert_eq!(patch.boundary(), boundary, "splitting edges opened the surface");
    }
    Ok(half_edges)
}

/// Splits the edges that `find` finds vertices on, as long as there are any. After the first round it is asked only around the points
/// whose faces have changed: the others had no vertices on them, and there are no new vertices.
fn split_by(
    patch: &mut Patch<'_>,
    mut half_edges: HalfEdges,
    merge: bool,
    find: impl Fn(&Patch<'_>, &HalfEdges, Around<'_>) -> Result<Splits, Error>,
) -> Result<HalfEdges, Error> {
    let most_faces = MOST_GROWTH * patch.face_count();
    let mut changed = None;
    for round in 0.. {
        let splits = find(patch, &half_edges, changed.as_ref().map_or(Around::All, Around::Points))?;
        if splits.is_empty() {
            break;
        }
        if round == MOST_ROUNDS || patch.face_count() > most_faces {
            patch.count_stop();
            break;
        }
        let before: Vec<bool> = patch.face_numbers().map(|face| patch[face].alive).collect();
        split_faces(patch, &splits, merge);
        patch.cancel();
        half_edges = HalfEdges::of(patch);
        changed = Some(points_of_changed_faces(patch, &before));
    }
    Ok(half_edges)
}

/// The corners of faces that were added or dropped since the faces `before` were alive.
fn points_of_changed_faces(patch: &Patch<'_>, before: &[bool]) -> BitSet {
    let mut points = BitSet::new(patch.point_count());
    for face in patch.face_numbers() {
        let face_now = &patch[face];
        if before.get(face.index()).copied().unwrap_or(false) != face_now.alive {
            face_now.corners.iter().for_each(|corner| points.insert(corner.0));
        }
    }
    points
}

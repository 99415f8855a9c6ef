//! Cutting: the kept pieces of each cut face as triangles (Vyatkin 2019, step 2).
//!
//! In a cut face the kept parts of its sides and its segments, directed by the operation, enter every point as often as
//! they leave it: they bound the kept region, with no geometry needed to close loops. Points that coincide are identified
//! before, opposite edges cancel, and only then the region is triangulated, in the projection along the axis its face looks
//! along most (dropping a coordinate rounds nothing).
//!
//! - `plane_sums`: faces that touch in one plane are added up and triangulated together;
//! - this file: all other faces, one by one.

pub(super) mod piece;
pub(super) mod plane_sums;
pub(super) mod sheet_origins;

use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use crate::Error;
use crate::boolean::arrangement::Arrangement;
use crate::boolean::arrangement::face_walk::visit_cut_faces;
use crate::boolean::classify::body::Body;
use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::ids::{CutFaceId, FaceId, PointId};
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::rounding::Rounding;
use crate::exact::Projection;
use crate::parallel::Runner;
use crate::polygon::{Shape, Triangulator};
use piece::Piece;

/// Faces that one thread cuts before the limits are checked: about a millisecond of work.
const FACES_AT_ONCE: usize = 512;

/// What was cut out of the faces of some parts.
#[derive(Debug, Default)]
pub(crate) struct Cut {
    pub(crate) pieces: Vec<Piece>,
    /// Whether rounding turned over some triangle.
    pub(crate) has_inverted: bool,
    /// Whether some triangle has no area, or an edge no longer than rounding.
    pub(crate) has_slivers: bool,
    /// Whether the boundary of what is kept of some face is not closed, so that what lies beside it is not known: crossings have been
    /// missed.
    pub(crate) is_open: bool,
}

impl Cut {
    pub(crate) fn append(&mut self, mut other: Self) {
        self.pieces.append(&mut other.pieces);
        self.has_inverted |= other.has_inverted;
        self.has_slivers |= other.has_slivers;
        self.is_open |= other.is_open;
    }
}

/// The pieces of a body, part by part and face by face, without the faces `done` otherwise. Edges no longer than
/// rounding are reported as slivers.
///
/// # Errors
/// Only limits.
pub(crate) fn cut(
    body: Body<'_>,
    done: &FxHashSet<FaceId>,
    rounding: Rounding,
    runner: Runner<'_>,
) -> Result<Cut, Error> {
    let cutter = Cutter { body, done, rounding };
    let mut all = Cut::default();
    for &part in body.parts {
        let count = body.arrangement.curve.faces[part.operand].len();
        let grain = if runner.is_parallel() { FACES_AT_ONCE } else { count };
        let cuts = runner.pieces(count, grain, |range| {
            let mut filler = Filler::default();
            let mut cut = Cut::default();
            for start in range.clone().step_by(FACES_AT_ONCE) {
                runner.control.check()?;
                let batch = start..(start + FACES_AT_ONCE).min(range.end);
                cutter.cut_faces(part, batch, &mut filler, &mut cut);
            }
            Ok::<Cut, Error>(cut)
        })?;
        for cut in cuts {
            all.append(cut?);
        }
    }
    Ok(all)
}

/// Triangulates what is kept of faces, given by its boundary; keeps its scratch memory between calls.
#[derive(Default)]
pub(crate) struct Filler {
    triangulator: Triangulator,
    /// The directed edges that bound what is kept of a face, to their left.
    pub(crate) boundary: Vec<[PointId; 2]>,
    local_boundary: Vec<[u32; 2]>,
    positions: Vec<[f64; 3]>,
    projected: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
}

impl Filler {
    /// Adds the triangles between the edges of the boundary, seen in a projection.
    pub(crate) fn fill<'p>(
        &mut self,
        position: impl Fn(PointId) -> &'p [f64; 3],
        seen: Projection,
        origin: Origin,
        rounding: Rounding,
        cut: &mut Cut,
    ) {
        // 1. What is left of the boundary.
        cancel_opposites(&mut self.boundary);
        if self.boundary.is_empty() {
            return;
        }
        // 2. Local numbers for its points, and where they are in the projection.
        let mut ids: SmallVec<[PointId; 16]> = SmallVec::new();
        ids.extend(self.boundary.iter().map(|edge| edge[0]));
        ids.sort_unstable();
        ids.dedup();
        let local = |point: PointId| ids.binary_search(&point).ok().map(|place| place as u32);
        self.local_boundary.clear();
        for &[from, to] in &self.boundary {
            let (Some(from), Some(to)) = (local(from), local(to)) else {
                cut.is_open = true;
                return;
            };
            self.local_boundary.push([from, to]);
        }
        self.positions.clear();
        self.positions.extend(ids.iter().map(|&point| *position(point)));
        self.projected.clear();
        self.projected.extend(self.positions.iter().map(|position| seen.project(position)));
        // 3. Its triangles.
        self.triangles.clear();
        let shape = self.triangulator.triangulate(&self.projected, &self.local_boundary, &mut self.triangles);
        cut.has_slivers |=
            shape >= Shape::Flat || has_short_edge(&self.positions, &self.local_boundary, rounding);
        cut.has_inverted |= shape == Shape::Folded;
        cut.pieces.extend(self.triangles.iter().map(|corners| Piece {
            corners: corners.map(|point| ids[point as usize]),
            origin,
            flat: false,
        }));
    }
}

/// Whether two consecutive points of a boundary are no further apart than rounding.
fn has_short_edge(positions: &[[f64; 3]], boundary: &[[u32; 2]], rounding: Rounding) -> bool {
    boundary.iter().any(|edge| {
        let [p, q] = edge.map(|i| positions[i as usize]);
        rounding.is_short(&p, &q)
    })
}

#[derive(Clone, Copy)]
struct Cutter<'a> {
    body: Body<'a>,
    done: &'a FxHashSet<FaceId>,
    rounding: Rounding,
}

impl Cutter<'_> {
    /// Cuts a range of the cut faces of a part.
    fn cut_faces(&self, part: Part, range: std::ops::Range<usize>, filler: &mut Filler, cut: &mut Cut) {
        let Arrangement { curve, points, plane_faces, .. } = self.body.arrangement;
        let faces = &curve.faces[part.operand];
        let windings = self.body.windings.of_operand(part.operand);
        let winding = |v: u32| windings[v as usize] as u32;
        visit_cut_faces(curve, points, part.operand, range, winding, |face| {
            let is_done = !self.done.is_empty() && self.done.contains(&faces[face].id);
            if !is_done && !plane_faces.belongs_to_earlier(part.operand, face) {
                self.cut_face(part, face, filler, cut);
            }
        });
    }

    /// Cuts a face, together with the later ones of its plane face.
    fn cut_face(&self, part: Part, first: CutFaceId, filler: &mut Filler, cut: &mut Cut) {
        let Arrangement { curve, points, plane_faces, .. } = self.body.arrangement;
        let faces = &curve.faces[part.operand];
        filler.boundary.clear();
        for member in plane_faces.members(part.operand, first) {
            self.body.add_boundary(part, &faces[member], &mut filler.boundary);
        }
        let seen = Projection::of(&self.body.complex().positions(faces[first].id));
        let seen = if part.reversed { seen.reversed() } else { seen };
        let origin = self.body.complex().origin(faces[first].id, part.reversed);
        filler.fill(|point| points.position(point), seen, origin, self.rounding, cut);
    }
}

/// Up to this many edges are compared pair by pair: fewer than sorting them costs.
const FEW: usize = 10;

/// Removes pairs of opposite edges.
fn cancel_opposites(edges: &mut Vec<[PointId; 2]>) {
    let opposite_pair = |edges: &[[PointId; 2]]| {
        edges.iter().enumerate().any(|(i, e)| edges[..i].iter().any(|f| f[0] == e[1] && f[1] == e[0]))
    };
    if edges.len() <= FEW && !opposite_pair(edges) {
        return;
    }
    edges.sort_unstable_by_key(|&[u, v]| (u.min(v), u.max(v), u > v));
    let mut kept = Vec::with_capacity(edges.len());
    for group in edges.chunk_by(|e, f| e[0].min(e[1]) == f[0].min(f[1]) && e[0].max(e[1]) == f[0].max(f[1])) {
        let ascending = group.iter().filter(|e| e[0] < e[1]).count();
        let descending = group.len() - ascending;
        let majority = if ascending > descending { group[0] } else { group[group.len() - 1] };
        kept.extend(std::iter::repeat_n(majority, ascending.abs_diff(descending)));
    }
    *edges = kept;
}

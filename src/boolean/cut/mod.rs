//! Cutting: the kept pieces of each cut face as triangles (Vyatkin 2019, step 2).
//!
//! In a cut face the kept parts of its sides and its segments, directed by the operation, enter every point as often as
//! they leave it: they bound the kept region, with no geometry needed to close loops. Points that coincide are identified
//! before, opposite edges cancel, and only then the region is triangulated, in the projection along the axis its face looks
//! along most (dropping a coordinate rounds nothing).

pub(super) mod walls;

use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use crate::Error;
use crate::boolean::arrangement::crossings::Crossings;
use crate::boolean::arrangement::cut_edges::CutEdges;
use crate::boolean::arrangement::cut_faces::{CutFace, CutFaces, UNCUT};
use crate::boolean::arrangement::identify::Identification;
use crate::boolean::arrangement::plane_faces::PlaneFaces;
use crate::boolean::arrangement::unrounded::ExtraCrossing;
use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::operands::Operands;
use crate::exact::Projection;
use crate::parallel::Runner;
use crate::polygon::{Shape, Triangulator};

/// A triangle cut out of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    /// Points: vertices by number, then nodes.
    pub(crate) corners: [u32; 3],
    /// The face it was cut from.
    pub(crate) triangle: u32,
}

/// Faces that are cut between looks at the limits.
const FACES_AT_ONCE: usize = 512;

/// What was cut out of the faces of a part.
#[derive(Debug, Default)]
pub(crate) struct Cut {
    pub(crate) pieces: Vec<Piece>,
    /// Whether rounding turned over some triangle.
    pub(crate) has_inverted: bool,
    /// Whether some triangle has no area, or an edge no longer than rounding.
    pub(crate) has_slivers: bool,
}

/// All that cutting needs to know.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cutter<'a> {
    pub(crate) operands: &'a Operands<'a>,
    pub(crate) crossings: &'a Crossings,
    pub(crate) edges: &'a CutEdges,
    /// Crossings after the nodes.
    pub(crate) extra: &'a [ExtraCrossing],
    pub(crate) faces: &'a [CutFaces; 2],
    pub(crate) plane_faces: &'a PlaneFaces,
    /// Winding numbers of the vertices, by side.
    pub(crate) windings: &'a [Vec<i32>; 2],
    pub(crate) identification: &'a Identification,
    /// The size of rounding.
    pub(crate) rounding: f64,
}

/// Scratch memory of one thread.
#[derive(Default)]
struct Scratch {
    triangulator: Triangulator,
    boundary: Vec<[u32; 2]>,
    positions: Vec<[f64; 3]>,
    points: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
}

impl Cutter<'_> {
    /// The pieces of a part, face by face, but for the faces `done` otherwise.
    pub(crate) fn cut(
        &self,
        part: Part,
        done: &FxHashSet<(usize, u32)>,
        runner: Runner<'_>,
    ) -> Result<Cut, Error> {
        let faces = &self.faces[part.side];
        let all = &faces.faces;
        let mut parts = runner
            .pieces(all.len(), if runner.is_parallel() { FACES_AT_ONCE } else { all.len() }, |range| {
                let mut scratch = Scratch::default();
                let mut cut = Cut::default();
                for start in range.clone().step_by(FACES_AT_ONCE) {
                    runner.control.check()?;
                    let some = start..(start + FACES_AT_ONCE).min(range.end);
                    let Self { operands, crossings, edges, .. } = *self;
                    let winding = |v: u32| self.windings[part.side][v as usize] as u32;
                    let visit = |place: u32| {
                        let is_done =
                            !done.is_empty() && done.contains(&(part.side, all[place as usize].triangle));
                        if !is_done && !self.plane_faces.belongs_to_earlier(part.side, place) {
                            self.cut_face(part, place, &mut scratch, &mut cut);
                        }
                    };
                    faces.for_each_place(some, part.side, operands, crossings, edges, winding, visit);
                }
                Ok::<Cut, Error>(cut)
            })?
            .into_iter();
        let mut all = parts.next().unwrap_or(Ok(Cut::default()))?;
        for part in parts {
            let mut part = part?;
            all.pieces.append(&mut part.pieces);
            all.has_inverted |= part.has_inverted;
            all.has_slivers |= part.has_slivers;
        }
        Ok(all)
    }

    /// Where a point is.
    pub(crate) fn position(&self, point: u32) -> &[f64; 3] {
        let first_node = self.operands.vertex_count();
        if point < first_node {
            self.operands.position(point)
        } else {
            &self.edges.positions[(point - first_node) as usize]
        }
    }

    /// Cuts a face, together with the later ones of its plane face.
    fn cut_face(&self, part: Part, place: u32, scratch: &mut Scratch, cut: &mut Cut) {
        let face = &self.faces[part.side].faces[place as usize];
        scratch.boundary.clear();
        for member in self.plane_faces.members(part.side, place) {
            self.add_boundary(part, &self.faces[part.side].faces[member as usize], &mut scratch.boundary);
        }
        cancel_opposites(&mut scratch.boundary);
        if scratch.boundary.is_empty() {
            return;
        }
        // Local numbers for the triangulation.
        let mut points: SmallVec<[u32; 16]> = SmallVec::new();
        points.extend(scratch.boundary.iter().map(|edge| edge[0]));
        points.sort_unstable();
        points.dedup();
        let local = |point: u32| points.binary_search(&point).expect("every point is left") as u32;
        for edge in &mut scratch.boundary {
            *edge = edge.map(local);
        }
        scratch.positions.clear();
        scratch.positions.extend(points.iter().map(|&point| *self.position(point)));
        let seen = self.projection(part, face);
        scratch.points.clear();
        scratch.points.extend(scratch.positions.iter().map(|position| seen.project(position)));
        scratch.triangles.clear();
        let shape =
            scratch.triangulator.triangulate(&scratch.points, &scratch.boundary, &mut scratch.triangles);
        cut.has_slivers |= shape >= Shape::Flat || self.has_short_edge(&scratch.positions, &scratch.boundary);
        cut.has_inverted |= shape == Shape::Folded;
        cut.pieces.extend(scratch.triangles.iter().map(|corners| Piece {
            corners: corners.map(|point| points[point as usize]),
            triangle: face.triangle,
        }));
    }

    /// Appends the directed edges that bound the kept region of a face, to their left; each as often as it counts. (Those
    /// of a plane face's members add up.)
    pub(crate) fn add_boundary(&self, part: Part, face: &CutFace, boundary: &mut Vec<[u32; 2]>) {
        self.for_boundary(part, face, |edge, _, count| {
            boundary.extend(std::iter::repeat_n(edge, count as usize));
        });
    }

    /// Calls `add` for every directed edge that bounds the kept region of a face, with the side of the face it is a part of,
    /// if it is one, and how often it counts.
    pub(crate) fn for_boundary(
        &self,
        part: Part,
        face: &CutFace,
        mut add: impl FnMut([u32; 2], Option<usize>, u32),
    ) {
        let first_node = self.operands.vertex_count();
        let first_vertex = self.operands.first_vertex(part.side);
        let winding = |vertex: u32| self.windings[part.side][(vertex - first_vertex) as usize];
        let mut add = |from: u32, to: u32, side: Option<usize>, count: i32| {
            let (from, to) =
                (self.identification.representative(from), self.identification.representative(to));
            if from != to && count != 0 {
                add(if count > 0 { [from, to] } else { [to, from] }, side, count.unsigned_abs());
            }
        };
        let corners =
            self.operands.sides[part.side].triangles[face.triangle as usize].map(|v| first_vertex + v);
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            if face.edges[k] == UNCUT {
                add(u, v, Some(k), part.sign() * part.multiplicity(winding(u)));
                continue;
            }
            let (low, high) = (u.min(v), u.max(v));
            let direction = if u == low { part.sign() } else { -part.sign() };
            let (mut from, mut around) = (low, winding(low));
            for &node in self.edges.nodes(face.edges[k]) {
                add(from, first_node + node, Some(k), direction * part.multiplicity(around));
                around += if self.crossings.nodes[node as usize].leaves { -1 } else { 1 };
                from = first_node + node;
            }
            add(from, high, Some(k), direction * part.multiplicity(around));
        }
        for &number in self.faces[part.side].segments(face) {
            let segment = &self.crossings.segments[number as usize];
            if let Some(head) = self.plane_faces.run_end(number, segment.head) {
                add(first_node + segment.tail, first_node + head, None, part.segment_direction());
            }
        }
    }

    /// Whether two consecutive points of a boundary are no further apart than rounding.
    fn has_short_edge(&self, positions: &[[f64; 3]], boundary: &[[u32; 2]]) -> bool {
        boundary.iter().any(|edge| {
            let [p, q] = edge.map(|i| positions[i as usize]);
            (0..3).all(|k| (p[k] - q[k]).abs() <= self.rounding)
        })
    }

    /// How a face is projected: its kept side is seen from the front.
    fn projection(&self, part: Part, face: &CutFace) -> Projection {
        let corners = self.operands.corners(part.side, face.triangle).map(|corner| corner.position);
        let seen = Projection::of(&corners);
        if part.reversed { seen.reversed() } else { seen }
    }
}

/// Removes pairs of opposite edges.
fn cancel_opposites(edges: &mut Vec<[u32; 2]>) {
    let opposite_pair = |edges: &[[u32; 2]]| {
        edges.iter().enumerate().any(|(i, e)| edges[..i].iter().any(|f| f[0] == e[1] && f[1] == e[0]))
    };
    const FEW: usize = 10;
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

//! The mesh of one face: a Delaunay triangulation of the parameter square that grows until every triangle is near
//! enough to the patch.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;
use spade::handles::FixedVertexHandle;
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::density::Density;
use super::deviation::{Deviation, ParameterTriangle};
use super::flat_triangle::FlatTriangle;
use super::joints::{Course, FaceSide};
use super::needles;
use super::surface::{Patch, PatchSide};
use crate::parametric::curve::discretise::Refinement;
use crate::parametric::error::GeometryError;
use crate::parametric::numeric::vector::{self, Point};
use crate::{Control, Error};

/// Vertex of the triangulation: its place in the scaled parameter plane and the number of its node.
#[derive(Clone, Copy, Debug)]
struct Site {
    position: Point2<f64>,
    node: u32,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// A node of the face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceNode {
    /// Parameters in the unit square.
    pub(crate) at: [f64; 2],
    /// The face's own point there.
    point: Point<3>,
    /// Number of the vertex in the whole mesh; `None` for a node of this face alone.
    pub(crate) vertex: Option<u32>,
    /// Parameter on the shared edge, for a node inside a side.
    edge_parameter: f64,
}

/// A node to be made on a shared edge between two neighbouring ones, given by their parameters on the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeSplit {
    pub(crate) edge: usize,
    pub(crate) between: [f64; 2],
}

/// What a round of refinement asks for.
#[derive(Debug, Default)]
pub(crate) struct Proposal {
    inner: Vec<[f64; 2]>,
    /// Nodes on collapsed sides, with the vertex the side collapses to.
    collapsed: Vec<([f64; 2], u32)>,
    pub(crate) splits: Vec<EdgeSplit>,
}

impl Proposal {
    pub(crate) fn is_empty(&self) -> bool {
        self.inner.is_empty() && self.collapsed.is_empty() && self.splits.is_empty()
    }
}

/// Edges of the triangulation as refinement sees them.
#[derive(Clone, Copy, PartialEq)]
enum EdgeKind {
    Inner,
    Collapsed(u32),
    Shared(EdgeSplit),
}

#[derive(Debug)]
pub(crate) struct FaceMesh {
    deviation: Deviation,
    sides: [FaceSide; 4],
    /// Units of the scaled parameter plane: about the lengths of the edges that the tolerance asks for.
    scale: [f64; 2],
    /// Edges the face is about worth along u and v.
    edges: [f64; 2],
    /// Nodes that thinning leaves: corners and, if the caller gave one, the grid.
    kept: usize,
    triangulation: DelaunayTriangulation<Site>,
    nodes: Vec<FaceNode>,
    accepted: FxHashSet<[u32; 3]>,
}

/// How a face starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    pub(crate) tolerance: f64,
    pub(crate) grid: [usize; 2],
    pub(crate) refinement: Refinement,
}

/// Least distance of nodes, in units of the unit square: some 10^5 roundings of a parameter, so that points and
/// triangles between them keep digits.
const SHORTEST: f64 = 1e-11;

impl FaceMesh {
    /// The face with its corners (their vertices given) and its first inner nodes.
    pub(crate) fn new(
        part: &Patch,
        sides: [FaceSide; 4],
        corners: [u32; 4],
        start: Start,
    ) -> Result<Self, Error> {
        let deviation = Deviation::new(part.pieces());
        let density = Density::new(&deviation, start.tolerance);
        let scale = density.metric();
        let triangulation = DelaunayTriangulation::new();
        let nodes = Vec::new();
        let edges = density.edges();
        let mut face = Self {
            deviation,
            sides,
            scale,
            edges,
            kept: 0,
            triangulation,
            nodes,
            accepted: FxHashSet::default(),
        };
        for (at, vertex) in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].into_iter().zip(corners) {
            face.insert(at, Some(vertex), 0.0)?;
        }
        let [columns, rows] = start.grid.map(|n| n.max(2) - 1);
        let given = columns > 1 || rows > 1;
        let inner = if start.refinement == Refinement::Levelled && !given {
            density.nodes()
        } else {
            let grid = (1..columns).flat_map(|i| (1..rows).map(move |j| [i, j]));
            grid.map(|[i, j]| [i as f64 / columns as f64, j as f64 / rows as f64]).collect()
        };
        face.kept = if given { 4 + inner.len() } else { 4 };
        for at in inner {
            face.insert(at, None, 0.0)?;
        }
        Ok(face)
    }

    /// Whether the face is straight across the given side, so that the side's own nodes are all it needs along it.
    pub(crate) fn is_straight_across(&self, side: usize) -> bool {
        let across = usize::from(matches!(PatchSide::ALL[side], PatchSide::VLow | PatchSide::VHigh));
        self.edges[across] < 1.0
    }

    fn insert(&mut self, at: [f64; 2], vertex: Option<u32>, edge_parameter: f64) -> Result<(), Error> {
        let position = Point2::new(at[0] * self.scale[0], at[1] * self.scale[1]);
        let before = self.triangulation.num_vertices();
        let inserted = self.triangulation.insert(Site { position, node: self.nodes.len() as u32 });
        if inserted.is_err() || self.triangulation.num_vertices() == before {
            return Err(exhausted());
        }
        self.nodes.push(FaceNode { at, point: self.deviation.point(at), vertex, edge_parameter });
        Ok(())
    }

    /// Adds a node of a shared edge on side number `side`, at `t` on the edge, `r` on the side.
    pub(crate) fn insert_on_side(&mut self, side: usize, r: f64, t: f64, vertex: u32) -> Result<(), Error> {
        self.insert(PatchSide::ALL[side].at(r), Some(vertex), t)
    }

    /// Number of triangles, degenerate ones included.
    pub(crate) fn triangle_count(&self) -> usize {
        self.triangulation.num_inner_faces()
    }

    /// Examines the triangles not yet accepted and says which nodes are missing.
    pub(crate) fn propose(&mut self, tolerance: f64, control: &Control) -> Result<Proposal, Error> {
        let mut proposal = Proposal::default();
        let mut halved: FxHashSet<[u32; 2]> = FxHashSet::default();
        let mut good = Vec::new();
        for (count, face) in self.triangulation.inner_faces().enumerate() {
            if count % 1024 == 0 {
                control.check()?;
            }
            let ids = face.vertices().map(|v| v.data().node);
            let key = sorted(ids);
            if self.accepted.contains(&key) {
                continue;
            }
            if !self.exceeds(ids, tolerance) {
                good.push(key);
                continue;
            }
            let edges = face.adjacent_edges().map(|edge| {
                let ends = [edge.from().data().node, edge.to().data().node];
                (ends, edge.rev().is_outer_edge())
            });
            self.split(edges, tolerance, &mut halved, &mut proposal)?;
        }
        self.accepted.extend(good);
        Ok(proposal)
    }

    fn exceeds(&self, ids: [u32; 3], tolerance: f64) -> bool {
        let nodes = ids.map(|i| &self.nodes[i as usize]);
        let flat = FlatTriangle::new(nodes.map(|n| n.point));
        let parameters: ParameterTriangle = nodes.map(|n| n.at);
        let [a, b, c] = parameters;
        // Most triangles that are too far are so at the middle of an edge.
        let probes = [middle(a, b), middle(b, c), middle(c, a)];
        probes.iter().any(|at| flat.distance(self.deviation.point(*at)) > tolerance)
            || self.deviation.exceeds(&parameters, &flat, tolerance)
    }

    /// Asks for nodes that improve a triangle with the given edges.
    fn split(
        &self,
        edges: [([u32; 2], bool); 3],
        tolerance: f64,
        halved: &mut FxHashSet<[u32; 2]>,
        proposal: &mut Proposal,
    ) -> Result<(), Error> {
        let kinds = edges.map(|(ends, outer)| self.kind(ends, outer));
        let deviations = edges.map(|(ends, _)| self.edge_deviation(ends));
        let mut chosen: SmallVec<[usize; 3]> = (0..3).filter(|&i| deviations[i] > tolerance).collect();
        if chosen.is_empty() {
            // The patch bulges over the triangle's inside, or the case is too close to decide: the longest edge.
            let length = |i: usize| {
                let [a, b] = edges[i].0.map(|n| self.nodes[n as usize].at);
                (b[0] - a[0]).powi(2) * self.scale[0].powi(2) + (b[1] - a[1]).powi(2) * self.scale[1].powi(2)
            };
            chosen.extend((0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))));
        }
        for i in chosen {
            let [a, b] = edges[i].0;
            if !halved.insert([a.min(b), a.max(b)]) {
                continue;
            }
            let [at_a, at_b] = [a, b].map(|n| self.nodes[n as usize].at);
            if (at_a[0] - at_b[0]).abs().max((at_a[1] - at_b[1]).abs()) < SHORTEST {
                return Err(exhausted());
            }
            match kinds[i] {
                EdgeKind::Inner => proposal.inner.push(middle(at_a, at_b)),
                EdgeKind::Collapsed(vertex) => proposal.collapsed.push((middle(at_a, at_b), vertex)),
                EdgeKind::Shared(split) => proposal.splits.push(split),
            }
        }
        Ok(())
    }

    fn kind(&self, ends: [u32; 2], outer: bool) -> EdgeKind {
        if !outer {
            return EdgeKind::Inner;
        }
        let nodes = ends.map(|n| &self.nodes[n as usize]);
        let on = |at: [f64; 2], side: PatchSide| match side {
            PatchSide::VLow => at[1] == 0.0,
            PatchSide::UHigh => at[0] == 1.0,
            PatchSide::VHigh => at[1] == 1.0,
            PatchSide::ULow => at[0] == 0.0,
        };
        let side = (0..4).find(|&s| nodes.iter().all(|n| on(n.at, PatchSide::ALL[s]))).unwrap_or(0);
        match &self.sides[side] {
            // Both ends are the point the side collapses to.
            FaceSide::Collapsed => nodes[0].vertex.map_or(EdgeKind::Inner, EdgeKind::Collapsed),
            FaceSide::Edge { edge, course } => {
                let along = usize::from(matches!(PatchSide::ALL[side], PatchSide::UHigh | PatchSide::ULow));
                let mut between = nodes.map(|n| edge_parameter(n, n.at[along], *course));
                between.sort_by(f64::total_cmp);
                EdgeKind::Shared(EdgeSplit { edge: *edge, between })
            }
        }
    }

    /// Distance of the patch's curve over an edge from the edge, sampled.
    fn edge_deviation(&self, ends: [u32; 2]) -> f64 {
        let [a, b] = ends.map(|n| &self.nodes[n as usize]);
        [0.25, 0.5, 0.75]
            .iter()
            .map(|&w| {
                let p = self.deviation.point(vector::lerp(a.at, b.at, w));
                vector::distance_to_segment(p, a.point, b.point)
            })
            .fold(0.0, f64::max)
    }

    /// Inserts the proposal's nodes of this face alone.
    pub(crate) fn apply(&mut self, proposal: &Proposal) -> Result<(), Error> {
        for &at in &proposal.inner {
            self.insert(at, None, 0.0)?;
        }
        for &(at, vertex) in &proposal.collapsed {
            self.insert(at, Some(vertex), 0.0)?;
        }
        Ok(())
    }

    /// Takes out inner nodes that the tolerance does not need: one after the other, the flattest surroundings first, as
    /// long as all triangles that fill the hole are near enough to the patch.
    pub(crate) fn thin(&mut self, tolerance: f64, control: &Control) -> Result<(), Error> {
        let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; self.nodes.len()];
        let mut order: Vec<(f64, u32)> = Vec::new();
        for vertex in self.triangulation.vertices() {
            let node = vertex.data().node;
            handles[node as usize] = Some(vertex.fix());
            if self.nodes[node as usize].vertex.is_none() && node as usize >= self.kept {
                let ends = vertex.out_edges().map(|edge| [node, edge.to().data().node]);
                let bend = ends.map(|ends| self.edge_deviation(ends)).fold(0.0, f64::max);
                order.push((bend, node));
            }
        }
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (count, (_, node)) in order.into_iter().enumerate() {
            if count % 256 == 0 {
                control.check()?;
            }
            let Some(handle) = handles[node as usize] else { continue };
            let ring: SmallVec<[u32; 12]> =
                self.triangulation.vertex(handle).out_edges().map(|edge| edge.to().data().node).collect();
            let site = self.triangulation.remove(handle);
            // The last vertex has taken the place of the removed one.
            if handle.index() < self.triangulation.num_vertices() {
                let moved = self.triangulation.vertex(handle).data().node;
                handles[moved as usize] = Some(handle);
            }
            handles[node as usize] = None;
            if !self.hole_is_near(&ring, &handles, tolerance) {
                let inserted = self.triangulation.insert(site).map_err(|_| exhausted())?;
                handles[node as usize] = Some(inserted);
            }
        }
        Ok(())
    }

    /// Whether all triangles between the given nodes are near enough to the patch.
    fn hole_is_near(&mut self, ring: &[u32], handles: &[Option<FixedVertexHandle>], tolerance: f64) -> bool {
        let mut fresh: SmallVec<[[u32; 3]; 12]> = SmallVec::new();
        for node in ring {
            let Some(handle) = handles[*node as usize] else { continue };
            for edge in self.triangulation.vertex(handle).out_edges() {
                if let Some(face) = edge.face().as_inner() {
                    let ids = face.vertices().map(|v| v.data().node);
                    let key = sorted(ids);
                    if ids.iter().all(|id| ring.contains(id))
                        && !self.accepted.contains(&key)
                        && !fresh.contains(&key)
                    {
                        if self.exceeds(ids, tolerance) {
                            return false;
                        }
                        fresh.push(key);
                    }
                }
            }
        }
        self.accepted.extend(fresh);
        true
    }

    /// The nodes, and the triangles as node numbers, each starting with its least, sorted.
    pub(crate) fn triangles(&self, tolerance: f64) -> (&[FaceNode], Vec<[u32; 3]>) {
        let faces = self.triangulation.inner_faces();
        let mut triangles: Vec<[u32; 3]> = faces.map(|face| face.vertices().map(|v| v.data().node)).collect();
        for triangle in &mut triangles {
            let least = (0..3).min_by_key(|&i| triangle[i]).unwrap_or(0);
            triangle.rotate_left(least);
        }
        triangles.sort_unstable();
        needles::remove(&FaceSurface { face: self, tolerance }, &mut triangles);
        (&self.nodes, triangles)
    }

    /// The face's own point of a node.
    pub(crate) fn place(&self, node: usize) -> Point<3> {
        self.nodes[node].point
    }
}

/// A face as the removal of needles sees it.
struct FaceSurface<'a> {
    face: &'a FaceMesh,
    tolerance: f64,
}

impl needles::MeshedSurface for FaceSurface<'_> {
    fn place(&self, node: u32) -> DVec3 {
        self.face.place(node as usize).into()
    }

    fn parameters(&self, node: u32) -> [f64; 2] {
        self.face.nodes[node as usize].at
    }

    fn is_near(&self, triangle: [u32; 3]) -> bool {
        !self.face.exceeds(triangle, self.tolerance)
    }
}

/// Parameter on the shared edge of a node of a side, at `r` along the side.
fn edge_parameter(node: &FaceNode, r: f64, course: Course) -> f64 {
    if r == 0.0 || r == 1.0 { if course.is_reversed() { 1.0 - r } else { r } } else { node.edge_parameter }
}

fn middle(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

fn sorted(mut ids: [u32; 3]) -> [u32; 3] {
    ids.sort_unstable();
    ids
}

fn exhausted() -> Error {
    GeometryError::TooManyNodes { what: "surface mesh", limit: usize::MAX }.into()
}

/// Global vertices for the nodes that have none yet, in the order of the nodes.
pub(crate) fn number_nodes(face: &FaceMesh, next: &mut u32) -> FxHashMap<u32, u32> {
    let mut numbers = FxHashMap::default();
    for (i, node) in face.nodes.iter().enumerate() {
        let vertex = node.vertex.unwrap_or_else(|| {
            *next += 1;
            *next - 1
        });
        numbers.insert(i as u32, vertex);
    }
    numbers
}

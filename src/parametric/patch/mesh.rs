//! Patches as one watertight mesh within a stated distance: **nonuniform-surface-mesh** (Choporov 2017).
//!
//! Boundaries that run along each other are found first and meshed once, so that neighbouring patches share their
//! points bit for bit. Every patch is then triangulated over its own parameter square and refined, all patches
//! together in rounds: a triangle farther from the patch than the tolerance (decided by hulls, see `deviation`)
//! gets nodes at the middle of its edges that deviate; a node on a shared edge goes to both its patches.

use rustc_hash::FxHashSet;

use super::face_mesh::{EdgeSplit, FaceMesh, Proposal, Start, number_nodes};
use super::joints::{self, Course, FaceSide, Gap, Joints, nearest_parameter};
use super::orientation;
use super::surface::{Patch, PatchSide};
use crate::parallel;
use crate::parametric::curve::discretise::{CurveMeshing, Refinement, check_resolvable};
use crate::parametric::curve::param_curve::Curve;
use crate::parametric::error::{GeometryError, check_positive};
use crate::parametric::numeric::vector::{self, Point};
use crate::{Control, Error, FaceGroup, FaceGroups, Mesh, Solid};

/// Settings of a patch mesh.
#[derive(Clone, Debug)]
pub struct PatchMeshing {
    tolerance: f64,
    join_tolerance: Option<f64>,
    grid: [usize; 2],
    refinement: Refinement,
    most_triangles: usize,
    keep_sides: bool,
    control: Control,
}

/// A triangle's patch and the parameters of its corners there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchTriangle {
    /// Index of the patch, from 0.
    pub patch: u32,
    /// `(u, v)` of the corners, in the order of the triangle's vertices.
    pub parameters: [[f64; 2]; 3],
}

/// A mesh of patches.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PatchMesh {
    /// The mesh, with one face group per patch ("patch 0", ...).
    pub mesh: Mesh,
    /// For every triangle, where it lies on which patch.
    pub origins: Vec<PatchTriangle>,
    /// Boundaries that meet no other. A closed surface has none.
    pub gaps: Vec<Gap>,
    /// For every patch, whether its triangles face against `S_u x S_v`.
    pub reversed: Vec<bool>,
}

impl PatchMesh {
    /// The mesh as a solid: the proof that it is closed.
    ///
    /// # Errors
    /// Those of [`Solid`]'s conversion.
    pub fn into_solid(self) -> Result<Solid, Error> {
        Solid::try_from(self.mesh)
    }
}

/// Boundaries count as one up to this part of the patches' size, unless set otherwise.
const JOIN_TOLERANCE: f64 = 1e-9;

/// Boundary nodes are placed for this part of the tolerance, so that triangles along them need not split them again:
/// where the patches beside are straight across, and where they bend and need some of the tolerance for themselves.
const EDGE_SHARE: [f64; 2] = [0.95, 0.7];

impl PatchMeshing {
    /// A mesh that deviates from the patches by no more than `tolerance`: every point of a patch is that near to the
    /// triangle over its parameters. (Along boundaries that were joined over a gap, the gap's width comes on top.)
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            join_tolerance: None,
            grid: [2, 2],
            refinement: Refinement::default(),
            most_triangles: 50_000_000,
            keep_sides: false,
            control: Control::default(),
        }
    }

    /// Takes boundaries up to `distance` apart for one (by default 1e-9 of the patches' size). The mesh is closed over such
    /// gaps; it may leave the patches by the width of the gap in addition.
    #[must_use]
    pub fn join_tolerance(mut self, distance: f64) -> Self {
        self.join_tolerance = Some(distance);
        self
    }

    /// Starts with a grid of at least `n` by `m` nodes on every smooth part of a patch (2 or more).
    #[must_use]
    pub fn grid(mut self, n: usize, m: usize) -> Self {
        self.grid = [n, m];
        self
    }

    /// How to refine: [`Refinement::Halving`] as in the paper, from the grid alone; [`Refinement::Levelled`] (the default)
    /// from a lattice that follows an estimate of the curvature (if no grid is given), and takes out the nodes that turn
    /// out not to be needed.
    #[must_use]
    pub fn refinement(mut self, refinement: Refinement) -> Self {
        self.refinement = refinement;
        self
    }

    /// Refuses to make more triangles than this.
    #[must_use]
    pub fn most_triangles(mut self, count: usize) -> Self {
        self.most_triangles = count;
        self
    }

    /// Lets the patches face as they are given. Otherwise patches are turned to agree with their neighbours, and
    /// closed shells to face outwards.
    #[must_use]
    pub fn keep_sides(mut self) -> Self {
        self.keep_sides = true;
        self
    }

    /// Limits: cancellation and deadline.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// The closed mesh of patches that bound a solid.
    ///
    /// # Errors
    /// [`GeometryError::Gaps`] with every boundary that meets no other, and those of [`surface`](Self::surface).
    pub fn closed(&self, patches: &[Patch]) -> Result<PatchMesh, Error> {
        let (faces, joints) = self.prepare(patches)?;
        if !joints.gaps.is_empty() {
            return Err(GeometryError::Gaps { gaps: joints.gaps }.into());
        }
        self.run(patches, &faces, &joints)
    }

    /// The mesh of patches that need not close; boundaries that meet are joined, the others are reported.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`], [`GeometryError::ToleranceTooSmall`], [`GeometryError::TooManyNodes`],
    /// [`GeometryError::BoundaryShared`] if more than two boundaries run along one curve,
    /// [`GeometryError::OneSided`]; [`Error::Cancelled`], [`Error::DeadlineExceeded`].
    pub fn surface(&self, patches: &[Patch]) -> Result<PatchMesh, Error> {
        let (faces, joints) = self.prepare(patches)?;
        self.run(patches, &faces, &joints)
    }

    /// Cuts the patches into smooth faces and joins them.
    fn prepare(&self, patches: &[Patch]) -> Result<(Faces, Joints), Error> {
        check_positive("tolerance", self.tolerance)?;
        let corners: Vec<Point<3>> = patches.iter().flat_map(Patch::bounds).collect();
        check_resolvable(self.tolerance, &corners)?;
        let mut faces = Faces { parts: Vec::new(), owner: Vec::new() };
        for (index, patch) in patches.iter().enumerate() {
            for part in patch.smooth_parts() {
                faces.parts.push(part);
                faces.owner.push(index);
            }
        }
        let join_tolerance = self.join_tolerance.unwrap_or(JOIN_TOLERANCE * vector::extent(&corners));
        let joints = joints::join(&faces.parts, &faces.owner, join_tolerance)?;
        Ok((faces, joints))
    }

    fn run(&self, patches: &[Patch], faces: &Faces, joints: &Joints) -> Result<PatchMesh, Error> {
        let mut builder = Builder::new(self, faces, joints)?;
        builder.refine()?;
        if self.refinement == Refinement::Levelled {
            builder.thin()?;
            builder.refine()?;
        }
        let reversed = if self.keep_sides {
            vec![false; faces.parts.len()]
        } else {
            orientation::find_turned_faces(&faces.parts, &faces.owner, joints)?
        };
        Ok(builder.assemble(patches.len(), &reversed))
    }
}

/// Smooth parts of patches.
struct Faces {
    parts: Vec<Patch>,
    /// The patch each part belongs to.
    owner: Vec<usize>,
}

/// Nodes of a shared edge: parameters, ascending, and vertices.
struct EdgeNodes {
    parameters: Vec<f64>,
    vertices: Vec<u32>,
}

struct Builder<'a> {
    settings: &'a PatchMeshing,
    faces: &'a Faces,
    joints: &'a Joints,
    meshes: Vec<FaceMesh>,
    edges: Vec<EdgeNodes>,
    /// Places of the shared vertices: corners first, then those of the edges.
    shared: Vec<Point<3>>,
}

impl<'a> Builder<'a> {
    fn new(settings: &'a PatchMeshing, faces: &'a Faces, joints: &'a Joints) -> Result<Self, Error> {
        let meshes = (0..faces.parts.len())
            .map(|i| {
                let corners = joints.corners[i].map(|c| c as u32);
                let PatchMeshing { tolerance, grid, refinement, .. } = *settings;
                FaceMesh::new(
                    &faces.parts[i],
                    joints.sides[i].clone(),
                    corners,
                    Start { tolerance, grid, refinement },
                )
            })
            .collect::<Result<Vec<_>, Error>>()?;
        let shared = joints.corner_places.clone();
        let mut builder = Self { settings, faces, joints, meshes, edges: Vec::new(), shared };
        for index in 0..joints.edges.len() {
            builder.mesh_edge(index)?;
        }
        Ok(builder)
    }

    /// The first nodes of an edge, given to its faces.
    fn mesh_edge(&mut self, index: usize) -> Result<(), Error> {
        let edge = &self.joints.edges[index];
        let along =
            |side: usize| usize::from(matches!(PatchSide::ALL[side], PatchSide::UHigh | PatchSide::ULow));
        let initial = edge.uses.iter().map(|&(_, side)| self.settings.grid[along(side)]).max().unwrap_or(2);
        let bends = edge.uses.iter().any(|&(face, side)| !self.meshes[face].is_straight_across(side));
        let mesh = CurveMeshing::new(EDGE_SHARE[usize::from(bends)] * self.settings.tolerance)
            .initial_nodes(initial.max(2))
            .refinement(self.settings.refinement)
            .most_nodes(self.settings.most_triangles)
            .mesh(&edge.curve)?;
        let (face, side) = edge.uses[0];
        let corners = self.joints.corners[face];
        let [start, end] = [[0, 1], [1, 2], [3, 2], [0, 3]][side].map(|c: usize| corners[c] as u32);
        self.edges.push(EdgeNodes { parameters: vec![0.0, 1.0], vertices: vec![start, end] });
        for &t in &mesh.parameters[1..mesh.parameters.len() - 1] {
            self.add_edge_node(index, t)?;
        }
        Ok(())
    }

    /// Makes a vertex at `t` of an edge and gives it to the edge's faces.
    fn add_edge_node(&mut self, index: usize, t: f64) -> Result<(), Error> {
        let place = self.joints.edges[index].curve.point(t);
        let vertex = self.shared.len() as u32;
        self.shared.push(place);
        let nodes = &mut self.edges[index];
        let at = nodes.parameters.partition_point(|&p| p < t);
        nodes.parameters.insert(at, t);
        nodes.vertices.insert(at, vertex);
        for &(face, side) in &self.joints.edges[index].uses {
            let FaceSide::Edge { course, .. } = &self.joints.sides[face][side] else { continue };
            let r = match course {
                Course::Same => t,
                Course::Opposite => 1.0 - t,
                Course::Nearest(_) => {
                    let curve = crate::parametric::curve::nurbs_tools::rescaled_to_unit(
                        &self.faces.parts[face].boundary(PatchSide::ALL[side]),
                    );
                    nearest_parameter(&curve, place)
                }
            };
            self.meshes[face].insert_on_side(side, r, t, vertex)?;
        }
        Ok(())
    }

    /// Rounds of refinement until nothing is missing.
    fn refine(&mut self) -> Result<(), Error> {
        loop {
            let proposals = self.propose()?;
            let mut splits: Vec<EdgeSplit> = Vec::new();
            for (mesh, proposal) in self.meshes.iter_mut().zip(&proposals) {
                mesh.apply(proposal)?;
                splits.extend(&proposal.splits);
            }
            let before = self.shared.len();
            let mut done: FxHashSet<(usize, u64)> = FxHashSet::default();
            for split in splits {
                let middle = 0.5 * (split.between[0] + split.between[1]);
                if done.insert((split.edge, middle.to_bits())) {
                    self.add_edge_node(split.edge, middle)?;
                }
            }
            let count: usize = self.meshes.iter().map(FaceMesh::triangle_count).sum();
            if count > self.settings.most_triangles {
                let limit = self.settings.most_triangles;
                return Err(GeometryError::TooManyNodes { what: "surface mesh", limit }.into());
            }
            if self.shared.len() == before && proposals.iter().all(Proposal::is_empty) {
                return Ok(());
            }
        }
    }

    fn propose(&mut self) -> Result<Vec<Proposal>, Error> {
        let PatchMeshing { tolerance, control, .. } = self.settings;
        each_face(&mut self.meshes, |mesh| mesh.propose(*tolerance, control))
    }

    fn thin(&mut self) -> Result<(), Error> {
        let PatchMeshing { tolerance, control, .. } = self.settings;
        each_face(&mut self.meshes, |mesh| mesh.thin(*tolerance, control)).map(|_| ())
    }

    /// One mesh of all faces: shared vertices first, then each face's own; triangles with coinciding corners are left
    /// out, and vertices that no triangle uses.
    fn assemble(&self, patches: usize, reversed: &[bool]) -> PatchMesh {
        let mut positions = self.shared.clone();
        let mut triangles = Vec::new();
        let mut origins = Vec::new();
        for (index, mesh) in self.meshes.iter().enumerate() {
            let mut next = positions.len() as u32;
            let numbers = number_nodes(mesh, &mut next);
            let (nodes, own) = mesh.triangles(self.settings.tolerance);
            positions.extend((0..nodes.len()).filter(|&i| nodes[i].vertex.is_none()).map(|i| mesh.place(i)));
            let domain = self.faces.parts[index].domain();
            let parameter = |node: u32| {
                let at = nodes[node as usize].at;
                [0, 1].map(|k| vector::mix(domain[k][0], domain[k][1], at[k]))
            };
            for ids in own {
                let ids = if reversed[index] { [ids[0], ids[2], ids[1]] } else { ids };
                let [a, b, c] = ids.map(|i| numbers[&i]);
                if a != b && b != c && c != a {
                    triangles.push([a, b, c]);
                    let patch = self.faces.owner[index] as u32;
                    origins.push(PatchTriangle { patch, parameters: ids.map(parameter) });
                }
            }
        }
        let mut mesh = compacted(&positions, &triangles);
        mesh.groups = FaceGroups {
            list: (0..patches).map(|i| FaceGroup { name: format!("patch {i}"), material: None }).collect(),
            of_triangle: origins.iter().map(|o| o.patch).collect(),
        };
        let mut of_patch = vec![false; patches];
        for (owner, reversed) in self.faces.owner.iter().zip(reversed) {
            of_patch[*owner] = *reversed;
        }
        PatchMesh { mesh, origins, gaps: self.joints.gaps.clone(), reversed: of_patch }
    }
}

/// Calls `work` for every face, in parallel if the crate is built so; the results in the order of the faces.
fn each_face<T: Send>(
    meshes: &mut [FaceMesh],
    work: impl Fn(&mut FaceMesh) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    parallel::try_map(meshes.iter_mut().collect(), work)
}

/// The mesh without the vertices that no triangle uses.
fn compacted(positions: &[Point<3>], triangles: &[[u32; 3]]) -> Mesh {
    let mut number = vec![u32::MAX; positions.len()];
    for &vertex in triangles.iter().flatten() {
        number[vertex as usize] = 0;
    }
    let mut kept = Vec::new();
    for (vertex, number) in number.iter_mut().enumerate().filter(|(_, n)| **n == 0) {
        *number = kept.len() as u32;
        kept.push(positions[vertex]);
    }
    let triangles = triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    Mesh::new(kept, triangles)
}

//! The ground of a boolean: the operands as one complex in general position.
//!
//! Notation of this folder and of all steps above it: operands are A (number 0) and B (number 1). A [`Complex`] numbers the
//! vertices and the triangles of both, those of A first. A *corner* is a vertex with its number and its position.
//! `D(T; x)` is `orient3d` of triangle T and point x; with T counter-clockwise seen from outside it is positive inside. All
//! points are perturbed (see [`crate::exact::perturbed`]): only A moves to first order, along its normals, outwards for a
//! union and inwards for an intersection or a difference, so that coincident faces resolve as regularised set operations
//! want it. (Outwards for a symmetric difference, where they are added up: see `cut::plane_sums`.)
//!
//! - `ids`: the numbers of things;
//! - `directions`: where each vertex of A moves;
//! - `predicates`: the one question every decision asks;
//! - `decided`: answers to it that cost much, remembered for a while;
//! - `meeting`: how two triangles meet;
//! - `rays`: how often a surface winds around a point;
//! - `planes`: which faces lie in one plane;
//! - `along`: which edges run along one another;
//! - `classes`: which of them may be merged, where attributes have to be kept;
//! - `rounding`: which lengths and heights may be the work of rounding.

pub(super) mod along;
pub(super) mod classes;
mod decided;
pub(super) mod directions;
pub(super) mod ids;
pub(super) mod meeting;
pub(super) mod operation;
pub(super) mod origin;
pub(super) mod planes;
pub(super) mod predicates;
pub(super) mod rays;
pub(super) mod rounding;

use std::sync::OnceLock;

use rustc_hash::FxHashSet;

use classes::Attributed;
use directions::Directions;
use ids::{FaceId, VertexId};
use origin::Origin;
use predicates::Perturbed;

/// One operand: borrowed arrays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Operand<'a> {
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
}

/// A vertex: its number over both operands, and where it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub(crate) id: VertexId,
    pub(crate) position: [f64; 3],
}

/// Which way the surface of A moves by an infinitesimal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    /// Outwards.
    Swell,
    /// Inwards.
    Shrink,
}

/// The vertices and faces of both operands under one numbering, and how they are perturbed. Every face has an owner, the
/// operand it belongs to; crossing it from outside to inside changes the winding number of its owner by one.
#[derive(Debug)]
pub(crate) struct Complex<'a> {
    pub(crate) operands: [Operand<'a>; 2],
    /// By operand, the result's group of each triangle; empty if there are no groups.
    groups: [&'a [u32]; 2],
    /// What tells classes of faces, where attributes have to be kept.
    attributed: Option<Attributed<'a>>,
    /// By operand, the class of each triangle: made when first asked for, which only faces of one plane do.
    classes: OnceLock<[Vec<u32>; 2]>,
    motion: Motion,
    /// The largest coordinate.
    largest: f64,
    /// By operand, the triangles that may meet the other one (see `candidates::overlap`): what directions are made from.
    near: [Vec<u32>; 2],
    /// Made when the first tie asks for them: without contacts nothing does.
    directions: OnceLock<Directions>,
}

impl<'a> Complex<'a> {
    /// `largest` is the largest coordinate of both operands, and `near` lists the triangles of A and of B that may meet the
    /// other operand, with all those around such places, ascending. There must be at most 2^31 vertices and fewer than 2^32
    /// triangles.
    pub(crate) fn new(
        operands: [Operand<'a>; 2],
        groups: [&'a [u32]; 2],
        motion: Motion,
        largest: f64,
        near: [Vec<u32>; 2],
    ) -> Self {
        let (attributed, classes, directions) = (None, OnceLock::new(), OnceLock::new());
        Self { operands, groups, attributed, classes, motion, largest, near, directions }
    }

    /// The same, with what tells classes of faces.
    pub(crate) fn with_attributes(mut self, attributed: Option<Attributed<'a>>) -> Self {
        self.attributed = attributed;
        self
    }

    /// One operand, of which some pairs of triangles are tested against each other, shrunk: parts that touch separate.
    pub(crate) fn alone(operand: Operand<'a>, largest: f64, pairs: &[[u32; 2]]) -> Self {
        // Directions take as long as all else where the pairs are few: only those of their vertices are made.
        let mut is_of_pair = vec![false; operand.positions.len()];
        for &triangle in pairs.as_flattened() {
            operand.triangles[triangle as usize].iter().for_each(|&v| is_of_pair[v as usize] = true);
        }
        let is_around = |triangle: &[u32; 3]| triangle.iter().any(|&v| is_of_pair[v as usize]);
        let near = (0..)
            .zip(operand.triangles)
            .filter(|(_, triangle)| is_around(triangle))
            .map(|(t, _)| t)
            .collect();
        let nothing = Operand { positions: &[], triangles: &[] };
        Self::new([operand, nothing], [&[]; 2], Motion::Shrink, largest, [near, Vec::new()])
    }

    /// Triangles of an operand that may meet the other one, ascending.
    pub(crate) fn near(&self, operand: usize) -> &[u32] {
        &self.near[operand]
    }

    /// How many vertices there are.
    #[inline]
    pub(crate) fn vertex_count(&self) -> u32 {
        (self.operands[0].positions.len() + self.operands[1].positions.len()) as u32
    }

    /// The number of the first vertex of an operand.
    #[inline]
    pub(crate) fn first_vertex(&self, operand: usize) -> u32 {
        if operand == 0 { 0 } else { self.operands[0].positions.len() as u32 }
    }

    /// A vertex by its index in its operand.
    #[inline]
    pub(crate) fn vertex(&self, operand: usize, index: u32) -> VertexId {
        VertexId::new(self.first_vertex(operand) + index)
    }

    /// The operand a vertex belongs to.
    #[inline]
    pub(crate) fn owner(&self, vertex: VertexId) -> usize {
        usize::from(vertex.index() >= self.operands[0].positions.len())
    }

    /// A vertex's index in its operand.
    #[inline]
    pub(crate) fn index_in_operand(&self, vertex: VertexId) -> usize {
        vertex.index() - self.first_vertex(self.owner(vertex)) as usize
    }

    /// Where a vertex is.
    #[inline]
    pub(crate) fn position(&self, vertex: VertexId) -> &'a [f64; 3] {
        let owner = self.owner(vertex);
        &self.operands[owner].positions[vertex.index() - self.first_vertex(owner) as usize]
    }

    /// A vertex with its position.
    pub(crate) fn corner(&self, vertex: VertexId) -> Corner {
        Corner { id: vertex, position: *self.position(vertex) }
    }

    /// A face by its index among the triangles of its operand.
    #[inline]
    pub(crate) fn face(&self, operand: usize, triangle: u32) -> FaceId {
        let first = if operand == 0 { 0 } else { self.operands[0].triangles.len() as u32 };
        FaceId::new(first + triangle)
    }

    /// The operand a face belongs to, and its index among the triangles there.
    #[inline]
    pub(crate) fn triangle(&self, face: FaceId) -> (usize, u32) {
        let of_a = self.operands[0].triangles.len();
        if face.index() < of_a { (0, face.number()) } else { (1, face.number() - of_a as u32) }
    }

    /// The operand a face belongs to.
    #[inline]
    pub(crate) fn owner_of_face(&self, face: FaceId) -> usize {
        self.triangle(face).0
    }

    /// The vertices of a face.
    #[inline]
    pub(crate) fn vertices(&self, face: FaceId) -> [VertexId; 3] {
        let (operand, triangle) = self.triangle(face);
        self.operands[operand].triangles[triangle as usize].map(|v| self.vertex(operand, v))
    }

    /// The corners of a face.
    #[inline]
    pub(crate) fn corners(&self, face: FaceId) -> [Corner; 3] {
        let (operand, triangle) = self.triangle(face);
        self.corners_of_triangle(operand, triangle)
    }

    /// The same for a triangle of a known operand.
    #[inline]
    pub(crate) fn corners_of_triangle(&self, operand: usize, triangle: u32) -> [Corner; 3] {
        let first = self.first_vertex(operand);
        let Operand { positions, triangles } = self.operands[operand];
        let corner = |v: u32| Corner { id: VertexId::new(first + v), position: positions[v as usize] };
        // (Written out: `map` over arrays of this size goes through copies on the stack, a tenth of the time of crossings.)
        let [u, v, w] = triangles[triangle as usize];
        [corner(u), corner(v), corner(w)]
    }

    /// Where the corners of a face are.
    #[inline]
    pub(crate) fn positions(&self, face: FaceId) -> [[f64; 3]; 3] {
        let (operand, triangle) = self.triangle(face);
        let Operand { positions, triangles } = self.operands[operand];
        let [u, v, w] = triangles[triangle as usize];
        [positions[u as usize], positions[v as usize], positions[w as usize]]
    }

    /// What is cut from a face comes from here.
    pub(crate) fn origin(&self, face: FaceId, reversed: bool) -> Origin {
        let (operand, triangle) = self.triangle(face);
        Origin { operand: operand as u32, triangle, reversed }
    }

    /// The face that something comes from.
    pub(crate) fn face_of(&self, origin: Origin) -> FaceId {
        self.face(origin.operand as usize, origin.triangle)
    }

    /// Vertices of A that no direction moves away from all their faces: saddles.
    pub(crate) fn vertices_without_direction(&self) -> &FxHashSet<u32> {
        self.directions().stuck()
    }

    fn directions(&self) -> &Directions {
        self.directions.get_or_init(|| Directions::new(&self.operands[0], &self.near[0]))
    }
}

impl Perturbed for Complex<'_> {
    #[inline]
    fn first_direction(&self, vertex: VertexId) -> [i32; 3] {
        if vertex.index() >= self.operands[0].positions.len() {
            return [0; 3];
        }
        let sense = if self.motion == Motion::Swell { 1 } else { -1 };
        self.directions().of(vertex.number()).map(|component| sense * component)
    }

    fn largest_coordinate(&self) -> f64 {
        self.largest
    }

    fn vertex_count(&self) -> u32 {
        Complex::vertex_count(self)
    }
}

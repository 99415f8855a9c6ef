//! The ground of the general arrangement: any number of closed surfaces under one numbering, in general position.
//!
//! An edge may have any even number of faces, and every face has a *step*: how much the winding number of its owner grows
//! from its outer side to its inner side. Triangles on the same three vertices are one face, whose step is their signed
//! count; where that is 0 there is none. A vertex is split into its fans (triangles connected by the edges at it), so that
//! bodies that touch in a vertex alone move apart.

use std::sync::OnceLock;

use rustc_hash::FxHashMap;

use super::edges::{Edges, Side};
use crate::Mesh;
use crate::boolean::complex::directions::Directions;
use crate::boolean::complex::ids::{EdgeId, FaceId, VertexId};
use crate::boolean::complex::predicates::Perturbed;
use crate::boolean::complex::{Corner, Operand};
use crate::mesh::UnionFind;

/// Directions have 10 bits; scaled by a component's colour they must stay below 2^16 (see [`crate::exact::perturbed`]).
const MOST_COLOURS: u32 = 64;

/// The vertices and faces of all operands.
#[derive(Debug)]
pub(crate) struct Surfaces {
    positions: Vec<[f64; 3]>,
    corners: Vec<[u32; 3]>,
    /// By face.
    steps: Vec<i32>,
    owners: Vec<u32>,
    /// By face, which triangle of its owner it is (the first, where there were several).
    triangles: Vec<u32>,
    /// By owner, the group of each of its triangles in the result; empty if there are no groups.
    groups: Vec<Vec<u32>>,
    /// By vertex, which piece of surface it belongs to.
    components: Vec<u32>,
    component_count: u32,
    largest: f64,
    /// Faces that may touch or cross another: what directions are made from.
    near: Vec<u32>,
    /// By component, the factor of its directions.
    colours: Vec<u32>,
    directions: OnceLock<Directions>,
    /// How surfaces that are not closed move; nothing where all are.
    open: Option<Box<OpenDirections>>,
}

impl Surfaces {
    /// The surfaces of meshes: all arrays one after the other.
    pub(crate) fn new(operands: &[&Mesh]) -> Self {
        let count = |of: fn(&Mesh) -> usize| operands.iter().map(|mesh| of(mesh)).sum();
        let vertex_count: usize = count(|mesh| mesh.positions.len());
        let face_count: usize = count(|mesh| mesh.triangles.len());
        let mut surfaces = Self {
            positions: Vec::with_capacity(vertex_count),
            corners: Vec::with_capacity(face_count),
            steps: vec![1; face_count],
            owners: Vec::with_capacity(face_count),
            triangles: Vec::with_capacity(face_count),
            groups: Vec::new(),
            components: Vec::new(),
            component_count: 0,
            largest: 0.0,
            near: Vec::new(),
            colours: Vec::new(),
            directions: OnceLock::new(),
            open: None,
        };
        for (owner, mesh) in (0..).zip(operands) {
            let first = surfaces.positions.len() as u32;
            surfaces.positions.extend_from_slice(&mesh.positions);
            surfaces.corners.extend(mesh.triangles.iter().map(|corners| corners.map(|v| v + first)));
            surfaces.owners.extend(std::iter::repeat_n(owner, mesh.triangles.len()));
            surfaces.triangles.extend(0..mesh.triangles.len() as u32);
        }
        surfaces.largest = surfaces.positions.iter().flatten().fold(0.0, |most, x: &f64| most.max(x.abs()));
        surfaces
    }

    /// Makes one face of triangles on the same vertices, and a vertex for each fan; the edges of all faces.
    pub(crate) fn separate(&mut self) -> Edges {
        let mut edges = Edges::new(&self.corners, self.positions.len());
        if self.merge_copies(&edges) {
            edges = Edges::new(&self.corners, self.positions.len());
        }
        self.separate_fans(&mut edges);
        edges
    }

    /// The edges of some faces.
    pub(crate) fn edges_of(&self, faces: &[FaceId]) -> Edges {
        Edges::of_faces(&self.corners, self.positions.len(), faces.iter().copied())
    }

    /// Makes one face of triangles on the same vertices; whether there were any.
    fn merge_copies(&mut self, edges: &Edges) -> bool {
        let mut sets: Option<UnionFind> = None;
        for (edge, [low, high]) in edges.iter() {
            let opposite = |side: &Side| {
                let corners = self.corners[side.face().index()];
                corners.into_iter().find(|&v| v != low.number() && v != high.number())
            };
            let sides = edges.sides(edge);
            for (i, side) in sides.iter().enumerate() {
                if let Some(other) = sides[..i].iter().find(|other| opposite(other) == opposite(side)) {
                    let sets = sets.get_or_insert_with(|| UnionFind::new(self.corners.len()));
                    sets.join(side.face().number(), other.face().number());
                }
            }
        }
        let Some(mut sets) = sets else { return false };
        let is_even = |from: [u32; 3], to: [u32; 3]| {
            let k = to.iter().position(|&v| v == from[0]).unwrap_or_default();
            to[(k + 1) % 3] == from[1]
        };
        for face in 0..self.corners.len() as u32 {
            let first = sets.root(face);
            if first != face {
                let same = is_even(self.corners[first as usize], self.corners[face as usize]);
                self.steps[first as usize] += if same { 1 } else { -1 };
                self.steps[face as usize] = 0;
            }
        }
        let steps = std::mem::take(&mut self.steps);
        let mut keep = steps.iter().map(|&step| step != 0);
        self.corners.retain(|_| keep.next().unwrap_or_default());
        for list in [&mut self.owners, &mut self.triangles] {
            let mut keep = steps.iter().map(|&step| step != 0);
            list.retain(|_| keep.next().unwrap_or_default());
        }
        self.steps = steps.into_iter().filter(|&step| step != 0).collect();
        true
    }

    /// Gives every fan of a vertex but the first a vertex of its own.
    fn separate_fans(&mut self, edges: &mut Edges) {
        // Corner k of face f is 3 f + k; corners of one vertex are joined across the edges they share.
        let mut sets = UnionFind::new(3 * self.corners.len());
        for (edge, ends) in edges.iter() {
            let sides = edges.sides(edge);
            let corner = |side: &Side, end: VertexId| {
                let corners = &self.corners[side.face().index()];
                let k = corners.iter().position(|&v| v == end.number()).unwrap_or_default();
                3 * side.face().number() + k as u32
            };
            for end in ends {
                let first = corner(&sides[0], end);
                sides[1..].iter().for_each(|side| sets.join(first, corner(side, end)));
            }
        }
        let mut fan_of = vec![u32::MAX; self.positions.len()];
        let mut changed = false;
        let mut new_vertex_of = FxHashMap::default();
        for face in 0..self.corners.len() {
            for k in 0..3 {
                let vertex = self.corners[face][k] as usize;
                let root = sets.root((3 * face + k) as u32);
                let fan = &mut fan_of[vertex];
                if *fan == u32::MAX {
                    *fan = root;
                } else if *fan != root {
                    let position = self.positions[vertex];
                    let positions = &mut self.positions;
                    self.corners[face][k] = *new_vertex_of.entry(root).or_insert_with(|| {
                        positions.push(position);
                        positions.len() as u32 - 1
                    });
                    changed = true;
                }
            }
        }
        if changed {
            edges.renumber(&self.corners);
        }
    }

    /// Says which group of the result each triangle of each operand belongs to; empty lists where there are no groups.
    pub(crate) fn set_groups(&mut self, groups: Vec<Vec<u32>>) {
        self.groups = groups;
    }

    /// Says which piece of surface each vertex belongs to, and how many there are.
    pub(crate) fn set_components(&mut self, (count, of_vertices): (usize, Vec<u32>)) {
        (self.component_count, self.components) = (count as u32, of_vertices);
    }

    /// Says which pairs of faces are near each other: from these directions and colours are made.
    pub(crate) fn set_near(&mut self, pairs: &[[FaceId; 2]]) {
        let mut is_near = crate::mesh::BitSet::new(self.corners.len());
        let mut beside: Vec<[u32; 2]> = Vec::new();
        for &[f, g] in pairs {
            is_near.insert(f.number());
            is_near.insert(g.number());
            let [x, y] = [f, g].map(|face| self.component(face));
            if x != y && beside.last() != Some(&[x.min(y), x.max(y)]) {
                beside.push([x.min(y), x.max(y)]);
            }
        }
        self.near = is_near.iter().collect();
        beside.sort_unstable();
        beside.dedup();
        self.colours = colour(self.component_count, &beside);
    }

    /// Says that pieces of surface may be open. Those that are stay where they are, but for their borders, which move on by an
    /// infinitesimal: so that a surface that ends exactly on another one passes through it.
    pub(crate) fn extend_borders(&mut self, edges: &Edges) {
        self.open = Some(Box::new(OpenDirections::new(self, edges)));
    }

    /// How many vertices there are.
    #[inline]
    pub(crate) fn vertex_count(&self) -> u32 {
        self.positions.len() as u32
    }

    /// How many faces there are.
    pub(crate) fn face_count(&self) -> u32 {
        self.corners.len() as u32
    }

    /// All faces, ascending.
    pub(crate) fn faces(&self) -> impl Iterator<Item = FaceId> + use<> {
        (0..self.corners.len() as u32).map(FaceId::new)
    }

    /// How many pieces of surface there are.
    pub(crate) fn component_count(&self) -> u32 {
        self.component_count
    }

    /// The piece of surface a face belongs to.
    pub(crate) fn component(&self, face: FaceId) -> u32 {
        self.components[self.corners[face.index()][0] as usize]
    }

    /// The piece of surface a vertex belongs to.
    pub(crate) fn component_of_vertex(&self, vertex: VertexId) -> u32 {
        self.components[vertex.index()]
    }

    /// Where a vertex is.
    #[inline]
    pub(crate) fn position(&self, vertex: VertexId) -> &[f64; 3] {
        &self.positions[vertex.index()]
    }

    /// A vertex with its position.
    #[inline]
    pub(crate) fn corner(&self, vertex: VertexId) -> Corner {
        Corner { id: vertex, position: self.positions[vertex.index()] }
    }

    /// The vertices of a face.
    #[inline]
    pub(crate) fn vertices(&self, face: FaceId) -> [VertexId; 3] {
        self.corners[face.index()].map(VertexId::new)
    }

    /// The corners of a face.
    #[inline]
    pub(crate) fn corners(&self, face: FaceId) -> [Corner; 3] {
        let [u, v, w] = self.vertices(face);
        [self.corner(u), self.corner(v), self.corner(w)]
    }

    /// Where the corners of a face are.
    #[inline]
    pub(crate) fn positions(&self, face: FaceId) -> [[f64; 3]; 3] {
        self.corners[face.index()].map(|v| self.positions[v as usize])
    }

    /// How much the winding number of its owner grows from the outer side of a face to its inner side.
    #[inline]
    pub(crate) fn step(&self, face: FaceId) -> i32 {
        self.steps[face.index()]
    }

    /// The operand a face belongs to.
    #[inline]
    pub(crate) fn owner(&self, face: FaceId) -> u32 {
        self.owners[face.index()]
    }

    /// The triangle of its owner that a face is.
    pub(crate) fn triangle(&self, face: FaceId) -> u32 {
        self.triangles[face.index()]
    }

    /// The result's group of a face.
    pub(crate) fn group(&self, face: FaceId) -> u32 {
        let of_owner = self.groups.get(self.owner(face) as usize);
        of_owner.and_then(|groups| groups.get(self.triangle(face) as usize)).copied().unwrap_or(0)
    }

    fn directions(&self) -> &Directions {
        self.directions.get_or_init(|| {
            let all = Operand { positions: &self.positions, triangles: &self.corners };
            Directions::new(&all, &self.near)
        })
    }
}

impl Perturbed for Surfaces {
    /// Every vertex moves inwards, pieces of surface that may touch by different amounts: what touches comes apart without
    /// any crossing, and what lies flush nests.
    fn first_direction(&self, vertex: VertexId) -> [i32; 3] {
        let Some(&component) = self.components.get(vertex.index()) else { return [0; 3] };
        let colour = self.colours.get(component as usize).copied().unwrap_or(1) as i32;
        if let Some(open) = &self.open
            && open.is_open[component as usize]
        {
            return open.at_border.get(&vertex.number()).map_or([0; 3], |along| along.map(|x| colour * x));
        }
        self.directions().of(vertex.number()).map(|component| -colour * component)
    }

    fn largest_coordinate(&self) -> f64 {
        self.largest
    }

    fn vertex_count(&self) -> u32 {
        Surfaces::vertex_count(self)
    }
}

/// How surfaces that are not closed move.
#[derive(Debug)]
struct OpenDirections {
    /// By component, whether an edge of it has a single face.
    is_open: Vec<bool>,
    /// Of vertices on such edges, away from the faces there and along them.
    at_border: FxHashMap<u32, [i32; 3]>,
}

impl OpenDirections {
    fn new(surfaces: &Surfaces, edges: &Edges) -> Self {
        let mut is_open = vec![false; surfaces.component_count as usize];
        let mut sums: FxHashMap<u32, [f64; 3]> = FxHashMap::default();
        for (edge, ends) in edges.iter() {
            let [side] = edges.sides(edge) else { continue };
            is_open[surfaces.component(side.face()) as usize] = true;
            let corners = surfaces.positions(side.face());
            let k = side.place();
            let away = away_from_face(corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            for end in ends {
                let sum = sums.entry(end.number()).or_default();
                (0..3).for_each(|axis| sum[axis] += away[axis]);
            }
        }
        let at_border = sums.into_iter().map(|(vertex, sum)| (vertex, quantised(sum))).collect();
        Self { is_open, at_border }
    }
}

/// The unit vector across the edge from p to q, in the plane of a face and away from its third corner r; zero for a face without
/// area.
fn away_from_face(p: [f64; 3], q: [f64; 3], r: [f64; 3]) -> [f64; 3] {
    let from_p = |x: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| x[k] - p[k]) };
    let (along, up) = (crate::mesh::unit(from_p(q)), from_p(r));
    let share: f64 = (0..3).map(|k| along[k] * up[k]).sum();
    crate::mesh::unit(std::array::from_fn(|k| share * along[k] - up[k]))
}

/// A vector with integer components, the largest of them of 10 bits (as [`Directions`] has them).
fn quantised(v: [f64; 3]) -> [i32; 3] {
    const SCALE: f64 = 511.0;
    let size = v.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    if size > 0.0 && size.is_finite() { v.map(|x| (x / size * SCALE).round() as i32) } else { [0; 3] }
}

/// The lowest colours, from 1 on, that neighbours do not have; those of many neighbours start again.
fn colour(count: u32, beside: &[[u32; 2]]) -> Vec<u32> {
    let mut lower: Vec<Vec<u32>> = vec![Vec::new(); count as usize];
    for &[x, y] in beside {
        lower[y as usize].push(x);
    }
    let mut colours: Vec<u32> = Vec::with_capacity(count as usize);
    for neighbours in &lower {
        let mut taken: Vec<u32> = neighbours.iter().map(|&x| colours[x as usize]).collect();
        taken.sort_unstable();
        taken.dedup();
        let free =
            (1..).zip(&taken).find(|(i, colour)| i != *colour).map_or(taken.len() as u32 + 1, |(i, _)| i);
        colours.push((free - 1) % MOST_COLOURS + 1);
    }
    colours
}

/// Names of what a face has beside an edge.
impl Edges {
    /// The edge of a side of a face and whether the side runs from its low end to its high end.
    #[inline]
    pub(crate) fn of_side(&self, surfaces: &Surfaces, face: FaceId, k: usize) -> (EdgeId, bool) {
        let edge = self.edge(face, k);
        (edge, self.ends(edge)[0] == surfaces.vertices(face)[k])
    }
}

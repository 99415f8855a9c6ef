//! Which triangle lies beside each directed edge, and some triangle at each point.

use rustc_hash::FxHashMap;

use super::patch::Face;
use crate::mesh::Buckets;

/// No triangle.
const NONE: u32 = u32::MAX;
/// Up to so many edges of a point are looked through one by one.
const FEW: usize = 16;

/// The adjacency of a surface in which every directed edge occurs once.
///
/// The edges there are at first are kept by the point they start at: looking one up then touches memory near that of its
/// neighbours, which a hash map would not. Edges made later are few.
#[derive(Default)]
pub(super) struct Adjacency {
    /// For each point the edges that start at it: where they end, ascending, and the triangle to their left, or [`NONE`].
    edges: Option<Buckets<(u32, u32)>>,
    /// The triangles to the left of other edges.
    more: FxHashMap<(u32, u32), u32>,
    /// Some triangle at each point, or [`NONE`].
    some_face: Vec<u32>,
}

impl Adjacency {
    /// The adjacency of triangles between so many points.
    pub(super) fn new(points: usize, faces: &[Face]) -> Self {
        let alive = (0..).zip(faces).filter(|(_, face)| face.alive);
        let mut some_face = vec![NONE; points];
        for (index, face) in alive.clone() {
            face.corners.iter().for_each(|&corner| some_face[corner as usize] = index);
        }
        let sides = alive.flat_map(|(index, face)| {
            let [a, b, c] = face.corners;
            [(a, (b, index)), (b, (c, index)), (c, (a, index))]
        });
        let mut edges = Buckets::new(points, sides);
        for edges in edges.each_mut() {
            edges.sort_unstable();
            // At the border an edge may occur more than once; the last one counts, and the first is what is found.
            for i in (1..edges.len()).rev() {
                if edges[i].0 == edges[i - 1].0 {
                    edges[i - 1].1 = edges[i].1;
                }
            }
        }
        Self { edges: Some(edges), more: FxHashMap::default(), some_face }
    }

    /// The triangle to the left of a directed edge.
    #[inline]
    pub(super) fn left_of(&self, from: u32, to: u32) -> Option<u32> {
        let edges = self.edges.as_ref()?.get(from as usize);
        match place(edges, to) {
            Some(place) => Some(edges[place].1).filter(|&face| face != NONE),
            None if self.more.is_empty() => None,
            None => self.more.get(&(from, to)).copied(),
        }
    }

    /// Some triangle at a point.
    pub(super) fn some_face(&self, point: u32) -> Option<u32> {
        self.some_face.get(point as usize).copied().filter(|&face| face != NONE)
    }

    /// Takes a triangle in.
    pub(super) fn link(&mut self, index: u32, corners: [u32; 3]) {
        for k in 0..3 {
            self.set(corners[k], corners[(k + 1) % 3], index);
            self.some_face[corners[k] as usize] = index;
        }
    }

    /// Leaves a triangle out; its corners have no triangle then that they are known by.
    pub(super) fn unlink(&mut self, corners: [u32; 3]) {
        for k in 0..3 {
            self.set(corners[k], corners[(k + 1) % 3], NONE);
            self.some_face[corners[k] as usize] = NONE;
        }
    }

    /// Finds triangles for those corners of a triangle that are known by none.
    pub(super) fn find_some_faces(&mut self, corners: [u32; 3]) {
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            if self.some_face[from as usize] == NONE
                && let Some(face) = self.left_of(from, to)
            {
                self.some_face[from as usize] = face;
            }
        }
    }

    fn set(&mut self, from: u32, to: u32, face: u32) {
        if let Some(buckets) = &mut self.edges {
            let edges = buckets.get_mut(from as usize);
            if let Some(place) = place(edges, to) {
                edges[place].1 = face;
                return;
            }
        }
        if face == NONE {
            self.more.remove(&(from, to));
        } else {
            self.more.insert((from, to), face);
        }
    }
}

/// Where an edge is among those from its start.
#[inline]
fn place(edges: &[(u32, u32)], to: u32) -> Option<usize> {
    let place = if edges.len() <= FEW {
        edges.iter().position(|edge| edge.0 >= to)?
    } else {
        edges.partition_point(|edge| edge.0 < to)
    };
    edges.get(place).is_some_and(|edge| edge.0 == to).then_some(place)
}

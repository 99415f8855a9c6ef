//! Which triangle lies beside each directed edge, and some triangle at each point.

use rustc_hash::FxHashMap;

use super::face::{Face, LocalFace, LocalPoint, sides};
use crate::mesh::Buckets;

/// No triangle.
const NONE: LocalFace = LocalFace(u32::MAX);
/// Edges that start at one point up to which they are searched in order. Most points have about six: they fit two cache
/// lines, where the branches of a binary search cost more than reading on.
const LINEAR_SEARCH_EDGES: usize = 16;

/// The adjacency of a surface in which every directed edge occurs once.
///
/// The first edges are kept by the point they start at: looking one up then touches memory near that of its neighbours, which
/// a hash map would not. Edges made later are few.
#[derive(Default)]
pub(super) struct Adjacency {
    /// For each point the edges that start at it: where they end, ascending, and the triangle to their left, or [`NONE`].
    edges: Option<Buckets<(LocalPoint, LocalFace)>>,
    /// The triangles to the left of other edges.
    more: FxHashMap<(LocalPoint, LocalPoint), LocalFace>,
    /// Some triangle at each point, or [`NONE`].
    some_face: Vec<LocalFace>,
}

impl Adjacency {
    /// The adjacency of triangles between `points` points. O(triangles), and a sort of the edges at each point.
    pub(super) fn new(points: usize, faces: &[Face]) -> Self {
        let alive = (0..).map(LocalFace).zip(faces).filter(|(_, face)| face.alive);
        let mut some_face = vec![NONE; points];
        for (index, face) in alive.clone() {
            face.corners.iter().for_each(|corner| some_face[corner.index()] = index);
        }
        let by_start = alive.flat_map(|(index, face)| face.sides().map(|(from, to)| (from.0, (to, index))));
        let mut edges = Buckets::new(points, by_start);
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
    pub(super) fn left_of(&self, from: LocalPoint, to: LocalPoint) -> Option<LocalFace> {
        let edges = self.edges.as_ref()?.get(from.index());
        match find_edge(edges, to) {
            Some(place) => Some(edges[place].1).filter(|&face| face != NONE),
            None if self.more.is_empty() => None,
            None => self.more.get(&(from, to)).copied(),
        }
    }

    /// Some triangle at a point.
    pub(super) fn some_face(&self, point: LocalPoint) -> Option<LocalFace> {
        self.some_face.get(point.index()).copied().filter(|&face| face != NONE)
    }

    /// Takes a triangle in.
    pub(super) fn link(&mut self, face: LocalFace, corners: [LocalPoint; 3]) {
        for (from, to) in sides(corners) {
            self.set(from, to, face);
            self.some_face[from.index()] = face;
        }
    }

    /// Leaves a triangle out; its corners have no triangle then that they are known by.
    pub(super) fn unlink(&mut self, corners: [LocalPoint; 3]) {
        for (from, to) in sides(corners) {
            self.set(from, to, NONE);
            self.some_face[from.index()] = NONE;
        }
    }

    /// Finds triangles for those corners of a triangle that are known by none.
    pub(super) fn find_some_faces(&mut self, corners: [LocalPoint; 3]) {
        for (from, to) in sides(corners) {
            if self.some_face[from.index()] == NONE
                && let Some(face) = self.left_of(from, to)
            {
                self.some_face[from.index()] = face;
            }
        }
    }

    fn set(&mut self, from: LocalPoint, to: LocalPoint, face: LocalFace) {
        if let Some(buckets) = &mut self.edges {
            let edges = buckets.get_mut(from.index());
            if let Some(place) = find_edge(edges, to) {
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

/// The position of the edge to a point among those from its start, which are sorted.
#[inline]
fn find_edge(edges: &[(LocalPoint, LocalFace)], to: LocalPoint) -> Option<usize> {
    let place = if edges.len() <= LINEAR_SEARCH_EDGES {
        edges.iter().position(|edge| edge.0 >= to)?
    } else {
        edges.partition_point(|edge| edge.0 < to)
    };
    edges.get(place).is_some_and(|edge| edge.0 == to).then_some(place)
}

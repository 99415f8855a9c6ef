//! Where anything happens: the faces round the crossings, and the patches of surface between them.
//!
//! Only faces that cross others need their edges, and those round them. In all the rest, which is nearly all, nothing changes
//! from a vertex to its neighbours: what is connected without a vertex of a near face is one *patch*, with one label.
//!
//! ```text
//!      patch    /\    /\    /\    patch             * vertices of near faces (they cross others, or may)
//!     --------./__\ *-----* /__\ .--------          . all others: those of a patch hang together
//!              \  / \ near/ \  /                    faces with a * have their edges and are walked over;
//!     ---------.\/   *---*   \/.---------           all others only belong to their patch
//! ```
//!
//! That takes a 2-manifold without two triangles on the same vertices. Otherwise all faces are walked over, and no patches are
//! made.

use super::surfaces::Surfaces;
use crate::boolean::complex::ids::{FaceId, VertexId};
use crate::mesh::{BitSet, Buckets, UnionFind};

/// The patches of surfaces, where they are made.
#[derive(Debug, Default)]
pub(crate) struct Locality {
    /// By vertex, its patch; [`NONE`] for one of a near face. Empty where there are no patches.
    of_vertex: Vec<u32>,
    /// By patch, the faces at its border.
    bordering: Option<Buckets<FaceId>>,
    count: usize,
}

/// No patch.
const NONE: u32 = u32::MAX;

impl Default for FaceId {
    fn default() -> Self {
        Self::NONE
    }
}

impl Locality {
    /// No patches; and the pieces of surface: how many, and that of each vertex.
    pub(crate) fn everywhere(surfaces: &Surfaces) -> (Self, (usize, Vec<u32>)) {
        let mut sets = UnionFind::new(surfaces.vertex_count() as usize);
        for face in surfaces.faces() {
            let [u, v, w] = surfaces.vertices(face).map(VertexId::number);
            sets.join(u, v);
            sets.join(v, w);
        }
        (Self::default(), sets.labels())
    }

    /// The patches between the faces that are near others; and the pieces of surface.
    pub(crate) fn around(surfaces: &Surfaces, pairs: &[[FaceId; 2]]) -> (Self, (usize, Vec<u32>)) {
        let vertices = surfaces.vertex_count() as usize;
        let mut is_near = BitSet::new(vertices);
        for &face in pairs.iter().flatten() {
            surfaces.vertices(face).iter().for_each(|v| is_near.insert(v.number()));
        }
        // 1. Patches: connected by sides without near vertices.
        let mut sets = UnionFind::new(vertices);
        let mut near = Vec::new();
        for face in surfaces.faces() {
            let corners = surfaces.vertices(face).map(VertexId::number);
            match corners.map(|v| is_near.contains(v)) {
                [false, false, false] => {
                    sets.join(corners[0], corners[1]);
                    sets.join(corners[1], corners[2]);
                }
                of_corner => {
                    near.push(face);
                    for k in 0..3 {
                        let next = (k + 1) % 3;
                        if !(of_corner[k] || of_corner[next]) {
                            sets.join(corners[k], corners[next]);
                        }
                    }
                }
            }
        }
        let (count, mut of_vertex) = sets.labels();
        is_near.iter().for_each(|v| of_vertex[v as usize] = NONE);
        let borders = near.iter().flat_map(|&face| {
            let patches = surfaces.vertices(face).map(|v| of_vertex[v.index()]);
            patches.into_iter().filter(|&patch| patch != NONE).map(move |patch| (patch, face))
        });
        let bordering = Buckets::new(count, borders);
        // 2. Pieces: these, and the faces between them.
        for &face in &near {
            let [u, v, w] = surfaces.vertices(face).map(VertexId::number);
            sets.join(u, v);
            sets.join(v, w);
        }
        (Self { of_vertex, bordering: Some(bordering), count }, sets.labels())
    }

    /// The faces that are walked over, ascending: those with a vertex of a near face, and those round some other `vertices`.
    pub(crate) fn walked_over(
        &self,
        surfaces: &Surfaces,
        vertices: impl Iterator<Item = VertexId>,
    ) -> Vec<FaceId> {
        let mut is_walked = BitSet::new(surfaces.vertex_count() as usize);
        vertices.for_each(|v| is_walked.insert(v.number()));
        let near = (0..).zip(&self.of_vertex).filter(|&(_, &patch)| patch == NONE);
        near.for_each(|(v, _)| is_walked.insert(v));
        let is_walked =
            |face: &FaceId| surfaces.vertices(*face).iter().any(|v| is_walked.contains(v.number()));
        surfaces.faces().filter(is_walked).collect()
    }

    /// How many patches there may be.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The patch that a vertex belongs to, if it does to one.
    #[inline]
    pub(crate) fn of_vertex(&self, vertex: VertexId) -> Option<usize> {
        self.of_vertex.get(vertex.index()).filter(|&&patch| patch != NONE).map(|&patch| patch as usize)
    }

    /// The faces at the border of a patch: with vertices of it and of near faces.
    pub(crate) fn bordering(&self, patch: usize) -> &[FaceId] {
        self.bordering.as_ref().map_or(&[], |faces| faces.get(patch))
    }
}

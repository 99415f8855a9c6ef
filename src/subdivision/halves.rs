//! Half-edges of faces of any size: which runs back along which, and where the fan of a vertex begins.

use rustc_hash::FxHashMap;

use super::error::CageError;
use super::level::NONE;

/// How half-edges hang together.
pub(crate) struct Halves {
    /// For each half-edge the one that runs back; [`NONE`] at a border.
    pub(crate) twins: Vec<u32>,
    /// For each half-edge its edge.
    pub(crate) edge_of: Vec<u32>,
    /// For each edge one of its half-edges, the lower one.
    pub(crate) edges: Vec<u32>,
}

impl Halves {
    /// Of half-edges with the given ends; `face_of` has the face of each.
    ///
    /// # Errors
    /// The first edge that two faces run along in the same direction.
    pub(crate) fn paired(
        count: usize,
        ends: impl Fn(u32) -> [u32; 2],
        face_of: impl Fn(u32) -> usize,
    ) -> Result<Self, CageError> {
        let (mut twins, mut edge_of) = (vec![NONE; count], vec![NONE; count]);
        let mut edges = Vec::with_capacity(count / 2 + 1);
        let mut known: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        known.reserve(count);
        for h in 0..count as u32 {
            let [u, v] = ends(h);
            if let Some(&other) = known.get(&[u, v]) {
                return Err(CageError::EdgeNotManifold { edge: [u, v], faces: [face_of(other), face_of(h)] });
            }
            known.insert([u, v], h);
            if let Some(&twin) = known.get(&[v, u]) {
                (twins[h as usize], twins[twin as usize]) = (twin, h);
                edge_of[h as usize] = edge_of[twin as usize];
            } else {
                edge_of[h as usize] = edges.len() as u32;
                edges.push(h);
            }
        }
        Ok(Self { twins, edge_of, edges })
    }

    /// For each edge its sharpness without tags: a border is a crease, all else is smooth.
    pub(crate) fn sharpness(&self) -> Vec<f64> {
        let of_edge = |&h: &u32| if self.twins[h as usize] == NONE { f64::INFINITY } else { 0.0 };
        self.edges.iter().map(of_edge).collect()
    }
}

/// For each vertex the half-edge its fan begins with: the lowest that leaves it, or that at a border; [`NONE`] without faces.
pub(crate) fn first_of_vertices(vertex_count: usize, twins: &[u32], from: impl Fn(u32) -> u32) -> Vec<u32> {
    let mut first = vec![NONE; vertex_count];
    for h in (0..twins.len() as u32).rev() {
        let current = &mut first[from(h) as usize];
        if *current == NONE || twins[*current as usize] != NONE || twins[h as usize] == NONE {
            *current = h;
        }
    }
    first
}

//! Angle-weighted pseudonormals (Baerentzen, Aanaes 2005): the normals whose side decides inside and outside when
//! the nearest point lies on an edge or at a vertex.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::Mesh;
use crate::spatial::Feature;

/// Normals of the faces, edges and vertices of a closed mesh, outward.
///
/// A zero normal marks a feature at which the normals do not decide the side: an edge with other than two triangles, or a
/// feature next to a triangle too thin to have a reliable normal.
#[derive(Clone, Debug)]
pub(crate) struct PseudoNormals {
    faces: Vec<DVec3>,
    /// For every triangle and edge (corner `i` to `i + 1`) the triangle on the other side; `NONE` if there is not
    /// exactly one.
    mates: Vec<[u32; 3]>,
    /// For every triangle and corner the index in `vertices`.
    corners: Vec<[u32; 3]>,
    vertices: Vec<DVec3>,
    /// What the edges say of the surface.
    edges: Edges,
}

/// What the edges of a surface say of it as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Edges {
    /// Exactly two triangles of opposite direction at each.
    Regular,
    /// As many triangles of either direction at each.
    Balanced,
    /// More of one direction at some: the surface is open there.
    Open,
}

const NONE: u32 = u32::MAX;
/// Below this ratio of doubled area to squared longest edge a normal may be off by more than a thousandth of a
/// degree.
const THIN: f64 = 1e-10;

impl PseudoNormals {
    /// Normals of `mesh`; vertices at equal positions are taken as one. O(n log n).
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let welded = weld(&mesh.positions);
        let corners: Vec<[u32; 3]> = mesh
            .triangles
            .iter()
            .map(|t| t.map(|vertex| welded.get(vertex as usize).copied().unwrap_or(NONE)))
            .collect();
        let position = |vertex: u32| mesh.positions.get(vertex as usize).map(|&p| DVec3::from_array(p));
        let faces: Vec<DVec3> = corners.iter().map(|t| face_normal(t.map(position))).collect();
        let (mates, edges) = mates(&corners);
        let mut vertices = vec![DVec3::ZERO; mesh.positions.len()];
        let mut unreliable = vec![false; mesh.positions.len()];
        for (corners, &normal) in corners.iter().zip(&faces) {
            for k in 0..3 {
                let at = corners[k] as usize;
                let around = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]].map(position);
                let [Some(p), Some(q), Some(r)] = around else { continue };
                if normal == DVec3::ZERO {
                    unreliable[at] = true;
                }
                let (u, v) = (q - p, r - p);
                vertices[at] += normal * u.cross(v).length().atan2(u.dot(v));
            }
        }
        for (normal, unreliable) in vertices.iter_mut().zip(unreliable) {
            if unreliable {
                *normal = DVec3::ZERO;
            }
        }
        Self { faces, mates, corners, vertices, edges }
    }

    /// The pseudonormal of a feature, not normalised; zero where it does not decide the side.
    pub(crate) fn of(&self, triangle: u32, feature: Feature) -> DVec3 {
        let triangle = triangle as usize;
        match feature {
            Feature::Face => self.faces[triangle],
            Feature::Edge(edge) => match self.mates[triangle][usize::from(edge)] {
                NONE => DVec3::ZERO,
                mate => {
                    let (own, other) = (self.faces[triangle], self.faces[mate as usize]);
                    if own == DVec3::ZERO || other == DVec3::ZERO { DVec3::ZERO } else { own + other }
                }
            },
            Feature::Vertex(corner) => self.vertices[self.corners[triangle][usize::from(corner)] as usize],
        }
    }

    /// Whether every edge has exactly two triangles, of opposite direction.
    pub(crate) fn is_regular(&self) -> bool {
        self.edges == Edges::Regular
    }

    /// Whether every edge has as many triangles of one direction as of the other: the surface has no boundary.
    pub(crate) fn is_closed(&self) -> bool {
        self.edges != Edges::Open
    }

    /// Number of triangles.
    pub(crate) fn len(&self) -> usize {
        self.faces.len()
    }

    /// Bytes held.
    pub(crate) fn memory(&self) -> usize {
        self.faces.capacity() * 24
            + (self.mates.capacity() + self.corners.capacity()) * 12
            + self.vertices.capacity() * 24
    }
}

/// For every vertex the first vertex at the same place (0 and -0 are one place).
fn weld(positions: &[[f64; 3]]) -> Vec<u32> {
    let mut first: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    first.reserve(positions.len());
    positions
        .iter()
        .enumerate()
        .map(|(index, position)| *first.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(index as u32))
        .collect()
}

fn face_normal(corners: [Option<DVec3>; 3]) -> DVec3 {
    let [Some(a), Some(b), Some(c)] = corners else { return DVec3::ZERO };
    let edges = [b - a, c - b, a - c];
    let longest = edges.iter().map(|edge| edge.abs().max_element()).fold(0.0, f64::max);
    if !(longest > 0.0) {
        return DVec3::ZERO;
    }
    // Scaled first, so that the products of very large or very small triangles stay in range.
    let cross = (edges[0] / longest).cross(-(edges[2] / longest));
    let doubled_area = cross.length();
    if doubled_area > THIN { cross / doubled_area } else { DVec3::ZERO }
}

/// The neighbour over each edge, where there is exactly one, and what the edges say of the surface.
fn mates(corners: &[[u32; 3]]) -> (Vec<[u32; 3]>, Edges) {
    let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * corners.len());
    for (triangle, corner) in corners.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corner[k], corner[(k + 1) % 3]);
            edges.push((a.min(b), a.max(b), (3 * triangle + k) as u32));
        }
    }
    edges.sort_unstable();
    let mut mates = vec![[NONE; 3]; corners.len()];
    let mut surface = Edges::Regular;
    for run in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let slot = |entry: u32| (entry as usize / 3, entry as usize % 3);
        let start = |entry: u32| corners[slot(entry).0][slot(entry).1];
        if let [(a, b, first), (_, _, second)] = *run
            && a != b
            && start(first) != start(second)
        {
            let (first, second) = (slot(first), slot(second));
            mates[first.0][first.1] = second.0 as u32;
            mates[second.0][second.1] = first.0 as u32;
        } else {
            let (a, b) = (run[0].0, run[0].1);
            let rising = run.iter().filter(|edge| start(edge.2) == a).count();
            let balanced = a == b || 2 * rising == run.len();
            surface = if balanced && surface != Edges::Open { Edges::Balanced } else { Edges::Open };
        }
    }
    (mates, surface)
}

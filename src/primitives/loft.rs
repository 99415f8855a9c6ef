//! Closed meshes between copies of one plane section: prisms, and whatever else moves a region through space.

use rustc_hash::FxHashMap;

use crate::Mesh;

/// The edges of plane triangles that have one on their left and none on their right, ascending.
pub(crate) fn boundary_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    edges.sort_unstable();
    let is_boundary = |&[a, b]: &[u32; 2]| edges.binary_search(&[b, a]).is_err();
    edges.iter().copied().filter(is_boundary).collect()
}

/// The closed mesh between rings of one section: `rings[k][i]` is the place of point `i` of the section on ring `k`. Its
/// `triangles` turn counter-clockwise seen against the direction of travel; its `boundary` has them on its left. If
/// `is_closed` the last ring is followed by the first, else the section closes both ends.
///
/// Triangles: those of the section at the first ring and the last, in turn; then two for each edge of the boundary and
/// each pair of rings, by the shorter diagonal. Points that coincide bit for bit become one vertex, and triangles that have
/// two such corners are left out.
pub(crate) fn loft(
    triangles: &[[u32; 3]],
    boundary: &[[u32; 2]],
    rings: &[Vec<[f64; 3]>],
    is_closed: bool,
) -> Mesh {
    let mut vertices = VertexTable::default();
    let ids: Vec<Vec<u32>> =
        rings.iter().map(|ring| ring.iter().map(|&place| vertices.id(place)).collect()).collect();
    let mut mesh: Vec<[u32; 3]> = Vec::new();
    let mut push = |[a, b, c]: [u32; 3]| {
        if a != b && b != c && c != a {
            mesh.push([a, b, c]);
        }
    };
    // 1. The ends.
    if let ([first, .., last], false) = (&ids[..], is_closed) {
        for [a, b, c] in triangles.iter().map(|corners| corners.map(|i| i as usize)) {
            push([first[a], first[c], first[b]]);
            push([last[a], last[b], last[c]]);
        }
    }
    // 2. The walls.
    let layers = if is_closed { rings.len() } else { rings.len().saturating_sub(1) };
    for [a, b] in boundary.iter().map(|edge| edge.map(|i| i as usize)) {
        for k in 0..layers {
            let above = (k + 1) % rings.len();
            let (low, high) = (&ids[k], &ids[above]);
            let rising = squared_distance(rings[k][a], rings[above][b]).sqrt();
            let falling = squared_distance(rings[k][b], rings[above][a]).sqrt();
            if rising <= falling {
                push([low[a], low[b], high[b]]);
                push([low[a], high[b], high[a]]);
            } else {
                push([low[a], low[b], high[a]]);
                push([low[b], high[b], high[a]]);
            }
        }
    }
    Mesh::new(vertices.positions, mesh)
}

fn squared_distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum()
}

/// Vertices, one for each place.
#[derive(Default)]
struct VertexTable {
    positions: Vec<[f64; 3]>,
    known: FxHashMap<[u64; 3], u32>,
}

impl VertexTable {
    /// The vertex at a place, made if there is none yet.
    fn id(&mut self, place: [f64; 3]) -> u32 {
        // Adding zero makes one of the two zeros.
        let place = place.map(|x| x + 0.0);
        *self.known.entry(place.map(f64::to_bits)).or_insert_with(|| {
            self.positions.push(place);
            (self.positions.len() - 1) as u32
        })
    }
}

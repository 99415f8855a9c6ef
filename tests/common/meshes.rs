//! Helpers shared by the tests: slow and simple judges, and ways to damage meshes.

use std::collections::{BTreeMap, HashMap};

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use trisect::Mesh;

/// Whether every directed edge is met by its opposite equally often. Triangles with a repeated corner count for
/// nothing, which needs no special case: their edges cancel.
pub(crate) fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut net: HashMap<(u32, u32), i64> = HashMap::new();
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *net.entry((from, to)).or_default() += 1;
            *net.entry((to, from)).or_default() -= 1;
        }
    }
    net.values().all(|&count| count == 0)
}

/// How often each triangle is in the surface, by the places of its corners; opposite copies cancel.
pub(crate) fn chain_of(mesh: &Mesh) -> BTreeMap<[[u64; 3]; 3], i64> {
    let mut chain = BTreeMap::new();
    for triangle in &mesh.triangles {
        let mut corners = triangle.map(|corner| mesh.positions[corner as usize].map(|x| (x + 0.0).to_bits()));
        if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
            continue;
        }
        // Sorting by hand counts the swaps, hence the orientation.
        let mut sign = 1;
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if corners[i] > corners[j] {
                corners.swap(i, j);
                sign = -sign;
            }
        }
        *chain.entry(corners).or_default() += sign;
    }
    chain.retain(|_, &mut count| count != 0);
    chain
}

/// Six times the volume of a mesh whose coordinates are small integers.
pub(crate) fn six_volumes(mesh: &Mesh) -> i64 {
    let determinant = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize].map(|x| x as i64));
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    mesh.triangles.iter().map(determinant).sum()
}

/// Every triangle with corners of its own, each coordinate off by at most `jitter`.
pub(crate) fn jittered_soup(mesh: &Mesh, jitter: f64) -> Mesh {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let corners = mesh.triangles.iter().flatten();
    let positions: Vec<_> = corners
        .map(|&corner| mesh.positions[corner as usize].map(|x| x + random.random_range(-jitter..=jitter)))
        .collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]);
    Mesh::new(positions, triangles.collect())
}

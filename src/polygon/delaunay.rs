//! Constrained Delaunay triangulation: of big polygons, and between edges by winding number.

use rustc_hash::FxHashMap;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::counted::{CountedEdge, CountedTriangle};

/// A vertex that remembers its index.
struct Vertex {
    position: Point2<f64>,
    index: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Appends a triangulation of the region to the left of the rings and returns true; or returns false and appends nothing
/// where the shape does not allow one (coincident projections, crossing edges, a coordinate out of range).
pub(super) fn triangulate(points: &[[f64; 2]], rings: &[&[u32]], triangles: &mut Vec<[u32; 3]>) -> bool {
    attempt(points, rings).is_some_and(|found| {
        triangles.extend(found);
        true
    })
}

fn attempt(points: &[[f64; 2]], rings: &[&[u32]]) -> Option<Vec<[u32; 3]>> {
    let mut corners = 0;
    let mut edges = Vec::new();
    for ring in rings {
        corners += ring.len();
        edges.extend((0..ring.len()).map(|i| ([ring[i], ring[(i + 1) % ring.len()]], 1)));
    }
    let found = between(points, &edges)?;
    // Complete: the count of Euler's formula for one outline (vertices visited twice count twice).
    (found.len() + 4 == corners + 2 * rings.len() && found.iter().all(|&(_, winding)| winding == 1))
        .then(|| found.into_iter().map(|(triangle, _)| triangle).collect())
}

/// Triangulates the plane between edges that each count a number of times, and returns the counter-clockwise triangles
/// round which they wind, with the winding number. `None` where the triangulation does not hold every edge as it is.
pub(super) fn between(points: &[[f64; 2]], edges: &[CountedEdge]) -> Option<Vec<CountedTriangle>> {
    // How often an edge counts from its lower vertex to its higher one.
    let mut counts: FxHashMap<(u32, u32), i32> = FxHashMap::default();
    for &([u, v], count) in edges {
        if u == v {
            return None;
        }
        *counts.entry((u.min(v), u.max(v))).or_default() += if u < v { count } else { -count };
    }
    counts.retain(|_, count| *count != 0);
    let mut constraints: Vec<(u32, u32)> = counts.keys().copied().collect();
    constraints.sort_unstable();
    let mut indices: Vec<u32> = constraints.iter().flat_map(|&(u, v)| [u, v]).collect();
    indices.sort_unstable();
    indices.dedup();
    let place = |v: u32| indices.binary_search(&v).expect("collected above");
    // Spade takes nothing but zero below 2^-142; such a difference is far below an ulp of the polygon's size.
    let vertices: Vec<Vertex> = indices
        .iter()
        .map(|&index| {
            let [x, y] = points[index as usize].map(|x| if x.abs() < 1e-42 { 0.0 } else { x });
            Vertex { position: Point2::new(x, y), index }
        })
        .collect();
    let count = vertices.len();
    // Loading vertices and edges at once would depend on the order of a hash set where points lie on one circle.
    let mut triangulation = ConstrainedDelaunayTriangulation::<Vertex>::bulk_load(vertices).ok()?;
    if triangulation.num_vertices() != count {
        return None;
    }
    let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; count];
    for vertex in triangulation.vertices() {
        handles[place(vertex.data().index)] = Some(vertex.fix());
    }
    for &(u, v) in &constraints {
        let (from, to) = handles[place(u)].zip(handles[place(v)])?;
        if triangulation.try_add_constraint(from, to).is_empty() {
            return None;
        }
    }
    // Flood from outside, where the winding number is 0; an edge passed from its right to its left adds its count.
    let mut winding: Vec<Option<i32>> = vec![None; triangulation.num_all_faces()];
    let outer = triangulation.outer_face();
    winding[outer.index()] = Some(0);
    let mut stack = vec![outer.fix()];
    let mut seen = 0;
    while let Some(face) = stack.pop() {
        let here = winding[face.index()]?;
        // Every edge once from each side, with its face to the left.
        let around: Vec<_> = match triangulation.face(face).as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => triangulation.convex_hull().map(|edge| edge.rev()).collect(),
        };
        for edge in around {
            let edge = if edge.face().fix() == face { edge } else { edge.rev() };
            let (from, to) = (edge.from().data().index, edge.to().data().index);
            let count = counts.get(&(from.min(to), from.max(to))).copied().unwrap_or(0);
            seen += usize::from(count != 0);
            // What lies to the left of an edge winds once more than what lies to its right.
            let there = here - if from < to { count } else { -count };
            let other = edge.rev().face().fix();
            match winding[other.index()] {
                None => {
                    winding[other.index()] = Some(there);
                    stack.push(other);
                }
                Some(known) if known != there => return None,
                Some(_) => {}
            }
        }
    }
    if seen != 2 * counts.len() {
        // Some edge runs through a vertex that is not its end.
        return None;
    }
    Some(
        triangulation
            .inner_faces()
            .filter_map(|face| {
                let winding = winding[face.fix().index()].filter(|&winding| winding != 0)?;
                Some((face.vertices().map(|vertex| vertex.data().index), winding))
            })
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Corners of grid cells lie on common circles and lines, and any choice of diagonals is as good as another.
    #[test]
    fn the_same_input_gives_the_same_triangles() {
        let mut rng = ChaCha8Rng::seed_from_u64(62);
        for _ in 0..1_000 {
            let size = rng.random_range(3..12u32);
            let full = rng.random_range(0.1..0.9);
            // Turned a bit: hardly any point lies exactly on the circle through others.
            let turn = if rng.random() { 0.0 } else { 0.3 };
            let points: Vec<[f64; 2]> = (0..(size + 1) * (size + 1))
                .map(|i| {
                    let (x, y) = (f64::from(i % (size + 1)), f64::from(i / (size + 1)));
                    [x - turn * y, y + turn * x]
                })
                .collect();
            let mut edges: Vec<CountedEdge> = Vec::new();
            for cell in 0..size * size {
                if rng.random_bool(full) {
                    let a = cell / size * (size + 1) + cell % size;
                    let (b, c, d) = (a + 1, a + size + 2, a + size + 1);
                    edges.extend([[a, b], [b, c], [c, d], [d, a]].map(|edge| (edge, 1)));
                }
            }
            let first = between(&points, &edges);
            assert!(edges.is_empty() || first.is_some(), "no edges cross");
            for _ in 0..3 {
                assert_eq!(between(&points, &edges), first);
            }
        }
    }
}

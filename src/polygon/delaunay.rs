//! Big polygons: a constrained Delaunay triangulation, checked for completeness.

use rustc_hash::{FxHashMap, FxHashSet};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

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
    let mut of_vertex: FxHashMap<u32, usize> = FxHashMap::default();
    let mut vertices = Vec::new();
    let mut edges: FxHashSet<(u32, u32)> = FxHashSet::default();
    let mut constraints = Vec::new();
    let mut corners = 0;
    for ring in rings {
        corners += ring.len();
        for (i, &v) in ring.iter().enumerate() {
            let w = ring[(i + 1) % ring.len()];
            let place = |v: u32, vertices: &mut Vec<Vertex>, of_vertex: &mut FxHashMap<u32, usize>| {
                *of_vertex.entry(v).or_insert_with(|| {
                    // Spade takes nothing but zero below 2^-142; such a difference is far below an ulp of the polygon's size.
                    let [x, y] = points[v as usize].map(|x| if x.abs() < 1e-42 { 0.0 } else { x });
                    vertices.push(Vertex { position: Point2::new(x, y), index: v });
                    vertices.len() - 1
                })
            };
            let from = place(v, &mut vertices, &mut of_vertex);
            let to = place(w, &mut vertices, &mut of_vertex);
            constraints.push([from, to]);
            if v == w || !edges.insert((v, w)) || edges.contains(&(w, v)) {
                return None;
            }
        }
    }
    let count = vertices.len();
    let mut conflict = false;
    let triangulation =
        ConstrainedDelaunayTriangulation::<Vertex>::try_bulk_load_cdt(vertices, constraints, |_| {
            conflict = true
        })
        .ok()?;
    if conflict || triangulation.num_vertices() != count {
        return None;
    }
    // Flood from the boundary's left sides; a boundary edge is never passed.
    let mut inside: FxHashSet<usize> = FxHashSet::default();
    let mut stack = Vec::new();
    for edge in triangulation.directed_edges() {
        if edges.contains(&(edge.from().data().index, edge.to().data().index)) {
            stack.push(edge.face().as_inner()?.fix());
        }
    }
    while let Some(face) = stack.pop() {
        if !inside.insert(face.index()) {
            continue;
        }
        for edge in triangulation.face(face).adjacent_edges() {
            let (from, to) = (edge.from().data().index, edge.to().data().index);
            if edges.contains(&(to, from)) {
                return None;
            }
            if !edges.contains(&(from, to)) {
                stack.push(edge.rev().face().as_inner()?.fix());
            }
        }
    }
    // Complete: the count of Euler's formula for one outline (vertices visited twice count twice).
    let found: Vec<[u32; 3]> = triangulation
        .inner_faces()
        .filter(|face| inside.contains(&face.fix().index()))
        .map(|face| face.vertices().map(|vertex| vertex.data().index))
        .collect();
    (found.len() + 4 == corners + 2 * rings.len()).then_some(found)
}

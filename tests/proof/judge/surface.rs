//! What a mesh is, by definition and slowly: the engine's own answers are not asked.

use std::collections::HashMap;

use trisect::Mesh;

use super::vector::{Point, cross, dot, extent, length, minus};

/// Properties of a triangle mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Properties {
    pub(crate) closed: bool,
    /// Closed, two triangles to each edge, one fan to each vertex, no vertex without a triangle.
    pub(crate) manifold: bool,
    /// Connected by edges.
    pub(crate) components: usize,
    /// Vertices minus edges plus triangles.
    pub(crate) euler: i64,
    /// Triangles whose corners lie exactly on a line, or repeat.
    pub(crate) zero_area: usize,
    pub(crate) volume: f64,
    pub(crate) area: f64,
}

impl Properties {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let mut edges: HashMap<(u32, u32), Vec<(usize, bool)>> = HashMap::new();
        for (index, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            for (u, v) in [(a, b), (b, c), (c, a)] {
                edges.entry((u.min(v), u.max(v))).or_default().push((index, u < v));
            }
        }
        let balanced =
            |sides: &Vec<(usize, bool)>| 2 * sides.iter().filter(|side| side.1).count() == sides.len();
        let closed = edges.values().all(balanced) && edges.keys().all(|(u, v)| u != v);
        let two_sided = closed && edges.values().all(|sides| sides.len() == 2);
        let corners = 3 * mesh.triangles.len();
        // Corners joined across edges: fans round vertices. Triangles joined across edges: components.
        let (mut fans, mut bodies) = (Sets::new(corners), Sets::new(mesh.triangles.len()));
        let corner_of = |triangle: usize, vertex: u32| {
            3 * triangle + mesh.triangles[triangle].iter().position(|&v| v == vertex).expect("a corner of it")
        };
        for (&(u, v), sides) in &edges {
            for pair in sides.windows(2) {
                bodies.join(pair[0].0, pair[1].0);
                for vertex in [u, v] {
                    fans.join(corner_of(pair[0].0, vertex), corner_of(pair[1].0, vertex));
                }
            }
        }
        let mut used = vec![false; mesh.positions.len()];
        mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        let vertices = used.iter().filter(|&&used| used).count();
        Self {
            closed,
            manifold: two_sided && fans.count() == vertices && vertices == used.len(),
            components: bodies.count(),
            euler: vertices as i64 - edges.len() as i64 + mesh.triangles.len() as i64,
            zero_area: mesh.triangles.iter().filter(|corners| is_flat(positions(mesh, corners))).count(),
            volume: volume(mesh),
            area: mesh.triangles.iter().map(|corners| triangle_area(positions(mesh, corners))).sum(),
        }
    }
}

fn positions(mesh: &Mesh, corners: &[u32; 3]) -> [Point; 3] {
    corners.map(|corner| mesh.positions[corner as usize])
}

fn triangle_area([a, b, c]: [Point; 3]) -> f64 {
    0.5 * length(cross(minus(b, a), minus(c, a)))
}

/// Whether three points are exactly on a line: all three projections are.
fn is_flat([a, b, c]: [Point; 3]) -> bool {
    let flat = |i: usize, j: usize| {
        let coordinates = |p: Point| robust::Coord { x: p[i], y: p[j] };
        robust::orient2d(coordinates(a), coordinates(b), coordinates(c)) == 0.0
    };
    flat(0, 1) && flat(1, 2) && flat(2, 0)
}

/// The enclosed volume, summed with compensation about the middle of the box.
pub(crate) fn volume(mesh: &Mesh) -> f64 {
    let [low, high] = extent(&mesh.positions);
    let middle = [0, 1, 2].map(|k| 0.5 * low[k] + 0.5 * high[k]);
    let (mut sum, mut lost) = (0.0f64, 0.0f64);
    for corners in &mesh.triangles {
        let [a, b, c] = positions(mesh, corners);
        let term = dot(minus(a, middle), cross(minus(b, a), minus(c, a)));
        let next = sum + term;
        lost += if sum.abs() >= term.abs() { (sum - next) + term } else { (term - next) + sum };
        sum = next;
    }
    (sum + lost) / 6.0
}

/// Disjoint sets of numbers.
pub(crate) struct Sets(Vec<usize>);

impl Sets {
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    pub(crate) fn find(&mut self, mut of: usize) -> usize {
        while self.0[of] != of {
            self.0[of] = self.0[self.0[of]];
            of = self.0[of];
        }
        of
    }

    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b);
    }

    pub(crate) fn count(&self) -> usize {
        self.0.iter().enumerate().filter(|&(index, &parent)| index == parent).count()
    }
}

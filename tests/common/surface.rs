//! What tests ask of a surface: closed, 2-manifold, volume, pieces and holes.
#![allow(dead_code, reason = "each test uses its own part")]

use std::collections::HashMap;

use trisect::Mesh;

/// Signed volume enclosed.
pub(crate) fn volume(mesh: &Mesh) -> f64 {
    let at = |vertex: u32| glam::DVec3::from_array(mesh.positions[vertex as usize]);
    let origin = mesh.positions.first().map_or(glam::DVec3::ZERO, |&p| glam::DVec3::from_array(p));
    mesh.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|vertex| at(vertex) - origin);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

/// Number of connected pieces and the sum of their genera; panics, saying where, unless the mesh is a closed
/// 2-manifold without isolated vertices: every directed edge once, its opposite once, one fan at every vertex.
pub(crate) fn manifold(mesh: &Mesh) -> (usize, i64) {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    for (index, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        assert!(a != b && b != c && c != a, "triangle {index} repeats a corner");
        for edge in [(a, b), (b, c), (c, a)] {
            let places = [edge.0, edge.1].map(|v| mesh.positions[v as usize]);
            assert!(edges.insert(edge, index as u32).is_none(), "directed edge used twice: {places:?}");
        }
    }
    for &(a, b) in edges.keys() {
        assert!(edges.contains_key(&(b, a)), "open edge at {:?}", mesh.positions[a as usize]);
    }
    // One fan at every vertex: walking over its edges returns after all its triangles.
    let mut corners = vec![0usize; mesh.positions.len()];
    let mut some = vec![None; mesh.positions.len()];
    for triangle in &mesh.triangles {
        for k in 0..3 {
            corners[triangle[k] as usize] += 1;
            some[triangle[k] as usize] = Some(triangle[(k + 1) % 3]);
        }
    }
    for vertex in 0..mesh.positions.len() {
        let start = some[vertex].unwrap_or_else(|| panic!("vertex {vertex} is not used"));
        let (mut at, mut steps) = (start, 0);
        loop {
            let triangle = mesh.triangles[edges[&(vertex as u32, at)] as usize];
            at = triangle.into_iter().find(|&v| v != vertex as u32 && v != at).expect("three corners");
            steps += 1;
            if at == start {
                break;
            }
        }
        assert_eq!(steps, corners[vertex], "several fans at {:?}", mesh.positions[vertex]);
    }
    let mut piece: Vec<usize> = (0..mesh.positions.len()).collect();
    fn root(piece: &mut [usize], mut at: usize) -> usize {
        while piece[at] != at {
            piece[at] = piece[piece[at]];
            at = piece[at];
        }
        at
    }
    for &(a, b) in edges.keys() {
        let (a, b) = (root(&mut piece, a as usize), root(&mut piece, b as usize));
        piece[a] = b;
    }
    let pieces = (0..piece.len()).filter(|&v| root(&mut piece, v) == v).count();
    let euler = mesh.positions.len() as i64 - edges.len() as i64 / 2 + mesh.triangles.len() as i64;
    (pieces, pieces as i64 - euler / 2)
}

//! How triangles hang together: components, fans, Euler characteristic, genus.

use super::components::Components;
use super::edges::EdgeTable;
use super::links::Links;
use super::union_find::UnionFind;

/// The shape of a set of triangles, regardless of where its vertices are.
#[derive(Clone, Debug)]
pub(super) struct Topology {
    /// How many pieces, connected by edges.
    pub(super) components: usize,
    /// The piece each triangle is in, numbered by their first triangles.
    pub(super) component_of: Vec<u32>,
    /// The vertices whose triangles form several fans (connected by the edges at the vertex), ascending, and how
    /// many.
    pub(super) pinched: Vec<(u32, u32)>,
    /// Used vertices minus edges plus triangles.
    pub(super) euler_characteristic: i64,
    /// The genus summed over the pieces, pinched vertices taken apart; `None` unless every edge has exactly two
    /// triangles in opposite directions.
    pub(super) genus: Option<usize>,
}

/// What of it is asked for most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// As [`Topology::components`].
    pub(super) components: usize,
    /// As [`Topology::euler_characteristic`].
    pub(super) euler_characteristic: i64,
    /// As [`Topology::genus`].
    pub(super) genus: Option<usize>,
}

impl Shape {
    /// Of triangles with the links `links`, whose corners are in range and differ. O(n).
    ///
    /// Where every vertex has one fan, what hangs together by vertices does so by edges; and the edges are counted by the triangles.
    pub(super) fn new(triangles: &[[u32; 3]], vertices: usize, links: &Links) -> Self {
        if !links.edge_manifold || links.pinched > 0 {
            let Topology { components, euler_characteristic, genus, .. } = Topology::new(triangles, vertices);
            return Self { components, euler_characteristic, genus };
        }
        let components = Components::new(triangles, vertices).count() - links.unreferenced;
        // Vertices - 3/2 triangles + triangles.
        let euler_characteristic = links.fans as i64 - triangles.len() as i64 / 2;
        // Every component is a closed orientable surface.
        let genus = (components as i64 - euler_characteristic / 2).max(0) as usize;
        Self { components, euler_characteristic, genus: Some(genus) }
    }
}

/// For every triangle the component it is in, counted from 0 in the order of their first triangles; and how many there are.
pub(super) fn labels(triangles: &[[u32; 3]], vertices: usize, links: &Links) -> (usize, Vec<u32>) {
    if links.edge_manifold && links.pinched == 0 {
        return Components::new(triangles, vertices).labels(triangles);
    }
    let topology = Topology::new(triangles, vertices);
    (topology.components, topology.component_of)
}

impl Topology {
    /// Of triangles whose corners are in range and differ. O(n).
    pub(super) fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        Self::of_edges(&EdgeTable::new(triangles, vertices), triangles, vertices)
    }

    /// The same, where the edges are known.
    pub(super) fn of_edges(table: &EdgeTable<'_>, triangles: &[[u32; 3]], vertices: usize) -> Self {
        let mut pieces = UnionFind::new(triangles.len());
        // Corner k of triangle t is 3 t + k; corners at one vertex are joined across the edges they share.
        let mut corners = UnionFind::new(3 * triangles.len());
        let corner = |triangle: u32, vertex: u32| {
            let own = triangles[triangle as usize];
            3 * triangle + own.iter().position(|&corner| corner == vertex).unwrap_or_default() as u32
        };
        let (mut edges, mut edge_manifold) = (0, true);
        for edge in table.iter() {
            edges += 1;
            edge_manifold &= edge.is_manifold();
            let mut neighbours = edge.triangles();
            let Some(first) = neighbours.next() else { continue };
            for next in neighbours {
                pieces.join(first, next);
                corners.join(corner(first, edge.low), corner(next, edge.low));
                corners.join(corner(first, edge.high), corner(next, edge.high));
            }
        }
        let mut fans = vec![0u32; vertices];
        for (index, &vertex) in triangles.iter().flatten().enumerate() {
            fans[vertex as usize] += u32::from(corners.root(index as u32) == index as u32);
        }
        let (components, component_of) = pieces.labels();
        let used = fans.iter().filter(|&&fans| fans > 0).count() as i64;
        let all_fans: i64 = fans.iter().map(|&fans| i64::from(fans)).sum();
        let faces_minus_edges = triangles.len() as i64 - edges;
        // Every component is a closed orientable surface: 2 - 2 genus = fans - edges + faces.
        let genus = components as i64 - (all_fans + faces_minus_edges) / 2;
        let pinched = (0..).zip(fans).filter(|&(_, fans)| fans > 1).collect();
        Self {
            components,
            component_of,
            pinched,
            euler_characteristic: used + faces_minus_edges,
            genus: edge_manifold.then_some(genus.max(0) as usize),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn two_tetrahedra(map: [u32; 4]) -> Vec<[u32; 3]> {
        let second = TETRAHEDRON.map(|triangle| triangle.map(|corner| map[corner as usize]));
        TETRAHEDRON.into_iter().chain(second).collect()
    }

    #[test]
    fn apart() {
        let topology = Topology::new(&two_tetrahedra([4, 5, 6, 7]), 8);
        assert_eq!((topology.components, topology.genus, topology.euler_characteristic), (2, Some(0), 4));
        assert_eq!(topology.component_of, [0, 0, 0, 0, 1, 1, 1, 1]);
        assert!(topology.pinched.is_empty());
    }

    #[test]
    fn touching_in_a_vertex() {
        let topology = Topology::new(&two_tetrahedra([0, 4, 5, 6]), 7);
        assert_eq!((topology.components, topology.genus, topology.euler_characteristic), (2, Some(0), 3));
        assert_eq!(topology.pinched, [(0, 2)]);
    }

    #[test]
    fn touching_in_an_edge() {
        let topology = Topology::new(&two_tetrahedra([0, 1, 4, 5]), 6);
        assert_eq!((topology.components, topology.genus, topology.euler_characteristic), (1, None, 3));
        assert!(topology.pinched.is_empty());
    }

    #[test]
    fn a_torus_has_a_hole() {
        // Three by three quadrilaterals.
        let vertex = |i: u32, j: u32| 3 * (i % 3) + j % 3;
        let quads = (0..9).map(|cell| (cell / 3, cell % 3));
        let triangles: Vec<_> = quads
            .flat_map(|(i, j)| {
                let (a, b, c, d) = (vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let topology = Topology::new(&triangles, 9);
        assert_eq!((topology.components, topology.genus, topology.euler_characteristic), (1, Some(1), 0));
    }
}

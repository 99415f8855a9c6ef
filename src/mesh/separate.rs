//! Solids that touch themselves, taken apart where they do.

use super::manifold::{HalfEdges, Surface, make_manifold};
use super::{Mesh, Polygons, Solid, attributes};

/// A whole mesh that is taken apart.
struct Whole {
    mesh: Mesh,
    /// For each triangle the one it is, or is a part of.
    source: Vec<u32>,
}

impl Surface for Whole {
    fn len(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn corners(&self, triangle: u32) -> Option<[u32; 3]> {
        Some(self.mesh.triangles[triangle as usize])
    }

    fn set_corners(&mut self, triangle: u32, corners: [u32; 3]) {
        self.mesh.triangles[triangle as usize] = corners;
    }

    fn add_part(&mut self, of: u32, corners: [u32; 3]) {
        self.mesh.triangles.push(corners);
        self.source.push(self.source[of as usize]);
        if let Some(&group) = self.mesh.groups.of_triangle.get(of as usize) {
            self.mesh.groups.of_triangle.push(group);
        }
        // What is cut up is part of its polygon no longer.
        let polygons = &mut self.mesh.polygons.of_triangle;
        if let Some(polygon) = polygons.get_mut(of as usize) {
            *polygon = Polygons::NONE;
            polygons.push(Polygons::NONE);
        }
    }

    fn position(&self, point: u32) -> [f64; 3] {
        self.mesh.positions[point as usize]
    }

    fn point_count(&self) -> usize {
        self.mesh.positions.len()
    }

    fn add_point(&mut self, position: [f64; 3]) -> u32 {
        self.mesh.positions.push(position);
        self.mesh.positions.len() as u32 - 1
    }

    fn is_complete(&self, _point: u32) -> bool {
        true
    }
}

impl Solid {
    /// This solid as a 2-manifold, and for every triangle of it the one it comes from: edges with more than two triangles
    /// and vertices with several fans of them are split so that what touches there separates. (Where two such edges would
    /// still share both ends, one gets a vertex in its middle.) O(n log n).
    ///
    /// ```
    /// use trisect::{Mesh, Solid};
    /// // Two tetrahedra that share the edge from vertex 0 to vertex 1.
    /// let [o, z] = [[0.0; 3], [0.0, 0.0, 1.0]];
    /// let positions = vec![o, z, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    /// let first = [[0, 3, 2], [0, 2, 1], [2, 3, 1], [3, 0, 1]];
    /// let second = [[0, 5, 4], [0, 4, 1], [4, 5, 1], [5, 0, 1]];
    /// let touching = Solid::try_from(Mesh::new(positions, [first, second].concat()))?;
    /// assert!(!touching.is_manifold());
    /// let (apart, _) = touching.separated();
    /// assert!(apart.is_manifold());
    /// assert_eq!(apart.volume(), touching.volume());
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn separated(&self) -> (Self, Vec<u32>) {
        let count = self.mesh().triangles.len() as u32;
        let Mesh { positions, triangles, groups, polygons, .. } = self.mesh();
        let (positions, triangles) = (positions.clone(), triangles.clone());
        let (groups, polygons) = (groups.clone(), polygons.clone());
        let mesh = Mesh { positions, triangles, groups, polygons, attributes: Vec::new() };
        let mut whole = Whole { mesh, source: (0..count).collect() };
        let half_edges = HalfEdges::of(&whole);
        make_manifold(&mut whole, &half_edges);
        whole.mesh.attributes =
            attributes::of_pieces(self.mesh(), &whole.mesh.positions, &whole.mesh.triangles, &whole.source);
        let mut separated = Self::from_closed_unchecked(whole.mesh);
        separated.source =
            Some(whole.source.iter().map(|&triangle| self.source_triangle(triangle)).collect());
        separated.cleaning = self.cleaning;
        separated.mending.clone_from(&self.mending);
        if let Some(known) = self.known_self_crossings() {
            separated.remember_self_crossings(known.clone());
        }
        (separated, whole.source)
    }
}

//! From the triangles as given to the chain they stand for: without the triangles that count for nothing, with
//! seams welded.

use super::{Mesh, MeshError, chain, duplicates, weld};

/// The triangles of a mesh that count, and what was done to get them.
#[derive(Debug, Default)]
pub(super) struct Cleaned {
    /// Triangles in the caller's vertex indices; of welded vertices the first.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The caller's index of each triangle, ascending.
    pub(super) source: Vec<u32>,
    /// How many triangles had a repeated corner, as given or once welded.
    pub(super) repeated_corners: usize,
    /// The caller's triangles left out as opposite copies of each other.
    pub(super) opposite: Vec<[u32; 2]>,
    /// How many vertices were replaced by another at the same place.
    pub(super) welded: usize,
    /// Whether the chain is closed.
    pub(super) closed: bool,
    /// Whether it is closed and every edge has exactly two triangles.
    pub(super) edge_manifold: bool,
}

/// Which vertices on open edges are made one where the triangles are not closed.
#[derive(Clone, Copy)]
pub(super) enum Weld {
    /// Those with equal coordinates.
    Exact,
    /// Those too that lie within this distance on edges still open then.
    Within(f64),
}

/// Refuses triangles out of range, and vertices that are not finite unless only triangles that count for nothing
/// use them.
pub(super) fn check_corners(mesh: &Mesh) -> Result<(), MeshError> {
    for (triangle, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for index in [a, b, c] {
            let Some(&position) = mesh.positions.get(index as usize) else {
                return Err(MeshError::IndexOutOfRange { triangle, index, vertices: mesh.positions.len() });
            };
            let counts = a != b && b != c && c != a;
            if counts && !position.iter().all(|x| x.is_finite()) {
                return Err(MeshError::NotFinite { vertex: index as usize, position });
            }
        }
    }
    Ok(())
}

/// Cleans `triangles`. Triangles out of range or with a corner that is not finite are left out, so that this works
/// on anything; [`Solid`](super::Solid) refuses them before.
pub(super) fn clean(positions: &[[f64; 3]], triangles: &[[u32; 3]], how: Weld) -> Cleaned {
    let sound = |&vertex: &u32| {
        let position = positions.get(vertex as usize);
        position.is_some_and(|position| position.iter().all(|x| x.is_finite()))
    };
    let mut cleaned = Cleaned::default();
    for (index, triangle) in triangles.iter().enumerate() {
        if triangle.iter().all(sound) {
            cleaned.triangles.push(*triangle);
            cleaned.source.push(index as u32);
        }
    }
    cleaned.drop_repeated_corners();
    let vertices = positions.len();
    let mut examined = cleaned.examine(vertices);
    if !examined.closed {
        examined = cleaned.weld(vertices, |open| weld::exact_targets(positions, open));
    }
    if let Weld::Within(distance) = how
        && !examined.closed
    {
        examined = cleaned.weld(vertices, |open| weld::near_targets(positions, open, distance));
    }
    // Opposite copies show in edges with more than two triangles or in a vertex that only they have. (A pair alone
    // on three vertices that all belong to other triangles too, by no edge, shows in neither; it does no harm.)
    if !examined.edge_manifold || examined.two_triangle_vertex {
        cleaned.drop_opposite(vertices);
        if !cleaned.opposite.is_empty() {
            examined = cleaned.examine(vertices);
        }
    }
    cleaned.closed = examined.closed;
    cleaned.edge_manifold = examined.edge_manifold;
    cleaned
}

impl Cleaned {
    fn examine(&self, vertices: usize) -> chain::Chain {
        chain::examine(&self.triangles, vertices).expect("triangles out of range were left out")
    }

    /// Replaces the vertices on open edges by their targets.
    fn weld(&mut self, vertices: usize, targets: impl FnOnce(&[u32]) -> Vec<u32>) -> chain::Chain {
        let open = chain::open_vertices(&self.triangles, vertices);
        let targets = targets(&open);
        self.welded += open.iter().zip(&targets).filter(|(vertex, target)| vertex != target).count();
        let map = weld::vertex_map(vertices, &open, &targets);
        for corner in self.triangles.iter_mut().flatten() {
            *corner = map[*corner as usize];
        }
        self.drop_repeated_corners();
        self.examine(vertices)
    }

    fn drop_repeated_corners(&mut self) {
        let before = self.triangles.len();
        self.retain(|_, [a, b, c]| a != b && b != c && c != a);
        self.repeated_corners += before - self.triangles.len();
    }

    fn drop_opposite(&mut self, vertices: usize) {
        let pairs = duplicates::find(&self.triangles, vertices).opposite;
        let mut dropped = vec![false; self.triangles.len()];
        for &triangle in pairs.iter().flatten() {
            dropped[triangle as usize] = true;
        }
        self.opposite =
            pairs.iter().map(|pair| pair.map(|triangle| self.source[triangle as usize])).collect();
        self.retain(|index, _| !dropped[index]);
    }

    fn retain(&mut self, keep: impl Fn(usize, [u32; 3]) -> bool) {
        let mut kept = 0;
        for index in 0..self.triangles.len() {
            if keep(index, self.triangles[index]) {
                self.triangles[kept] = self.triangles[index];
                self.source[kept] = self.source[index];
                kept += 1;
            }
        }
        self.triangles.truncate(kept);
        self.source.truncate(kept);
    }
}

/// Leaves out the vertices no triangle uses and renumbers the rest, in order.
pub(crate) fn compact(positions: &[[f64; 3]], triangles: &mut [[u32; 3]]) -> Vec<[f64; 3]> {
    const UNUSED: u32 = u32::MAX;
    let mut numbers = vec![UNUSED; positions.len()];
    for &corner in triangles.iter().flatten() {
        numbers[corner as usize] = 0;
    }
    let mut kept = Vec::new();
    for (number, position) in numbers.iter_mut().zip(positions) {
        if *number != UNUSED {
            *number = kept.len() as u32;
            kept.push(*position);
        }
    }
    for corner in triangles.iter_mut().flatten() {
        *corner = numbers[*corner as usize];
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    #[test]
    fn soup_is_welded() {
        let positions: Vec<_> =
            TETRAHEDRON.iter().flatten().map(|&vertex| CORNERS[vertex as usize]).collect();
        let triangles: Vec<_> =
            (0..4).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner)).collect();
        let mut cleaned = clean(&positions, &triangles, Weld::Exact);
        assert!(cleaned.closed && cleaned.edge_manifold);
        assert_eq!(cleaned.welded, 8);
        let kept = compact(&positions, &mut cleaned.triangles);
        assert_eq!(kept.len(), 4);
        let places = |triangle: [u32; 3]| triangle.map(|corner| kept[corner as usize]);
        assert_eq!(places(cleaned.triangles[3]), TETRAHEDRON[3].map(|corner| CORNERS[corner as usize]));
    }

    #[test]
    fn what_counts_for_nothing_is_dropped() {
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.insert(0, [0, 1, 1]);
        // A fin on an edge, from both sides, with a vertex of its own.
        triangles.insert(1, [0, 1, 4]);
        triangles.push([1, 0, 4]);
        let mut positions = CORNERS.to_vec();
        positions.push([0.5, -1.0, 0.0]);
        let cleaned = clean(&positions, &triangles, Weld::Exact);
        assert!(cleaned.closed && cleaned.edge_manifold);
        assert_eq!(cleaned.triangles, TETRAHEDRON);
        assert_eq!(cleaned.source, [2, 3, 4, 5]);
        assert_eq!(cleaned.opposite, [[1, 6]]);
        assert_eq!((cleaned.repeated_corners, cleaned.welded), (1, 0));
    }

    #[test]
    fn a_wall_between_bodies_is_dropped() {
        // Two tetrahedra on one face, which both have: every vertex of it has other triangles too.
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.extend([[0, 1, 2], [4, 1, 0], [4, 2, 1], [4, 0, 2]]);
        let positions = [&CORNERS[..], &[[0.2, 0.2, -1.0]]].concat();
        let cleaned = clean(&positions, &triangles, Weld::Exact);
        assert!(cleaned.closed && cleaned.edge_manifold);
        assert_eq!(cleaned.opposite, [[0, 4]]);
        assert_eq!(cleaned.triangles.len(), 6);
    }

    #[test]
    fn garbage_is_left_out() {
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.extend([[0, 1, 9], [4, 0, 1]]);
        let mut positions = CORNERS.to_vec();
        positions.push([f64::NAN, 0.0, 0.0]);
        let cleaned = clean(&positions, &triangles, Weld::Exact);
        assert!(cleaned.closed);
        assert_eq!(cleaned.source, [0, 1, 2, 3]);
    }

    #[test]
    fn bodies_that_touch_stay_apart_where_closed_by_themselves() {
        // The second body shares a place with the first, but is a soup; the first has its own indices.
        let mut positions = CORNERS.to_vec();
        let mut triangles = TETRAHEDRON.to_vec();
        for triangle in TETRAHEDRON {
            let first = positions.len() as u32;
            positions.extend(triangle.map(|corner| CORNERS[corner as usize].map(|x| -x)));
            triangles.push([first, first + 2, first + 1]);
        }
        let cleaned = clean(&positions, &triangles, Weld::Exact);
        assert!(cleaned.closed && cleaned.edge_manifold);
        assert_eq!(cleaned.triangles[..4], TETRAHEDRON);
        assert_eq!(cleaned.welded, 8);
    }
}

//! Patches: the pieces a surface falls into when it is cut along every edge that has not exactly two triangles.
//! Inside a patch the orientation of one triangle settles that of all others.

use super::buckets::Buckets;
use super::edges::EdgeTable;
use super::weighted_union_find::WeightedUnionFind;

/// The patches of a set of triangles, numbered by their first triangles.
pub(super) struct Patches {
    /// The patch each triangle is in.
    pub(super) of_triangle: Vec<u32>,
    /// The triangles of each patch.
    pub(super) triangles: Buckets<u32>,
    /// The triangles to reverse so that each patch is oriented alike throughout: never more than half of a patch.
    pub(super) reverse: Vec<bool>,
    /// Whether each patch, so reversed, is closed by itself. Never for one that cannot be oriented (Moebius).
    pub(super) closed: Vec<bool>,
}

impl Patches {
    /// Of the triangles the table was made of. O(n).
    pub(super) fn new(table: &EdgeTable<'_>, count: usize) -> Self {
        // Even differences of values: oriented alike; odd ones: against each other.
        let mut sets = WeightedUnionFind::new(count);
        let mut contradictions = Vec::new();
        for edge in table.iter().filter(|edge| edge.valence() == 2) {
            let mut both = edge.triangles();
            let (Some(a), Some(b)) = (both.next(), both.next()) else { continue };
            if sets.join(a, b, i32::from(edge.net() != 0)) % 2 != 0 {
                contradictions.push(a);
            }
        }
        let mut of_triangle = vec![0u32; count];
        let mut reverse = vec![false; count];
        let mut patches = 0;
        for triangle in 0..count {
            let (root, difference) = sets.root(triangle as u32);
            reverse[triangle] = difference % 2 != 0;
            of_triangle[triangle] = if root as usize == triangle {
                patches += 1;
                patches - 1
            } else {
                of_triangle[root as usize]
            };
        }
        let labelled = of_triangle.iter().zip(0..).map(|(&patch, triangle)| (patch, triangle));
        let triangles = Buckets::new(patches as usize, labelled);
        for patch in 0..triangles.len() {
            let members = triangles.get(patch);
            let reversed = members.iter().filter(|&&triangle| reverse[triangle as usize]).count();
            if 2 * reversed > members.len() {
                members.iter().for_each(|&triangle| reverse[triangle as usize] ^= true);
            }
        }
        let mut closed = vec![true; triangles.len()];
        for triangle in contradictions {
            closed[of_triangle[triangle as usize] as usize] = false;
        }
        let mut shares = Vec::new();
        for edge in table.iter().filter(|edge| edge.valence() != 2) {
            let direction =
                |triangle: u32| if edge.is_upward(triangle) ^ reverse[triangle as usize] { 1 } else { -1 };
            shares.clear();
            shares.extend(
                edge.triangles().map(|triangle| (of_triangle[triangle as usize], direction(triangle))),
            );
            shares.sort_unstable();
            for share in shares.chunk_by(|a, b| a.0 == b.0) {
                closed[share[0].0 as usize] &= share.iter().map(|entry| entry.1).sum::<i32>() == 0;
            }
        }
        Self { of_triangle, triangles, reverse, closed }
    }

    /// Of triangles whose every edge has exactly two in opposite directions, given the component each triangle is in. O(n).
    pub(super) fn of_components((count, of_triangle): (usize, Vec<u32>)) -> Self {
        let labelled = of_triangle.iter().zip(0..).map(|(&patch, triangle)| (patch, triangle));
        let triangles = Buckets::new(count, labelled);
        let reverse = vec![false; of_triangle.len()];
        Self { of_triangle, triangles, reverse, closed: vec![true; count] }
    }

    /// Whether any triangle of `patch` is to be reversed.
    pub(super) fn is_mixed(&self, patch: usize) -> bool {
        self.triangles.get(patch).iter().any(|&triangle| self.reverse[triangle as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn patches(triangles: &[[u32; 3]], vertices: usize) -> Patches {
        Patches::new(&EdgeTable::new(triangles, vertices), triangles.len())
    }

    #[test]
    fn the_minority_is_reversed() {
        for odd in 0..4 {
            let mut triangles = TETRAHEDRON;
            triangles[odd].swap(0, 1);
            let patches = patches(&triangles, 4);
            assert_eq!(patches.reverse, [0, 1, 2, 3].map(|triangle| triangle == odd));
            assert_eq!(patches.closed, [true]);
            assert!(patches.is_mixed(0));
        }
    }

    #[test]
    fn bodies_on_one_edge_are_patches() {
        let second = TETRAHEDRON.map(|triangle| triangle.map(|corner| [0, 1, 4, 5][corner as usize]));
        let triangles: Vec<_> = TETRAHEDRON.into_iter().chain(second).collect();
        let patches = patches(&triangles, 6);
        assert_eq!(patches.of_triangle, [0, 0, 0, 0, 1, 1, 1, 1]);
        assert_eq!(patches.closed, [true, true]);
    }

    #[test]
    fn a_hole_opens_its_patch_only() {
        let second = TETRAHEDRON.map(|triangle| triangle.map(|corner| corner + 4));
        let triangles: Vec<_> = TETRAHEDRON[1..].iter().copied().chain(second).collect();
        let patches = patches(&triangles, 8);
        assert_eq!(patches.closed, [false, true]);
        assert!(!patches.is_mixed(0) && !patches.is_mixed(1));
    }

    #[test]
    fn a_moebius_strip_is_never_closed() {
        let triangles: Vec<_> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
        let patches = patches(&triangles, 5);
        assert_eq!(patches.triangles.len(), 1);
        assert_eq!(patches.closed, [false]);
    }
}

//! Triangles on the same three vertices.

use super::buckets::Buckets;
use super::chain::sorted;

/// Which triangles repeat others.
#[derive(Debug, Default)]
pub(super) struct Duplicates {
    /// Pairs on the same vertices with opposite orientation: nothing as a chain. Each triangle is in one pair at
    /// most; the later copies of an orientation are paired first.
    pub(super) opposite: Vec<[u32; 2]>,
    /// Of what is left: an earlier triangle and a further copy of it with the same orientation.
    pub(super) same: Vec<[u32; 2]>,
}

/// The pairs of triangles on the same three vertices with opposite orientation; each triangle is in one at most. O(n).
pub(crate) fn opposite_pairs(triangles: &[[u32; 3]], vertices: usize) -> Vec<[u32; 2]> {
    find(triangles, vertices).opposite
}

/// Finds the repeated triangles. O(n), with a short sort per vertex.
pub(super) fn find(triangles: &[[u32; 3]], vertices: usize) -> Duplicates {
    let by_lowest = triangles.iter().enumerate().map(|(index, &triangle)| {
        let ([low, mid, high], odd) = sorted(triangle);
        (low, (u64::from(mid) << 32 | u64::from(high), odd, index as u32))
    });
    let mut buckets = Buckets::new(vertices, by_lowest);
    let mut found = Duplicates::default();
    for vertex in 0..vertices {
        let list = buckets.get_mut(vertex);
        if list.len() < 2 {
            continue;
        }
        list.sort_unstable();
        for copies in list.chunk_by(|a, b| a.0 == b.0).filter(|copies| copies.len() > 1) {
            let (forward, backward) = copies.split_at(copies.partition_point(|copy| !copy.1));
            let paired = forward.len().min(backward.len());
            let (forward, forward_paired) = forward.split_at(forward.len() - paired);
            let (backward, backward_paired) = backward.split_at(backward.len() - paired);
            let pairs = forward_paired.iter().zip(backward_paired);
            found.opposite.extend(pairs.map(|(a, b)| [a.2.min(b.2), a.2.max(b.2)]));
            for left in [forward, backward] {
                found.same.extend(left.iter().skip(1).map(|copy| [left[0].2, copy.2]));
            }
        }
    }
    found.opposite.sort_unstable();
    found.same.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_told_by_orientation() {
        let triangles = [[0, 1, 2], [3, 4, 5], [1, 2, 0], [0, 2, 1], [5, 4, 3], [2, 0, 1], [0, 1, 3]];
        let found = find(&triangles, 6);
        assert_eq!(found.opposite, [[1, 4], [3, 5]]);
        assert_eq!(found.same, [[0, 2]]);
    }
}

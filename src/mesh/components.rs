//! The pieces of a surface that are connected by its vertices.

use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

use crate::parallel::map_chunks;

/// Triangles a piece of work.
const CHUNK: usize = 1 << 14;

/// Disjoint sets of vertices, which any number of threads may join at once. What the sets are in the end does not depend on the
/// order of the joins.
///
/// Nothing but the numbers themselves goes from thread to thread, so their order in time is of no matter (`Relaxed`).
pub(super) struct Components {
    /// For each vertex one of its set that is lower, or itself. Parents only ever go down, so there is an end to every way up.
    parents: Vec<AtomicU32>,
    /// Joins of sets that were two.
    joins: AtomicUsize,
}

impl Components {
    /// Of triangles whose corners are below `vertices`. O(n).
    pub(super) fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let sets =
            Self { parents: (0..vertices as u32).map(AtomicU32::new).collect(), joins: AtomicUsize::new(0) };
        map_chunks(triangles, CHUNK, |chunk| {
            let mut joins = 0;
            for &[a, b, c] in chunk {
                let [p, q, r] = [a, b, c].map(|vertex| sets.parent(vertex));
                // Nearly always: what is behind is in one set already.
                if p != q || q != r {
                    joins += usize::from(sets.join(a, b)) + usize::from(sets.join(a, c));
                }
            }
            sets.joins.fetch_add(joins, Ordering::Relaxed);
        });
        sets
    }

    /// How many sets there are. A vertex of no triangle is a set of its own.
    pub(super) fn count(&self) -> usize {
        self.parents.len() - self.joins.load(Ordering::Relaxed)
    }

    /// For every triangle the set it is in, counted from 0 in the order of their first triangles, and how many have triangles.
    pub(super) fn labels(&self, triangles: &[[u32; 3]]) -> (usize, Vec<u32>) {
        const NONE: u32 = u32::MAX;
        let mut numbers = vec![NONE; self.parents.len()];
        let mut count = 0;
        let label = |triangle: &[u32; 3]| {
            let number = &mut numbers[self.root(triangle[0]) as usize];
            if *number == NONE {
                *number = count;
                count += 1;
            }
            *number
        };
        let labels = triangles.iter().map(label).collect();
        (count as usize, labels)
    }

    #[inline]
    fn parent(&self, vertex: u32) -> u32 {
        self.parents[vertex as usize].load(Ordering::Relaxed)
    }

    /// The lowest of a set, or what was the lowest a moment ago.
    #[inline]
    fn root(&self, mut vertex: u32) -> u32 {
        loop {
            let parent = self.parent(vertex);
            let above = self.parent(parent);
            if above == parent {
                return parent;
            }
            // Any vertex of the set that is lower will do, so it does not matter who writes last.
            self.parents[vertex as usize].store(above, Ordering::Relaxed);
            vertex = above;
        }
    }

    /// Makes one set of two; whether they were two.
    #[inline]
    fn join(&self, a: u32, b: u32) -> bool {
        loop {
            let (a, b) = (self.root(a), self.root(b));
            if a == b {
                return false;
            }
            let (low, high) = (a.min(b), a.max(b));
            let place = &self.parents[high as usize];
            // Only what is the lowest of its set still is given a parent.
            if place.compare_exchange(high, low, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
                return true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::super::UnionFind;
    use super::*;

    #[test]
    fn sets_are_those_of_one_thread() {
        let mut random = ChaCha8Rng::seed_from_u64(17);
        for (vertices, count) in [(10u32, 4), (1_000, 300), (100_000, 60_000), (60_000, 200_000)] {
            let triangles: Vec<[u32; 3]> =
                (0..count).map(|_| std::array::from_fn(|_| random.random_range(0..vertices))).collect();
            let mut expected = UnionFind::new(vertices as usize);
            for &[a, b, c] in &triangles {
                expected.join(a, b);
                expected.join(a, c);
            }
            let sets = Components::new(&triangles, vertices as usize);
            let (with_triangles, labels) = sets.labels(&triangles);
            let roots: Vec<u32> = (0..vertices).map(|vertex| expected.root(vertex)).collect();
            assert_eq!(sets.count(), (0..vertices).zip(&roots).filter(|&(v, &root)| v == root).count());
            assert!((0..vertices).all(|vertex| sets.root(vertex) == roots[vertex as usize]));
            let mut numbers = HashMap::new();
            for (triangle, &label) in triangles.iter().zip(&labels) {
                let next = numbers.len() as u32;
                assert_eq!(*numbers.entry(roots[triangle[0] as usize]).or_insert(next), label);
            }
            assert_eq!(with_triangles, numbers.len());
        }
    }
}

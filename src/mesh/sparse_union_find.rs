//! Disjoint sets of a few items among very many.

use std::hash::Hash;

use rustc_hash::FxHashMap;

/// Sets of items of which nearly all are alone, and take no memory: [`UnionFind`](super::UnionFind) would hold four bytes
/// for each vertex of the operands where a few dozen of millions are joined.
///
/// The lowest item of a set stands for it, so nothing depends on the order of the joins.
#[derive(Debug)]
pub(crate) struct SparseUnionFind<T> {
    /// For every item that is not the lowest of its set, a lower one of the same set.
    parents: FxHashMap<T, T>,
}

impl<T> Default for SparseUnionFind<T> {
    fn default() -> Self {
        Self { parents: FxHashMap::default() }
    }
}

impl<T: Copy + Ord + Hash> SparseUnionFind<T> {
    /// The lowest item of the set `item` is in.
    pub(crate) fn root(&mut self, mut item: T) -> T {
        while let Some(&parent) = self.parents.get(&item) {
            let Some(&grandparent) = self.parents.get(&parent) else { return parent };
            // Path halving.
            self.parents.insert(item, grandparent);
            item = grandparent;
        }
        item
    }

    /// Makes one set of two.
    pub(crate) fn join(&mut self, a: T, b: T) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parents.insert(a.max(b), a.min(b));
        }
    }

    /// For every item that is not the lowest of its set, the lowest; in no particular order.
    pub(crate) fn into_roots(mut self) -> FxHashMap<T, T> {
        let items: Vec<T> = self.parents.keys().copied().collect();
        for item in items {
            let root = self.root(item);
            self.parents.insert(item, root);
        }
        self.parents
    }

    /// The sets of two items or more, by their lowest items; each ascending.
    pub(crate) fn into_sets(self) -> Vec<Vec<T>> {
        let mut members: Vec<(T, T)> =
            self.into_roots().into_iter().flat_map(|(item, root)| [(root, item), (root, root)]).collect();
        members.sort_unstable();
        members.dedup();
        let sets = members.chunk_by(|a, b| a.0 == b.0);
        sets.map(|set| set.iter().map(|&(_, item)| item).collect()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_those_of_joined_items() {
        let joined = || {
            let mut sets = SparseUnionFind::default();
            [(40, 10), (50, 40), (3, 7), (7, 3), (20, 50), (9, 9)].iter().for_each(|&(a, b)| sets.join(a, b));
            sets
        };
        let mut sets = joined();
        assert!(!sets.is_empty() && SparseUnionFind::<u32>::default().is_empty());
        assert_eq!([50, 20, 7, 9, 1_000].map(|item| sets.root(item)), [10, 10, 3, 9, 1_000]);
        assert_eq!(joined().into_sets(), [vec![3, 7], vec![10, 20, 40, 50]]);
        let mut roots: Vec<(u32, u32)> = joined().into_roots().into_iter().collect();
        roots.sort_unstable();
        assert_eq!(roots, [(7, 3), (20, 10), (40, 10), (50, 10)]);
    }

    #[test]
    fn a_long_chain_is_short_afterwards() {
        let mut sets = SparseUnionFind::default();
        (0..10_000u32).rev().for_each(|item| sets.join(item, item + 1));
        assert!((0..=10_000).all(|item| sets.root(item) == 0));
    }
}

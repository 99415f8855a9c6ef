//! Branches of a tree of boxes: the items below one pack.

use std::ops::Range;

use super::box_tree::BoxTree;
use super::pack::LANES;

/// A pack of a tree, with everything below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Branch {
    level: usize,
    place: usize,
}

impl Branch {
    /// The branches that make it up; none of the items' own packs.
    pub(crate) fn parts(self, tree: &BoxTree) -> impl Iterator<Item = Self> {
        let parts = self.level.checked_sub(1).map(|level| {
            let end = tree.level(level).len();
            let places = LANES * self.place..(LANES * (self.place + 1)).min(end);
            places.map(move |place| Self { level, place })
        });
        parts.into_iter().flatten()
    }

    /// Where its items stand in the list of all.
    pub(crate) fn range(self, tree: &BoxTree) -> Range<usize> {
        let each = LANES.pow(self.level as u32 + 1);
        self.place * each..((self.place + 1) * each).min(tree.items().len())
    }
}

/// Some of the branches of a tree.
#[derive(Debug)]
pub(crate) struct Branches(Vec<Vec<bool>>);

impl Branches {
    /// None of them.
    pub(crate) fn none(tree: &BoxTree) -> Self {
        let levels = if tree.is_empty() { 0 } else { tree.top() + 1 };
        Self((0..levels).map(|level| vec![false; tree.level(level).len()]).collect())
    }

    /// Adds one.
    pub(crate) fn insert(&mut self, branch: Branch) {
        self.0[branch.level][branch.place] = true;
    }

    /// Whether it is among them by itself.
    #[inline(always)]
    pub(super) fn contains(&self, level: usize, place: u32) -> bool {
        self.0[level][place as usize]
    }
}

impl BoxTree {
    /// The largest branches, of `least` items or more, all of whose items have a property in common: each with these. Properties of
    /// an item are bits. In the order of the items; no two have an item in common. O(n).
    pub(crate) fn branches_alike(&self, least: usize, properties: impl Fn(u32) -> u8) -> Vec<(Branch, u8)> {
        let mut found = Vec::new();
        if self.is_empty() {
            return found;
        }
        // 1. What all items below a pack have in common.
        let all = |list: &[u8]| list.iter().fold(u8::MAX, |all, of| all & of);
        let of_items = |items: &[u32]| items.iter().fold(u8::MAX, |all, &item| all & properties(item));
        let mut levels: Vec<Vec<u8>> = vec![self.items().chunks(LANES).map(of_items).collect()];
        for level in 1..=self.top() {
            levels.push(levels[level - 1].chunks(LANES).map(all).collect());
        }
        // 2. Downwards from the top, in order.
        let mut stack = vec![Branch { level: self.top(), place: 0 }];
        while let Some(branch) = stack.pop() {
            let common = levels[branch.level][branch.place];
            if branch.range(self).len() < least {
                continue;
            }
            if common != 0 {
                found.push((branch, common));
                continue;
            }
            let first = stack.len();
            stack.extend(branch.parts(self));
            stack[first..].reverse();
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;
    use obvhs::aabb::Aabb;

    use super::*;

    #[test]
    fn branches_alike_are_the_largest() {
        let boxes: Vec<Aabb> = (0..1000)
            .map(|i| Aabb { min: Vec3A::splat(i as f32), max: Vec3A::splat(i as f32 + 0.5) })
            .collect();
        let tree = BoxTree::of_boxes(&boxes);
        let is_low = |item: u32| if item < 600 { 1 } else { 2 };
        let found = tree.branches_alike(4, is_low);
        let mut covered = 0;
        for (branch, common) in &found {
            let range = branch.range(&tree);
            assert!(range.start >= covered && range.len() >= 4);
            covered = range.end;
            assert!(tree.items()[range].iter().all(|&item| is_low(item) == *common));
        }
        let items: usize = found.iter().map(|(branch, _)| branch.range(&tree).len()).sum();
        assert_eq!(items, 1000);
        assert!(found.len() < 20, "{}", found.len());
        assert_eq!(tree.branches_alike(4, |_| 0), []);
        assert_eq!(tree.branches_alike(1001, |_| 1), []);
        assert_eq!(tree.branches_alike(1000, |_| 1).len(), 1);
        assert_eq!(BoxTree::empty().branches_alike(0, |_| 1), []);
    }
}

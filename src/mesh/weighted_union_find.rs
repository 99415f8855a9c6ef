//! Disjoint sets of indices with known differences of values inside a set.

/// Sets of the indices below a limit, each index with a value of which only differences inside its set are known; at first
/// each index is alone. Joining and asking cost O(log n) on the average of many (path halving).
pub(crate) struct WeightedUnionFind {
    /// 0 for the lowest of a set, else one more than another of the set: memory that starts as zeros costs nothing until it
    /// is used.
    parents: Vec<u32>,
    /// The value of each index less that of its parent.
    offsets: Vec<i32>,
}

impl WeightedUnionFind {
    pub(crate) fn new(size: usize) -> Self {
        Self { parents: vec![0; size], offsets: vec![0; size] }
    }

    /// The lowest index of the set `index` is in, and the value of `index` less that of the lowest.
    #[inline]
    pub(crate) fn root(&mut self, mut index: u32) -> (u32, i32) {
        let mut sum = 0;
        loop {
            let parent = self.parents[index as usize];
            if parent == 0 {
                return (index, sum);
            }
            let grandparent = self.parents[parent as usize - 1];
            // Path halving.
            if grandparent != 0 {
                self.offsets[index as usize] += self.offsets[parent as usize - 1];
                self.parents[index as usize] = grandparent;
            }
            sum += self.offsets[index as usize];
            index = self.parents[index as usize] - 1;
        }
    }

    /// Records that the value of `b` is that of `a` plus `difference`. Returns by how much that contradicts what is known:
    /// 0 unless both were in one set already.
    #[inline]
    pub(crate) fn join(&mut self, a: u32, b: u32, difference: i32) -> i32 {
        let ((root_a, value_a), (root_b, value_b)) = (self.root(a), self.root(b));
        // value(root_b) - value(root_a), were it not for what is known.
        let between = value_a + difference - value_b;
        if root_a == root_b {
            return between;
        }
        let (low, high, offset) =
            if root_a < root_b { (root_a, root_b, between) } else { (root_b, root_a, -between) };
        self.parents[high as usize] = low + 1;
        self.offsets[high as usize] = offset;
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn differences_follow_from_those_recorded() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        for _ in 0..50 {
            let values: Vec<i32> = (0..200).map(|_| rng.random_range(-9..10)).collect();
            let mut sets = WeightedUnionFind::new(values.len());
            for _ in 0..150 {
                let [a, b] = [0; 2].map(|_| rng.random_range(0..values.len()));
                let difference = values[b] - values[a];
                assert_eq!(sets.join(a as u32, b as u32, difference), 0);
                assert_eq!(sets.join(b as u32, a as u32, 3 - difference), 3);
            }
            for (index, value) in values.iter().enumerate() {
                let (root, difference) = sets.root(index as u32);
                assert_eq!(value - values[root as usize], difference);
                assert!(root as usize <= index);
            }
        }
    }
}

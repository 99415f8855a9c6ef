//! Disjoint sets of indices.

/// Sets of the indices below a limit; at first each index is alone.
pub(crate) struct UnionFind {
    parents: Vec<u32>,
}

impl UnionFind {
    pub(crate) fn new(size: usize) -> Self {
        Self { parents: (0..size as u32).collect() }
    }

    /// The lowest index of the set `index` is in.
    pub(crate) fn root(&mut self, mut index: u32) -> u32 {
        while self.parents[index as usize] != index {
            let grandparent = self.parents[self.parents[index as usize] as usize];
            self.parents[index as usize] = grandparent;
            index = grandparent;
        }
        index
    }

    /// Makes one set of two.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// The sets numbered in the order of their lowest indices: how many, and the number of each index.
    pub(crate) fn labels(&mut self) -> (usize, Vec<u32>) {
        let mut count = 0;
        let mut labels = vec![0; self.parents.len()];
        for index in 0..self.parents.len() {
            let root = self.root(index as u32) as usize;
            labels[index] = if root == index {
                count += 1;
                count - 1
            } else {
                labels[root]
            };
        }
        (count as usize, labels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_numbered_by_their_lowest_member() {
        let mut sets = UnionFind::new(6);
        sets.join(4, 1);
        sets.join(5, 4);
        sets.join(3, 0);
        assert_eq!(sets.root(5), 1);
        assert_eq!(sets.labels(), (3, vec![0, 1, 2, 0, 1, 1]));
    }
}

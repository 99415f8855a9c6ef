//! Lists of items per key, packed one after the other by a counting sort.

/// For every key below a limit the list of its items, in the order they were given.
pub(super) struct Buckets<T> {
    /// Where the list of each key begins; one more for the end.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Buckets<T> {
    /// Files `entries` (key, item) under keys below `keys`. The entries are asked for twice; there must be fewer
    /// than 2^32.
    pub(super) fn new(keys: usize, entries: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut starts = vec![0u32; keys + 1];
        for (key, _) in entries.clone() {
            starts[key as usize + 1] += 1;
        }
        for key in 0..keys {
            starts[key + 1] += starts[key];
        }
        let mut items = vec![T::default(); starts[keys] as usize];
        // Each start runs to the end of its list, which is where the next began; shifted back afterwards.
        for (key, item) in entries {
            let next = &mut starts[key as usize];
            items[*next as usize] = item;
            *next += 1;
        }
        starts.copy_within(0..keys, 1);
        starts[0] = 0;
        Self { starts, items }
    }

    /// The items of `key`.
    pub(super) fn get(&self, key: usize) -> &[T] {
        &self.items[self.range(key)]
    }

    /// The items of `key`, to be changed or sorted.
    pub(super) fn get_mut(&mut self, key: usize) -> &mut [T] {
        let range = self.range(key);
        &mut self.items[range]
    }

    /// The number of keys.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn range(&self, key: usize) -> std::ops::Range<usize> {
        self.starts[key] as usize..self.starts[key + 1] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_keep_their_order() {
        let entries = [(2, 'a'), (0, 'b'), (2, 'c'), (3, 'd')];
        let buckets = Buckets::new(5, entries.into_iter());
        let lists: Vec<_> = (0..buckets.len()).map(|key| buckets.get(key).to_vec()).collect();
        assert_eq!(lists, [vec!['b'], vec![], vec!['a', 'c'], vec!['d'], vec![]]);
        assert_eq!(Buckets::<u32>::new(0, std::iter::empty()).len(), 0);
    }
}

//! Lists of items per key, packed one after the other by a counting sort.

/// For every key below a limit the list of its items, in the order they were given.
#[derive(Debug)]
pub(crate) struct Buckets<T> {
    /// Where the list of each key begins; one more for the end.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Buckets<T> {
    /// Files `entries` (key, item) under keys below `keys`. The entries are asked for twice; there must be fewer
    /// than 2^32.
    pub(crate) fn new(keys: usize, entries: impl Iterator<Item = (u32, T)> + Clone) -> Self {
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
    pub(crate) fn get(&self, key: usize) -> &[T] {
        &self.items[self.range(key)]
    }

    /// The items of `key`, to be changed or sorted.
    pub(crate) fn get_mut(&mut self, key: usize) -> &mut [T] {
        let range = self.range(key);
        &mut self.items[range]
    }

    /// The number of items.
    pub(crate) fn total(&self) -> usize {
        self.items.len()
    }

    /// The number of keys.
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The items of every key, in the order of the keys.
    pub(crate) fn each(&self) -> impl Iterator<Item = &[T]> {
        self.starts.windows(2).map(|range| &self.items[range[0] as usize..range[1] as usize])
    }

    /// As [`each`](Self::each), to be changed or sorted.
    pub(crate) fn each_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        let mut rest = self.items.as_mut_slice();
        self.starts.windows(2).map(move |range| {
            let (list, after) = std::mem::take(&mut rest).split_at_mut((range[1] - range[0]) as usize);
            rest = after;
            list
        })
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

    #[test]
    fn lists_come_in_the_order_of_their_keys() {
        let entries = [(2, 'a'), (0, 'b'), (2, 'c'), (4, 'd'), (0, 'e')];
        let mut buckets = Buckets::new(5, entries.into_iter());
        let all: Vec<String> = buckets.each().map(|list| list.iter().collect()).collect();
        assert_eq!(all, ["be", "", "ac", "", "d"]);
        buckets.each_mut().for_each(<[char]>::reverse);
        assert_eq!(buckets.get(2), ['c', 'a']);
    }
}

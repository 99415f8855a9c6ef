//! Things in buckets: a sort by a number without gaps (such as a point's) in linear time.

/// Things by bucket, in each in the order in which they came.
pub(crate) struct Buckets<T> {
    /// Where each bucket starts; a last entry marks the end.
    starts: Vec<u32>,
    things: Vec<T>,
}

impl<T: Copy + Default> Buckets<T> {
    /// Puts things into `count` buckets, each into the one named with it. The things are gone through twice.
    pub(crate) fn new(count: usize, things: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut starts = vec![0u32; count + 1];
        for (bucket, _) in things.clone() {
            starts[bucket as usize] += 1;
        }
        // Where each starts; filling moves that to where the next one does.
        let mut sum = 0;
        for start in &mut starts {
            let size = *start;
            *start = sum;
            sum += size;
        }
        let mut sorted = vec![T::default(); sum as usize];
        for (bucket, thing) in things {
            let place = &mut starts[bucket as usize];
            sorted[*place as usize] = thing;
            *place += 1;
        }
        starts.rotate_right(1);
        starts[0] = 0;
        Self { starts, things: sorted }
    }

    /// The things in a bucket.
    #[inline]
    pub(crate) fn get(&self, bucket: u32) -> &[T] {
        &self.things[self.range(bucket)]
    }

    /// As [`get`](Self::get).
    #[inline]
    pub(crate) fn get_mut(&mut self, bucket: u32) -> &mut [T] {
        let range = self.range(bucket);
        &mut self.things[range]
    }

    fn range(&self, bucket: u32) -> std::ops::Range<usize> {
        self.starts[bucket as usize] as usize..self.starts[bucket as usize + 1] as usize
    }

    /// All buckets, in their order.
    pub(crate) fn each(&self) -> impl Iterator<Item = &[T]> {
        self.starts.windows(2).map(|range| &self.things[range[0] as usize..range[1] as usize])
    }

    /// As [`each`](Self::each).
    pub(crate) fn each_mut(&mut self) -> impl Iterator<Item = &mut [T]> {
        let mut rest = self.things.as_mut_slice();
        self.starts.windows(2).map(move |range| {
            let (bucket, after) = std::mem::take(&mut rest).split_at_mut((range[1] - range[0]) as usize);
            rest = after;
            bucket
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_keep_their_order_in_their_bucket() {
        let things = [(2, 'a'), (0, 'b'), (2, 'c'), (4, 'd'), (0, 'e')];
        let mut buckets = Buckets::new(5, things.into_iter());
        let all: Vec<String> = buckets.each_mut().map(|bucket| bucket.iter().collect()).collect();
        assert_eq!(all, ["be", "", "ac", "", "d"]);
        assert_eq!(buckets.get(2), ['a', 'c']);
        buckets.get_mut(4)[0] = 'f';
        assert_eq!(buckets.get(4), ['f']);
    }
}

//! Loops under limits.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::loops::{join, map_by, parts, places};
use crate::control::{Control, Limit};

/// How loops run: on how many threads, and under which limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Runner<'a> {
    pub(crate) control: &'a Control,
    #[cfg(feature = "parallel")]
    parallel: bool,
}

impl<'a> Runner<'a> {
    /// Loops run on the current rayon pool, if there is one and `parallel` allows it.
    pub(crate) fn new(control: &'a Control, parallel: bool) -> Self {
        #[cfg(not(feature = "parallel"))]
        let _ = parallel;
        Self {
            control,
            #[cfg(feature = "parallel")]
            parallel: parallel && rayon::current_num_threads() > 1,
        }
    }

    /// The same limits on the caller's thread alone.
    pub(crate) fn serial(self) -> Self {
        Self::new(self.control, false)
    }

    /// Whether loops may use several threads.
    pub(crate) fn is_parallel(self) -> bool {
        #[cfg(feature = "parallel")]
        return self.parallel;
        #[cfg(not(feature = "parallel"))]
        false
    }

    /// How many threads loops may use.
    pub(crate) fn threads(self) -> usize {
        #[cfg(feature = "parallel")]
        if self.parallel {
            return rayon::current_num_threads();
        }
        1
    }

    /// Cuts `0..count` into pieces of `grain` and returns what `piece` makes of each, in order. The limits are checked
    /// before every piece.
    pub(crate) fn pieces<T: Send>(
        self,
        count: usize,
        grain: usize,
        piece: impl Fn(Range<usize>) -> T + Sync,
    ) -> Result<Vec<T>, Limit> {
        self.each_by(cut(count, grain), &piece)
    }

    /// The same for work that may fail. After every piece the fraction that is done is reported as that of `stage`.
    pub(crate) fn staged_pieces<T: Send, E: From<Limit> + Send>(
        self,
        count: usize,
        grain: usize,
        stage: &str,
        piece: impl Fn(Range<usize>) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        let pieces = cut(count, grain);
        let (total, done) = (pieces.len(), AtomicUsize::new(0));
        let finish = || {
            let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
            self.control.report(stage, finished as f64 / total as f64)
        };
        self.try_each(pieces, &|range| {
            let result = piece(range)?;
            finish()?;
            Ok(result)
        })
    }

    /// What `fill` appends for each piece of `0..count`, in order; about `room` items. The limits are checked before every
    /// piece.
    pub(crate) fn gather<T: Copy + Default + Send + Sync>(
        self,
        count: usize,
        grain: usize,
        room: usize,
        fill: impl Fn(Range<usize>, &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Limit> {
        self.gather_by(count, grain, room, &fill)
    }

    /// [`Self::gather`], compiled once for the type of the items.
    fn gather_by<T: Copy + Default + Send + Sync>(
        self,
        count: usize,
        grain: usize,
        room: usize,
        fill: &(dyn Fn(Range<usize>, &mut Vec<T>) + Sync),
    ) -> Result<Vec<T>, Limit> {
        if self.is_parallel() {
            let pieces = self.pieces(count, grain, |range| {
                let mut piece = Vec::new();
                fill(range, &mut piece);
                piece
            })?;
            return self.concat(pieces);
        }
        let mut all = Vec::with_capacity(room);
        for range in cut(count, grain) {
            self.control.check()?;
            fill(range, &mut all);
        }
        Ok(all)
    }

    /// What `work` makes of every item, in order. The limits are checked before every one.
    pub(crate) fn each<T: Send, R: Send>(
        self,
        items: Vec<T>,
        work: impl Fn(T) -> R + Sync,
    ) -> Result<Vec<R>, Limit> {
        self.each_by(items, &work)
    }

    /// [`Self::each`], compiled once for the types of items and results.
    fn each_by<T: Send, R: Send>(
        self,
        items: Vec<T>,
        work: &(dyn Fn(T) -> R + Sync),
    ) -> Result<Vec<R>, Limit> {
        self.try_each(items, &|item| Ok(work(item)))
    }

    /// The same for work that may fail.
    fn try_each<T: Send, R: Send, E: From<Limit> + Send>(
        self,
        items: Vec<T>,
        work: &(dyn Fn(T) -> Result<R, E> + Sync),
    ) -> Result<Vec<R>, E> {
        map_by(items, self.is_parallel(), &|item| {
            self.control.check()?;
            work(item)
        })
    }

    /// Lets `fill` write all of `items`, given the index of the first and a piece of `grain`. The limits are checked before
    /// every piece.
    pub(crate) fn fill<T: Send>(
        self,
        items: &mut [T],
        grain: usize,
        fill: impl Fn(usize, &mut [T]) + Sync,
    ) -> Result<(), Limit> {
        self.fill_by(items, grain, &fill)
    }

    /// [`Self::fill`], compiled once for the type of the items.
    fn fill_by<T: Send>(
        self,
        items: &mut [T],
        grain: usize,
        fill: &(dyn Fn(usize, &mut [T]) + Sync),
    ) -> Result<(), Limit> {
        let grain = grain.max(1);
        self.each(places(items, grain), |(first, piece)| fill(first, piece)).map(drop)
    }

    /// Lists one after the other.
    pub(crate) fn concat<T: Copy + Default + Send + Sync>(
        self,
        mut lists: Vec<Vec<T>>,
    ) -> Result<Vec<T>, Limit> {
        if lists.len() < 2 {
            return Ok(lists.pop().unwrap_or_default());
        }
        let count = lists.iter().map(Vec::len).sum();
        // Zeros cost nothing until they are written over, side by side.
        let mut all = vec![T::default(); count];
        let lengths: Vec<usize> = lists.iter().map(Vec::len).collect();
        let places = parts(&mut all, lengths).into_iter().zip(lists).collect();
        self.each(places, |(place, list)| place.copy_from_slice(&list))?;
        Ok(all)
    }

    /// Sorts items that differ from each other, so that the order does not depend on the number of threads.
    pub(crate) fn sort<T: Ord + Send>(self, items: &mut [T]) {
        #[cfg(feature = "parallel")]
        if self.parallel && items.len() > 1 << 14 {
            use rayon::prelude::*;
            items.par_sort_unstable();
            return;
        }
        items.sort_unstable();
    }

    /// What two independent computations return, run side by side if allowed.
    pub(crate) fn both<A: Send, B: Send>(
        self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        if self.is_parallel() { join(usize::MAX, first, second) } else { (first(), second()) }
    }
}

/// Ranges of `grain` that cut `0..count`, the last one perhaps shorter.
fn cut(count: usize, grain: usize) -> Vec<Range<usize>> {
    let grain = grain.max(1);
    (0..count).step_by(grain).map(|start| start..(start + grain).min(count)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_ends_the_loop() {
        let control = Control::new();
        let pieces = |fails: bool| {
            Runner::new(&control, true).staged_pieces(100, 7, "test", |range| {
                if fails && range.contains(&50) { Err(Limit::Cancelled) } else { Ok(range) }
            })
        };
        assert!(pieces(true).is_err());
        assert!(pieces(false).is_ok_and(|pieces| pieces.into_iter().flatten().eq(0..100)));
    }
}

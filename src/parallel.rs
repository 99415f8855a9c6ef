//! Loops over ranges, on rayon's threads where that pays and is allowed; the results never depend on it.

use std::ops::Range;

use crate::{Control, Error};

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

    /// Cuts `0..count` into pieces of `grain` and returns what `piece` makes of each, in order. The limits are checked
    /// before every piece.
    pub(crate) fn pieces<T: Send>(
        self,
        count: usize,
        grain: usize,
        piece: impl Fn(Range<usize>) -> T + Sync,
    ) -> Result<Vec<T>, Error> {
        let pieces = count.div_ceil(grain.max(1));
        let run = |i: usize| -> Result<T, Error> {
            self.control.check()?;
            Ok(piece(i * grain..((i + 1) * grain).min(count)))
        };
        #[cfg(feature = "parallel")]
        if self.parallel && pieces > 1 {
            use rayon::prelude::*;
            return (0..pieces).into_par_iter().map(run).collect();
        }
        (0..pieces).map(run).collect()
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
        #[cfg(feature = "parallel")]
        if self.parallel {
            return rayon::join(first, second);
        }
        (first(), second())
    }
}

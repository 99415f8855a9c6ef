//! Loops over independent pieces of work: in parallel where the crate is built so, with the same result either way.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::{Control, Error};

/// `f` of every piece of `0..count`, in order of the pieces. Pieces hold `size` consecutive numbers (the last one
/// perhaps fewer). Asks `control` before each piece, and reports the fraction done as `stage`.
pub(crate) fn pieces<T: Send>(
    count: usize,
    size: usize,
    control: &Control,
    stage: &str,
    f: impl Fn(Range<usize>) -> Result<T, Error> + Sync + Send,
) -> Result<Vec<T>, Error> {
    let done = AtomicUsize::new(0);
    let total = count.div_ceil(size.max(1));
    let piece = |index: usize| {
        control.check()?;
        let result = f(index * size..((index + 1) * size).min(count))?;
        let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
        control.report(stage, finished as f64 / total as f64)?;
        Ok(result)
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..total).into_par_iter().map(piece).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..total).map(piece).collect()
    }
}

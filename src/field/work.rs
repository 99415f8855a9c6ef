//! Loops over independent pieces of work: in parallel where the crate is built so, with the same result either way.

use std::ops::Range;

use crate::parallel::Runner;
use crate::{Control, Error};

/// `f` of every piece of `0..count`, in order of the pieces. Pieces hold `size` consecutive numbers (the last one
/// perhaps fewer). Asks `control` before each piece, and reports the fraction done as `stage`.
pub(crate) fn pieces<T: Send>(
    count: usize,
    size: usize,
    control: &Control,
    stage: &str,
    f: impl Fn(Range<usize>) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    Runner::new(control, true).staged_pieces(count, size, stage, f)
}

//! Reading what is needed soon.

/// Reads values, so that what is near them is in the cache afterwards. Where data lie in no order that follows from their
/// use, the misses of such a loop overlap; between long computations each would be waited for by itself.
#[inline(always)]
pub(crate) fn read_ahead(values: impl Iterator<Item = u32>) {
    std::hint::black_box(values.fold(0, |sum, value| sum ^ value));
}

//! The two shapes of data-parallel work this layer needs. Without the feature `parallel` the same pieces are
//! worked one after the other, so the results are the same bits.

/// Runs both, at once where another thread is free.
#[cfg(feature = "parallel")]
pub(super) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// Runs both.
#[cfg(not(feature = "parallel"))]
pub(super) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    (a(), b())
}

/// `work` on pieces of `items` of fixed length; the results in order.
#[cfg(feature = "parallel")]
pub(super) fn map_chunks<T: Sync, R: Send>(
    items: &[T],
    length: usize,
    work: impl Fn(&[T]) -> R + Send + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    items.par_chunks(length).map(work).collect()
}

/// `work` on pieces of `items` of fixed length; the results in order.
#[cfg(not(feature = "parallel"))]
pub(super) fn map_chunks<T: Sync, R: Send>(
    items: &[T],
    length: usize,
    work: impl Fn(&[T]) -> R + Send + Sync,
) -> Vec<R> {
    items.chunks(length).map(work).collect()
}

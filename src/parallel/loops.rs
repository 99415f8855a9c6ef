//! Loops without limits, and what hands their items out.

use std::convert::Infallible;
use std::ops::Range;
#[cfg(feature = "parallel")]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(feature = "parallel")]
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Units of work (triangles, say) below which waking another thread costs more than it saves.
#[cfg(feature = "parallel")]
const WORTH_A_THREAD: usize = 1 << 13;

/// Runs both, at once where another thread is free and there is enough `work` to do.
pub(crate) fn join<A: Send, B: Send>(
    work: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    if work >= WORTH_A_THREAD {
        let (mut a, mut b) = (Some(a), Some(b));
        let (mut of_a, mut of_b) = (None, None);
        run_both(&mut || of_a = a.take().map(|a| a()), &mut || of_b = b.take().map(|b| b()));
        return (of_a.expect("it has run"), of_b.expect("it has run"));
    }
    let _ = work;
    (a(), b())
}

/// Runs both, at once where another thread is free.
#[cfg(feature = "parallel")]
fn run_both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    rayon::join(a, b);
}

/// Calls `work` with every number below `count`, on all threads of the current pool.
#[cfg(feature = "parallel")]
fn for_each_number(count: usize, work: &(dyn Fn(usize) + Sync)) {
    use rayon::prelude::*;
    (0..count).into_par_iter().for_each(work);
}

/// The results of `work` on every item, in order.
pub(crate) fn map<T: Send, R: Send>(items: Vec<T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    map_all(items, &work)
}

/// [`map`], compiled once for the types of items and results.
fn map_all<T: Send, R: Send>(items: Vec<T>, work: &(dyn Fn(T) -> R + Sync)) -> Vec<R> {
    match map_by(items, true, &|item| Ok::<R, Infallible>(work(item))) {
        Ok(results) => results,
        Err(never) => match never {},
    }
}

/// The results of `work` on every item, in order, or the first failure in the order of those items that were looked at: no
/// further ones are once there is one.
pub(crate) fn try_map<T: Send, R: Send, E: Send>(
    items: Vec<T>,
    work: impl Fn(T) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    map_by(items, true, &work)
}

/// [`try_map`], on other threads only if `parallel`; compiled once for the types of items, results and failures.
pub(super) fn map_by<T: Send, R: Send, E: Send>(
    items: Vec<T>,
    parallel: bool,
    work: &(dyn Fn(T) -> Result<R, E> + Sync),
) -> Result<Vec<R>, E> {
    #[cfg(feature = "parallel")]
    if parallel && items.len() > 1 && rayon::current_num_threads() > 1 {
        return map_on_threads(items, work);
    }
    let _ = parallel;
    let mut results = Vec::with_capacity(items.len());
    for item in items {
        results.push(work(item)?);
    }
    Ok(results)
}

/// [`map_by`] on all threads of the current pool.
#[cfg(feature = "parallel")]
fn map_on_threads<T: Send, R: Send, E: Send>(
    items: Vec<T>,
    work: &(dyn Fn(T) -> Result<R, E> + Sync),
) -> Result<Vec<R>, E> {
    let items = slots(items);
    let results: Vec<Slot<R>> = empty_slots(items.len());
    let has_failed = AtomicBool::new(false);
    // The failure of the least index.
    let failure: Mutex<Option<(usize, E)>> = Mutex::new(None);
    for_each_number(items.len(), &|index| {
        if has_failed.load(Ordering::Relaxed) {
            return;
        }
        // Nobody else asks for it.
        let Some(item) = take(&items[index]) else { return };
        match work(item) {
            Ok(result) => *lock(&results[index]) = Some(result),
            Err(error) => {
                has_failed.store(true, Ordering::Relaxed);
                let mut first = lock(&failure);
                if first.as_ref().is_none_or(|(before, _)| index < *before) {
                    *first = Some((index, error));
                }
            }
        }
    });
    match take(&failure) {
        Some((_, error)) => Err(error),
        None => Ok(contents(results)),
    }
}

/// An item that one thread leaves for another.
#[cfg(feature = "parallel")]
type Slot<T> = Mutex<Option<T>>;

/// What is in the slot; who panicked with it has left it whole.
#[cfg(feature = "parallel")]
fn lock<T>(slot: &Slot<T>) -> MutexGuard<'_, Option<T>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(feature = "parallel")]
fn take<T>(slot: &Slot<T>) -> Option<T> {
    lock(slot).take()
}

#[cfg(feature = "parallel")]
fn slots<T>(items: Vec<T>) -> Vec<Slot<T>> {
    let mut slots = Vec::with_capacity(items.len());
    for item in items {
        slots.push(Mutex::new(Some(item)));
    }
    slots
}

#[cfg(feature = "parallel")]
fn empty_slots<T>(count: usize) -> Vec<Slot<T>> {
    let mut slots = Vec::with_capacity(count);
    slots.resize_with(count, || Mutex::new(None));
    slots
}

#[cfg(feature = "parallel")]
fn contents<T>(slots: Vec<Slot<T>>) -> Vec<T> {
    let mut items = Vec::with_capacity(slots.len());
    for slot in slots {
        if let Some(item) = take(&slot) {
            items.push(item);
        }
    }
    items
}

/// `work` on pieces of `items` of fixed length; the results in order.
pub(crate) fn map_chunks<T: Sync, R: Send>(
    items: &[T],
    length: usize,
    work: impl Fn(&[T]) -> R + Sync,
) -> Vec<R> {
    map(items.chunks(length).collect(), work)
}

/// How many pieces to cut `length` units of work into: one on a single thread or for little work.
pub(crate) fn piece_count(length: usize, smallest: usize) -> usize {
    #[cfg(feature = "parallel")]
    {
        match rayon::current_num_threads() {
            1 => 1,
            threads => (length / smallest.max(1)).clamp(1, threads * 4),
        }
    }
    #[cfg(not(feature = "parallel"))]
    {
        let _ = (length, smallest);
        1
    }
}

/// A list of `count` items that `fill` puts in, given the index of the first item and room for a run of them.
pub(crate) fn build<T: Copy + Default + Send>(
    count: usize,
    smallest: usize,
    fill: impl Fn(usize, &mut [T]) + Sync,
) -> Vec<T> {
    let mut items = vec![T::default(); count];
    let length = count.div_ceil(piece_count(count, smallest)).max(1);
    map(places(&mut items, length), |(first, run)| fill(first, run));
    items
}

/// What `of_range` makes of the ranges that `0..count` is cut into, one after the other. For items that cannot be put into room made before as
/// [`build`] does, or for which that costs a pass over memory.
pub(crate) fn append<T: Send>(
    count: usize,
    smallest: usize,
    of_range: impl Fn(Range<usize>) -> Vec<T> + Sync,
) -> Vec<T> {
    let mut pieces = map(ranges(count, piece_count(count, smallest)), of_range).into_iter();
    let mut all = pieces.next().unwrap_or_default();
    all.reserve_exact(pieces.as_slice().iter().map(Vec::len).sum());
    pieces.for_each(|mut piece| all.append(&mut piece));
    all
}

/// Pieces of `length` items, each with the index of its first.
pub(super) fn places<T>(items: &mut [T], length: usize) -> Vec<(usize, &mut [T])> {
    let mut places = Vec::with_capacity(items.len().div_ceil(length));
    for piece in items.chunks_mut(length) {
        places.push((places.len() * length, piece));
    }
    places
}

/// Whether `test` holds for every item.
pub(crate) fn all<T: Sync>(items: &[T], test: impl Fn(&T) -> bool + Sync) -> bool {
    /// Items that one thread looks at between two looks at whether another has found one that fails.
    const RUN: usize = 1 << 14;
    let holds = |run: &[T]| if run.iter().all(&test) { Ok(()) } else { Err(()) };
    if items.len() < 8 * RUN {
        return holds(items).is_ok();
    }
    try_map(items.chunks(RUN).collect(), holds).is_ok()
}

/// Cuts `items` into parts of given lengths.
pub(crate) fn parts<T>(mut items: &mut [T], lengths: impl IntoIterator<Item = usize>) -> Vec<&mut [T]> {
    let part = |length| items.split_off_mut(..length).expect("no longer than the items together");
    lengths.into_iter().map(part).collect()
}

/// Ranges that cut `0..length` into pieces of nearly equal size.
pub(crate) fn ranges(length: usize, count: usize) -> Vec<Range<usize>> {
    let count = count.max(1);
    // The product of a length and a small count cannot overflow 128 bits.
    let bound = |i: usize| (length as u128 * i as u128 / count as u128) as usize;
    (0..count).map(|i| bound(i)..bound(i + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_cover_everything_once() {
        for (length, count) in [(0, 3), (1, 3), (10, 3), (7, 7), (1000, 8)] {
            let all: Vec<usize> = ranges(length, count).into_iter().flatten().collect();
            assert_eq!(all, (0..length).collect::<Vec<_>>());
        }
    }

    #[test]
    fn lists_are_built_in_order() {
        for count in [0, 1, 10, 100_000] {
            let built = build(count, 1000, |first, run: &mut [u64]| {
                run.iter_mut().enumerate().for_each(|(i, item)| *item = (first + i) as u64);
            });
            assert!(built.iter().copied().eq(0..count as u64));
            assert!(all(&built, |&item| item < count as u64));
            assert!(count == 0 || !all(&built, |&item| item != count as u64 / 2));
        }
    }

    #[test]
    fn results_come_in_order() {
        let squares = map((0..1000).collect(), |i: u64| i * i);
        assert!(squares.windows(2).all(|pair| pair[0] < pair[1]));
        let chunks = map_chunks(&squares, 7, |chunk| chunk[0]);
        assert!(chunks.iter().eq(squares.iter().step_by(7)));
    }

    #[test]
    fn the_first_failure_is_told() {
        let until =
            |limit: u32| try_map((0..1000).collect(), |i: u32| if i < limit { Ok(i) } else { Err(i) });
        assert_eq!(until(1000), Ok((0..1000).collect()));
        assert!(until(0).is_err_and(|i| i < 1000) && until(900).is_err_and(|i| i >= 900));
    }

    #[test]
    fn both_results_come_back() {
        assert_eq!(join(usize::MAX, || 1, || "two"), (1, "two"));
        assert_eq!(join(0, || 1, || "two"), (1, "two"));
    }
}

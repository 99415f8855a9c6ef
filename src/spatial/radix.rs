//! Sorting by small integers, digit by digit (LSD radix sort).

use crate::parallel::{map, parts, piece_count};

/// Bits of a digit: its counters fit the first-level cache, and so does a cache line for each.
const DIGIT: u32 = 11;
/// Below this many items sorting by comparisons is faster: counting takes as long as the number of digits.
const FEW: usize = 256;

/// Items that a thread sorts at least: longer work than handing it over.
const PIECE: usize = 1 << 15;
/// Bits by which items are shared out among threads: so many shares that the threads' sums are alike, however the keys are distributed.
const SHARED_OUT: u32 = 8;

/// [`sort`], on several threads where that pays.
pub(crate) fn sort_parallel<T: Copy + Default + Send>(
    items: &mut Vec<T>,
    key: impl Fn(&T) -> u32 + Sync,
    bits: u32,
) {
    let mut other = Vec::new();
    if bits <= SHARED_OUT || piece_count(items.len(), PIECE) < 2 {
        sort(items, &mut other, key, bits);
        return;
    }
    // 1. Shared out by the highest digit.
    let lower = bits - SHARED_OUT;
    let mut lengths = vec![0usize; 1 << SHARED_OUT];
    items.iter().for_each(|item| lengths[(key(item) >> lower) as usize] += 1);
    let (mut places, mut start) = (lengths.clone(), 0);
    places.iter_mut().for_each(|place| start += std::mem::replace(place, start));
    other.resize(items.len(), T::default());
    for item in items.iter() {
        let place = &mut places[(key(item) >> lower) as usize];
        other[*place] = *item;
        *place += 1;
    }
    std::mem::swap(items, &mut other);
    // 2. Each share by the others.
    let (shares, room) = (parts(items, lengths.iter().copied()), parts(&mut other, lengths.iter().copied()));
    let shares = shares.into_iter().zip(room).filter(|(share, _)| share.len() > 1);
    map(shares.collect(), |(share, room)| {
        if sort_digits(share, room, &key, lower) {
            share.copy_from_slice(room);
        }
    });
}

/// Sorts by a key of `bits` bits, keeping the order of items with equal keys. `other` is memory for a second copy, with
/// any contents before and after.
pub(crate) fn sort<T: Copy + Default>(
    items: &mut Vec<T>,
    other: &mut Vec<T>,
    key: impl Fn(&T) -> u32,
    bits: u32,
) {
    if items.len() >= FEW {
        if other.is_empty() {
            // Fresh memory is zero without being written to.
            *other = vec![T::default(); items.len()];
        }
        other.resize(items.len(), T::default());
    }
    if sort_digits(items, other, &key, bits) {
        std::mem::swap(items, other);
    }
}

/// Sorts by the lowest `bits` bits of a key; whether the result is in `other`, which has as many items (unless they are
/// few: those are compared).
fn sort_digits<T: Copy>(items: &mut [T], other: &mut [T], key: &impl Fn(&T) -> u32, bits: u32) -> bool {
    // Digits of about equal size.
    let passes = bits.div_ceil(DIGIT).max(1);
    let digit = bits.div_ceil(passes);
    let mask = (1u32 << digit) - 1;
    if items.len() < FEW {
        let mask = u32::MAX >> (u32::BITS - bits.max(1));
        items.sort_by_key(|item| key(item) & mask);
        return false;
    }
    let mut counts = vec![0u32; (passes as usize) << digit];
    for item in items.iter() {
        let key = key(item);
        for pass in 0..passes {
            counts[((pass << digit) | (key >> (pass * digit) & mask)) as usize] += 1;
        }
    }
    let (mut from, mut to) = (items, other);
    for pass in 0..passes {
        let starts = &mut counts[(pass << digit) as usize..((pass + 1) << digit) as usize];
        let mut start = 0;
        for count in starts.iter_mut() {
            start += std::mem::replace(count, start);
        }
        for item in from.iter() {
            let place = &mut starts[(key(item) >> (pass * digit) & mask) as usize];
            to[*place as usize] = *item;
            *place += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    passes % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn threads_sort_alike() {
        let mut rng = ChaCha8Rng::seed_from_u64(18);
        for (count, bits, most) in
            [(200_000, 30, u32::MAX >> 2), (150_000, 30, 5_000), (100_000, 20, 1 << 20), (70_000, 8, 256)]
        {
            let mut items: Vec<(u32, usize)> = (0..count).map(|i| (rng.random_range(0..most), i)).collect();
            let mut expected = items.clone();
            expected.sort_by_key(|item| item.0);
            sort_parallel(&mut items, |item| item.0, bits);
            assert!(items == expected, "{count} items of {bits} bits");
        }
    }

    #[test]
    fn agrees_with_a_stable_sort() {
        let mut rng = ChaCha8Rng::seed_from_u64(17);
        let mut other = Vec::new();
        for (count, bits) in
            [(0, 1), (1, 30), (255, 8), (256, 1), (5_000, 11), (5_000, 12), (20_000, 30), (9_000, 32)]
        {
            let mask = u32::MAX >> (32 - bits);
            let mut items: Vec<(u32, usize)> = (0..count).map(|i| (rng.random::<u32>() & mask, i)).collect();
            let mut expected = items.clone();
            expected.sort_by_key(|item| item.0);
            sort(&mut items, &mut other, |item| item.0, bits);
            assert_eq!(items, expected, "{count} items of {bits} bits");
        }
    }
}

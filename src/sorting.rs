//! Sorts for lists that are short, or are sorted seldom, compiled to little.
//!
//! Each use of the standard library's sorts compiles a whole algorithm for its type and its comparison: 90 ms of processor time
//! and 20 kB for `sort_by`, 150 ms and 35 kB for `sort_unstable_by` (Rust 1.95, level 3; these take 9 ms and 5 kB), and there were
//! 140 of them. Lists that a pass over whole meshes sorts are left to the standard library, or to radix sorts.

use std::cmp::Ordering;

/// Items up to which they are put in by insertion, as the standard library's sorts do it.
const SHORT: usize = 20;

/// As `items.sort()`: equal items stay in their order.
pub(crate) fn sort<T: Ord>(items: &mut [T]) {
    sort_with(items, &mut T::cmp);
}

/// As `items.sort_by_key(key)`: equal items stay in their order.
pub(crate) fn sort_by_key<T, K: Ord>(items: &mut [T], mut key: impl FnMut(&T) -> K) {
    sort_with(items, &mut |x, y| key(x).cmp(&key(y)));
}

/// As `items.sort_by(compare)`: equal items stay in their order.
pub(crate) fn sort_by<T>(items: &mut [T], mut compare: impl FnMut(&T, &T) -> Ordering) {
    sort_with(items, &mut compare);
}

fn sort_with<T>(items: &mut [T], compare: &mut dyn FnMut(&T, &T) -> Ordering) {
    if items.len() > SHORT {
        let order = sorted_order(items.len(), &mut |i, j| compare(&items[i], &items[j]));
        return arrange(items, order);
    }
    for end in 1..items.len() {
        let mut place = end;
        while place > 0 && compare(&items[place], &items[place - 1]) == Ordering::Less {
            items.swap(place, place - 1);
            place -= 1;
        }
    }
}

/// The numbers below `count` in the order of what they stand for.
fn sorted_order(count: usize, compare: &mut dyn FnMut(usize, usize) -> Ordering) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&i, &j| compare(i, j));
    order
}

/// Puts at every place the item that `from` says is at another one, cycle by cycle.
fn arrange<T>(items: &mut [T], mut from: Vec<usize>) {
    for start in 0..items.len() {
        let mut place = start;
        loop {
            let next = std::mem::replace(&mut from[place], place);
            if next == start {
                break;
            }
            items.swap(place, next);
            place = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn sorts_as_the_standard_library_does() {
        const SEED: u64 = 20_261_128;
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        for count in (0..64).chain([1000, 5000]) {
            // Few values, so that many are equal; the second number tells equal ones apart.
            let items: Vec<(u32, usize)> =
                (0..count).map(|i| (random.random_range(0..=count as u32 / 3), i)).collect();
            let mut expected = items.clone();
            expected.sort_by_key(|item| std::cmp::Reverse(item.0));
            let mut sorted = items.clone();
            sort_by(&mut sorted, |x, y| y.0.cmp(&x.0));
            assert_eq!(sorted, expected, "{count} items, seed {SEED}");

            expected.sort_by_key(|item| item.0);
            sort_by_key(&mut sorted, |item| item.0);
            assert_eq!(sorted, expected, "{count} items by key");

            expected.sort_unstable();
            sort(&mut sorted);
            assert_eq!(sorted, expected, "{count} items as they are");
        }
    }
}

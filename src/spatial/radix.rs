//! Sorting by small integers, digit by digit (LSD radix sort).

/// Bits of a digit: its counters fit the first-level cache, and so does a cache line for each.
const DIGIT: u32 = 11;
/// Below this many items sorting by comparisons is faster: counting takes as long as the number of digits.
const FEW: usize = 256;

/// Sorts by a key of `bits` bits, keeping the order of items with equal keys. `other` is memory for a second copy, with
/// any contents before and after.
pub(crate) fn sort<T: Copy + Default>(
    items: &mut Vec<T>,
    other: &mut Vec<T>,
    key: impl Fn(&T) -> u32,
    bits: u32,
) {
    if items.len() < FEW {
        items.sort_by_key(key);
        return;
    }
    // Digits of about equal size.
    let passes = bits.div_ceil(DIGIT).max(1);
    let digit = bits.div_ceil(passes);
    let mask = (1u32 << digit) - 1;
    let mut counts = vec![0u32; (passes as usize) << digit];
    for item in items.iter() {
        let key = key(item);
        for pass in 0..passes {
            counts[((pass << digit) | (key >> (pass * digit) & mask)) as usize] += 1;
        }
    }
    if other.is_empty() {
        // Fresh memory is zero without being written to.
        *other = vec![T::default(); items.len()];
    }
    other.resize(items.len(), T::default());
    for pass in 0..passes {
        let starts = &mut counts[(pass << digit) as usize..((pass + 1) << digit) as usize];
        let mut start = 0;
        for count in starts.iter_mut() {
            start += std::mem::replace(count, start);
        }
        for item in items.iter() {
            let place = &mut starts[(key(item) >> (pass * digit) & mask) as usize];
            other[*place as usize] = *item;
            *place += 1;
        }
        std::mem::swap(items, other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

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

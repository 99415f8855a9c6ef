//! What was decided exactly a moment ago.
//!
//! A triangle is asked on which side of it a vertex lies once for each triangle around that vertex that it is near, and an edge on which
//! side of it another passes once for each pair of triangles beside the two. Nearly always a filter answers, faster than any table. Where
//! surfaces are flush, or flush but for rounding, none does, and each answer costs some tenths of a microsecond.

use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};

use super::ids::VertexId;

/// Answers that are remembered: 128 kB a thread, which the second-level cache holds. (Twice or half as many make no difference to 1,000
/// cubes in one file, turned.)
const ENTRIES: usize = 1 << 12;

/// An answer of an exact predicate, and whether the perturbation gave it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Answer {
    pub(crate) is_positive: bool,
    pub(crate) is_tie: bool,
}

/// Who asks: vertices have other places, and move elsewhere, in another complex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Asker(u64);

impl Asker {
    /// One that has not asked yet.
    pub(crate) fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// One answer: of four vertices in ascending order.
#[derive(Clone, Copy, Default)]
struct Entry {
    asker: Asker,
    vertices: [u32; 4],
    answer: Answer,
}

thread_local! {
    static ENTRIES_OF_THREAD: RefCell<Vec<Entry>> = const { RefCell::new(Vec::new()) };
}

/// The answer for four vertices, the remembered one or that of `decide`. Both orders of two of them give opposite ones.
pub(crate) fn remembered(asker: Asker, vertices: [VertexId; 4], decide: impl FnOnce() -> Answer) -> Answer {
    let (vertices, is_odd) = ascending(vertices.map(VertexId::number));
    if vertices.windows(2).any(|pair| pair[0] == pair[1]) {
        return decide();
    }
    let turned = |answer: Answer| Answer { is_positive: answer.is_positive != is_odd, ..answer };
    let place = place_of(vertices);
    let known = ENTRIES_OF_THREAD.with_borrow(|entries| {
        let entry = entries.get(place)?;
        (entry.asker == asker && entry.vertices == vertices).then_some(entry.answer)
    });
    if let Some(answer) = known {
        return turned(answer);
    }
    let answer = decide();
    ENTRIES_OF_THREAD.with_borrow_mut(|entries| {
        if entries.is_empty() {
            entries.resize(ENTRIES, Entry::default());
        }
        entries[place] = Entry { asker, vertices, answer: turned(answer) };
    });
    answer
}

/// Four numbers in ascending order, and whether an odd number of exchanges leads there.
fn ascending(mut x: [u32; 4]) -> ([u32; 4], bool) {
    let mut is_odd = false;
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        if x[i] > x[j] {
            x.swap(i, j);
            is_odd = !is_odd;
        }
    }
    (x, is_odd)
}

/// Where the answer of four vertices is kept.
fn place_of(vertices: [u32; 4]) -> usize {
    const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;
    let mixed = vertices
        .into_iter()
        .fold(0u64, |sum, v| (sum.rotate_left(23) ^ u64::from(v)).wrapping_mul(MULTIPLIER));
    (mixed >> (u64::BITS - ENTRIES.ilog2())) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_remembered_for_all_orders_and_one_asker() {
        let count = std::cell::Cell::new(0);
        let ask = |asker: Asker, vertices: [u32; 4], is_positive: bool| {
            let decide = || {
                count.set(count.get() + 1);
                Answer { is_positive, is_tie: true }
            };
            remembered(asker, vertices.map(VertexId::new), decide)
        };
        let (one, other) = (Asker::new(), Asker::new());
        assert!(ask(one, [7, 3, 9, 1], true).is_positive);
        // Two of them exchanged, and three of them in turn.
        assert!(!ask(one, [3, 7, 9, 1], false).is_positive);
        assert!(ask(one, [3, 9, 7, 1], false).is_positive);
        assert!(ask(one, [7, 3, 9, 1], false).is_tie);
        assert_eq!(count.get(), 1);
        assert!(!ask(other, [7, 3, 9, 1], false).is_positive);
        assert_eq!(count.get(), 2);
        // What is twice the same has no two orders.
        ask(one, [2, 2, 5, 6], true);
        ask(one, [2, 2, 5, 6], true);
        assert_eq!(count.get(), 4);
    }

    #[test]
    fn all_orders_are_even_or_odd() {
        let mut orders = vec![(vec![0u32, 1, 2, 3], false)];
        for i in 0..3 {
            for j in i + 1..4 {
                let exchanged = orders.iter().map(|(order, is_odd)| {
                    let mut order = order.clone();
                    order.swap(i, j);
                    (order, !is_odd)
                });
                orders.extend(exchanged.collect::<Vec<_>>());
            }
        }
        for (order, is_odd) in orders {
            assert_eq!(ascending(order.try_into().unwrap()), ([0, 1, 2, 3], is_odd));
        }
    }
}

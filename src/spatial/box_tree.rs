//! A balanced tree over boxes in Morton order, four by four.
//!
//! Built once per operation and walked once, so build time counts most: items are sorted by the Morton code of their
//! centre and packed in fours, level by level. The depth is the logarithm of the number of items for any input: equal,
//! nested and fan-shaped boxes, on which agglomerative builders go quadratic, cost what all others do. The boxes of a pack
//! are laid out so that one step tests all four at once. Pairs of boxes are found by [`visit_pairs`](super::visit_pairs).

use std::ops::Range;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use smallvec::{SmallVec, smallvec};

use super::pack::{LANES, Pack, for_each_bit};
use super::{morton, radix};
use crate::parallel::{append, build, read_ahead};

/// Items whose boxes are read ahead; a multiple of [`LANES`], and few enough to stay in the first-level cache.
const AT_ONCE: usize = 64;

/// Items that one thread takes at least.
const PIECE: usize = 1 << 14;
/// The box of no points.
const NOTHING: Aabb = Aabb { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

/// A balanced tree over the boxes of items: every pack of a level holds the boxes of four packs of the level below.
#[derive(Debug)]
pub(crate) struct BoxTree {
    /// Item numbers in Morton order.
    items: Vec<u32>,
    /// The packs: the items' own boxes first, then level by level up to a single one.
    levels: Vec<Vec<Pack>>,
    /// The box of everything.
    bounds: Aabb,
}

impl BoxTree {
    /// Memory for one item, while the tree is built: its box and that of a quarter pack, its key twice, its share of packs
    /// and its number.
    pub(crate) const BYTES_PER_ITEM: usize =
        5 * size_of::<Aabb>() / 4 + 2 * size_of::<u64>() + size_of::<Pack>() / (LANES - 1) + size_of::<u32>();

    /// The tree of nothing.
    pub(crate) fn empty() -> Self {
        Self::of_boxes(&[])
    }

    /// The tree of the given items.
    pub(crate) fn new(items: &[u32], box_of: impl Fn(u32) -> Aabb) -> Self {
        Self::of_boxes(&items.iter().map(|&item| box_of(item)).collect::<Vec<_>>()).renumbered(items)
    }

    /// The same tree with other numbers for its items.
    pub(crate) fn renumbered(mut self, numbers: &[u32]) -> Self {
        self.items.iter_mut().for_each(|item| *item = numbers[*item as usize]);
        self
    }

    /// The tree of the given boxes; items are places in their list.
    pub(crate) fn of_boxes(unsorted: &[Aabb]) -> Self {
        let mut centres = NOTHING;
        for aabb in unsorted {
            let centre = aabb.min + aabb.max;
            centres.min = centres.min.min(centre);
            centres.max = centres.max.max(centre);
        }
        Self::of(unsorted.len(), &centres, |item| unsorted[item as usize])
    }

    /// The tree of the boxes of triangles. On several threads where that pays.
    pub(crate) fn of_triangles(points: &[Vec3A], triangles: &[[u32; 3]]) -> Self {
        let mut all = NOTHING;
        for &point in points {
            all.min = all.min.min(point);
            all.max = all.max.max(point);
        }
        let centres = Aabb { min: all.min + all.min, max: all.max + all.max };
        Self::of(triangles.len(), &centres, |item| {
            let [a, b, c] = triangles[item as usize].map(|v| points[v as usize]);
            Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
        })
    }

    /// The tree of `count` boxes, twice the centres of which are in `centres`.
    fn of(count: usize, centres: &Aabb, box_of: impl Fn(u32) -> Aabb + Sync) -> Self {
        // 1. Items by the Morton codes of their centres (twice the centres, which is as good).
        let extent = (centres.max - centres.min).max_element();
        let scale = if extent > 0.0 { morton::LAST as f32 / extent } else { 0.0 };
        let mut order = build(count, PIECE, |first, run: &mut [u64]| {
            for (item, key) in (first as u32..).zip(run) {
                let aabb = box_of(item);
                let [x, y, z] = ((aabb.min + aabb.max - centres.min) * scale).to_array();
                *key = u64::from(morton::code([z as u32, y as u32, x as u32])) << 32 | u64::from(item);
            }
        });
        radix::sort_parallel(&mut order, |&key| (key >> 32) as u32, morton::BITS);
        let items = build(count, PIECE, |first, run: &mut [u32]| {
            run.iter_mut().zip(&order[first..]).for_each(|(item, &key)| *item = key as u32);
        });
        drop(order);

        // 2. The packs of the items; then level by level, until one pack holds everything.
        let mut levels = vec![packs_of(items.len(), |range| {
            let items = &items[range];
            let mut packs = Vec::with_capacity(items.len().div_ceil(LANES));
            for part in items.chunks(AT_ONCE) {
                read_ahead(part.iter().map(|&item| box_of(item).min.x.to_bits()));
                packs.extend(
                    part.chunks(LANES).map(|group| Pack::new(group.iter().map(|&item| box_of(item)))),
                );
            }
            packs
        })];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            let above = packs_of(below.len(), |range| {
                below[range].chunks(LANES).map(|group| Pack::new(group.iter().map(Pack::hull))).collect()
            });
            levels.push(above);
        }
        let bounds = levels.last().and_then(|top| top.first()).map_or(Aabb::INVALID, Pack::hull);
        Self { items, levels, bounds }
    }

    /// Whether there are no items.
    pub(super) fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// The level of the single pack at the top; the items' boxes are level 0.
    pub(super) fn top(&self) -> usize {
        self.levels.len() - 1
    }

    /// The box of everything.
    pub(super) fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The packs of a level. Lane k of pack p is the box of pack 4 p + k of the level below, or of an item.
    #[inline]
    pub(super) fn level(&self, level: usize) -> &[Pack] {
        &self.levels[level]
    }

    /// The items in the order of the lanes of the lowest level.
    #[inline]
    pub(crate) fn items(&self) -> &[u32] {
        &self.items
    }

    /// Calls `found` for every item whose box meets `query` (closed boxes).
    pub(crate) fn meeting(&self, query: &Aabb, mut found: impl FnMut(u32)) {
        if self.is_empty() {
            return;
        }
        let (low, high) = (query.min.to_array(), query.max.to_array());
        // Enough for all levels of a tree of 2^32 items.
        let mut stack: SmallVec<[(usize, usize); 64]> = smallvec![(self.top(), 0)];
        while let Some((level, place)) = stack.pop() {
            let meeting = self.level(level)[place].meeting(low, high);
            for_each_bit(meeting, |lane| {
                let place = LANES * place + lane as usize;
                if level == 0 {
                    found(self.items[place]);
                } else {
                    stack.push((level - 1, place));
                }
            });
        }
    }
}

/// What `packs` makes of `0..count` boxes piece by piece, a pack of every four.
fn packs_of(count: usize, packs: impl Fn(Range<usize>) -> Vec<Pack> + Sync) -> Vec<Pack> {
    append(count.div_ceil(LANES), PIECE / LANES, |range| {
        packs(LANES * range.start..(LANES * range.end).min(count))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_and_nested_boxes_keep_the_tree_flat() {
        let boxes: Vec<Aabb> = (0..10_000)
            .map(|i| {
                let size = if i < 5_000 { 1.0 } else { i as f32 };
                Aabb { min: Vec3A::splat(-size), max: Vec3A::splat(size) }
            })
            .collect();
        let items: Vec<u32> = (0..10_000).collect();
        let tree = BoxTree::new(&items, |i| boxes[i as usize]);
        assert!(tree.levels.len() < 10);
    }

    #[test]
    fn unused_lanes_meet_nothing() {
        let everything = Aabb { min: Vec3A::splat(f32::NEG_INFINITY), max: Vec3A::splat(f32::INFINITY) };
        for count in 0..40 {
            let tree = BoxTree::of_boxes(&vec![everything; count]);
            let mut found = Vec::new();
            tree.meeting(&everything, |item| found.push(item));
            found.sort_unstable();
            assert!(found.into_iter().eq(0..count as u32));
        }
    }
}

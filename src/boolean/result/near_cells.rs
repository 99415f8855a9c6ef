//! Which boxes have one of another list in the same cell of a coarse grid: two lists of many small triangles that meet along a curve
//! have few.

use obvhs::aabb::Aabb;

use crate::mesh::BitSet;

/// Cells along an axis: the grid then fits the first-level cache.
const CELLS: u32 = 64;
/// Cells that a box may cover, on average: what covers more is found faster without a grid.
const MOST_CELLS: usize = 24;
/// Fewer boxes than this are not worth a grid.
const FEW: usize = 4_096;

/// Of each list what has a box of another list in a cell that its own box covers; the order stays. `box_of` gives boxes in a
/// [`Frame`](crate::spatial::Frame), where all coordinates lie in -2..2.
pub(super) fn near_others(lists: Vec<Vec<u32>>, box_of: impl Fn(u32) -> Aabb) -> Vec<Vec<u32>> {
    if lists.iter().map(Vec::len).sum::<usize>() < FEW {
        return lists;
    }
    // 1. The cells of each list.
    let mut grids = Vec::with_capacity(lists.len());
    let mut covered = 0;
    for list in &lists {
        let mut grid = BitSet::new(CELLS.pow(3) as usize);
        for (i, &item) in list.iter().enumerate() {
            let cells = Cells::of(&box_of(item));
            covered += cells.count();
            if covered > MOST_CELLS * (i + FEW) {
                return lists;
            }
            cells.for_each(|cell| grid.insert(cell));
        }
        covered = 0;
        grids.push(grid);
    }
    // 2. What covers a cell of another.
    let near = |(own, list): (usize, Vec<u32>)| -> Vec<u32> {
        let others = || grids.iter().enumerate().filter(|&(k, _)| k != own).map(|(_, grid)| grid);
        let mut marked = BitSet::new(CELLS.pow(3) as usize);
        others().for_each(|grid| marked.unite(grid));
        let is_near = |item: &u32| Cells::of(&box_of(*item)).any(|cell| marked.contains(cell));
        list.into_iter().filter(is_near).collect()
    };
    lists.into_iter().enumerate().map(near).collect()
}

/// The cells that a box covers. Numbers never fall as coordinates rise, so boxes that meet have a cell in common.
struct Cells {
    low: [u32; 3],
    high: [u32; 3],
}

impl Cells {
    #[inline]
    fn of(aabb: &Aabb) -> Self {
        let cell = |x: f32| (((x + 2.0) * (CELLS as f32 / 4.0)) as u32).min(CELLS - 1);
        Self { low: aabb.min.to_array().map(cell), high: aabb.max.to_array().map(cell) }
    }

    #[inline]
    fn count(&self) -> usize {
        (0..3).map(|k| (self.high[k] - self.low[k] + 1) as usize).product()
    }

    #[inline]
    fn for_each(&self, mut visit: impl FnMut(u32)) {
        self.any(|cell| {
            visit(cell);
            false
        });
    }

    #[inline]
    fn any(&self, mut test: impl FnMut(u32) -> bool) -> bool {
        let [x, y, z] = [0, 1, 2].map(|k| self.low[k]..=self.high[k]);
        for z in z {
            for y in y.clone() {
                for x in x.clone() {
                    if test((z * CELLS + y) * CELLS + x) {
                        return true;
                    }
                }
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn boxes_that_meet_another_list_stay() {
        let mut random = ChaCha8Rng::seed_from_u64(20);
        for size in [0.001, 0.02, 0.3] {
            let boxes: Vec<Aabb> = (0..9_000)
                .map(|_| {
                    let min = Vec3A::from_array(std::array::from_fn(|_| random.random_range(-2.0..1.7)));
                    let extent = Vec3A::from_array(std::array::from_fn(|_| random.random_range(0.0..size)));
                    Aabb { min, max: min + extent }
                })
                .collect();
            // Two lists that lie apart but for a slab, and a short one.
            let side = |i: &u32| boxes[*i as usize].min.x > 0.0;
            let (right, left): (Vec<u32>, Vec<u32>) = (0..8_900).partition(side);
            let lists = vec![left, right, (8_900..9_000).collect()];
            let thinned = near_others(lists.clone(), |i| boxes[i as usize]);
            for (own, list) in lists.iter().enumerate() {
                let others =
                    || lists.iter().enumerate().filter(|&(k, _)| k != own).flat_map(|(_, list)| list);
                let meets = |i: &u32| {
                    let a = &boxes[*i as usize];
                    others().any(|&j| {
                        let b = &boxes[j as usize];
                        a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
                    })
                };
                let kept = &thinned[own];
                assert!(kept.is_sorted() && kept.iter().all(|i| list.contains(i)));
                assert!(list.iter().filter(|i| meets(i)).all(|i| kept.binary_search(i).is_ok()), "{size}");
            }
            if size < 0.01 {
                assert!(thinned[0].len() < lists[0].len() / 2, "{}", thinned[0].len());
            }
        }
    }
}

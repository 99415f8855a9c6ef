//! Points in a tree of boxes, to find those near a segment.

use super::super::Bounds;

/// Points in one leaf, at most.
const LEAF: usize = 8;

/// Points in boxes in boxes: halves along the longest side.
pub(super) struct PointTree<'a> {
    positions: &'a [[f64; 3]],
    /// The points in the order of the leaves.
    points: Vec<u32>,
    /// Boxes: of node n the children are 2 n + 1 and 2 n + 2.
    boxes: Vec<Bounds>,
}

impl<'a> PointTree<'a> {
    pub(super) fn new(positions: &'a [[f64; 3]], points: Vec<u32>) -> Self {
        let leaves = points.len().div_ceil(LEAF).max(1).next_power_of_two();
        let mut tree = Self { positions, points, boxes: vec![Bounds::NOTHING; 2 * leaves - 1] };
        let count = tree.points.len();
        tree.build(0, 0, count, leaves);
        tree
    }

    fn build(&mut self, node: usize, begin: usize, end: usize, leaves: usize) {
        let positions = self.positions;
        let points = &mut self.points[begin..end];
        let mut extent = Bounds::NOTHING;
        points.iter().for_each(|&point| extent.include(&positions[point as usize]));
        self.boxes[node] = extent;
        if leaves > 1 {
            let size = [0, 1, 2].map(|axis| extent.high[axis] * 0.5 - extent.low[axis] * 0.5);
            let longest = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
            let place = |point: u32| positions[point as usize][longest];
            let half = points.len() / 2;
            if half > 0 {
                points.select_nth_unstable_by(half, |&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
            }
            self.build(2 * node + 1, begin, begin + half, leaves / 2);
            self.build(2 * node + 2, begin + half, end, leaves / 2);
        }
    }

    /// Visits all points whose leaves come within `reach` of the segment, and perhaps others. Returns how many boxes and
    /// points were looked at.
    pub(super) fn near_segment(
        &self,
        [a, b]: [&[f64; 3]; 2],
        reach: f64,
        mut visit: impl FnMut(u32),
    ) -> usize {
        let mut looked_at = 0;
        let mut open = vec![(0, 0, self.points.len())];
        while let Some((node, begin, end)) = open.pop() {
            looked_at += 1;
            if begin == end || !meets(&self.boxes[node], [a, b], reach) {
                continue;
            }
            if 2 * node + 1 < self.boxes.len() {
                let half = begin + (end - begin) / 2;
                open.push((2 * node + 2, half, end));
                open.push((2 * node + 1, begin, half));
            } else {
                looked_at += end - begin;
                self.points[begin..end].iter().for_each(|&point| visit(point));
            }
        }
        looked_at
    }
}

/// Whether the segment may come within `reach` of the box. Never false where it does.
fn meets(extent: &Bounds, [a, b]: [&[f64; 3]; 2], reach: f64) -> bool {
    /// Room for the roundings of a division and a product, relative to the segment.
    const ROOM: f64 = 1e-12;
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..3 {
        let (low, high) = (extent.low[axis] - reach, extent.high[axis] + reach);
        let along = b[axis] - a[axis];
        if a[axis].max(b[axis]) < low || a[axis].min(b[axis]) > high {
            return false;
        }
        let (first, last) = ((low - a[axis]) / along, (high - a[axis]) / along);
        if first.is_finite() && last.is_finite() {
            enter = enter.max(first.min(last) - ROOM);
            leave = leave.min(first.max(last) + ROOM);
        }
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_near_points_are_visited() {
        let positions: Vec<[f64; 3]> =
            (0..1000).map(|i| [f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)]).collect();
        let tree = PointTree::new(&positions, (0..1000).collect());
        for (a, b) in [(0, 999), (5, 5), (17, 903), (90, 99), (0, 909)] {
            let ends = [&positions[a], &positions[b]];
            let mut found = Vec::new();
            let looked_at = tree.near_segment(ends, 0.3, |point| found.push(point));
            found.sort_unstable();
            for point in 0..1000u32 {
                let place = positions[point as usize];
                let close = (0..=1000).any(|step| {
                    let at = f64::from(step) / 1000.0;
                    let on: [f64; 3] = std::array::from_fn(|k| ends[0][k] + (ends[1][k] - ends[0][k]) * at);
                    super::super::rounding::apart(&place, &on) <= 0.3
                });
                assert!(!close || found.binary_search(&point).is_ok(), "{a} {b} {point}");
            }
            assert!(looked_at < 700, "{a} {b}: {looked_at}");
        }
        assert_eq!(PointTree::new(&positions, vec![]).near_segment([&[0.0; 3]; 2], 1.0, |_| {}), 1);
    }
}

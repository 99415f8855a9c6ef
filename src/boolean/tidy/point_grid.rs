//! Points in the cells of a grid.

use super::face::LocalPoint;
use crate::mesh::Buckets;

/// Points per cell of a search, on average, beyond which the search is left to another structure: four times as many as
/// there should be.
const MOST_POINTS_PER_CELL: usize = 8;
/// Points per cell that the size of the cells is chosen for, if the points fill their box.
const POINTS_PER_CELL: usize = 2;
/// Cells along an axis at most: bounds the memory of grids of points on a line.
const MOST_CELLS_PER_AXIS: usize = 1 << 10;

/// Points by cell. The cell along an axis never falls while the coordinate rises, so that nothing is missed by rounding.
pub(super) struct PointGrid {
    low: [f64; 3],
    cells_per_unit: [f64; 3],
    /// Number of cells along each axis.
    counts: [usize; 3],
    cells: Buckets<LocalPoint>,
}

impl PointGrid {
    /// A grid of the given points. O(points).
    pub(super) fn new<'p>(points: &[LocalPoint], position: impl Fn(LocalPoint) -> &'p [f64; 3]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for at in points.iter().map(|&point| position(point)) {
            for k in 0..3 {
                low[k] = low[k].min(at[k]);
                high[k] = high[k].max(at[k]);
            }
        }
        // Cubes, as many as wanted if the points fill their box. Half lengths do not overflow.
        let half: [f64; 3] = std::array::from_fn(|k| (0.5 * high[k] - 0.5 * low[k]).max(0.0));
        let longest = half.iter().fold(0.0f64, |longest, &x| longest.max(x));
        let fill: f64 = half.iter().map(|&x| (x / longest).max(1.0 / MOST_CELLS_PER_AXIS as f64)).product();
        let wanted = (points.len() / POINTS_PER_CELL).max(1) as f64;
        let along_longest = (wanted / fill).cbrt();
        let mut counts = [1; 3];
        let mut cells_per_unit = [0.0; 3];
        for k in 0..3 {
            let count = (along_longest * (half[k] / longest)).clamp(1.0, MOST_CELLS_PER_AXIS as f64).floor();
            let per_unit = 0.5 * (count / half[k]);
            if count > 1.0 && per_unit.is_finite() {
                (counts[k], cells_per_unit[k]) = (count as usize, per_unit);
            }
        }
        let mut grid = Self { low, cells_per_unit, counts, cells: Buckets::new(0, std::iter::empty()) };
        let in_cell = |&point: &LocalPoint| (grid.number(grid.cell(position(point))), point);
        let cells = Buckets::new(counts.iter().product(), points.iter().map(in_cell));
        grid.cells = cells;
        grid
    }

    fn cell(&self, at: &[f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| {
            let along = (at[k] - self.low[k]) * self.cells_per_unit[k];
            // Conversion saturates; what is not a number is 0.
            (along as usize).min(self.counts[k] - 1)
        })
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> u32 {
        ((x * self.counts[1] + y) * self.counts[2] + z) as u32
    }

    /// Calls `visit` for all points in the box with corners `p` and `q`, once each, and for some others. Where that box covers
    /// more than `most_cells` cells, or these hold more than [`MOST_POINTS_PER_CELL`] times as many points, nothing is
    /// visited and the answer is false.
    pub(super) fn visit_box(
        &self,
        p: &[f64; 3],
        q: &[f64; 3],
        most_cells: usize,
        mut visit: impl FnMut(LocalPoint),
    ) -> bool {
        let (from, to) = (self.cell(p), self.cell(q));
        let ranges: [_; 3] = std::array::from_fn(|k| from[k].min(to[k])..from[k].max(to[k]) + 1);
        if ranges.iter().map(ExactSizeIterator::len).product::<usize>() > most_cells {
            return false;
        }
        let [xs, ys, zs] = ranges;
        let cells = xs.flat_map(|x| {
            let zs = zs.clone();
            ys.clone().flat_map(move |y| zs.clone().map(move |z| [x, y, z]))
        });
        let points = |cell: [usize; 3]| self.cells.get(self.number(cell) as usize);
        if cells.clone().map(|cell| points(cell).len()).sum::<usize>()
            > most_cells.saturating_mul(MOST_POINTS_PER_CELL)
        {
            return false;
        }
        cells.for_each(|cell| points(cell).iter().for_each(|&point| visit(point)));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn every_point_of_a_box_is_found_once() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for extent in [[1.0, 1.0, 1.0], [1e3, 1e-9, 1.0], [0.0, 2.0, 0.0], [0.0; 3], [1.7e308; 3]] {
            let mut at = || -> [f64; 3] { extent.map(|x| (rng.random_range(-8..=8) as f64 / 8.0) * x) };
            let positions: Vec<[f64; 3]> = (0..400).map(|_| at()).collect();
            let points: Vec<LocalPoint> = (0..400).map(LocalPoint).collect();
            let grid = PointGrid::new(&points, |point| &positions[point.index()]);
            for _ in 0..100 {
                let (p, q) = (at(), at());
                let mut found = Vec::new();
                assert!(grid.visit_box(&p, &q, usize::MAX, |point| found.push(point)));
                found.sort_unstable();
                assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
                for &point in &points {
                    let x = &positions[point.index()];
                    let is_within = (0..3).all(|k| p[k].min(q[k]) <= x[k] && x[k] <= p[k].max(q[k]));
                    assert!(!is_within || found.contains(&point));
                }
            }
        }
    }

    #[test]
    fn crowded_cells_are_left_to_others() {
        // All points but one in one cell.
        let positions: Vec<[f64; 3]> =
            (0..5_000).map(|i| if i == 0 { [1e6; 3] } else { [f64::from(i) * 1e-6; 3] }).collect();
        let points: Vec<LocalPoint> = (0..5_000).map(LocalPoint).collect();
        let grid = PointGrid::new(&points, |point| &positions[point.index()]);
        assert!(!grid.visit_box(&[0.0; 3], &[1e-6; 3], 64, |_| panic!("too many")));
        assert!(grid.visit_box(&[9e5; 3], &[9e5; 3], 64, |_| {}));
    }
}

//! Which cells of a coarse grid a set of triangles passes.

use glam::Vec3A;

/// Largest number of cells along an axis: the grid then fits a second-level cache.
const MAX_RESOLUTION: u32 = 128;
/// A triangle whose box covers more cells than this is divided.
const DIVIDE_FROM: u32 = 12;
/// So often a triangle is divided at most.
const MAX_DIVISIONS: u32 = 1 << 14;
/// Divided parts reach a bit further, in cells, so that rounding of midpoints loses nothing.
const MARGIN: f32 = 1.0 / 64.0;

/// A grid of bits over the cube from -2 to 2 of a [`Frame`](super::Frame).
#[derive(Debug)]
pub(crate) struct Occupancy {
    bits: Vec<u64>,
    resolution: u32,
}

/// A range of cells along each axis, ends included.
#[derive(Clone, Copy)]
struct Cells {
    low: [u32; 3],
    high: [u32; 3],
}

impl Occupancy {
    /// An empty grid with about `resolution` cells along each axis of the region the frame was made for.
    pub(crate) fn new(resolution: u32) -> Self {
        // The region lies in -1..1 up to a factor of two; what is outside falls into the outermost cells.
        let resolution = (2 * resolution).clamp(8, 2 * MAX_RESOLUTION).next_multiple_of(8);
        Self { bits: vec![0; (resolution as usize).pow(3).div_ceil(64)], resolution }
    }

    /// Unmarks all cells.
    pub(crate) fn clear(&mut self) {
        self.bits.fill(0);
    }

    /// Marks the cells a triangle passes (and perhaps a few beside it).
    pub(crate) fn mark(&mut self, corners: [Vec3A; 3]) {
        let resolution = self.resolution;
        divide(corners.map(|corner| self.scaled(corner)), resolution, |cells| {
            for_cells(cells, resolution, |word, bit| {
                self.bits[word] |= bit;
                false
            })
        });
    }

    /// Whether a triangle passes a marked cell (or nearly).
    pub(crate) fn is_marked(&self, corners: [Vec3A; 3]) -> bool {
        divide(corners.map(|corner| self.scaled(corner)), self.resolution, |cells| {
            for_cells(cells, self.resolution, |word, bit| self.bits[word] & bit != 0)
        })
    }

    /// A point in units of cells.
    fn scaled(&self, point: Vec3A) -> Vec3A {
        (point + 2.0) * (self.resolution as f32 / 4.0)
    }
}

fn cell_range(low: Vec3A, high: Vec3A, resolution: u32) -> Cells {
    let last = (resolution - 1) as f32;
    let cell = |v: Vec3A| v.clamp(Vec3A::ZERO, Vec3A::splat(last)).to_array().map(|x| x as u32);
    Cells { low: cell(low), high: cell(high) }
}

/// Calls `visit` for each cell of a range until it returns true; returns whether it did.
#[inline]
fn for_cells(cells: Cells, resolution: u32, mut visit: impl FnMut(usize, u64) -> bool) -> bool {
    for z in cells.low[2]..=cells.high[2] {
        for y in cells.low[1]..=cells.high[1] {
            let row = (z * resolution + y) * resolution;
            for x in cells.low[0]..=cells.high[0] {
                let cell = row + x;
                if visit(cell as usize / 64, 1 << (cell % 64)) {
                    return true;
                }
            }
        }
    }
    false
}

/// Calls `visit` with ranges of cells that cover a triangle, until it returns true; returns whether it did. A triangle that
/// is much smaller than its box is divided along its longest side, so that needles cover only what they pass.
#[inline]
fn divide(corners: [Vec3A; 3], resolution: u32, mut visit: impl FnMut(Cells) -> bool) -> bool {
    let [a, b, c] = corners;
    let cells = cell_range(a.min(b).min(c), a.max(b).max(c), resolution);
    if count(cells) <= DIVIDE_FROM {
        return visit(cells);
    }
    divide_further(corners, resolution, &mut visit)
}

fn count(cells: Cells) -> u32 {
    (0..3).map(|k| cells.high[k] - cells.low[k] + 1).product()
}

fn divide_further(corners: [Vec3A; 3], resolution: u32, visit: &mut impl FnMut(Cells) -> bool) -> bool {
    let mut stack = vec![corners];
    let mut divisions = 0;
    let end = Vec3A::splat(resolution as f32);
    while let Some([a, b, c]) = stack.pop() {
        let margin = Vec3A::splat(MARGIN);
        let (low, high) = (a.min(b).min(c) - margin, a.max(b).max(c) + margin);
        // Nothing meets outside the region.
        if high.cmplt(Vec3A::ZERO).any() || low.cmpgt(end).any() {
            continue;
        }
        let cells = cell_range(low, high, resolution);
        // Below the size of a cell there is nothing to gain by dividing.
        if count(cells) <= DIVIDE_FROM || (high - low).max_element() <= 2.0 || divisions >= MAX_DIVISIONS {
            if visit(cells) {
                return true;
            }
            continue;
        }
        divisions += 1;
        let longest = [(b - a).length_squared(), (c - b).length_squared(), (a - c).length_squared()];
        let [p, q, r] = if longest[0] >= longest[1] && longest[0] >= longest[2] {
            [a, b, c]
        } else if longest[1] >= longest[2] {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let middle = (p + q) * 0.5;
        stack.push([p, middle, r]);
        stack.push([middle, q, r]);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn triangles_with_a_common_point_meet_in_a_cell() {
        let mut rng = ChaCha8Rng::seed_from_u64(14);
        for round in 0..3_000 {
            let mut grid = Occupancy::new([4, 30, 128][round % 3]);
            let mut point =
                |size: f32| Vec3A::new(rng.random(), rng.random(), rng.random()) * 2.0 * size - size;
            // Two triangles through one point: its barycentric coordinates in both are a third.
            let size = [1.2, 0.05, 1e-4][round / 3 % 3];
            let (a, b, centre) = (point(size), point(size), point(0.9));
            let first = [centre + a, centre + b, centre - a - b];
            let (a, b) = (point(1.5), point(1e-3));
            let second = [centre + a, centre + b, centre - a - b];
            grid.mark(first);
            assert!(grid.is_marked(second), "{first:?} {second:?}");
            grid.clear();
            assert!(!grid.is_marked(second));
        }
    }

    #[test]
    fn a_needle_covers_only_what_it_passes() {
        let mut grid = Occupancy::new(64);
        grid.mark([Vec3A::splat(-1.0), Vec3A::splat(1.0), Vec3A::new(1.0, 1.0, 0.99)]);
        let marked: u32 = grid.bits.iter().map(|word| word.count_ones()).sum();
        assert!((64..2_000).contains(&marked), "{marked}");
    }
}

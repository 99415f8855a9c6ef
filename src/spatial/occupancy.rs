//! Which cells of a coarse grid a set of triangles passes.
//!
//! A triangle whose box covers many cells is divided: for needles that lie askew. If all cells of its box were marked instead,
//! a knot less 50 short cylinders took 1.5 times as long, a crowd of 200 spheres 1.1 times (`boolean/candidates` says how
//! that was measured).

use glam::Vec3A;
use obvhs::aabb::Aabb;

use super::Frame;

/// Largest number of cells along an axis: the grid then fits a second-level cache.
const MAX_RESOLUTION: u32 = 256;
/// A region thinner than this is one cell wide (in the units of a [`Frame`](super::Frame)).
const THINNEST: f32 = 1e-6;
/// Bits of one component of a cell number; the last resolution has eight.
const BITS: u32 = 10;
const MASK: u32 = (1 << BITS) - 1;
/// A triangle whose box covers more cells than this is divided: below, marking all of them is faster.
const DIVIDE_FROM: u32 = 12;
/// Divisions of one triangle, at most: about as many as there are cells on its way through the largest grid, many times over.
const MAX_DIVISIONS: u32 = 1 << 14;
/// Divided parts are widened so that rounding loses nothing: by this part of a cell,
const MARGIN: f32 = 1.0 / 64.0;
/// and by this part of a cell for each cell that the triangle reaches from the origin. (Three half units in the last place
/// for a corner; one for every midpoint, of coordinates that shrink by half in two divisions.)
const MARGIN_PER_CELL: f32 = 8.0 * f32::EPSILON;

/// A grid of bits over a region of a [`Frame`](super::Frame).
#[derive(Debug)]
pub(crate) struct Occupancy {
    bits: Vec<u64>,
    /// Cells along each axis, a power of two, and its logarithm.
    resolution: u32,
    shift: u32,
    /// Where the grid starts, and cells per unit.
    low: Vec3A,
    scale: Vec3A,
}

/// The cell of a point: three components of [`BITS`] bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cell(u32);

impl Cell {
    fn components(self) -> [u32; 3] {
        [self.0 & MASK, self.0 >> BITS & MASK, self.0 >> (2 * BITS)]
    }
}

/// A range of cells along each axis, ends included.
#[derive(Clone, Copy)]
struct Cells {
    low: [u32; 3],
    high: [u32; 3],
}

impl Occupancy {
    /// An empty grid with at most `resolution` cells along each axis of the region the frame was made for.
    pub(crate) fn new(resolution: u32) -> Self {
        // The region lies in -1..1 up to a factor of two; what is outside falls into the outermost cells.
        let resolution = (1 << (2 * resolution.min(MAX_RESOLUTION)).max(1).ilog2()).clamp(8, MAX_RESOLUTION);
        Self::over(&Aabb { min: Vec3A::splat(-2.0), max: Vec3A::splat(2.0) }, resolution)
    }

    /// An empty grid with `resolution` cells (a power of two) along each axis of a region, whatever its proportions.
    pub(crate) fn over(region: &Aabb, resolution: u32) -> Self {
        let extent = region.max - region.min;
        let scale = extent.to_array().map(|x| if x > THINNEST { resolution as f32 / x } else { 0.0 });
        Self {
            bits: vec![0; (resolution as usize).pow(3).div_ceil(64)],
            resolution,
            shift: resolution.trailing_zeros(),
            low: region.min,
            scale: Vec3A::from_array(scale),
        }
    }

    /// A grid of the same cells, none of them marked.
    pub(crate) fn empty(&self) -> Self {
        Self { bits: vec![0; self.bits.len()], ..*self }
    }

    /// The cells marked in either of two grids of the same cells.
    pub(crate) fn united(mut self, other: Self) -> Self {
        self.bits.iter_mut().zip(other.bits).for_each(|(word, other)| *word |= other);
        self
    }

    /// The shortest side of a cell, in units of the frame.
    pub(crate) fn cell_length(&self) -> f32 {
        1.0 / self.scale.max_element()
    }

    /// Cells along each axis.
    pub(crate) fn resolution(&self) -> u32 {
        self.resolution
    }

    /// The number of a cell: x runs fastest, then y.
    #[inline]
    pub(crate) fn number(&self, cell: Cell) -> u32 {
        number(cell.components(), self.shift)
    }

    /// The cell with a number.
    #[inline]
    pub(crate) fn numbered(&self, number: u32) -> Cell {
        let mask = self.resolution - 1;
        let [x, y, z] = [0, self.shift, 2 * self.shift].map(|shift| number >> shift & mask);
        Cell(x | y << BITS | z << (2 * BITS))
    }

    /// Marks the cell with a number.
    #[inline]
    pub(crate) fn mark_number(&mut self, number: u32) {
        self.bits[number as usize / 64] |= 1 << (number % 64);
    }

    /// Whether the cell with a number is marked.
    #[inline]
    pub(crate) fn is_number_marked(&self, number: u32) -> bool {
        self.bits[number as usize / 64] >> (number % 64) & 1 == 1
    }

    /// The cell of a point. Points outside the grid are in its outermost cells.
    #[inline]
    pub(crate) fn cell(&self, point: Vec3A) -> Cell {
        let last = Vec3A::splat((self.resolution - 1) as f32);
        let [x, y, z] = self.scaled(point).clamp(Vec3A::ZERO, last).to_array().map(|x| x as u32);
        Cell(x | y << BITS | z << (2 * BITS))
    }

    /// Marks the cells a triangle passes (and perhaps a few next to it), given the cells of its corners; `corners` is asked
    /// only for big triangles.
    #[inline]
    pub(crate) fn mark(&mut self, of_corners: [Cell; 3], corners: impl FnOnce() -> [Vec3A; 3]) {
        let shift = self.shift;
        if of_corners[0] == of_corners[1] && of_corners[1] == of_corners[2] {
            let (word, bit) = place(of_corners[0].components(), shift);
            self.bits[word] |= bit;
            return;
        }
        let cells = around(of_corners);
        if count(cells) <= DIVIDE_FROM {
            for_cells(cells, shift, |word, bit| {
                self.bits[word] |= bit;
                false
            });
            return;
        }
        let corners = corners();
        let mut mark = |cells: Cells| {
            for_cells(cells, shift, |word, bit| {
                self.bits[word] |= bit;
                false
            })
        };
        if Frame::is_bent(&corners) {
            mark(cells);
            return;
        }
        let scaled = corners.map(|corner| (corner - self.low) * self.scale);
        divide(scaled, self.resolution, &mut mark);
    }

    /// Whether a triangle passes a marked cell (or nearly); arguments as in [`mark`](Self::mark).
    #[inline]
    pub(crate) fn is_marked(&self, of_corners: [Cell; 3], corners: impl FnOnce() -> [Vec3A; 3]) -> bool {
        let is_set = |word: usize, bit: u64| self.bits[word] & bit != 0;
        if of_corners[0] == of_corners[1] && of_corners[1] == of_corners[2] {
            let (word, bit) = place(of_corners[0].components(), self.shift);
            return is_set(word, bit);
        }
        let cells = around(of_corners);
        if count(cells) <= DIVIDE_FROM {
            return for_cells(cells, self.shift, is_set);
        }
        let corners = corners();
        if Frame::is_bent(&corners) {
            return for_cells(cells, self.shift, is_set);
        }
        let scaled = corners.map(|corner| self.scaled(corner));
        divide(scaled, self.resolution, &mut |cells| for_cells(cells, self.shift, is_set))
    }

    /// A point in units of cells.
    #[inline]
    fn scaled(&self, point: Vec3A) -> Vec3A {
        (point - self.low) * self.scale
    }
}

/// The range of cells around those of three corners.
#[inline]
fn around(of_corners: [Cell; 3]) -> Cells {
    let [a, b, c] = of_corners.map(Cell::components);
    Cells {
        low: std::array::from_fn(|k| a[k].min(b[k]).min(c[k])),
        high: std::array::from_fn(|k| a[k].max(b[k]).max(c[k])),
    }
}

#[inline]
fn number([x, y, z]: [u32; 3], shift: u32) -> u32 {
    (z << shift | y) << shift | x
}

/// Word and bit of a cell.
#[inline]
fn place(components: [u32; 3], shift: u32) -> (usize, u64) {
    let number = number(components, shift);
    (number as usize / 64, 1 << (number % 64))
}

fn cell_range(low: Vec3A, high: Vec3A, resolution: u32) -> Cells {
    let last = (resolution - 1) as f32;
    let cell = |v: Vec3A| v.clamp(Vec3A::ZERO, Vec3A::splat(last)).to_array().map(|x| x as u32);
    Cells { low: cell(low), high: cell(high) }
}

/// Calls `visit` with words and bits that hold the cells of a range, until it returns true; returns whether it did.
#[inline]
fn for_cells(cells: Cells, shift: u32, mut visit: impl FnMut(usize, u64) -> bool) -> bool {
    let Cells { low, high } = cells;
    for z in low[2]..high[2] + 1 {
        for y in low[1]..high[1] + 1 {
            let row = (z << shift | y) << shift;
            let (mut first, last) = (row | low[0], row | high[0]);
            // Cells along x are bits side by side.
            while first / 64 < last / 64 {
                if visit(first as usize / 64, !0 << (first % 64)) {
                    return true;
                }
                first = (first / 64 + 1) * 64;
            }
            if visit(first as usize / 64, !0 << (first % 64) & !0 >> (63 - last % 64)) {
                return true;
            }
        }
    }
    false
}

fn count(cells: Cells) -> u32 {
    (0..3).map(|k| cells.high[k] - cells.low[k] + 1).product()
}

/// Calls `visit` with ranges of cells that cover a triangle, until it returns true; returns whether it did. A triangle that
/// is much smaller than its box is divided along its longest side, so that needles cover only what they pass.
fn divide(corners: [Vec3A; 3], resolution: u32, visit: &mut impl FnMut(Cells) -> bool) -> bool {
    let mut stack = vec![corners];
    let mut divisions = 0;
    let end = Vec3A::splat(resolution as f32);
    let reach = corners.iter().fold(0.0f32, |reach, corner| reach.max(corner.abs().max_element()));
    let margin = Vec3A::splat(MARGIN + MARGIN_PER_CELL * reach);
    while let Some([a, b, c]) = stack.pop() {
        let (low, high) = (a.min(b).min(c) - margin, a.max(b).max(c) + margin);
        // Nothing meets outside the region.
        if high.cmplt(Vec3A::ZERO).any() || low.cmpgt(end).any() {
            continue;
        }
        let cells = cell_range(low, high, resolution);
        // Below the size of a cell there is nothing to gain by dividing.
        if count(cells) <= DIVIDE_FROM
            || (high - low).max_element() <= 2.0 + 2.0 * margin.x
            || divisions >= MAX_DIVISIONS
        {
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
        for round in 0..4_000 {
            let small = Aabb { min: Vec3A::splat(-0.9), max: Vec3A::new(0.9, 1.5, 0.95) };
            let mut grid = match round % 4 {
                3 => Occupancy::over(&small, 32),
                i => Occupancy::new([4, 30, 128][i]),
            };
            let mut point =
                |size: f32| Vec3A::new(rng.random(), rng.random(), rng.random()) * 2.0 * size - size;
            // Two triangles through one point: its barycentric coordinates in both are a third.
            let size = [1.2, 0.05, 1e-4, 3e4][round / 4 % 4];
            let (a, b, centre) = (point(size), point(size), point(0.9));
            let first = [centre + a, centre + b, centre - a - b];
            let (a, b) = (point(1.5), point(1e-3));
            let second = [centre + a, centre + b, centre - a - b];
            let cells = |grid: &Occupancy, t: [Vec3A; 3]| t.map(|corner| grid.cell(corner));
            grid.mark(cells(&grid, first), || first);
            let of_second = cells(&grid, second);
            assert!(grid.is_marked(of_second, || second), "{first:?} {second:?}");
            grid = grid.empty();
            assert!(!grid.is_marked(of_second, || second));
        }
    }

    #[test]
    fn a_needle_covers_only_what_it_passes() {
        let mut grid = Occupancy::new(64);
        let needle = [Vec3A::splat(-1.0), Vec3A::splat(1.0), Vec3A::new(1.0, 1.0, 0.99)];
        grid.mark(needle.map(|corner| grid.cell(corner)), || needle);
        let marked: u32 = grid.bits.iter().map(|word| word.count_ones()).sum();
        assert!((64..2_000).contains(&marked), "{marked}");
    }
}

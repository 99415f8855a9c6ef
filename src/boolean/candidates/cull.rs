//! Triangles ruled out by a grid as fine as the triangles.
//!
//! For operands that pass many cells of the coarse grid without touching there. Without it: 1.35 for a knot less 50 short
//! cylinders, where vertices are many next to what is near; nothing for two spheres, where the coarse grid leaves little.

use glam::Vec3A;

use super::refined_boxes::Corners;
use super::{SAMPLE, corners};
use crate::boolean::complex::Complex;
use crate::control::Limit;
use crate::parallel::{Runner, read_ahead};
use crate::spatial::{Cell, Frame, Occupancy};

/// The grid pays only if its cells are this many times shorter than those of the overlap's, which ruled out what it can.
const FINER: f32 = 2.0;
/// Grid cells that a triangle covers on the average, at most: needles in a grid made for small triangles take longer to mark
/// than the hierarchies save.
const MOST_CELLS_PER_TRIANGLE: f32 = 12.0;
/// Grid cells along half the region, times the usual length of a triangle: cells are up to two triangles wide (the number
/// along an axis is a power of two), so that most triangles are in one or two of them.
const CELLS_PER_LENGTH: f32 = 1.4;
/// The part of a sample that may stay; if more does, nothing is ruled out. Where surfaces run side by side it is nearly all.
const USELESS: f64 = 0.8;
/// Grids marked side by side, at most: each is up to 2 MB, and they have to be united.
const MOST_GRIDS: usize = 8;
/// Triangles that one thread looks up between two looks at the limits.
const TRIANGLES_PER_PIECE: usize = 1 << 14;
/// Triangles whose cells are found before the first of them is looked up, so that cache misses overlap.
const TRIANGLES_AT_ONCE: usize = 64;

/// The near triangles of each side that pass a grid cell which the other side passes, too; `None` where that would be
/// nearly all, or the grid no finer than that of the overlap, whose cells are `coarse_cell` long.
///
/// # Errors
/// Only limits.
pub(super) fn cull(
    complex: &Complex<'_>,
    frame: &Frame,
    coarse_cell: f32,
    runner: Runner<'_>,
) -> Result<Option<[Vec<u32>; 2]>, Limit> {
    let near = [complex.near(0), complex.near(1)];
    // 1. A grid that fits the triangles, if there is one.
    let Some(grid) = fitting_grid(complex, frame, near, coarse_cell) else { return Ok(None) };
    // 2. The cells of the vertices.
    let culling = Culling::new(complex, frame, near, grid, runner);
    // 3. What A passes; a sample of B tells whether to go on.
    let by_a = culling.marked_by(0, near[0])?;
    if culling.is_useless(&by_a) {
        return Ok(None);
    }
    // 4. What of B passes that, and what of A passes the cells of those triangles.
    let of_b = culling.passing(&by_a, 1)?;
    let of_a = culling.passing(&culling.marked_by(1, &of_b)?, 0)?;
    Ok(Some([of_a, of_b]))
}

/// An empty grid with cells for the smaller triangles, unless it is hardly finer than cells of `coarse_cell` or too fine for
/// the larger triangles.
fn fitting_grid(
    complex: &Complex<'_>,
    frame: &Frame,
    near: [&[u32]; 2],
    coarse_cell: f32,
) -> Option<Occupancy> {
    let usual = [0, 1].map(|side| UsualSize::new(near[side], |t| corners(complex, frame, side, t)));
    let grid = Occupancy::new((CELLS_PER_LENGTH / usual[0].length.min(usual[1].length)) as u32);
    if grid.cell_length() * FINER > coarse_cell {
        return None;
    }
    let cells: f32 = usual.iter().map(|usual| usual.cells(grid.cell_length())).sum();
    (cells <= MOST_CELLS_PER_TRIANGLE * (near[0].len() + near[1].len()) as f32).then_some(grid)
}

/// How large the triangles of a list usually are.
struct UsualSize {
    count: usize,
    length: f32,
    /// How many cells one covers in a grid with cells of length 1: along its length, and by its area.
    area: f32,
}

impl UsualSize {
    fn new(triangles: &[u32], corners: impl Fn(u32) -> Corners) -> Self {
        let sample = triangles.iter().step_by(triangles.len().div_ceil(SAMPLE));
        let count = sample.len() as f32;
        let (mut length, mut area) = (0.0, 0.0);
        for &t in sample {
            let [a, b, c] = corners(t).map(|corner| corner.clamp(Vec3A::splat(-2.0), Vec3A::splat(2.0)));
            length += (a.max(b).max(c) - a.min(b).min(c)).max_element();
            area += 0.5 * (b - a).cross(c - a).length();
        }
        Self { count: triangles.len(), length: length / count, area: area / count }
    }

    /// How many cells of a given length all triangles cover, about.
    fn cells(&self, cell: f32) -> f32 {
        self.count as f32 * (1.0 + self.length / cell + self.area / (cell * cell))
    }
}

/// Both operands and a grid.
struct Culling<'a> {
    complex: &'a Complex<'a>,
    frame: &'a Frame,
    near: [&'a [u32]; 2],
    /// The grid, nothing marked.
    grid: Occupancy,
    /// By side, the cell of every vertex; empty where most vertices belong to no near triangle.
    of_vertices: [Vec<Cell>; 2],
    runner: Runner<'a>,
}

impl<'a> Culling<'a> {
    fn new(
        complex: &'a Complex<'a>,
        frame: &'a Frame,
        near: [&'a [u32]; 2],
        grid: Occupancy,
        runner: Runner<'a>,
    ) -> Self {
        let cells_of_vertices = |side: usize| -> Vec<Cell> {
            let positions = complex.operands[side].positions;
            if 3 * near[side].len() < positions.len() {
                return Vec::new();
            }
            positions.iter().map(|position| grid.cell(frame.point(position))).collect()
        };
        let (of_a, of_b) = runner.both(|| cells_of_vertices(0), || cells_of_vertices(1));
        Self { complex, frame, near, of_vertices: [of_a, of_b], grid, runner }
    }

    fn corners(&self, side: usize, triangle: u32) -> Corners {
        corners(self.complex, self.frame, side, triangle)
    }

    /// The cells of a triangle's corners.
    fn cells(&self, side: usize, triangle: u32) -> [Cell; 3] {
        if self.of_vertices[side].is_empty() {
            return self.corners(side, triangle).map(|corner| self.grid.cell(corner));
        }
        self.complex.operands[side].triangles[triangle as usize].map(|v| self.of_vertices[side][v as usize])
    }

    /// Calls `visit` with the cells of some triangles, a batch at a time.
    fn for_each_with_cells(&self, side: usize, triangles: &[u32], mut visit: impl FnMut(u32, [Cell; 3])) {
        let mut batch = Vec::with_capacity(TRIANGLES_AT_ONCE);
        for triangles in triangles.chunks(TRIANGLES_AT_ONCE) {
            if self.of_vertices[side].is_empty() {
                let operand = &self.complex.operands[side];
                let corners = triangles.iter().flat_map(|&t| operand.triangles[t as usize]);
                read_ahead(corners.map(|v| operand.positions[v as usize][0].to_bits() as u32));
            }
            batch.clear();
            batch.extend(triangles.iter().map(|&t| self.cells(side, t)));
            triangles.iter().zip(&batch).for_each(|(&t, cells)| visit(t, *cells));
        }
    }

    /// The grid with the cells marked that some triangles pass. Grids marked side by side are united: which triangle is
    /// marked by which thread does not matter.
    fn marked_by(&self, side: usize, triangles: &[u32]) -> Result<Occupancy, Limit> {
        let grain = triangles.len().div_ceil(self.runner.threads().min(MOST_GRIDS)).max(1);
        let grids = self.runner.pieces(triangles.len(), grain, |range| {
            let mut marked = self.grid.empty();
            self.for_each_with_cells(side, &triangles[range], |t, cells| {
                marked.mark(cells, || self.corners(side, t));
            });
            marked
        })?;
        Ok(grids.into_iter().reduce(Occupancy::united).unwrap_or_else(|| self.grid.empty()))
    }

    /// Whether nearly all triangles of B pass a cell that A has marked, by a sample.
    fn is_useless(&self, by_a: &Occupancy) -> bool {
        let sample = self.near[1].iter().step_by(self.near[1].len().div_ceil(SAMPLE));
        let passes = |t: u32| by_a.is_marked(self.cells(1, t), || self.corners(1, t));
        let passing = sample.clone().filter(|&&t| passes(t)).count();
        passing as f64 > USELESS * sample.len() as f64
    }

    /// The near triangles of a side that pass a marked cell.
    fn passing(&self, marked: &Occupancy, side: usize) -> Result<Vec<u32>, Limit> {
        let near = self.near[side];
        self.runner.gather(near.len(), TRIANGLES_PER_PIECE, 0, |range, passing| {
            self.for_each_with_cells(side, &near[range], |t, cells| {
                if marked.is_marked(cells, || self.corners(side, t)) {
                    passing.push(t);
                }
            });
        })
    }
}

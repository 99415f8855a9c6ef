//! Pairs of triangles that may meet (Vyatkin 2019, step 1: hierarchies of axis-aligned boxes; of capsules for needles), after
//! most triangles have been ruled out by grids.

pub(super) mod capsule;
pub(super) mod capsule_tree;
pub(super) mod overlap;
pub(super) mod refined_boxes;

use glam::Vec3A;
use obvhs::aabb::Aabb;

use crate::Error;
use crate::boolean::complex::Complex;
use crate::control::{Limit, Reservation};
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Cell, Frame, Occupancy, read_ahead, visit_pairs};
use capsule_tree::CapsuleTree;
use overlap::Overlap;
use refined_boxes::{Boxes, Corners};

/// Below this many triangles near the other operand, ruling some out costs more than it saves.
const CULL_FROM: usize = 2_000;
/// Capsules pay from so many pairs of triangles on, if at least one of so many triangles is a needle.
const CAPSULES_FROM_PAIRS: usize = 1 << 14;
const NEEDLES_FROM: usize = 4;
/// The cells must be so many times shorter than those of the overlap.
const FINER: f32 = 2.0;
/// More grid cells for each triangle, on the average, are too many.
const MOST_CELLS_PER_TRIANGLE: f32 = 12.0;
/// Grid cells along half the region, times the usual length of a triangle.
const CELLS_PER_LENGTH: f32 = 1.4;
/// So many triangles tell how long they usually are, and whether ruling some out pays: it does not if more than this part
/// of them stays.
const SAMPLE: usize = 1_000;
const USELESS: f64 = 0.8;
/// So many grids are marked at once.
const MOST_GRIDS: usize = 8;
/// So many triangles are looked up in the grid at once.
const TRIANGLES_PER_PIECE: usize = 1 << 14;
/// The cells of so many triangles are found before the first is looked up.
const TRIANGLES_AT_ONCE: usize = 64;

/// The triangles of both operands that may meet the other, in hierarchies whose items are triangles.
pub(crate) struct Candidates {
    hierarchies: Hierarchies,
    _memory: Reservation,
}

enum Hierarchies {
    Boxes([BoxTree; 2]),
    /// Where there are many needles.
    Capsules([CapsuleTree; 2]),
}

impl Candidates {
    /// Rules out what a grid finer than that of the overlap can, and builds the hierarchies of the rest.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(complex: &Complex<'_>, overlap: &Overlap, runner: Runner<'_>) -> Result<Self, Error> {
        runner.control.check()?;
        let Some(common) = overlap.common else {
            let trees = [BoxTree::empty(), BoxTree::empty()];
            let hierarchies = Hierarchies::Boxes(trees);
            return Ok(Self { hierarchies, _memory: runner.control.reserve(0)? });
        };
        let frame = Frame::of(common.low, common.high);
        let near = [complex.near(0), complex.near(1)];
        let culled = (near[0].len().min(near[1].len()) >= CULL_FROM)
            .then(|| cull(complex, &frame, overlap.cell_length, runner))
            .transpose()?
            .flatten();
        let items = [0, 1].map(|side| culled.as_ref().map_or(near[side], |culled| &culled[side]));
        let corners = |side: usize, t: u32| corners(complex, &frame, side, t);
        let many = items[0].len().saturating_mul(items[1].len()) >= CAPSULES_FROM_PAIRS;
        if many && (0..2).any(|side| has_needles(items[side], |t| corners(side, t))) {
            let bytes = (items[0].len() + items[1].len()) * CapsuleTree::BYTES_PER_ITEM;
            let memory = runner.control.reserve(bytes as u64)?;
            let tree = |side: usize| CapsuleTree::new(items[side], |t| corners(side, t));
            let (a, b) = runner.both(|| tree(0), || tree(1));
            return Ok(Self { hierarchies: Hierarchies::Capsules([a, b]), _memory: memory });
        }
        let boxes = |side: usize| Boxes::new(items[side], |t| corners(side, t));
        let (a, b) = runner.both(|| boxes(0), || boxes(1));
        let common = Aabb { min: frame.point(&common.low), max: frame.point(&common.high) };
        let [a, b] = refined_boxes::refine([a, b], &common, corners);
        let bytes = (a.boxes.len() + b.boxes.len()) * (BoxTree::BYTES_PER_ITEM + size_of::<u32>());
        let memory = runner.control.reserve(bytes as u64)?;
        let tree = |of: &Boxes| BoxTree::of_boxes(&of.boxes).renumbered(&of.triangles);
        let (tree_a, tree_b) = runner.both(|| tree(&a), || tree(&b));
        let hierarchies = Hierarchies::Boxes([tree_a, tree_b]);
        Ok(Self { hierarchies, _memory: memory })
    }

    /// Calls `visit` for all pairs of a triangle of A and one of B that the hierarchies do not tell apart; more than once
    /// where several of their boxes meet.
    pub(crate) fn visit<T: Send>(
        &self,
        runner: Runner<'_>,
        visit: impl Fn(u32, u32, &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Error> {
        self.visit_batches(runner, |pairs, found| pairs.iter().for_each(|&[s, t]| visit(s, t, found)))
    }

    /// The same, some hundred pairs at once.
    pub(crate) fn visit_batches<T: Send>(
        &self,
        runner: Runner<'_>,
        visit: impl Fn(&[[u32; 2]], &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Error> {
        match &self.hierarchies {
            Hierarchies::Boxes([a, b]) => Ok(visit_pairs(a, b, runner, visit)?),
            Hierarchies::Capsules([a, b]) => capsule_tree::visit_pairs(a, b, runner, visit),
        }
    }
}

/// Whether many triangles are needles.
fn has_needles(triangles: &[u32], corners: impl Fn(u32) -> Corners) -> bool {
    let sample = triangles.iter().step_by(triangles.len().div_ceil(SAMPLE).max(1));
    let needles = sample.clone().filter(|&&t| capsule::is_needle(&corners(t))).count();
    needles * NEEDLES_FROM >= sample.len()
}

fn corners(complex: &Complex<'_>, frame: &Frame, side: usize, triangle: u32) -> Corners {
    let operand = &complex.operands[side];
    operand.triangles[triangle as usize].map(|v| frame.point(&operand.positions[v as usize]))
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

/// The near triangles of each side that pass a grid cell which the other side passes, too; `None` where that would be
/// nearly all, or the grid no finer than that of the overlap, whose cells are `coarse_cell` long.
fn cull(
    complex: &Complex<'_>,
    frame: &Frame,
    coarse_cell: f32,
    runner: Runner<'_>,
) -> Result<Option<[Vec<u32>; 2]>, Error> {
    let near = [complex.near(0), complex.near(1)];
    let corners = |side: usize, t: u32| corners(complex, frame, side, t);
    // Cells up to two triangles wide: most triangles are in one or two of them.
    let usual = [0, 1].map(|side| UsualSize::new(near[side], |t| corners(side, t)));
    let grid = Occupancy::new((CELLS_PER_LENGTH / usual[0].length.min(usual[1].length)) as u32);
    if grid.cell_length() * FINER > coarse_cell {
        return Ok(None);
    }
    // Needles in a grid made for small triangles take longer than the hierarchies save.
    let cells: f32 = usual.iter().map(|usual| usual.cells(grid.cell_length())).sum();
    if cells > MOST_CELLS_PER_TRIANGLE * (near[0].len() + near[1].len()) as f32 {
        return Ok(None);
    }
    // Each vertex once, unless most of them belong to no near triangle.
    let cells_of_vertices = |side: usize| -> Vec<Cell> {
        let positions = complex.operands[side].positions;
        if 3 * near[side].len() < positions.len() {
            return Vec::new();
        }
        positions.iter().map(|position| grid.cell(frame.point(position))).collect()
    };
    let (of_a, of_b) = runner.both(|| cells_of_vertices(0), || cells_of_vertices(1));
    let of_vertices = [of_a, of_b];
    let cells = |grid: &Occupancy, side: usize, t: u32| {
        if of_vertices[side].is_empty() {
            return corners(side, t).map(|corner| grid.cell(corner));
        }
        complex.operands[side].triangles[t as usize].map(|v| of_vertices[side][v as usize])
    };
    // Calls `visit` with the cells of some triangles, a batch at a time, so that cache misses overlap.
    let with_cells =
        |grid: &Occupancy, side: usize, triangles: &[u32], visit: &mut dyn FnMut(u32, [Cell; 3])| {
            let mut batch = Vec::with_capacity(TRIANGLES_AT_ONCE);
            for triangles in triangles.chunks(TRIANGLES_AT_ONCE) {
                if of_vertices[side].is_empty() {
                    let operand = &complex.operands[side];
                    let corners = triangles.iter().flat_map(|&t| operand.triangles[t as usize]);
                    read_ahead(corners.map(|v| operand.positions[v as usize][0].to_bits() as u32));
                }
                batch.clear();
                batch.extend(triangles.iter().map(|&t| cells(grid, side, t)));
                triangles.iter().zip(&batch).for_each(|(&t, cells)| visit(t, *cells));
            }
        };
    // Grids marked side by side are added up; which triangle is marked by whom does not matter.
    let marked_by = |side: usize, triangles: &[u32]| -> Result<Occupancy, Error> {
        let grain = triangles.len().div_ceil(runner.threads().min(MOST_GRIDS)).max(1);
        let parts = runner.pieces(triangles.len(), grain, |range| {
            let mut marked = grid.empty();
            with_cells(&grid, side, &triangles[range], &mut |t, cells| {
                marked.mark(cells, || corners(side, t));
            });
            marked
        })?;
        Ok(parts.into_iter().reduce(Occupancy::united).unwrap_or_else(|| grid.empty()))
    };
    let passing = |grid: &Occupancy, side: usize| -> Result<Vec<u32>, Limit> {
        runner.gather(near[side].len(), TRIANGLES_PER_PIECE, 0, |range, passing| {
            with_cells(grid, side, &near[side][range], &mut |t, cells| {
                if grid.is_marked(cells, || corners(side, t)) {
                    passing.push(t);
                }
            });
        })
    };
    let by_a = marked_by(0, near[0])?;
    // Where surfaces run side by side, hardly anything can be ruled out.
    let sample = near[1].iter().step_by(near[1].len().div_ceil(SAMPLE));
    let passing_sample = sample.clone().filter(|&&t| by_a.is_marked(cells(&by_a, 1, t), || corners(1, t)));
    if passing_sample.count() as f64 > USELESS * sample.len() as f64 {
        return Ok(None);
    }
    let of_b = passing(&by_a, 1)?;
    Ok(Some([passing(&marked_by(1, &of_b)?, 0)?, of_b]))
}

//! Pairs of triangles that may meet (Vyatkin 2019, step 1: hierarchies of axis-aligned boxes), after most triangles have
//! been ruled out by a coarse grid.

use obvhs::aabb::Aabb;

use super::capsule::Capsule;
use super::operands::Operands;
use super::refined_boxes::{self, Boxes, Corners};
use crate::Error;
use crate::control::Reservation;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Cell, Frame, Occupancy, visit_pairs};

/// Below this many triangles near the other operand, ruling some out costs more than it saves.
const CULL_FROM: usize = 2_000;
/// So many grids are marked at once.
const MOST_GRIDS: usize = 8;
/// So many triangles are looked up in the grid at once.
const TRIANGLES_PER_PIECE: usize = 1 << 14;

/// The triangles of both operands that may meet the other, in hierarchies of boxes.
pub(super) struct Candidates {
    /// Hierarchies over places in the lists below.
    trees: [BoxTree; 2],
    triangles: [Vec<u32>; 2],
    /// Capsules in the boxes; empty where there are few needles.
    capsules: [Vec<Capsule>; 2],
    _memory: Reservation,
}

impl Candidates {
    /// Rules out what a coarse grid can, and builds the hierarchies of the rest. `common` is the common part of the
    /// operands' boxes, if there is one.
    ///
    /// # Errors
    /// Only limits.
    pub(super) fn new(
        operands: &Operands<'_>,
        common: Option<Bounds>,
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        runner.control.check()?;
        let Some(common) = common else {
            let nothing = runner.control.reserve(0)?;
            let trees = [BoxTree::empty(), BoxTree::empty()];
            return Ok(Self {
                trees,
                triangles: Default::default(),
                capsules: Default::default(),
                _memory: nothing,
            });
        };
        let frame = Frame::of(common.low, common.high);
        let near = [operands.near(0), operands.near(1)];
        let culled = (near[0].len().min(near[1].len()) >= CULL_FROM)
            .then(|| cull(operands, &frame, runner))
            .transpose()?;
        let corners = |side: usize, t: u32| corners(operands, &frame, side, t);
        let boxes = |side: usize| {
            let items = culled.as_ref().map_or(near[side], |culled| &culled[side]);
            Boxes::new(items, |t| corners(side, t))
        };
        let (a, b) = runner.both(|| boxes(0), || boxes(1));
        let common = Aabb { min: frame.point(&common.low), max: frame.point(&common.high) };
        let [a, b] = refined_boxes::refine([a, b], &common, corners);
        let items = a.boxes.len() + b.boxes.len();
        let bytes_per_item = BoxTree::BYTES_PER_ITEM
            + size_of::<u32>()
            + if a.capsules.is_empty() { 0 } else { size_of::<Capsule>() };
        let memory = runner.control.reserve((items * bytes_per_item) as u64)?;
        let (tree_a, tree_b) = runner.both(|| BoxTree::of_boxes(&a.boxes), || BoxTree::of_boxes(&b.boxes));
        Ok(Self {
            trees: [tree_a, tree_b],
            triangles: [a.triangles, b.triangles],
            capsules: [a.capsules, b.capsules],
            _memory: memory,
        })
    }

    /// Calls `visit` for all pairs of a triangle of A and one of B whose boxes meet; more than once where several of their
    /// boxes do.
    pub(super) fn visit<T: Send>(
        &self,
        runner: Runner<'_>,
        visit: impl Fn(u32, u32, &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Error> {
        self.visit_batches(runner, |pairs, found| pairs.iter().for_each(|&[s, t]| visit(s, t, found)))
    }

    /// The same, some hundred pairs at once.
    pub(super) fn visit_batches<T: Send>(
        &self,
        runner: Runner<'_>,
        visit: impl Fn(&[[u32; 2]], &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Error> {
        let [of_a, of_b] = &self.triangles;
        let [a, b] = &self.trees;
        let has_capsules = !self.capsules[0].is_empty() && !self.capsules[1].is_empty();
        visit_pairs(a, b, runner, |pairs, found| {
            let mut triangles = Vec::with_capacity(pairs.len());
            for &[i, j] in pairs {
                let (i, j) = (i as usize, j as usize);
                if !has_capsules || !self.capsules[0][i].is_apart(&self.capsules[1][j]) {
                    triangles.push([of_a[i], of_b[j]]);
                }
            }
            visit(&triangles, found);
        })
    }
}

fn corners(operands: &Operands<'_>, frame: &Frame, side: usize, triangle: u32) -> Corners {
    let operand = &operands.sides[side];
    operand.triangles[triangle as usize].map(|v| frame.point(&operand.positions[v as usize]))
}

/// The near triangles of each side that pass a grid cell which the other side passes, too.
fn cull(operands: &Operands<'_>, frame: &Frame, runner: Runner<'_>) -> Result<[Vec<u32>; 2], Error> {
    let near = [operands.near(0), operands.near(1)];
    // Cells up to two triangles wide: most triangles are in one or two of them.
    let resolution = ((near[0].len().max(near[1].len()) as f64).sqrt() / 3.0) as u32;
    let grid = Occupancy::new(resolution);
    // Each vertex once, unless most of them belong to no near triangle.
    let cells_of_vertices = |side: usize| -> Vec<Cell> {
        let positions = operands.sides[side].positions;
        if 3 * near[side].len() < positions.len() {
            return Vec::new();
        }
        positions.iter().map(|position| grid.cell(frame.point(position))).collect()
    };
    let (of_a, of_b) = runner.both(|| cells_of_vertices(0), || cells_of_vertices(1));
    let of_vertices = [of_a, of_b];
    let corners = |side: usize, t: u32| corners(operands, frame, side, t);
    let cells = |grid: &Occupancy, side: usize, t: u32| {
        if of_vertices[side].is_empty() {
            return corners(side, t).map(|corner| grid.cell(corner));
        }
        operands.sides[side].triangles[t as usize].map(|v| of_vertices[side][v as usize])
    };
    // Grids marked side by side are added up; which triangle is marked by whom does not matter.
    let marked_by = |side: usize, triangles: &[u32]| -> Result<Occupancy, Error> {
        let grain = triangles.len().div_ceil(runner.threads().min(MOST_GRIDS)).max(1);
        let parts = runner.pieces(triangles.len(), grain, |range| {
            let mut grid = grid.empty();
            for &t in &triangles[range] {
                grid.mark(cells(&grid, side, t), || corners(side, t));
            }
            grid
        })?;
        Ok(parts.into_iter().reduce(Occupancy::united).unwrap_or_else(|| grid.empty()))
    };
    let passing = |grid: &Occupancy, side: usize| -> Result<Vec<u32>, Error> {
        let is_marked = |t: &u32| grid.is_marked(cells(grid, side, *t), || corners(side, *t));
        let grain = if runner.is_parallel() { TRIANGLES_PER_PIECE } else { near[side].len().max(1) };
        let pieces = runner.pieces(near[side].len(), grain, |range| {
            near[side][range].iter().copied().filter(is_marked).collect::<Vec<u32>>()
        })?;
        let mut pieces = pieces.into_iter();
        let mut all = pieces.next().unwrap_or_default();
        pieces.for_each(|piece| all.extend(piece));
        Ok(all)
    };
    let of_b = passing(&marked_by(0, near[0])?, 1)?;
    Ok([passing(&marked_by(1, &of_b)?, 0)?, of_b])
}

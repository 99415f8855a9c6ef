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
        let culled = (near[0].len().min(near[1].len()) >= CULL_FROM).then(|| cull(operands, &frame, runner));
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
        let (tree_a, tree_b) = runner.both(|| BoxTree::of_boxes(a.boxes), || BoxTree::of_boxes(b.boxes));
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
        let [of_a, of_b] = &self.triangles;
        let [a, b] = &self.trees;
        if self.capsules[0].is_empty() || self.capsules[1].is_empty() {
            return visit_pairs(a, b, runner, |i, j, found| visit(of_a[i as usize], of_b[j as usize], found));
        }
        visit_pairs(a, b, runner, |i, j, found| {
            if !self.capsules[0][i as usize].is_apart(&self.capsules[1][j as usize]) {
                visit(of_a[i as usize], of_b[j as usize], found);
            }
        })
    }
}

fn corners(operands: &Operands<'_>, frame: &Frame, side: usize, triangle: u32) -> Corners {
    let operand = &operands.sides[side];
    operand.triangles[triangle as usize].map(|v| frame.point(&operand.positions[v as usize]))
}

/// The near triangles of each side that pass a grid cell which the other side passes, too.
fn cull(operands: &Operands<'_>, frame: &Frame, runner: Runner<'_>) -> [Vec<u32>; 2] {
    let near = [operands.near(0), operands.near(1)];
    // Cells up to two triangles wide: most triangles are in one or two of them.
    let resolution = ((near[0].len().max(near[1].len()) as f64).sqrt() / 3.0) as u32;
    let mut grid = Occupancy::new(resolution);
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
    for &t in near[0] {
        grid.mark(cells(&grid, 0, t), || corners(0, t));
    }
    let marked = |grid: &Occupancy, side: usize| -> Vec<u32> {
        let is_marked = |t: &u32| grid.is_marked(cells(grid, side, *t), || corners(side, *t));
        near[side].iter().copied().filter(is_marked).collect()
    };
    let of_b = marked(&grid, 1);
    grid.clear();
    for &t in &of_b {
        grid.mark(cells(&grid, 1, t), || corners(1, t));
    }
    [marked(&grid, 0), of_b]
}

//! Pairs of triangles that may meet (Vyatkin 2019, step 1: hierarchies of axis-aligned boxes), after most triangles have
//! been ruled out by a coarse grid.

use obvhs::aabb::Aabb;

use super::operands::Operands;
use crate::Error;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, Occupancy, visit_pairs};

/// Below this many triangles near the other operand, ruling some out costs more than it saves.
const CULL_FROM: usize = 2_000;

/// The triangles of both operands that may meet the other, in hierarchies of boxes.
pub(super) struct Candidates {
    trees: [BoxTree; 2],
}

impl Candidates {
    /// Rules out what a coarse grid can, and builds the hierarchies of the rest. `common` is the common part of the
    /// operands' boxes, if there is one.
    pub(super) fn new(operands: &Operands<'_>, common: Option<Bounds>, runner: Runner<'_>) -> Self {
        let Some(common) = common else { return Self { trees: [BoxTree::empty(), BoxTree::empty()] } };
        let frame = Frame::of(common.low, common.high);
        let near = [operands.near(0), operands.near(1)];
        let culled = (near[0].len().min(near[1].len()) >= CULL_FROM).then(|| cull(operands, &frame, runner));
        let tree = |side: usize| {
            let items = culled.as_ref().map_or(near[side], |culled| &culled[side]);
            BoxTree::new(items, |t| triangle_box(operands, &frame, side, t))
        };
        let (a, b) = runner.both(|| tree(0), || tree(1));
        Self { trees: [a, b] }
    }

    /// Calls `visit` for all pairs of a triangle of A and one of B whose boxes meet.
    pub(super) fn visit<T: Send>(
        &self,
        runner: Runner<'_>,
        visit: impl Fn(u32, u32, &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Error> {
        visit_pairs(&self.trees[0], &self.trees[1], runner, visit)
    }
}

fn triangle_box(operands: &Operands<'_>, frame: &Frame, side: usize, triangle: u32) -> Aabb {
    let operand = &operands.sides[side];
    frame.triangle(operand.triangles[triangle as usize].map(|v| &operand.positions[v as usize]))
}

/// The near triangles of each side that pass a grid cell which the other side passes, too.
fn cull(operands: &Operands<'_>, frame: &Frame, runner: Runner<'_>) -> [Vec<u32>; 2] {
    let near = [operands.near(0), operands.near(1)];
    // Cells a few triangles wide.
    let resolution = ((near[0].len().max(near[1].len()) as f64).sqrt() / 2.0) as u32;
    let corners = |side: usize, t: u32| {
        let operand = &operands.sides[side];
        operand.triangles[t as usize].map(|v| frame.point(&operand.positions[v as usize]))
    };
    let mut cells = Occupancy::new(resolution);
    for &t in near[0] {
        cells.mark(corners(0, t));
    }
    let of_b: Vec<u32> = near[1].iter().copied().filter(|&t| cells.is_marked(corners(1, t))).collect();
    cells.clear();
    for &t in &of_b {
        cells.mark(corners(1, t));
    }
    let of_a: Vec<u32> = near[0].iter().copied().filter(|&t| cells.is_marked(corners(0, t))).collect();
    let _ = runner;
    [of_a, of_b]
}

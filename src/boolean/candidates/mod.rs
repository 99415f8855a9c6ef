//! Pairs of triangles that may meet (Vyatkin 2019, step 1: hierarchies of axis-aligned boxes; of capsules for needles), after
//! most triangles have been ruled out by grids.
//!
//! The file of each tier says what case it is for and what it gains there: the time of the whole operation without the tier,
//! as a multiple of that with it. Measured on 2026-11-27 on an AMD EPYC virtual machine, 2 cores, by the processor time of one
//! thread, least of five (of three where a run takes seconds). Others worked on the machine: differences below 0.1 mean
//! nothing. Cases are those of `benches/shapes`.

pub(super) mod capsule;
pub(super) mod capsule_tree;
mod cull;
pub(super) mod overlap;
pub(super) mod refined_boxes;

use obvhs::aabb::Aabb;

use crate::Error;
use crate::boolean::complex::Complex;
use crate::control::Reservation;
use crate::parallel::Runner;
use crate::spatial::{BoxTree, Frame, visit_pairs};
use capsule_tree::CapsuleTree;
use overlap::Overlap;
use refined_boxes::{Boxes, Corners};

/// Below this many triangles near the other operand, ruling some out costs more than it saves.
const CULL_FROM: usize = 2_000;
/// Capsules pay from this many pairs of triangles on,
const CAPSULES_FROM_PAIRS: usize = 1 << 14;
/// if at least one triangle of this many is a needle.
const NEEDLES_FROM: usize = 4;
/// Triangles that stand for all where it is asked what they usually are like.
const SAMPLE: usize = 1_000;

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
        // 1. A grid as fine as the triangles rules out most of those that are near.
        let frame = Frame::of(common.low, common.high);
        let near = [complex.near(0), complex.near(1)];
        let culled = (near[0].len().min(near[1].len()) >= CULL_FROM)
            .then(|| cull::cull(complex, &frame, overlap.cell_length, runner))
            .transpose()?
            .flatten();
        let items = [0, 1].map(|side| culled.as_ref().map_or(near[side], |culled| &culled[side]));
        let corners = |side: usize, t: u32| corners(complex, &frame, side, t);
        // 2. Where many are needles, capsules around what is left.
        let many = items[0].len().saturating_mul(items[1].len()) >= CAPSULES_FROM_PAIRS;
        if many && (0..2).any(|side| has_needles(items[side], |t| corners(side, t))) {
            let bytes = (items[0].len() + items[1].len()) * CapsuleTree::BYTES_PER_ITEM;
            let memory = runner.control.reserve(bytes as u64)?;
            let tree = |side: usize| CapsuleTree::new(items[side], |t| corners(side, t));
            let (a, b) = runner.both(|| tree(0), || tree(1));
            return Ok(Self { hierarchies: Hierarchies::Capsules([a, b]), _memory: memory });
        }
        // 3. Else boxes, several for triangles that are large next to the other operand's.
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

    /// Calls `visit` for all pairs of a triangle of A and one of B that the hierarchies do not rule out; more than once
    /// where several of their boxes meet.
    pub(crate) fn visit<T: Send>(
        &self,
        runner: Runner<'_>,
        visit: impl Fn(u32, u32, &mut Vec<T>) + Sync,
    ) -> Result<Vec<T>, Error> {
        self.visit_batches(runner, |pairs, found| pairs.iter().for_each(|&[s, t]| visit(s, t, found)))
    }

    /// The same, some hundreds of pairs at once.
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
pub(crate) fn has_needles(triangles: &[u32], corners: impl Fn(u32) -> Corners) -> bool {
    let sample = triangles.iter().step_by(triangles.len().div_ceil(SAMPLE).max(1));
    let needles = sample.clone().filter(|&&t| capsule::is_needle(&corners(t))).count();
    needles * NEEDLES_FROM >= sample.len()
}

fn corners(complex: &Complex<'_>, frame: &Frame, side: usize, triangle: u32) -> Corners {
    let operand = &complex.operands[side];
    operand.triangles[triangle as usize].map(|v| frame.point(&operand.positions[v as usize]))
}

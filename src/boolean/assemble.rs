//! The result's arrays: untouched triangles in their order, then what was cut.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use super::cut_edges::CutEdges;
use super::cut_faces::{BitSet, CutFaces};
use super::identify::Identification;
use super::multiplicity::Part;
use super::operands::Operands;
use super::outcome::Origin;
use crate::Error;
use crate::parallel::{Runner, ranges};

/// A triangle that cutting made or changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewTriangle {
    /// Points: vertices by number, then nodes, then copies.
    pub(super) corners: [u32; 3],
    pub(super) origin: Origin,
    /// Whether the corners lay on one line before they were rounded.
    pub(super) flat: bool,
}

/// The arrays of a result.
#[derive(Debug, Default)]
pub(super) struct Assembled {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) origins: Vec<Origin>,
    /// Decisions that plain positions left open.
    pub(super) ties: u64,
    /// Whether rounding turned over some triangle.
    pub(super) has_inverted: bool,
}

impl Assembled {
    /// Both, as bodies of their own.
    pub(super) fn beside(mut self, other: Self) -> Result<Self, Error> {
        if self.triangles.is_empty() {
            return Ok(other);
        }
        let vertices = self.positions.len() + other.positions.len();
        if vertices > u32::MAX as usize {
            return Err(Error::TooLarge { what: format!("{vertices} vertices in one result") });
        }
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v + offset)));
        self.origins.extend(other.origins);
        self.has_inverted |= other.has_inverted;
        Ok(self)
    }
}

/// What the arrays are made of.
pub(super) struct Ingredients<'a> {
    pub(super) operands: &'a Operands<'a>,
    pub(super) parts: &'a [Part],
    pub(super) faces: &'a [CutFaces; 2],
    /// Winding numbers of the vertices, by side; empty where all are 0.
    pub(super) windings: &'a [Vec<i32>; 2],
    pub(super) identification: &'a Identification,
    pub(super) edges: &'a CutEdges,
    pub(super) new: &'a [NewTriangle],
    /// Uncut triangles that `new` replaces, by side.
    pub(super) replaced: Option<&'a [BitSet; 2]>,
    /// Positions of the points after the nodes.
    pub(super) copies: &'a [[f64; 3]],
}

impl Ingredients<'_> {
    /// How often an uncut triangle counts in a part.
    #[inline]
    fn count(&self, part: Part, triangle: u32, corners: [u32; 3]) -> u32 {
        if self.faces[part.side].is_cut(triangle)
            || self.replaced.is_some_and(|r| r[part.side].contains(triangle))
        {
            return 0;
        }
        let winding = self.windings[part.side].get(corners[0] as usize).copied().unwrap_or(0);
        part.multiplicity(winding).unsigned_abs()
    }

    /// Builds the arrays.
    pub(super) fn assemble(&self, runner: Runner<'_>) -> Result<Assembled, Error> {
        let operands = self.operands;
        let points = operands.vertex_count() as usize + self.edges.positions.len() + self.copies.len();
        // First mark the points in use, then number them in order: A's, B's, nodes, copies.
        let number: Vec<AtomicU32> = std::iter::repeat_with(|| AtomicU32::new(UNUSED)).take(points).collect();
        let mark = |point: u32| number[point as usize].store(USED, Ordering::Relaxed);
        let pieces = self.pieces(runner);
        let grain = if runner.is_parallel() { 1 } else { pieces.len() };
        let counts = runner.pieces(pieces.len(), grain, |range| {
            let mut count = 0;
            for piece in &pieces[range] {
                self.for_kept(piece, |_, times, points| {
                    count += times as usize;
                    points.into_iter().for_each(mark);
                });
            }
            count
        })?;
        self.new.iter().flat_map(|triangle| triangle.corners).for_each(mark);
        let mut positions = Vec::new();
        for (point, entry) in number.iter().enumerate() {
            if entry.load(Ordering::Relaxed) == USED {
                entry.store(positions.len() as u32, Ordering::Relaxed);
                positions.push(self.position(point as u32));
            }
        }

        let total = counts.iter().sum::<usize>() + self.new.len();
        let runs = runner.pieces(pieces.len(), grain, |range| {
            // The first run has room for all.
            let room = if range.start == 0 { total } else { counts[range.start] };
            let mut run = Run { triangles: Vec::with_capacity(room), origins: Vec::with_capacity(room) };
            for piece in &pieces[range] {
                self.for_kept(piece, |origin, times, points| {
                    let [a, b, c] = points.map(|point| number[point as usize].load(Ordering::Relaxed));
                    for _ in 0..times {
                        run.triangles.push(if origin.reversed { [a, c, b] } else { [a, b, c] });
                        run.origins.push(origin);
                    }
                });
            }
            run
        })?;
        let mut runs = runs.into_iter();
        let Run { mut triangles, mut origins } = runs.next().unwrap_or_default();
        for run in runs {
            triangles.extend(run.triangles);
            origins.extend(run.origins);
        }
        for triangle in self.new {
            triangles.push(triangle.corners.map(|point| number[point as usize].load(Ordering::Relaxed)));
            origins.push(triangle.origin);
        }
        Ok(Assembled { positions, triangles, origins, ..Assembled::default() })
    }

    /// What one thread looks at: parts of the result, or of these.
    fn pieces(&self, runner: Runner<'_>) -> Vec<(Part, Range<usize>)> {
        let share = |part: &Part| {
            let count = self.operands.sides[part.side].triangles.len();
            let pieces = if runner.is_parallel() { count.div_ceil(TRIANGLES_PER_PIECE) } else { 1 };
            ranges(count, pieces).into_iter().map(|range| (*part, range)).collect::<Vec<_>>()
        };
        self.parts.iter().flat_map(share).collect()
    }

    /// Calls `found` for every uncut triangle that stays: origin, how often it counts, and its points.
    #[inline]
    fn for_kept(&self, (part, range): &(Part, Range<usize>), mut found: impl FnMut(Origin, u32, [u32; 3])) {
        let first = self.operands.first_vertex(part.side);
        let triangles = &self.operands.sides[part.side].triangles[range.clone()];
        for (t, &corners) in range.clone().zip(triangles) {
            let times = self.count(*part, t as u32, corners);
            if times == 0 {
                continue;
            }
            // A negative multiplicity turns the triangle over once more.
            let winding = self.windings[part.side].get(corners[0] as usize).copied().unwrap_or(0);
            let reversed = part.reversed != (part.multiplicity(winding) < 0);
            let origin = Origin { operand: part.side as u32, triangle: t as u32, reversed };
            found(origin, times, corners.map(|v| self.identification.representative(first + v)));
        }
    }

    fn position(&self, point: u32) -> [f64; 3] {
        let first_node = self.operands.vertex_count();
        if point < first_node {
            return *self.operands.position(point);
        }
        let node = (point - first_node) as usize;
        match self.edges.positions.get(node) {
            Some(position) => *position,
            None => self.copies[node - self.edges.positions.len()],
        }
    }
}

/// Triangles of the result that one thread has written.
#[derive(Default)]
struct Run {
    triangles: Vec<[u32; 3]>,
    origins: Vec<Origin>,
}

/// How many triangles one thread looks at.
const TRIANGLES_PER_PIECE: usize = 1 << 16;
const UNUSED: u32 = u32::MAX;
const USED: u32 = u32::MAX - 1;

//! What of each operand can meet the other: a few passes over the arrays, before anything is built.
//!
//! The common part of the operands' boxes is divided into a coarse grid. Cells that the other operand's surface does not pass
//! form regions (`spatial::Regions`), in each of which it winds around everything equally often. Triangles that touch no
//! passed cell need not be looked at again.
//!
//! For operands of many triangles that cross along a curve. Without the grid: 1.2 for two spheres of 330,000 triangles, and
//! 1.8 if the finer grid (`cull`) is not there either; 2.4 for a knot less 50 short cylinders without both. With the grid, but
//! without regions, so that every vertex in a free cell is decided for itself: 7.6 for the spheres, 2.4 for a crowd of 200
//! spheres, 1.5 for the knot.

use obvhs::aabb::Aabb;

use crate::Error;
use crate::boolean::complex::Operand;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::spatial::{Frame, Occupancy, Regions};

/// Below this many triangles of the smaller operand, ruling some out costs more than it saves.
const DIVIDE_FROM: usize = 1_000;
/// Cells along an axis, at most: their numbers have 15 bits.
const MOST_CELLS: u32 = 32;
/// Triangles that stand for all where it is asked how long they usually are.
const SAMPLE: usize = 256;
/// Cells along an axis that a triangle may usually pass.
const MOST_PASSED: f32 = 8.0;
/// Vertices or triangles that one thread looks at between two looks at the limits.
const PIECE: usize = 1 << 14;
/// The same where pieces have a grid each and no thread waits for one.
const SERIAL_PIECE: usize = 1 << 18;

/// Where a vertex is: the number of its cell in the coarse grid, or that it is outside, and beyond which sides of the common
/// box (two bits for each axis).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place(u16);

impl Place {
    const OUTSIDE: u16 = 1 << 15;

    /// Whether the vertex lies outside the other operand's box.
    #[inline]
    pub(crate) fn is_outside(self) -> bool {
        self.0 & Self::OUTSIDE != 0
    }

    /// The number of the cell of a vertex that is not outside.
    #[inline]
    pub(crate) fn cell(self) -> u32 {
        u32::from(self.0)
    }
}

/// Where the operands may meet.
#[derive(Debug)]
pub(crate) struct Overlap {
    /// The common part of the operands' boxes, if there is one.
    pub(crate) common: Option<Bounds>,
    /// The shortest side of a cell of the coarse grid, in units of the common box's frame.
    pub(crate) cell_length: f32,
    /// By side, where each vertex is; empty if all are outside the other operand's box.
    pub(crate) places: [Vec<Place>; 2],
    /// By side, the triangles that may meet the other operand or leave the common box, ascending. Of every vertex that the
    /// other operand's surface may touch, all triangles are among them.
    pub(crate) near: [Vec<u32>; 2],
    /// By side, the regions of cells that the other operand does not pass.
    pub(crate) regions: [Regions; 2],
}

impl Overlap {
    /// Finds it for operands with the given boxes.
    ///
    /// # Errors
    /// Only limits.
    pub(crate) fn new(
        sides: &[Operand<'_>; 2],
        bounds: &[Bounds; 2],
        runner: Runner<'_>,
    ) -> Result<Self, Error> {
        let Some(common) = intersection(&bounds[0], &bounds[1]) else {
            let nowhere = || Regions::of(&Occupancy::over(&Aabb::INVALID, 1));
            return Ok(Self {
                common: None,
                cell_length: f32::INFINITY,
                places: Default::default(),
                near: Default::default(),
                regions: [nowhere(), nowhere()],
            });
        };
        // 1. A coarse grid over the common part of the boxes.
        let frame = Frame::of(common.low, common.high);
        let region = Aabb { min: frame.point(&common.low), max: frame.point(&common.high) };
        let grid = Occupancy::over(&region, resolution(sides, &frame, &region));
        // 2. Where each vertex is, and which cells each surface passes.
        let seen = |side: usize| -> Result<Seen, Error> {
            let view = View { operand: &sides[side], common: &common, frame: &frame, grid: &grid };
            let places = view.places(runner)?;
            let (near, passed) = view.near(&places, runner)?;
            Ok(Seen { places, near, passed })
        };
        let (a, b) = runner.both(|| seen(0), || seen(1));
        let seen = [a?, b?];
        // 3. Triangles that touch a cell the other surface passes.
        let meeting = |side: usize| -> Result<Vec<u32>, Error> {
            let view = View { operand: &sides[side], common: &common, frame: &frame, grid: &grid };
            view.meeting(&seen[side], &seen[1 - side].passed, runner)
        };
        let (near_a, near_b) = runner.both(|| meeting(0), || meeting(1));
        let near = [near_a?, near_b?];
        // 4. The cells it does not pass, in connected regions.
        let regions = [1, 0].map(|other| Regions::of(&seen[other].passed));
        let cell_length = grid.cell_length();
        Ok(Self { common: Some(common), cell_length, places: seen.map(|seen| seen.places), near, regions })
    }
}

/// Cells along each axis of the coarse grid: up to three triangles wide, for the operand with fewer, but such that needles do
/// not pass too many.
fn resolution(sides: &[Operand<'_>; 2], frame: &Frame, region: &Aabb) -> u32 {
    let fewest = sides[0].triangles.len().min(sides[1].triangles.len());
    if fewest < DIVIDE_FROM {
        return 1;
    }
    let finest = (1 << ((fewest as f64).sqrt() / 3.0).max(1.0).log2() as u32).min(MOST_CELLS);
    let extent = (region.max - region.min).max_element();
    let longest = sides.iter().map(|side| usual_length(side, frame, region)).fold(0.0, f32::max);
    (0..)
        .map(|i| finest >> i)
        .find(|&cells| cells <= 4 || longest * cells as f32 <= MOST_PASSED * extent)
        .unwrap_or(1)
}

/// How long the parts of triangles in a region usually are.
fn usual_length(operand: &Operand<'_>, frame: &Frame, region: &Aabb) -> f32 {
    let sample = operand.triangles.iter().step_by(operand.triangles.len().div_ceil(SAMPLE));
    let (mut sum, mut count) = (0.0, 0.0f32);
    for triangle in sample {
        let [a, b, c] = triangle.map(|v| frame.point(&operand.positions[v as usize]));
        let (low, high) = (a.min(b).min(c).max(region.min), a.max(b).max(c).min(region.max));
        if low.cmple(high).all() {
            sum += (high - low).max_element();
            count += 1.0;
        }
    }
    sum / count.max(1.0)
}

/// What one operand looks like in the grid.
struct Seen {
    places: Vec<Place>,
    /// The triangles whose box meets the common box.
    near: Vec<u32>,
    /// The cells they pass.
    passed: Occupancy,
}

/// One operand, and the grid.
struct View<'a> {
    operand: &'a Operand<'a>,
    common: &'a Bounds,
    frame: &'a Frame,
    grid: &'a Occupancy,
}

impl View<'_> {
    fn places(&self, runner: Runner<'_>) -> Result<Vec<Place>, Error> {
        let positions = self.operand.positions;
        let Bounds { low, high } = self.common;
        let is_divided = self.grid.resolution() > 1;
        let place = |position: &[f64; 3]| {
            let mut beyond = 0;
            for k in 0..3 {
                beyond |= u16::from(position[k] < low[k]) << (2 * k);
                beyond |= u16::from(position[k] > high[k]) << (2 * k + 1);
            }
            if beyond != 0 {
                Place(Place::OUTSIDE | beyond)
            } else if is_divided {
                Place(self.grid.number(self.grid.cell(self.frame.point(position))) as u16)
            } else {
                Place(0)
            }
        };
        let mut places = vec![Place(0); positions.len()];
        runner.fill(&mut places, PIECE, |first, places| {
            let positions = &positions[first..];
            places.iter_mut().zip(positions).for_each(|(of, position)| *of = place(position));
        })?;
        Ok(places)
    }

    /// Triangles whose box meets the common box, and the cells they pass.
    fn near(&self, places: &[Place], runner: Runner<'_>) -> Result<(Vec<u32>, Occupancy), Error> {
        let triangles = self.operand.triangles;
        let grain = if runner.is_parallel() { PIECE } else { SERIAL_PIECE };
        let pieces = runner.pieces(triangles.len(), grain, |range| {
            let mut passed = self.grid.empty();
            let mut near = Vec::new();
            for (t, corners) in range.clone().zip(&triangles[range]) {
                let [a, b, c] = corners.map(|v| places[v as usize].0);
                let (all, any) = (a & b & c, a | b | c);
                if all & Place::OUTSIDE != 0 && all != Place::OUTSIDE {
                    continue;
                }
                near.push(t as u32);
                if any & Place::OUTSIDE != 0 {
                    let corners = self.corners(*corners);
                    passed.mark(corners.map(|corner| self.grid.cell(corner)), || corners);
                } else if a == b && b == c {
                    passed.mark_number(u32::from(a));
                } else {
                    let cells = [a, b, c].map(|place| self.grid.numbered(u32::from(place)));
                    passed.mark(cells, || self.corners(*corners));
                }
            }
            (near, passed)
        })?;
        let (near, grids): (Vec<Vec<u32>>, Vec<Occupancy>) = pieces.into_iter().unzip();
        let passed = grids.into_iter().reduce(Occupancy::united).unwrap_or_else(|| self.grid.empty());
        Ok((runner.concat(near)?, passed))
    }

    /// Those of the near triangles that touch a cell the other operand passes, or leave the common box.
    fn meeting(&self, seen: &Seen, passed: &Occupancy, runner: Runner<'_>) -> Result<Vec<u32>, Error> {
        if self.grid.resolution() == 1 {
            return Ok(seen.near.clone());
        }
        let may_meet = |t: &u32| {
            let corners = self.operand.triangles[*t as usize];
            let [a, b, c] = corners.map(|v| seen.places[v as usize].0);
            if (a | b | c) & Place::OUTSIDE != 0 {
                return true;
            }
            if a == b && b == c {
                return passed.is_number_marked(u32::from(a));
            }
            let cells = [a, b, c].map(|place| self.grid.numbered(u32::from(place)));
            passed.is_marked(cells, || self.corners(corners))
        };
        let near = &seen.near;
        Ok(runner.gather(near.len(), PIECE, 0, |range, meeting| {
            meeting.extend(near[range].iter().copied().filter(may_meet));
        })?)
    }

    fn corners(&self, triangle: [u32; 3]) -> [glam::Vec3A; 3] {
        triangle.map(|v| self.frame.point(&self.operand.positions[v as usize]))
    }
}

/// The common part of two boxes, if there is one (touching boxes have one).
fn intersection(a: &Bounds, b: &Bounds) -> Option<Bounds> {
    let low: [f64; 3] = std::array::from_fn(|k| a.low[k].max(b.low[k]));
    let high: [f64; 3] = std::array::from_fn(|k| a.high[k].min(b.high[k]));
    (0..3).all(|k| low[k] <= high[k]).then_some(Bounds { low, high })
}

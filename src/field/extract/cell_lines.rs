//! Whether a cell is simple: the lines on its faces, as far as its own eight corners show, and the one loop they form.

use glam::DVec3;
use smallvec::SmallVec;

use super::filling::{Cell, Corner};
use super::loops::{LoopLink, chain, stretches};
use super::solve::{crossing, deviation, kink, sample};
use crate::field::expression::Scratch;
/// The outline of each face of a cube, as numbers of its corners, counter-clockwise seen from outside.
fn outline(axis: usize, upper: bool) -> [usize; 4] {
    let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    if upper { [0, u, u | v, v].map(|corner| corner | 1 << axis) } else { [0, v, u | v, u] }
}

/// The lines on the faces of a cell, as far as its own eight corners show.
#[derive(Default)]
struct CellLines {
    /// Crossings of the cell's edges, which are named by two corners, the lower first.
    crossings: SmallVec<[((usize, usize), DVec3); 12]>,
    /// The lines, with the axis of their face and whether it is the upper one.
    lines: SmallVec<[(LoopLink, usize, bool); 6]>,
}

impl CellLines {
    /// `None` if a face is cut by several lines, or the lines are not one loop.
    fn new(cell: &Cell<'_>, points: &[DVec3; 8], values: &[f64; 8], scratch: &mut Scratch) -> Option<Self> {
        let mut found = Self::default();
        for axis in 0..3 {
            for upper in [false, true] {
                let corners = outline(axis, upper);
                let inside = corners.map(|corner| values[corner] > 0.0);
                let stretches = stretches(&inside);
                if stretches.len() > 1 {
                    return None;
                }
                for (enter, exit) in stretches {
                    let [from, to] = [enter, exit].map(|k| {
                        let (a, b) = (corners[k], corners[(k + 1) % 4]);
                        found.crossing(cell, (a.min(b), a.max(b)), points, values, scratch)
                    });
                    found.lines.push((LoopLink { from, to, kink: None }, axis, upper));
                }
            }
        }
        let segments: Vec<LoopLink> = found.lines.iter().map(|line| line.0).collect();
        (chain(&segments).len() == 1).then_some(found)
    }

    /// Number of the crossing of an edge, found if it is not known yet.
    fn crossing(
        &mut self,
        cell: &Cell<'_>,
        edge: (usize, usize),
        points: &[DVec3; 8],
        values: &[f64; 8],
        scratch: &mut Scratch,
    ) -> u32 {
        if let Some(known) = self.crossings.iter().position(|crossing| crossing.0 == edge) {
            return known as u32;
        }
        let (from, to) = edge;
        let at = crossing(cell.tape, points[from], points[to], [values[from], values[to]], 5, scratch);
        self.crossings.push((edge, at));
        (self.crossings.len() - 1) as u32
    }

    /// Whether all crossings lie on one branch of the field.
    fn have_one_branch(&self, cell: &Cell<'_>, scratch: &mut Scratch) -> bool {
        let first = sample(cell.tape, self.crossings[0].1, scratch).branch;
        self.crossings[1..].iter().all(|crossing| sample(cell.tape, crossing.1, scratch).branch == first)
    }

    /// The corners of the loop: crossings, and kinks where branches meet on a face.
    fn corners(&self, cell: &Cell<'_>, scratch: &mut Scratch) -> Vec<Corner> {
        let mut kinks: Vec<DVec3> = Vec::new();
        let mut segments = Vec::with_capacity(self.lines.len());
        for &(segment, axis, upper) in &self.lines {
            let ends = [segment.from, segment.to].map(|vertex| self.crossings[vertex as usize].1);
            let (mut low, mut high) = (cell.low, cell.high);
            if upper {
                low[axis] = high[axis];
            } else {
                high[axis] = low[axis];
            }
            let found = kink(cell.tape, ends, (low, high), axis, cell.tolerance, scratch);
            kinks.extend(found);
            let number = (self.crossings.len() + kinks.len() - 1) as u32;
            segments.push(LoopLink { kink: found.map(|_| number), ..segment });
        }
        chain(&segments).into_iter().next().map_or_else(Vec::new, |pieces| {
            corners_of(&pieces, |vertex| {
                let vertex = vertex as usize;
                let crossing = self.crossings.get(vertex);
                crossing.map_or_else(|| kinks[vertex - self.crossings.len()], |crossing| crossing.1)
            })
        })
    }
}

/// Whether the surface in the cell, as far as its own eight corners show, is one piece that a filling follows to within
/// the tolerance.
pub(super) fn is_simple(
    cell: &Cell<'_>,
    points: &[DVec3; 8],
    values: &[f64; 8],
    crease_may_hide: bool,
    scratch: &mut Scratch,
) -> bool {
    let Some(lines) = CellLines::new(cell, points, values, scratch) else { return false };
    if crease_may_hide && lines.have_one_branch(cell, scratch) {
        return false;
    }
    let corners = lines.corners(cell, scratch);
    for (k, corner) in corners.iter().enumerate() {
        let next = corners[(k + 1) % corners.len()];
        if deviation(cell.tape, (corner.place + next.place) * 0.5, scratch) > cell.tolerance {
            return false;
        }
    }
    let filling = cell.fill(&corners, scratch);
    cell.error(&corners, &filling, scratch) <= cell.tolerance
}

/// The corners of a loop, kinks included.
pub(super) fn corners_of(pieces: &[LoopLink], place: impl Fn(u32) -> DVec3) -> Vec<Corner> {
    let mut corners = Vec::with_capacity(pieces.len());
    for piece in pieces {
        corners.push(Corner { place: place(piece.from), vertex: piece.from, kink: false });
        if let Some(vertex) = piece.kink {
            corners.push(Corner { place: place(vertex), vertex, kink: true });
        }
    }
    corners
}

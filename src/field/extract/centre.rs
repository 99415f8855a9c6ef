//! The point that a cell is divided into tetrahedra from.
//!
//! The surface between that point and the boundary of the cell is what joins the regions of one side there. From the middle of the cell a
//! film thinner than the cell, that misses the middle, would get a tunnel, although it is whole on the boundary.

use glam::DVec3;

use super::boundaries::CellFace;
use super::lattice::{Key, unkey};
use super::octree::value_at;
use super::tables::{FaceLine, Tables};
use crate::Error;
use crate::field::expression::{Scratch, Tape};

/// Of the way from the middle of the cell to the mean of what is of one side on its boundary: where a point of that side is looked for. The
/// mean of a film's points is in the film, unless it bends a lot.
const TOWARDS: [f64; 3] = [1.0, 0.8, 0.5];
/// Of the side of the cell: how far from its boundary the point is at least, so that no tetrahedron is flat.
const INSET: f64 = 0.05;

/// A place on the boundary of a divided cell where the field's sign is known.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum SpokeEnd {
    Point(Key),
    /// The middle of a face, doubled so that it is whole.
    Face([u32; 3]),
}

/// The point to divide a cell from, and the field there: the middle, unless that is of one of two sides of which there are several regions on
/// the boundary, the other side has one, and a point of the other is found. A film stays whole so, and a gap open.
pub(super) fn centre(
    tables: &Tables<'_>,
    cell: usize,
    tape: &Tape,
    scratch: &mut Scratch,
) -> Result<(DVec3, f64), Error> {
    let (low, high) = tables.lattice.corners(tables.cells[cell].cube);
    let middle = (low + high) * 0.5;
    let value = value_at(tape, middle, scratch)?;
    let regions = Regions::of(tables, cell);
    let parting = match (regions.count(true), regions.count(false)) {
        (1, 2..) => true,
        (2.., 1) => false,
        _ => return Ok((middle, value)),
    };
    if (value > 0.0) == parting {
        return Ok((middle, value));
    }
    let mean = regions.mean(parting);
    for part in TOWARDS {
        let inset = (high - low) * INSET;
        let at = middle.lerp(mean, part).clamp(low + inset, high - inset);
        let there = value_at(tape, at, scratch)?;
        if (there > 0.0) == parting {
            return Ok((at, there));
        }
    }
    Ok((middle, value))
}

/// The places on the boundary of a cell, in regions of one side that hang together there.
#[derive(Default)]
struct Regions {
    ends: Vec<SpokeEnd>,
    places: Vec<DVec3>,
    inside: Vec<bool>,
    /// For every place the number of its region.
    regions: Vec<usize>,
}

impl Regions {
    fn of(tables: &Tables<'_>, cell: usize) -> Self {
        let mut all = Self::default();
        for CellFace { face, points, inside } in tables.boundaries.of(cell) {
            let place = |point: Key| tables.lattice.place(unkey(point));
            let around: Vec<usize> = points
                .iter()
                .zip(inside)
                .map(|(&point, &inside)| all.number(SpokeEnd::Point(point), place(point), inside))
                .collect();
            for k in 0..around.len() {
                all.join(around[k], around[(k + 1) % around.len()]);
            }
            if let Some(FaceLine::Fanned { inside, .. }) = tables.line(face) {
                let (low, high) = tables.span(face);
                let centre = all.number(SpokeEnd::Face(face.centre_doubled()), (low + high) * 0.5, *inside);
                around.iter().for_each(|&point| all.join(centre, point));
            }
        }
        all
    }

    fn number(&mut self, end: SpokeEnd, place: DVec3, inside: bool) -> usize {
        let known = self.ends.iter().position(|&other| other == end);
        known.unwrap_or_else(|| {
            self.ends.push(end);
            self.places.push(place);
            self.inside.push(inside);
            self.regions.push(self.ends.len() - 1);
            self.ends.len() - 1
        })
    }

    /// Notes that two places are next to each other: of one side, they are of one region.
    fn join(&mut self, a: usize, b: usize) {
        if self.inside[a] == self.inside[b] {
            let (kept, gone) = (self.regions[a], self.regions[b]);
            self.regions.iter_mut().filter(|region| **region == gone).for_each(|region| *region = kept);
        }
    }

    fn of_side(&self, inside: bool) -> impl Iterator<Item = usize> {
        (0..self.ends.len()).filter(move |&k| self.inside[k] == inside)
    }

    /// How many regions one side has.
    fn count(&self, inside: bool) -> usize {
        let mut regions: Vec<usize> = self.of_side(inside).map(|k| self.regions[k]).collect();
        regions.sort_unstable();
        regions.dedup();
        regions.len()
    }

    /// The mean of the places of one side, which has some.
    fn mean(&self, inside: bool) -> DVec3 {
        let count = self.of_side(inside).count();
        self.of_side(inside).map(|k| self.places[k]).sum::<DVec3>() / count as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_of_one_side_and_hang_together() {
        let mut regions = Regions::default();
        let add = |regions: &mut Regions, key: Key, inside| {
            regions.number(SpokeEnd::Point(key), DVec3::splat(key as f64), inside)
        };
        let square: Vec<usize> = (0..4).map(|key| add(&mut regions, key, key % 2 == 0)).collect();
        for k in 0..4 {
            regions.join(square[k], square[(k + 1) % 4]);
        }
        assert_eq!([true, false].map(|inside| regions.count(inside)), [2, 2]);
        // The middle of the square is inside.
        let middle = regions.number(SpokeEnd::Face([0; 3]), DVec3::splat(1.0), true);
        square.iter().for_each(|&corner| regions.join(middle, corner));
        assert_eq!([true, false].map(|inside| regions.count(inside)), [1, 2]);
        assert_eq!(regions.mean(true), DVec3::splat(1.0));
        assert_eq!(add(&mut regions, 2, true), square[2]);
    }
}

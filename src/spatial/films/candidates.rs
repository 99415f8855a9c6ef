//! The triangles that may be sides of films that are lost.

use glam::DVec3;

use super::NORMAL_SLACK;
use super::opposed::{Cells, Normals};
use crate::mesh::{BitSet, Bounds};
use crate::parallel::read_ahead;
use crate::spatial::morton::coherent_order;

/// Triangles whose least altitude is below this many steps are rounding's own: they may turn anyhow.
const LEAST_ALTITUDE: f64 = 4.0;
/// Triangles whose corners are read ahead, as where volumes are summed up.
const RUN: u32 = 16;
/// In place of the number of a cell: several.
const SEVERAL: u32 = u32::MAX - 1;
/// In place of the number of a cell: the triangle is no candidate.
const NOWHERE: u32 = u32::MAX;

/// A triangle that may be one side of a film.
pub(super) struct Candidate {
    pub(super) triangle: u32,
    pub(super) moved: bool,
    pub(super) normal: DVec3,
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Candidate {
    pub(super) fn normals(&self) -> Normals {
        Normals::of(self.normal.as_vec3().to_array(), self.moved)
    }
}

/// A surface before and after its vertices were moved.
pub(super) struct Surface<'a> {
    pub(super) before: &'a [[f64; 3]],
    pub(super) after: &'a [[f64; 3]],
    pub(super) moved: &'a BitSet,
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) step: f64,
}

impl Surface<'_> {
    fn has_moved(&self, triangle: &[u32; 3]) -> bool {
        triangle.iter().any(|&v| self.moved.contains(v))
    }

    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| DVec3::from_array(self.before[v as usize]))
    }

    /// A triangle, if it is wide enough to be a side of a film.
    #[inline]
    pub(super) fn candidate(&self, index: u32) -> Option<Candidate> {
        let triangle = &self.triangles[index as usize];
        let [a, b, c] = self.corners(triangle);
        let normal = (b - a).cross(c - a);
        // (All in squares: coordinates that single precision has room for have squares of squares that are numbers.)
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let (least, area) = (LEAST_ALTITUDE * self.step, normal.length_squared());
        let is_wide = area > least * least * longest && area.is_finite();
        is_wide.then(|| Candidate {
            triangle: index,
            moved: self.has_moved(triangle),
            normal: normal / area.sqrt(),
            low: a.min(b).min(c),
            high: a.max(b).max(c),
        })
    }

    /// For each vertex which sides of a box it lies beyond, if most lie beyond some.
    pub(super) fn sides_of_most(&self, low: DVec3, high: DVec3) -> Option<Vec<u8>> {
        let mut sides = vec![0; self.before.len()];
        Bounds { low: low.to_array(), high: high.to_array() }.mark_sides_beyond(self.before, &mut sides);
        (2 * sides.iter().filter(|&&sides| sides != 0).count() > sides.len()).then_some(sides)
    }

    /// The candidates, in an order along a curve through space; those far from every moved vertex, and from all that look the other way,
    /// left out.
    pub(super) fn candidates(&self, most_passed: usize) -> Vec<Candidate> {
        // 1. The box of all triangles that have moved. (Their corners are marked, and then read in order.)
        let mut ends = BitSet::new(self.before.len());
        let triangles = self.triangles.iter().filter(|triangle| self.has_moved(triangle));
        triangles.flatten().for_each(|&v| ends.insert(v));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for place in ends.iter().map(|v| DVec3::from_array(self.before[v as usize])) {
            (low, high) = (low.min(place), high.max(place));
        }
        let reach = 2.0 * self.step;
        (low, high) = (low - reach, high + reach);
        if !low.cmple(high).all() {
            return Vec::new();
        }
        let is_there =
            |candidate: &Candidate| candidate.high.cmpge(low).all() && candidate.low.cmple(high).all();
        // (Where hardly a vertex was moved, most triangles are wholly beyond one of its sides.)
        let sides = self.sides_of_most(low, high);
        let is_beyond = |index: u32| {
            sides.as_ref().is_some_and(|sides| {
                let [a, b, c] = self.triangles[index as usize].map(|v| sides[v as usize]);
                a & b & c != 0
            })
        };
        // 2. Which cells have nearly opposite normals. (Where triangles pass many cells each, that is not asked.)
        let around = |of: &Candidate| [of.low - reach, of.high + reach];
        let mut cells = Cells::new(low, high, self.triangles.len());
        let (mut homes, mut passed) = (Vec::with_capacity(self.triangles.len()), 0);
        for index in 0..self.triangles.len() as u32 {
            if is_beyond(index) {
                homes.push(NOWHERE);
                continue;
            }
            if sides.is_none() && index.is_multiple_of(RUN) {
                let run = self.triangles[index as usize..].iter().take(RUN as usize).flatten();
                read_ahead(run.map(|&v| self.before[v as usize][0].to_bits() as u32));
            }
            let home = match self.candidate(index).filter(is_there) {
                Some(candidate) if passed <= most_passed => {
                    let (cell, count) = cells.add(around(&candidate), &candidate.normals());
                    passed += count;
                    cell.unwrap_or(SEVERAL)
                }
                Some(_) => SEVERAL,
                None => NOWHERE,
            };
            homes.push(home);
        }
        // 3. The triangles there.
        let are_all = passed > most_passed;
        let is_opposed = |of: &Candidate| are_all || cells.is_any_opposed(around(of), NORMAL_SLACK);
        let found = (0..).zip(&homes).filter_map(|(index, &home)| match home {
            NOWHERE => None,
            SEVERAL => self.candidate(index).filter(is_opposed),
            cell if are_all || cells.is_opposed(cell, NORMAL_SLACK) => self.candidate(index),
            _ => None,
        });
        let found: Vec<Candidate> = found.collect();
        drop((cells, homes));
        let middle = |of: &Candidate| (of.low * 0.5 + of.high * 0.5).to_array();
        let middles: Vec<[f64; 3]> = found.iter().map(middle).collect();
        let mut found: Vec<Option<Candidate>> = found.into_iter().map(Some).collect();
        coherent_order(&middles).into_iter().filter_map(|index| found[index as usize].take()).collect()
    }
}

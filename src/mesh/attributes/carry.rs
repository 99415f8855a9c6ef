//! Attributes of a mesh whose triangles are triangles of other meshes, or pieces of them.
//!
//! A corner that a source triangle has too keeps its value; every other one gets what the source triangle has at its place.
//! That is a function of the source triangle and the place alone, and on an edge of the edge and the place: what a cut has
//! parted still agrees, to the bit.

use super::interpolate::Interpolator;
use super::table;
use super::{Attribute, Mesh};
use crate::control::Limit;
use crate::exact::barycentric::{Place, nearest_place};
use crate::parallel::Runner;

/// Consecutive triangles of the new mesh that come from consecutive ones of a source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// The source's place in the list of sources.
    pub(crate) source: u32,
    /// The first of its triangles.
    pub(crate) triangle: u32,
    /// How many.
    pub(crate) count: u32,
    /// Whether they face the other way.
    pub(crate) reversed: bool,
    /// Whether they are known to be those triangles, corner by corner; else they may be pieces of them.
    pub(crate) whole: bool,
}

/// A mesh that is to have attributes, and where its triangles come from, in their order.
pub(crate) struct Descent<'a> {
    pub(crate) sources: &'a [&'a Mesh],
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) runs: &'a [Run],
    /// The distance from 1 to the next number that coordinates were rounded to.
    pub(crate) unit: f64,
}

/// Where a corner's value is taken from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Taken {
    /// The source's triangle; for a new corner its place in the list of those.
    pub(super) of: u32,
    /// That triangle's corner: 0, 1 or 2; [`NEW`] for a new corner.
    pub(super) corner: u32,
}

/// See [`Taken`].
pub(super) const NEW: u32 = 3;

/// A corner that no source triangle has.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewCorner {
    /// The vertex of the new mesh.
    pub(super) vertex: u32,
    pub(super) source: u32,
    pub(super) triangle: u32,
    pub(super) reversed: bool,
    pub(super) place: Place,
}

/// Where all values are taken from.
pub(super) struct Plan<'a> {
    pub(super) of: &'a Descent<'a>,
    pub(super) interpolators: Vec<Interpolator<'a>>,
    /// The corners of all triangles of runs that are not whole.
    pub(super) taken: Vec<[Taken; 3]>,
    pub(super) new: Vec<NewCorner>,
    /// The new corners, those of a vertex side by side.
    pub(super) by_vertex: Vec<u32>,
}

/// Triangles that one thread looks at before the limits are checked: about a millisecond.
const TRIANGLES_AT_ONCE: usize = 1 << 12;

/// The attributes of the new mesh: all that some source has. O(n), a few nanoseconds for each corner that stays, and about a
/// microsecond for each that is new.
///
/// # Errors
/// Only limits.
pub(crate) fn carry(descent: &Descent<'_>, runner: Runner<'_>) -> Result<Vec<Attribute>, Limit> {
    if descent.sources.iter().all(|mesh| mesh.attributes.is_empty()) {
        return Ok(Vec::new());
    }
    let plan = Plan::new(descent, runner)?;
    table::attributes(&plan, runner)
}

impl<'a> Plan<'a> {
    fn new(of: &'a Descent<'a>, runner: Runner<'_>) -> Result<Self, Limit> {
        // 1. The triangles that may be pieces, one by one.
        let mut pieces: Vec<(u32, Run)> = Vec::new();
        let mut first = 0;
        for run in of.runs {
            if !run.whole {
                pieces.extend(
                    (0..run.count).map(|i| (first + i, Run { triangle: run.triangle + i, count: 1, ..*run })),
                );
            }
            first += run.count;
        }
        // 2. Their corners.
        let found = runner.pieces(pieces.len(), TRIANGLES_AT_ONCE, |range| {
            let (mut taken, mut new) = (Vec::with_capacity(range.len()), Vec::new());
            for &(triangle, run) in &pieces[range] {
                taken.push(of.corners(triangle, run, &mut new));
            }
            (taken, new)
        })?;
        let (mut taken, mut new) = (Vec::with_capacity(pieces.len()), Vec::new());
        for (of_piece, new_of_piece) in found {
            let offset = new.len() as u32;
            taken.extend(of_piece.into_iter().map(|corners: [Taken; 3]| {
                corners.map(|corner| match corner.corner {
                    NEW => Taken { of: corner.of + offset, ..corner },
                    _ => corner,
                })
            }));
            new.extend(new_of_piece);
        }
        // 3. By vertex: those with the same value share it.
        let mut by_vertex: Vec<u32> = (0..new.len() as u32).collect();
        by_vertex.sort_by_key(|&corner| new[corner as usize].vertex);
        let interpolators = of.sources.iter().map(|mesh| Interpolator::new(&mesh.attributes)).collect();
        Ok(Self { of, interpolators, taken, new, by_vertex })
    }
}

impl Descent<'_> {
    /// Where the corners of a triangle are taken from.
    fn corners(&self, triangle: u32, run: Run, new: &mut Vec<NewCorner>) -> [Taken; 3] {
        let source = self.sources[run.source as usize];
        let corners = source.triangles[run.triangle as usize].map(|v| source.positions[v as usize]);
        let vertices = self.triangles[triangle as usize];
        let places = vertices.map(|v| self.positions[v as usize]);
        // 1. The whole triangle, then (nearly always in order) single corners.
        let in_order = |k: usize| if run.reversed { (3 - k) % 3 } else { k };
        let taken = |corner: usize| Taken { of: run.triangle, corner: corner as u32 };
        if (0..3).all(|k| self.is_at(&corners[in_order(k)], &places[k])) {
            return [0, 1, 2].map(|k| taken(in_order(k)));
        }
        // 2. What lies elsewhere in it.
        [0, 1, 2].map(|k| {
            let same = (0..3).map(|i| in_order((k + i) % 3)).find(|&i| self.is_at(&corners[i], &places[k]));
            if let Some(corner) = same {
                return taken(corner);
            }
            let (place, _) = nearest_place(&corners, &places[k], self.unit);
            new.push(NewCorner {
                vertex: vertices[k],
                source: run.source,
                triangle: run.triangle,
                reversed: run.reversed,
                place,
            });
            Taken { of: new.len() as u32 - 1, corner: NEW }
        })
    }

    /// Whether a vertex is where a corner of a source is, or was before it was rounded to single precision.
    fn is_at(&self, corner: &[f64; 3], place: &[f64; 3]) -> bool {
        corner == place || (self.unit > f64::EPSILON && corner.map(|x| f64::from(x as f32)) == *place)
    }
}

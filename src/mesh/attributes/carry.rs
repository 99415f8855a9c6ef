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
    /// Where faces were merged, and a triangle reaches beyond the one it comes from: which other one is there.
    pub(crate) beyond: &'a Beyond<'a>,
}

/// Given a source, one of its triangles and a place beyond that: the triangle of the same plane that holds the place.
pub(crate) type Beyond<'a> = dyn Fn(u32, u32, &[f64; 3]) -> Option<u32> + Sync + 'a;

/// Where a corner of the new mesh is in a source.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CornerPlace {
    /// At a corner (0, 1 or 2) of a triangle.
    Corner(u32, usize),
    /// Elsewhere in a triangle.
    Within(u32, Place),
}

/// How far a corner may be from the triangle it comes from and still belong to it alone, in units in the last place of its
/// coordinates: what rounding and the clean-up move it by, several times over.
const BEYOND_ULPS: f64 = 32.0;

/// That distance at a place, for coordinates rounded to such a unit.
pub(crate) fn reach(p: &[f64; 3], unit: f64) -> f64 {
    BEYOND_ULPS * unit * p.iter().fold(0.0f64, |size, x| size.max(x.abs()))
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

/// The source's corner that corner `k` is, if the triangle is whole.
fn in_order(run: Run, k: usize) -> usize {
    if run.reversed { (3 - k) % 3 } else { k }
}

impl Descent<'_> {
    /// Where the corners of a triangle are taken from.
    fn corners(&self, triangle: u32, run: Run, new: &mut Vec<NewCorner>) -> [Taken; 3] {
        let vertices = self.triangles[triangle as usize];
        let places = vertices.map(|v| self.positions[v as usize]);
        let corners = self.corners_of(run.source, run.triangle);
        // 1. The whole triangle.
        if (0..3).all(|k| self.is_at(&corners[in_order(run, k)], &places[k])) {
            return [0, 1, 2].map(|k| Taken { of: run.triangle, corner: in_order(run, k) as u32 });
        }
        // 2. Corner by corner.
        [0, 1, 2].map(|k| match self.corner_place(run, k, &places[k]) {
            CornerPlace::Corner(of, corner) => Taken { of, corner: corner as u32 },
            CornerPlace::Within(triangle, place) => {
                let Run { source, reversed, .. } = run;
                new.push(NewCorner { vertex: vertices[k], source, triangle, reversed, place });
                Taken { of: new.len() as u32 - 1, corner: NEW }
            }
        })
    }

    /// Where corner `k` of a triangle that comes from the first one of a run is, its place being `p`.
    pub(crate) fn corner_place(&self, run: Run, k: usize, p: &[f64; 3]) -> CornerPlace {
        // 1. At a corner, nearly always the same one.
        let at_corner = |corners: &[[f64; 3]; 3]| {
            (0..3).map(|i| in_order(run, (k + i) % 3)).find(|&i| self.is_at(&corners[i], p))
        };
        let corners = self.corners_of(run.source, run.triangle);
        if let Some(corner) = at_corner(&corners) {
            return CornerPlace::Corner(run.triangle, corner);
        }
        // 2. In the triangle.
        let (place, off) = nearest_place(&corners, p, self.unit);
        if off <= reach(p, self.unit) {
            return CornerPlace::Within(run.triangle, place);
        }
        // 3. In another one of its plane.
        let Some(other) = (self.beyond)(run.source, run.triangle, p) else {
            return CornerPlace::Within(run.triangle, place);
        };
        let corners = self.corners_of(run.source, other);
        match at_corner(&corners) {
            Some(corner) => CornerPlace::Corner(other, corner),
            None => CornerPlace::Within(other, nearest_place(&corners, p, self.unit).0),
        }
    }

    fn corners_of(&self, source: u32, triangle: u32) -> [[f64; 3]; 3] {
        let source = self.sources[source as usize];
        source.triangles[triangle as usize].map(|v| source.positions[v as usize])
    }

    /// Whether a vertex is where a corner of a source is, or was before it was rounded to single precision.
    fn is_at(&self, corner: &[f64; 3], place: &[f64; 3]) -> bool {
        corner == place || (self.unit > f64::EPSILON && corner.map(|x| f64::from(x as f32)) == *place)
    }
}

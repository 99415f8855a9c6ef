//! Where each corner of a mesh takes its values from: a corner of a source, or a place in one of its triangles.

use super::descent::{CornerPlace, Descent, Run, in_order};
use super::interpolate::Interpolator;
use crate::control::Limit;
use crate::exact::barycentric::Place;
use crate::parallel::Runner;

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

impl<'a> Plan<'a> {
    pub(super) fn new(of: &'a Descent<'a>, runner: Runner<'_>) -> Result<Self, Limit> {
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
                taken.push(corners_taken(of, triangle, run, &mut new));
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

/// Where the corners of a triangle are taken from.
fn corners_taken(of: &Descent<'_>, triangle: u32, run: Run, new: &mut Vec<NewCorner>) -> [Taken; 3] {
    let vertices = of.triangles[triangle as usize];
    let places = vertices.map(|v| of.positions[v as usize]);
    let corners = of.corners_of(run.source, run.triangle);
    // 1. The whole triangle.
    if (0..3).all(|k| of.is_at(&corners[in_order(run, k)], &places[k])) {
        return [0, 1, 2].map(|k| Taken { of: run.triangle, corner: in_order(run, k) as u32 });
    }
    // 2. Corner by corner.
    [0, 1, 2].map(|k| match of.corner_place(run, k, &places[k]) {
        CornerPlace::Corner(of, corner) => Taken { of, corner: corner as u32 },
        CornerPlace::Within(triangle, place) => {
            let Run { source, reversed, .. } = run;
            new.push(NewCorner { vertex: vertices[k], source, triangle, reversed, place });
            Taken { of: new.len() as u32 - 1, corner: NEW }
        }
    })
}

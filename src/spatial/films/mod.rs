//! Films and gaps of a surface that moving its vertices a little closes: pairs of triangles back to back, or face to face,
//! that a plane separates before and none does after.
//!
//! Only triangles with nearly opposite normals can lie so, and on most surfaces neighbours have similar ones. A coarse grid with the
//! normals in each cell, and then a hierarchy with a box of normals beside each box of points, pass over every part without opposite
//! normals, which leaves next to nothing of a surface without thin walls (Volino, Magnenat-Thalmann 1994, cull self-collisions by
//! cones alike).

mod candidates;
mod opposed;
mod tree;

use glam::DVec3;

use crate::exact::{Sign, orient3d};
use crate::mesh::BitSet;
use crate::{Control, Limit};
use candidates::{Candidate, Surface};
use tree::Tree;

/// The cosine beyond which normals count as opposite: 8 degrees. A film is thinner than rounding and wider than several
/// times that, so its sides differ by less.
const OPPOSITE: f64 = -0.99;
/// How far components of opposite normals may be apart: 2 sin(4 degrees), and the rounding to single precision.
const NORMAL_SLACK: f32 = 0.15;
/// Pairs of nodes and of triangles looked at for each triangle before the search ends. Usual surfaces have about one; where
/// so many triangles lie within a rounding of each other, the surface is lost as a whole, and its volume tells.
const MOST_PAIRS: usize = 64;
/// Cells that triangles pass on average, at most: bounds the time of marking them where triangles are large.
const MOST_PASSED: usize = 8;

/// A pair of triangles that lost what was between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Film {
    /// The middle of one of them, before.
    pub(crate) place: [f64; 3],
    /// How far apart they were.
    pub(crate) thickness: f64,
}

/// What is no longer between triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LostFilms {
    /// Pairs with material between them, back to back.
    pub(crate) films: usize,
    /// Pairs with nothing between them, face to face.
    pub(crate) gaps: usize,
    /// The first of each in the order of the search.
    pub(crate) first_film: Option<Film>,
    pub(crate) first_gap: Option<Film>,
}

/// Looks for films and gaps between `triangles` that were there with the vertices at `before` and are not at `after`, where those in
/// `moved` are elsewhere, no coordinate being moved by more than half a `step`. O(n log n).
///
/// # Errors
/// The limits of `control`.
pub(crate) fn lost_films(
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    moved: &BitSet,
    triangles: &[[u32; 3]],
    step: f64,
    control: &Control,
) -> Result<LostFilms, Limit> {
    let surface = Surface { before, after, moved, triangles, step };
    search(&surface, MOST_PASSED * triangles.len(), control)
}

/// The same, with marks for no more than so many cells that triangles pass.
fn search(surface: &Surface<'_>, most_passed: usize, control: &Control) -> Result<LostFilms, Limit> {
    let Surface { before, after, triangles, step, .. } = *surface;
    let candidates = surface.candidates(most_passed);
    if candidates.is_empty() {
        return Ok(LostFilms::default());
    }
    let tree = Tree::new(&candidates);
    let mut search =
        Search { before, after, triangles, step, candidates: &candidates, found: LostFilms::default() };
    let most = MOST_PAIRS.saturating_mul(triangles.len());
    tree.visit_pairs(2.0 * step, most, control, |i, j| search.examine(i, j))?;
    Ok(search.found)
}

/// The search, with what it has found.
struct Search<'a> {
    before: &'a [[f64; 3]],
    after: &'a [[f64; 3]],
    triangles: &'a [[u32; 3]],
    step: f64,
    candidates: &'a [Candidate],
    found: LostFilms,
}

impl Search<'_> {
    fn examine(&mut self, i: usize, j: usize) {
        let (s, t) = (&self.candidates[i], &self.candidates[j]);
        if !(s.moved || t.moved) || s.normal.dot(t.normal) > OPPOSITE {
            return;
        }
        let (a, b) = (self.triangles[s.triangle as usize], self.triangles[t.triangle as usize]);
        let place = |v: u32| DVec3::from_array(self.before[v as usize]);
        let (p, q) = (a.map(place), b.map(place));
        let heights = |from: &Candidate, origin: DVec3, corners: &[DVec3; 3]| {
            corners.map(|corner| from.normal.dot(corner - origin))
        };
        let (over_s, over_t) = (heights(s, p[0], &q), heights(t, q[0], &p));
        let largest = |heights: &[f64; 3]| heights.iter().fold(0.0_f64, |most, h| most.max(h.abs()));
        let thickness = largest(&over_s).min(largest(&over_t));
        // Each side moves by less than a step along every axis.
        if !(thickness <= 4.0 * self.step) || !overlap(&p, &q, s.normal, 2.0 * self.step) {
            return;
        }
        if !separated(self.before, a, b) || separated(self.after, a, b) {
            return;
        }
        let film = Film { place: ((p[0] + p[1] + p[2]) / 3.0).to_array(), thickness };
        // In front of the other is face to face.
        if over_s.iter().sum::<f64>() > 0.0 {
            self.found.gaps += 1;
            self.found.first_gap.get_or_insert(film);
        } else {
            self.found.films += 1;
            self.found.first_film.get_or_insert(film);
        }
    }
}

/// Whether the plane of one triangle has the other's corners, but for common ones, strictly on one side. Exact.
fn separated(positions: &[[f64; 3]], a: [u32; 3], b: [u32; 3]) -> bool {
    let beside = |plane: [u32; 3], corners: [u32; 3]| {
        let [p, q, r] = plane.map(|v| &positions[v as usize]);
        let mut sides = corners
            .into_iter()
            .filter(|corner| !plane.iter().any(|v| v == corner))
            .map(|corner| orient3d(p, q, r, &positions[corner as usize]));
        match sides.next() {
            None | Some(Sign::Zero) => false,
            Some(side) => sides.all(|other| other == side),
        }
    };
    beside(a, b) || beside(b, a)
}

/// Whether two triangles overlap by more than `least` in every direction of the plane across `normal`.
fn overlap(p: &[DVec3; 3], q: &[DVec3; 3], normal: DVec3, least: f64) -> bool {
    let clear = |t: &[DVec3; 3], k: usize| {
        let axis = normal.cross(t[(k + 1) % 3] - t[k]).normalize_or_zero();
        let range = |corners: &[DVec3; 3]| {
            let along = corners.map(|corner| axis.dot(corner - t[k]));
            (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]))
        };
        let (x, y) = (range(p), range(q));
        x.1.min(y.1) - x.0.max(y.0) > least
    };
    (0..3).all(|k| clear(p, k) && clear(q, k))
}

#[cfg(test)]
mod tests;

//! Mending a mesh that is not closed, where what it encloses is certain all the same.
//!
//! Every step works on the chain of triangles and decides exactly: by indices, by the signs of determinants, and by the
//! distances that are rounding at the coordinates at hand. What a step would do counts only if the surface is closed in the
//! end; otherwise the mesh stays as it is.
//!
//! 1. Vertices of open edges that are a rounding apart are made one ([`seams`]), and vertices on an open edge split it
//!    ([`splits`]): first where all open edges around then cancel, in a second attempt everywhere ([`sew`]).
//! 2. Further copies of triangles are left out ([`duplicates`]).
//! 3. Fins, stray triangles and walls stored once are left out ([`cells`]).
//!
//! Holes are filled only on request ([`fill`]), where nothing else does; the fillings are refined ([`refine`]) if that is asked for as well.
//!
//! Triangles without area are left out before, where that leaves fewer edges open.

mod cells;
mod fill;
mod points;
mod refine;
mod report;
mod rings;
mod rounding;
mod seams;
mod sew;
mod soup;
mod splits;

pub(super) use refine::refine;
pub use report::Mending;
pub use soup::Readied;
pub(crate) use soup::Soup;
pub(crate) use splits::fan_around_splits;

use super::places::{Fault, Spots};
use super::{Bounds, Mesh, chain, duplicates, measure, weld};
use crate::exact::collinear;
use sew::{Sewing, Splits};

/// What may be done.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Leave {
    /// Places within this distance are one, besides those that are by rounding.
    pub(super) distance: Option<f64>,
    /// Whether parts that remain open are left out.
    pub(super) closed_parts: bool,
}

/// Triangles that are being mended, over the vertices as given.
#[derive(Clone)]
pub(super) struct Surface<'a> {
    mesh: &'a Mesh,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The given index of each triangle, or of that which it is a piece of: ascending.
    pub(super) source: Vec<u32>,
    pub(super) report: Mending,
}

/// Tries to make a closed surface of `triangles`, which are not closed, have corners in range and finite, and none twice.
/// `source` are their given indices, ascending. `None` if that cannot be done with certainty. O(n log n).
pub(super) fn mend<'a>(
    mesh: &'a Mesh,
    triangles: &[[u32; 3]],
    source: &[u32],
    leave: Leave,
) -> Option<Surface<'a>> {
    let splits = match leave.distance {
        Some(_) => &[Splits::ByRounding, Splits::ByDistance][..],
        None => &[Splits::ByRounding],
    };
    // The first of those that leave out the least.
    let all = splits.iter().filter_map(|&splits| mend_with(mesh, triangles, source, leave, splits));
    all.reduce(|best, next| if open_area(&next) < open_area(&best) { next } else { best })
}

fn open_area(surface: &Surface<'_>) -> f64 {
    surface.report.open_area
}

fn mend_with<'a>(
    mesh: &'a Mesh,
    triangles: &[[u32; 3]],
    source: &[u32],
    leave: Leave,
    splits: Splits,
) -> Option<Surface<'a>> {
    let given = Surface::new(mesh, triangles.to_vec(), source.to_vec());
    let (bare, fewer_open) = given.without_zero_area();
    let first = if fewer_open { bare.clone() } else { given.clone() };
    let (careful, mut more_to_do) = attempt(first, leave, splits, true);
    let mut found: Vec<Surface<'_>> = careful.into_iter().collect();
    if fewer_open && found.is_empty() {
        let (careful, more) = attempt(given, leave, splits, true);
        found.extend(careful);
        more_to_do |= more;
    }
    if more_to_do && found.iter().all(|surface| open_area(surface) > 0.0) {
        found.extend(attempt(bare, leave, splits, false).0);
    }
    // The first of those that leave out the least.
    found.into_iter().reduce(|best, next| if open_area(&next) < open_area(&best) { next } else { best })
}

/// The same by filling holes of up to `most` edges, after seams are joined and copies left out.
pub(super) fn mend_by_filling<'a>(
    mesh: &'a Mesh,
    triangles: &[[u32; 3]],
    source: &[u32],
    distance: Option<f64>,
    most: usize,
) -> Option<Surface<'a>> {
    let mut surface = Surface::new(mesh, triangles.to_vec(), source.to_vec());
    let splits = if distance.is_some() { Splits::ByDistance } else { Splits::ByRounding };
    sew::sew(&mut surface, Sewing { distance, splits, where_it_closes: distance.is_none() });
    if !surface.is_closed() {
        surface.drop_copies();
    }
    fill::fill(&mut surface, most);
    // A sheet and its filling enclose nothing.
    let is_body = measure::enclosed_volume(&mesh.positions, &surface.triangles) != 0.0;
    (surface.is_closed() && is_body).then_some(surface)
}

/// The least distance within which joining vertices (and splitting edges) closes the surface of `triangles`; where parts may stay
/// open, closes as much of it as any distance does, if that is more than rounding does. `None` if none up to a thousandth of its
/// size does, or if it is closed. (The least of those tried: the more is joined the more cancels, but for what is joined too much.)
pub(super) fn closing_distance(mesh: &Mesh, triangles: &[[u32; 3]], closed_parts: bool) -> Option<f64> {
    /// Parts of the size that are tried, ascending: from what single precision rounds to what is seen, four to a power of ten.
    const DIGITS: std::ops::RangeInclusive<i32> = 4..=9;
    const QUARTERS: [f64; 4] = [1.8, 3.2, 5.6, 10.0];
    const WAYS: [Splits; 2] = [Splits::ByRounding, Splits::ByDistance];
    let positions = &mesh.positions;
    let edges = weld::boundary(triangles, positions.len());
    let corners = triangles.iter().flatten().map(|&corner| &positions[corner as usize]);
    let size = Bounds::of(corners)?.diagonal();
    if edges.is_empty() {
        return None;
    }
    let usable = |distance: f64| distance > 0.0 && distance.is_finite();
    let tried: Vec<f64> = DIGITS
        .rev()
        .flat_map(|digits| QUARTERS.map(|part| size * part * 10f64.powi(-digits)))
        .filter(|&distance| usable(distance))
        .collect();
    let left_open = |distance: f64, splits| sew::left_open(positions, &edges, Some(distance), splits);
    // 1. How many edges may stay open.
    let most = if closed_parts {
        let by_rounding = sew::left_open(positions, &edges, None, Splits::ByRounding);
        let all = WAYS.iter().flat_map(|&splits| tried.iter().map(move |&distance| (distance, splits)));
        all.map(|(distance, splits)| left_open(distance, splits))
            .min()
            .filter(|&least| least < by_rounding)?
    } else {
        0
    };
    // 2. By joining vertices where that does, else by splitting edges as well.
    WAYS.into_iter().find_map(|splits| {
        let closes = |distance: f64| usable(distance) && left_open(distance, splits) <= most;
        let coarse = tried.iter().copied().find(|&distance| closes(distance))?;
        // What is joined within that distance is no further apart than one of these.
        let gaps = sew::gaps(positions, &edges, coarse);
        let least = gaps.partition_point(|&gap| !closes(gap));
        Some(gaps.get(least).copied().filter(|&gap| closes(gap)).unwrap_or(coarse))
    })
}

/// One attempt. Returns as well whether something was left undone because it would not close the surface.
fn attempt(
    mut surface: Surface<'_>,
    leave: Leave,
    splits: Splits,
    where_it_closes: bool,
) -> (Option<Surface<'_>>, bool) {
    // 1. Seams, then seams and edges with vertices on them.
    let sewing = Sewing { distance: leave.distance, splits: Splits::None, where_it_closes };
    let mut more_to_do = where_it_closes && sew::sew(&mut surface, sewing);
    if !surface.is_closed() {
        more_to_do = sew::sew(&mut surface, Sewing { splits, ..sewing });
    }
    // 2. Copies.
    if !surface.is_closed() {
        surface.drop_copies();
    }
    // 3. What bounds nothing.
    let closed = surface.is_closed() || cells::drop_unbounding(&mut surface, leave.closed_parts);
    let done = closed && surface.is_closed() && !surface.triangles.is_empty();
    (done.then_some(surface), more_to_do)
}

impl<'a> Surface<'a> {
    fn new(mesh: &'a Mesh, triangles: Vec<[u32; 3]>, source: Vec<u32>) -> Self {
        Self { mesh, triangles, source, report: Mending::default() }
    }

    fn is_closed(&self) -> bool {
        chain::examine(&self.triangles, self.mesh.positions.len()).is_ok_and(|chain| chain.closed)
    }

    /// Leaves out further copies of triangles, and opposite copies in pairs.
    fn drop_copies(&mut self) {
        let found = duplicates::find(&self.triangles, self.mesh.positions.len());
        let mut dropped = vec![false; self.triangles.len()];
        found.opposite.iter().flatten().for_each(|&triangle| dropped[triangle as usize] = true);
        found.same.iter().for_each(|pair| dropped[pair[1] as usize] = true);
        self.drop(&dropped, |report| &mut report.copies);
    }

    /// The same, known to be mended within a distance that was asked for.
    pub(super) fn within(mut self, distance: Option<f64>) -> Self {
        self.report.distance = distance;
        self
    }

    /// This surface without the triangles that have no area and an open edge, and whether that leaves fewer edges open.
    fn without_zero_area(&self) -> (Self, bool) {
        let boundary = weld::boundary(&self.triangles, self.mesh.positions.len());
        let mut open: Vec<(u32, u32)> =
            boundary.iter().map(|edge| (edge.from.min(edge.to), edge.from.max(edge.to))).collect();
        open.sort_unstable();
        let is_open = |a: u32, b: u32| open.binary_search(&(a.min(b), a.max(b))).is_ok();
        let has_none = |&[a, b, c]: &[u32; 3]| {
            let [p, q, r] = [a, b, c].map(|corner| &self.mesh.positions[corner as usize]);
            (is_open(a, b) || is_open(b, c) || is_open(c, a)) && collinear(p, q, r)
        };
        let dropped: Vec<bool> = self.triangles.iter().map(has_none).collect();
        let mut bare = self.clone();
        bare.drop(&dropped, |report| &mut report.zero_area);
        let fewer = weld::boundary(&bare.triangles, self.mesh.positions.len()).len() < boundary.len();
        (bare, fewer)
    }

    /// Leaves out the chosen triangles, counted as one kind.
    fn drop(&mut self, chosen: &[bool], kind: Kind) {
        self.drop_of_each_kind(&[(chosen, kind)]);
    }

    fn drop_of_each_kind(&mut self, kinds: &[(&[bool], Kind)]) {
        let spots = Spots { mesh: self.mesh };
        let mut report = std::mem::take(&mut self.report);
        for (chosen, kind) in kinds {
            for (&index, _) in self.source.iter().zip(*chosen).filter(|(_, chosen)| **chosen) {
                kind(&mut report).add(|| spots.triangles(&[index]));
            }
        }
        self.report = report;
        let kept = |index: usize| kinds.iter().all(|(chosen, _)| !chosen[index]);
        let mut next = 0..self.source.len();
        self.source.retain(|_| next.next().is_none_or(kept));
        let mut next = 0..self.triangles.len();
        self.triangles.retain(|_| next.next().is_none_or(kept));
    }

    /// Notes how many open parts there are and how large they are.
    fn set_aside(&mut self, chosen: &[bool], parts: usize) {
        let triangles: Vec<[u32; 3]> = self
            .triangles
            .iter()
            .zip(chosen)
            .filter(|(_, chosen)| **chosen)
            .map(|(triangle, _)| *triangle)
            .collect();
        let corners = triangles.iter().flatten().map(|&corner| &self.mesh.positions[corner as usize]);
        if let Some(bounds) = Bounds::of(corners) {
            self.report.open_area += measure::area(&self.mesh.positions, &triangles, &bounds);
        }
        self.report.open_part_count += parts;
    }
}

/// Where a kind is counted.
type Kind = fn(&mut Mending) -> &mut Fault;

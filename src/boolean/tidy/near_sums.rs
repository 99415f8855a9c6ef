//! Sums of faces that lie in one plane but for rounding.
//!
//! Faces that were flush before their bodies were turned cross wherever rounding likes, and leave films: two layers that enclose
//! nothing but rounding. As in an exact plane (`cut::plane_sums`), the faces of such a plane are added up, whichever way they look: edges
//! between them cancel, and so do layers that look opposite ways. What edges are left is what faces of other planes bound, so the
//! surface stays closed; all of it is within rounding of the plane.

use rustc_hash::FxHashMap;

use super::face::{LocalFace, LocalPoint, edge_between};
use super::flatness::is_triangle_low;
use super::flatten::Flattening;
use super::near_planes::{Looking, NearPlane, NearPlanes};
use super::patch::Patch;
use crate::boolean::complex::origin::Origin;
use crate::boolean::cut::sheet_origins::{FlatSource, SheetOrigins};
use crate::exact::{Projection, Sign, orient2d};
use crate::mesh::Buckets;
use crate::polygon::{self, Edge};
use crate::{Control, Error};

/// Adds up the faces of each plane where there is reason to: some of them are not exactly in one plane, and some were cut. Where the shapes do not
/// allow it the faces stay as they are.
///
/// # Errors
/// Only limits.
pub(super) fn add_up(patch: &mut Patch<'_>, control: &Control) -> Result<(), Error> {
    let planes = NearPlanes::of(patch, Looking::EitherWay);
    let number_of = |origin: Origin| planes.of_origin(origin).map(|(number, _)| number);
    let number = |face: LocalFace| number_of(patch[face].origin);
    let in_planes = patch.faces().filter_map(|(face, _)| Some((number(face)?, face)));
    let by_plane = Buckets::new(planes.len(), in_planes.collect::<Vec<_>>().into_iter());
    let has_films = with_films(patch, &planes);
    let mut done = Flattening::default();
    for (number, faces) in (0..).zip(by_plane.each()) {
        control.check()?;
        if !has_films[number] && !has_reason(patch, faces) {
            continue;
        }
        let plane = planes.get(number);
        if let Some(sum) = Sum::of(patch, plane, faces) {
            done = done.beside(sum.take_the_place_of(patch, faces));
        }
    }
    patch.note_flattening(done);
    patch.cancel();
    Ok(())
}

/// Which planes have faces that lie on one another, and so perhaps a film between them.
fn with_films(patch: &Patch<'_>, planes: &NearPlanes) -> Vec<bool> {
    let mut has_films = vec![false; planes.len()];
    let source = patch.source();
    for pair in source.nearly_flush {
        let both = |reversed: bool| {
            let number = |face| planes.of_origin(Origin { reversed, ..source.origin(face) }).map(|of| of.0);
            pair.map(number)
        };
        for number in [false, true].into_iter().flat_map(both).flatten() {
            has_films[number as usize] = true;
        }
    }
    has_films
}

/// Whether faces were cut, and are of one plane but not exactly.
fn has_reason(patch: &Patch<'_>, faces: &[LocalFace]) -> bool {
    let origin = |face: LocalFace| patch[face].origin;
    let was_cut = faces.iter().any(|&face| !patch[face].untouched);
    was_cut && faces.iter().any(|&face| !patch.source().are_coplanar(origin(faces[0]), origin(face)))
}

/// A triangle that is left, and whether its corners are on one line but for rounding.
type Left = ([LocalPoint; 3], Origin, bool);

/// The faces of one plane, added up.
struct Sum {
    left: Vec<Left>,
    /// How far the surface has moved at most.
    displacement: f64,
    /// Points that are no more.
    gone: u64,
}

impl Sum {
    /// `None` where the shapes do not allow it.
    fn of(patch: &mut Patch<'_>, plane: &NearPlane, faces: &[LocalFace]) -> Option<Self> {
        let seen = plane.along_axis();
        // 1. Numbers without gaps for the points.
        let mut points: Vec<LocalPoint> = faces.iter().flat_map(|&face| patch[face].corners).collect();
        points.sort_unstable();
        points.dedup();
        let known = points.len();
        let mut flat: Vec<[f64; 2]> =
            points.iter().map(|&point| seen.project(patch.position(point))).collect();
        // 2. What the sides of all wind around.
        let edges = edges(patch, faces, &points);
        let mut copies: Vec<[f64; 3]> = Vec::new();
        let mut at: FxHashMap<[u64; 2], u32> =
            (0..).zip(&flat).map(|(i, p)| (p.map(|x| (x + 0.0).to_bits()), i)).collect();
        let position = |copies: &[[f64; 3]], i: u32| match points.get(i as usize) {
            Some(&point) => *patch.position(point),
            None => copies[i as usize - known],
        };
        let found = polygon::by_winding(&mut flat, &edges, |x, y, flat| {
            let position = |i: u32| position(&copies, i);
            let crossing = crossing(seen, x.ends.map(position), y.ends.map(position))?;
            let place = seen.project(&crossing);
            Some(*at.entry(place.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                copies.push(crossing);
                flat.push(place);
                flat.len() as u32 - 1
            }))
        });
        let found = found?;
        // 3. Each triangle comes from a face around it. (One that rounding has turned over, as thin as that, comes from any.)
        let origins = origins(patch, seen, faces);
        let mut left: Vec<([u32; 3], Origin, bool)> = Vec::new();
        let slivers = found.slivers.iter().map(|&counted| (counted, true));
        let triangles = found.triangles.iter().map(|&counted| (counted, false));
        for ((triangle, winding), is_sliver) in triangles.chain(slivers) {
            let upward = winding > 0;
            let place = triangle.map(|i| flat[i as usize]);
            let origin = origins.find(place, upward).or_else(|| origins.find(place, !upward))?;
            let [a, b, c] = triangle;
            let corners = if upward { [a, b, c] } else { [a, c, b] };
            left.extend(std::iter::repeat_n((corners, origin, is_sliver), winding.unsigned_abs() as usize));
        }
        // 4. No new edge that triangles elsewhere may have as well.
        let mut is_left = vec![false; known];
        for &(corners, ..) in &left {
            corners.iter().filter(|&&i| (i as usize) < known).for_each(|&i| is_left[i as usize] = true);
        }
        let displacement =
            points.iter().map(|&point| plane.distance(patch.position(point))).fold(0.0, f64::max);
        points.extend(copies.into_iter().map(|copy| patch.add_point(copy)));
        let left = left.into_iter().map(|(corners, origin, is_flat)| {
            let corners = corners.map(|i| points[i as usize]);
            (corners, origin, is_flat || is_triangle_low(patch, corners))
        });
        let left: Vec<Left> = left.collect();
        let sides = left.iter().flat_map(|&([a, b, c], ..)| [(a, b), (b, c), (c, a)]);
        if sides.into_iter().any(|(u, v)| patch.has_outer_edge(u, v)) && adds_outer_edge(patch, faces, &left)
        {
            return None;
        }
        let gone = is_left.iter().filter(|&&is_left| !is_left).count() as u64;
        Some(Self { left, displacement: 2.0 * displacement, gone })
    }

    /// Puts the sum into the place of the faces.
    fn take_the_place_of(self, patch: &mut Patch<'_>, faces: &[LocalFace]) -> Flattening {
        faces.iter().for_each(|&face| patch.drop_face(face));
        for (corners, origin, is_flat) in self.left {
            patch.add_face(corners, origin, is_flat);
        }
        Flattening { vertices: self.gone, displacement: self.displacement }
    }
}

/// Whether triangles have a side that others outside the patch have and no face had.
fn adds_outer_edge(patch: &Patch<'_>, faces: &[LocalFace], left: &[Left]) -> bool {
    let mut before: Vec<_> = faces.iter().flat_map(|&face| patch[face].sides()).collect();
    before.sort_unstable();
    let mut sides = left.iter().flat_map(|&([a, b, c], ..)| [(a, b), (b, c), (c, a)]);
    sides.any(|(u, v)| patch.has_outer_edge(u, v) && before.binary_search(&(u, v)).is_err())
}

/// The sides of faces, by the places of their ends in a list. Those between faces that are not to be merged stay sides.
fn edges(patch: &Patch<'_>, faces: &[LocalFace], points: &[LocalPoint]) -> Vec<Edge> {
    let place = |point: LocalPoint| points.partition_point(|&other| other < point) as u32;
    let mut sides: Vec<_> = faces
        .iter()
        .flat_map(|&face| patch[face].sides().map(|(u, v)| (edge_between(u, v), u > v, patch[face].origin)))
        .collect();
    sides.sort_by_key(|&(edge, is_back, _)| (edge, is_back));
    let mut edges = Vec::with_capacity(sides.len());
    for group in sides.chunk_by(|x, y| x.0 == y.0) {
        let first = group[0].2;
        let kept = group.iter().any(|side| !patch.source().belong_together(first, side.2));
        let ((u, v), line) = (group[0].0, edges.len() as u32);
        let count = group.iter().map(|&(_, is_back, _)| if is_back { -1 } else { 1 }).sum();
        edges.push(Edge { ends: [place(u), place(v)], count, line, kept });
    }
    edges
}

/// The faces that triangles may come from.
fn origins(patch: &Patch<'_>, seen: Projection, faces: &[LocalFace]) -> SheetOrigins {
    let sources = faces.iter().filter_map(|&face| {
        let corners = patch[face].corners.map(|point| seen.project(patch.position(point)));
        let sign = orient2d(corners[0], corners[1], corners[2]);
        // A sliver may have been turned over.
        let is_useful = sign != Sign::Zero && !is_triangle_low(patch, patch[face].corners);
        let looks_up = sign == Sign::Positive;
        is_useful.then_some(FlatSource { origin: patch[face].origin, looks_up, corners })
    });
    SheetOrigins::new(sources.collect())
}

/// Where two segments of a plane cross, on the first.
fn crossing(seen: Projection, [p, q]: [[f64; 3]; 2], [a, b]: [[f64; 3]; 2]) -> Option<[f64; 3]> {
    let [from, to] = [a, b].map(|point| seen.project(&point));
    let side = |point: &[f64; 3]| {
        let [x, y] = seen.project(point);
        (to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0])
    };
    let (before, after) = (side(&p), side(&q));
    let part = before / (before - after);
    let at = std::array::from_fn(|k| p[k] + part * (q[k] - p[k]));
    (0.0..=1.0).contains(&part).then_some(at)
}

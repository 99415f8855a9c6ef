//! Points in which three faces meet: where their pairwise segments cross.
//!
//! In face f the segments with g and with h cross iff the ends of the one lie on different sides of h and the ends of the other
//! on different sides of g. One face decides for all three.

use super::crossings::Crossings;
use super::edges::Edges;
use super::surfaces::Surfaces;
use crate::Error;
use crate::boolean::complex::ids::{FaceId, SegmentId, VertexId};
use crate::boolean::complex::predicates::{Perturbed, Predicates};
use crate::exact::planes;
use crate::parallel::Runner;

/// A point in which three faces meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triple {
    /// Ascending.
    pub(crate) faces: [FaceId; 3],
    /// The segments of the faces 0 and 1, 0 and 2, 1 and 2.
    pub(crate) segments: [SegmentId; 3],
    /// By segment, whether its head lies inside the face that is not its own.
    pub(crate) head_inside: [bool; 3],
}

impl Triple {
    /// The face that is not a segment's own, and whether the segment's head lies inside it.
    #[inline]
    pub(crate) fn beside(&self, segment: SegmentId) -> (FaceId, bool) {
        let i = self.segments.iter().position(|&other| other == segment).unwrap_or_default();
        (self.faces[2 - i], self.head_inside[i])
    }
}

/// Faces that one thread looks at before the limits are checked.
const FACES_AT_ONCE: usize = 64;

/// All three-face points, by faces; and how many decisions plain coordinates left open.
///
/// # Errors
/// Only limits.
pub(crate) fn find(
    surfaces: &Surfaces,
    edges: &Edges,
    crossings: &Crossings,
    cut: &[FaceId],
    runner: Runner<'_>,
) -> Result<(Vec<Triple>, u64), Error> {
    let predicates = Predicates::new(surfaces);
    let search = Search { surfaces, edges, crossings, predicates };
    let found = runner.pieces(cut.len(), FACES_AT_ONCE, |range| {
        let mut found = Vec::new();
        cut[range].iter().for_each(|&face| search.add_lowest_of(face, &mut found));
        found
    })?;
    Ok((found.concat(), search.predicates.into_contacts()))
}

struct Search<'a> {
    surfaces: &'a Surfaces,
    edges: &'a Edges,
    crossings: &'a Crossings,
    predicates: Predicates<'a>,
}

impl Search<'_> {
    /// Adds the points of which a face is the lowest.
    fn add_lowest_of(&self, f: FaceId, found: &mut Vec<Triple>) {
        let above = |face: FaceId, floor: FaceId| {
            let all = self.crossings.of_face(face);
            let partner = |segment: &SegmentId| self.crossings.segment(*segment).partner(face);
            &all[all.partition_point(|segment| partner(segment) <= floor)..]
        };
        for &fg in above(f, f) {
            let g = self.crossings.segment(fg).partner(f);
            // The faces above g that cross both: the shorter list is looked up in the longer one.
            let (of_f, of_g) = (above(f, g), above(g, g));
            let (short, of_short, long, of_long) =
                if of_f.len() < of_g.len() { (of_f, f, of_g, g) } else { (of_g, g, of_f, f) };
            let mut rest = long;
            for &segment in short {
                let h = self.crossings.segment(segment).partner(of_short);
                let partner = |other: &SegmentId| self.crossings.segment(*other).partner(of_long);
                rest = &rest[rest.partition_point(|other| partner(other) < h)..];
                if let Some(&other) = rest.first().filter(|&other| partner(other) == h) {
                    let (fh, gh) = if of_short == f { (segment, other) } else { (other, segment) };
                    found.extend(self.meet([f, g, h], [fg, fh, gh]));
                }
            }
        }
    }

    /// Whether three faces that cross pairwise meet in a point.
    fn meet(&self, faces: [FaceId; 3], segments: [SegmentId; 3]) -> Option<Triple> {
        // With an edge in common, two segments end at its node in the third face; with a vertex in common to all, they begin
        // there.
        let [a, b, c] = faces.map(|face| self.surfaces.vertices(face));
        let common = |x: &[VertexId; 3], y: &[VertexId; 3]| x.iter().filter(|v| y.contains(v)).count();
        if common(&a, &b) > 1 || common(&a, &c) > 1 || common(&b, &c) > 1 {
            return None;
        }
        if a.iter().any(|v| b.contains(v) && c.contains(v)) {
            return None;
        }
        let is_inside =
            |point, face| self.crossings.is_inside(self.surfaces, self.edges, &self.predicates, point, face);
        let [fg, fh, gh] = segments.map(|segment| self.crossings.segment(segment));
        let head_in_h = is_inside(fg.head, faces[2]);
        if is_inside(fg.tail, faces[2]) == head_in_h {
            return None;
        }
        let head_in_g = is_inside(fh.head, faces[1]);
        if is_inside(fh.tail, faces[1]) == head_in_g {
            return None;
        }
        let head_in_f = is_inside(gh.head, faces[0]);
        debug_assert_ne!(is_inside(gh.tail, faces[0]), head_in_f, "one face decides for all three");
        Some(Triple { faces, segments, head_inside: [head_in_h, head_in_g, head_in_f] })
    }
}

/// Where a three-face point is, correctly rounded.
pub(crate) fn locate(surfaces: &Surfaces, triple: &Triple) -> [f64; 3] {
    let positions = triple.faces.map(|face| surfaces.positions(face));
    planes::meeting_filter(positions.each_ref().map(<[_; 3]>::each_ref)).unwrap_or_else(|| {
        let faces = perturbed(surfaces, triple);
        planes::meeting(faces.each_ref().map(<[_; 3]>::each_ref))
    })
}

/// The corners of the faces of a three-face point, perturbed.
pub(crate) fn perturbed(
    surfaces: &Surfaces,
    triple: &Triple,
) -> [[crate::exact::perturbed::PerturbedPoint; 3]; 3] {
    triple.faces.map(|face| surfaces.corners(face).map(|corner| surfaces.perturbed(&corner)))
}

//! Clean-up of what snapping and rounding left behind, near the intersection curve only.
//!
//! Cutting always gives a closed surface, but where bodies touch it may pass through an edge or a vertex more than once,
//! hold opposite copies of a triangle, triangles without area, and needless vertices. The steps of [`attempt`] mend that, on
//! a [`Patch`]: the pieces of cut faces and the kept triangles around their points. All else keeps its bits and its order.
//!
//! Every loop that could go on for long has a bound; where one stops with work left, the result is still closed, and
//! [`Tidied::stopped`] counts it.

mod adjacency;
mod chain;
mod edge_points;
mod face;
mod flatness;
mod flatten;
mod flip;
mod gather;
mod lines;
mod near_planes;
mod near_points;
mod near_sums;
mod patch;
mod point_grid;
mod remove_vertices;
mod separate;
mod shared_edges;
mod short_edges;
mod snap;
mod source;
mod split_faces;
mod splits;

use crate::boolean::complex::ids::{FaceId, PointId, VertexId};
use crate::boolean::complex::rounding::Rounding;
use crate::boolean::cut::piece::Piece;
use crate::parallel::Runner;
use crate::{Control, Error};
use face::LocalPoint;
pub use flatten::Flattening;
use patch::{Patch, Tidied};
use separate::Separation;
pub(crate) use source::Ground;
use source::Source;

/// Rounds of all steps at most, while triangles without area are left: removing vertices, collapsing and flipping may leave
/// some for the next round. Bounds the time where the surface around holds a triangle fast that has no area.
const MOST_ROUNDS: usize = 3;

/// Settings of the clean-up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings<'a> {
    /// Whether needless vertices are removed, and faces of one plane triangulated together.
    pub(super) remove_vertices: bool,
    /// Edges and heights that are not worth a triangle.
    pub(super) rounding: Rounding,
    /// Whether points at the same place are snapped to one where operands touch.
    pub(super) glue: bool,
    /// How many decisions plain coordinates left open: without any, nothing touches.
    pub(super) contacts: u64,
    /// Pairs of faces in one plane but for rounding, whether they cross or not.
    pub(super) nearly_flush: &'a [[FaceId; 2]],
    /// Vertices of edges of several operands that run along one another, whether anything crosses there or not.
    pub(super) along_edges: &'a [VertexId],
    /// Whether what lies in one plane but for rounding becomes one face.
    pub(super) flatten: bool,
    /// Whether to clean up even where the arrangement gives no reason to: cutting left slivers, or faces were added up.
    pub(super) always: bool,
}

/// Cleans up the pieces of a result; `None` where there is nothing to do. O(n) to look, and O(k log k) for the k triangles
/// near the curve.
///
/// # Errors
/// Those of the limits.
pub(crate) fn tidy(
    ground: Ground<'_>,
    pieces: &[Piece],
    settings: &Settings<'_>,
    runner: Runner<'_>,
) -> Result<Option<Tidied>, Error> {
    let source = Source {
        ground,
        rounding: settings.rounding,
        has_contacts: settings.contacts > 0,
        nearly_flush: if settings.flatten { settings.nearly_flush } else { &[] },
    };
    if !settings.always && settings.along_edges.is_empty() && !source.needs_clean_up() {
        return Ok(None);
    }
    runner.control.check()?;
    let mut candidates = source.points_on_coplanar_edges();
    if settings.remove_vertices {
        candidates.extend(source.representatives());
    }
    // Where an operand touches itself, triangles may come apart at points that are not wholly in the patch. Then all starts
    // again with those; each is taken in but once.
    let mut extra: Vec<PointId> = source.points_on_pinched_edges();
    extra.extend(settings.along_edges.iter().map(|&vertex| source.point_of_vertex(vertex)));
    extra.extend(source.nearly_flush.iter().flatten().flat_map(|&face| source.points_of_face(face)));
    loop {
        let patch = gather::gather(source, pieces, &extra);
        // Candidates outside the patch have nothing that changed around them.
        let local = candidates.iter().filter_map(|&point| patch.find_point(point)).collect();
        match attempt(patch, local, settings, runner.control)? {
            Attempt::Done(tidied) => return Ok(Some(tidied)),
            Attempt::Widen(points) => extra.extend(points),
        }
    }
}

/// What one attempt came to.
enum Attempt {
    Done(Tidied),
    /// The patch was too small: it must have all triangles at these vertices or nodes too.
    Widen(Vec<PointId>),
}

/// Runs all steps on a patch. The candidates are the points that may turn out to be needless.
fn attempt(
    mut patch: Patch<'_>,
    mut candidates: Vec<LocalPoint>,
    settings: &Settings<'_>,
    control: &Control,
) -> Result<Attempt, Error> {
    let has_contacts = patch.source().has_contacts;
    let merge = settings.remove_vertices;
    if has_contacts {
        flatness::mark_flat(&mut patch);
    }
    // 0. Points in one place but for rounding become one, and faces in one plane but for rounding are added up.
    if settings.flatten {
        let snapped = near_points::snap(&mut patch);
        patch.note_flattening(snapped);
        near_sums::add_up(&mut patch, control)?;
    }
    for round in 1.. {
        // 1. Triangles without area: first all those of one line at once, then what is left one by one.
        lines::remove_flat_by_line(&mut patch, merge);
        chain::remove_flat(&mut patch);
        patch.cancel();
        // 2. The ends of edges that cannot come apart become one; all points at the same place do where that is asked for.
        snap::snap_ends(&mut patch);
        if settings.glue && has_contacts && round == 1 {
            snap::snap_coincident(&mut patch);
        }
        // 3. Edges that lie on one another are subdivided alike; coplanar strips are triangulated as one.
        let half_edges = shared_edges::subdivide(&mut patch, has_contacts, merge, control)?;
        // 4. Triangles are paired at edges, and vertices with several fans are split: a 2-manifold.
        match separate::separate(&mut patch, &half_edges) {
            Separation::Connected(points) => candidates.extend(points),
            Separation::Incomplete(points) => {
                let points = points.into_iter().map(|point| patch.source_point(point));
                return Ok(Attempt::Widen(points.collect()));
            }
        }
        control.check()?;
        // 5. Needless vertices are removed.
        if settings.remove_vertices {
            flip::flip_low(&mut patch, Rounding::has_no_height);
            remove_vertices::remove_vertices(&mut patch, candidates.clone(), control)?;
        }
        // 6. Edges within rounding are collapsed, and slivers within rounding flipped; or what is in one plane but for rounding becomes
        //    one face.
        short_edges::collapse(&mut patch, false);
        if settings.flatten {
            flip::flip_slivers(&mut patch);
            flatten::flatten(&mut patch, control)?;
        } else {
            flip::flip_low(&mut patch, Rounding::is_low);
        }
        // 7. Again, if that has left triangles without area.
        let has_flat =
            if settings.flatten { flatness::has_exactly_flat(&patch) } else { flatness::has_flat(&patch) };
        if !has_flat {
            break;
        }
        if round == MOST_ROUNDS {
            patch.count_stop();
            break;
        }
    }
    Ok(Attempt::Done(patch.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::Operation;
    use crate::boolean::arrangement::Arrangement;
    use crate::boolean::arrangement::crossings::Crossings;
    use crate::boolean::arrangement::curve::Curve;
    use crate::boolean::candidates::Candidates;
    use crate::boolean::candidates::overlap::Overlap;
    use crate::boolean::classify::body::Body;
    use crate::boolean::classify::multiplicity;
    use crate::boolean::classify::winding::Windings;
    use crate::boolean::complex::origin::Origin;
    use crate::boolean::complex::{Complex, Motion, Operand};
    use crate::mesh::Bounds;

    /// Cleans up pieces with the vertices of the first of two tetrahedra that are apart, of which nothing else is kept.
    fn tidy_pieces(pieces: &[Piece]) -> Tidied {
        let (control, triangles) = (Control::default(), [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        let runner = Runner::new(&control, false);
        let corners = |x: f64| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
        let positions = [corners(0.0), corners(5.0)];
        let operands = positions.each_ref().map(|positions| Operand { positions, triangles: &triangles });
        let bounds = [0.0, 5.0].map(|x| Bounds { low: [x, 0.0, 0.0], high: [x + 1.0, 1.0, 1.0] });
        let mut overlap = Overlap::new(&operands, &bounds, runner).unwrap();
        let near = std::mem::take(&mut overlap.near);
        let complex = Complex::new(operands, [&[]; 2], Motion::Shrink, 6.0, near);
        let candidates = Candidates::new(&complex, &overlap, runner).unwrap();
        let crossings = Crossings::find(&complex, &candidates, None, runner).unwrap();
        let curve = Curve::new(&complex, crossings, &[], runner).unwrap();
        let windings = Windings::new(&curve, &overlap, &bounds, [true; 2], runner).unwrap();
        let arrangement = Arrangement::new(curve, Vec::new(), true, runner).unwrap();
        let parts = multiplicity::parts(Operation::Intersection);
        let body = Body { arrangement: &arrangement, windings: &windings, parts };
        let settings = Settings {
            remove_vertices: true,
            rounding: Rounding::up_to(6.0),
            glue: false,
            contacts: 0,
            nearly_flush: &[],
            along_edges: &[],
            flatten: false,
            always: true,
        };
        tidy(Ground::Body(body), pieces, &settings, runner).unwrap().expect("it was asked for")
    }

    fn piece(corners: [u32; 3], flat: bool) -> Piece {
        let origin = Origin { operand: 0, triangle: 0, reversed: false };
        Piece { corners: corners.map(PointId::new), origin, flat }
    }

    #[test]
    fn a_clean_up_that_stops_with_work_left_is_counted() {
        // Nothing lies beside the triangle that it could be flipped or split with.
        let tidied = tidy_pieces(&[piece([0, 2, 1], true)]);
        assert_eq!((tidied.new.len(), tidied.stopped), (1, 1));
    }

    #[test]
    fn a_clean_up_that_comes_to_an_end_is_not_counted() {
        let tidied = tidy_pieces(&[piece([0, 2, 1], false)]);
        assert_eq!((tidied.new.len(), tidied.stopped), (1, 0));
        let opposite = tidy_pieces(&[piece([0, 2, 1], false), piece([0, 1, 2], false)]);
        assert_eq!((opposite.new.len(), opposite.stopped), (0, 0));
    }
}

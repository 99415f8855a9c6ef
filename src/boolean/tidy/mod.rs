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
mod flip;
mod gather;
mod lines;
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

use crate::boolean::classify::body::Body;
use crate::boolean::complex::ids::PointId;
use crate::boolean::cut::piece::Piece;
use crate::parallel::Runner;
use crate::{Control, Error};
use face::LocalPoint;
use patch::{Patch, Tidied};
use separate::Separation;
use source::Source;

/// Rounds of all steps while triangles without area are left. Collapsing and flipping may leave some for the next round;
/// what is left after three is kept by the rest of the surface, and further rounds would leave it too.
const MOST_ROUNDS: usize = 3;

/// Settings of the clean-up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    /// Whether needless vertices are removed, and faces of one plane triangulated together.
    pub(super) remove_vertices: bool,
    /// What a rounded point can be off, in units of the coordinates: edges and heights up to this are not worth a triangle.
    pub(super) rounding: f64,
    /// Whether points at the same place are snapped to one where operands touch.
    pub(super) glue: bool,
    /// How many decisions plain coordinates left open: without any, nothing touches.
    pub(super) contacts: u64,
    /// Whether to clean up even where nothing points to work.
    pub(super) always: bool,
}

/// Cleans up the pieces of a result; `None` where there is nothing to do. O(n) to look, and O(k log k) for the k triangles
/// near the curve.
///
/// # Errors
/// Those of the limits.
pub(super) fn tidy(
    body: Body<'_>,
    pieces: &[Piece],
    settings: &Settings,
    runner: Runner<'_>,
) -> Result<Option<Tidied>, Error> {
    let source = Source { body, rounding: settings.rounding, has_contacts: settings.contacts > 0 };
    if !settings.always && !source.needs_clean_up() {
        return Ok(None);
    }
    runner.control.check()?;
    let mut candidates = source.points_on_coplanar_edges();
    if settings.remove_vertices {
        candidates.extend(source.representatives());
    }
    // Where an operand touches itself, triangles may come apart at points that are not wholly in the patch. Then all starts
    // again with those; each is taken in but once.
    let mut extra: Vec<PointId> = Vec::new();
    loop {
        let patch = gather::gather(source, pieces, &extra);
        // Candidates that are not in the patch need no look.
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
    settings: &Settings,
    control: &Control,
) -> Result<Attempt, Error> {
    let has_contacts = patch.source().has_contacts;
    let merge = settings.remove_vertices;
    if has_contacts {
        flatness::mark_flat(&mut patch);
    }
    for round in 1.. {
        // 1. Triangles without area: first all those of one line at once, then what is left one by one.
        lines::remove_flat_by_line(&mut patch, merge);
        chain::remove_flat(&mut patch);
        patch.cancel();
        // 2. Points at the same place become one, where that is asked for.
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
            flip::flip_low(&mut patch, 0.0);
            remove_vertices::remove_vertices(&mut patch, candidates.clone(), control)?;
        }
        // 6. Edges within rounding are collapsed, and slivers within rounding flipped.
        let rounding = patch.source().rounding;
        short_edges::collapse(&mut patch, rounding);
        flip::flip_low(&mut patch, rounding);
        // 7. Again, if that has left triangles without area.
        if !flatness::has_flat(&patch) {
            break;
        }
        if round == MOST_ROUNDS {
            patch.count_stop();
            break;
        }
    }
    Ok(Attempt::Done(patch.collect()))
}

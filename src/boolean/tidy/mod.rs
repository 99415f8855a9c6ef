//! Tidying what identification and rounding left behind, near the intersection curve only.
//!
//! Cutting always gives a closed surface, but where bodies touch it may pass through an edge or a vertex more than once,
//! hold opposite copies of a triangle, triangles without area, and vertices nobody needs. Five steps mend that: cancel,
//! pair (make it 2-manifold), flip, remove, collapse. They work on a patch: the pieces of cut faces and the kept triangles
//! round their points. All else keeps its bits and its order.

mod adjacency;
mod kept;
mod lines;
mod patch;
mod point_grid;
mod remove;
mod shared_edges;
mod short_edges;
mod source;
mod split_faces;
mod zero_area;

use crate::boolean::classify::body::Body;
use crate::boolean::complex::Complex;
use crate::boolean::cut::piece::Piece;
use crate::mesh::BitSet;
use crate::mesh::{HalfEdges, make_manifold};
use crate::parallel::Runner;
use crate::{Control, Error};
use patch::Patch;
use rustc_hash::FxHashSet;
use source::Source;

/// How often all steps are repeated while triangles without area are left.
const ROUNDS: usize = 3;

/// What tidying made of the pieces.
pub(super) struct Tidied {
    pub(super) new: Vec<Piece>,
    /// Uncut triangles that are replaced, by side.
    pub(super) replaced: [BitSet; 2],
    /// Positions of points made here; they are numbered after the nodes.
    pub(super) copies: Vec<[f64; 3]>,
}

/// Settings of tidying.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    /// Whether vertices that nobody needs are removed.
    pub(super) remove_vertices: bool,
    /// The size of rounding: edges and heights up to this are not worth a triangle.
    pub(super) rounding: f64,
    /// Whether points at the same place become one where operands touch.
    pub(super) glue: bool,
    /// How many decisions plain coordinates left open: without any, nothing touches.
    pub(super) contacts: u64,
    /// Whether to look even where nothing points to work.
    pub(super) always: bool,
}

/// Tidies the pieces of a body; `None` where there is nothing to do.
///
/// # Errors
/// Only limits.
pub(super) fn tidy(
    body: Body<'_>,
    pieces: &[Piece],
    settings: &Settings,
    runner: Runner<'_>,
) -> Result<Option<Tidied>, Error> {
    let cutter = &Source { body, rounding: settings.rounding, contacts: settings.contacts };
    let (planes, parts) = (body.complex(), body.parts);
    let arrangement = body.arrangement;
    let on_coplanar = arrangement.plane_faces.nodes_on_coplanar_edges();
    let mut candidates: Vec<u32> =
        on_coplanar.iter().map(|&node| arrangement.points.of_node(node).number()).collect();
    let regular = !settings.always
        && arrangement.identification.is_empty()
        && candidates.is_empty()
        && !body.windings.have_repeats(&arrangement.curve);
    if regular {
        return Ok(None);
    }
    runner.control.check()?;
    if settings.remove_vertices {
        candidates.extend(cutter.representatives());
    }
    // Where an operand touches itself, triangles may come apart at points that are not wholly in the patch. Then all starts
    // again with those; each is taken in but once.
    let mut others = FxHashSet::default();
    loop {
        let patch = Patch::new(cutter, parts, pieces, &others);
        match tidied(patch, cutter, settings, planes, candidates.clone(), runner)? {
            Ok(tidied) => return Ok(Some(tidied)),
            Err(pinched) => others.extend(pinched),
        }
    }
}

/// Runs all steps on a patch; or the points that must be wholly in it.
fn tidied(
    mut patch: Patch<'_>,
    cutter: &Source<'_>,
    settings: &Settings,
    planes: &Complex<'_>,
    mut candidates: Vec<u32>,
    runner: Runner<'_>,
) -> Result<Result<Tidied, FxHashSet<u32>>, Error> {
    // By the patch's own numbers; those that are not in it need no look.
    candidates = candidates.into_iter().filter_map(|point| patch.here(point)).collect();
    if cutter.contacts > 0 {
        zero_area::mark_flat(&mut patch, cutter);
    }
    let mergeable = settings.remove_vertices.then_some(planes);
    for round in 0..ROUNDS {
        let glue = settings.glue && round == 0;
        let copied_from = separate(&mut patch, cutter, glue, mergeable, runner.control)?;
        let pinched = patch.pinched(&copied_from);
        if !pinched.is_empty() {
            return Ok(Err(pinched.into_iter().map(|point| patch.number(point)).collect()));
        }
        candidates.extend(copied_from.into_iter().flat_map(|(copy, of)| [copy, of]));
        runner.control.check()?;
        if settings.remove_vertices {
            zero_area::flip(&mut patch, 0.0);
            remove::remove(&mut patch, planes, candidates.clone(), runner.control)?;
        }
        short_edges::collapse(&mut patch, settings.rounding);
        zero_area::flip(&mut patch, settings.rounding);
        if round + 1 == ROUNDS || !zero_area::any_flat(&patch) {
            break;
        }
    }
    Ok(Ok(patch.collect()))
}

/// Makes the patch a 2-manifold without triangles that have no area. Returns the points made, with those they are copies
/// of.
fn separate(
    patch: &mut Patch<'_>,
    cutter: &Source<'_>,
    glue: bool,
    planes: Option<&Complex<'_>>,
    control: &Control,
) -> Result<Vec<(u32, u32)>, Error> {
    lines::straighten(patch, planes);
    zero_area::split_chain(patch);
    patch.cancel();
    if glue && cutter.contacts > 0 {
        shared_edges::identify(patch);
    }
    #[cfg(debug_assertions)]
    let boundary = patch.boundary();
    let half_edges = if cutter.contacts > 0 {
        shared_edges::split(patch, cutter, planes, control)?
    } else {
        HalfEdges::of(patch)
    };
    #[cfg(debug_assertions)]
    assert_eq!(patch.boundary(), boundary, "splitting edges opened the surface");
    let copied_from = make_manifold(patch, &half_edges);
    patch.connect();
    Ok(copied_from)
}

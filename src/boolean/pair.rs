//! The pipeline for two operands, one line a step.

use crate::boolean::arrangement::Arrangement;
use crate::boolean::arrangement::crossings::Crossings;
use crate::boolean::arrangement::curve::Curve;
use crate::boolean::arrangement::nearly_flush::NearlyFlush;
use crate::boolean::arrangement::points::AddedPoint;
use crate::boolean::arrangement::sheets::{self, Rule, Touching};
use crate::boolean::candidates::Candidates;
use crate::boolean::candidates::overlap::{Overlap, Place};
use crate::boolean::classify::body::Body;
use crate::boolean::classify::multiplicity::{self, Keep, Part};
use crate::boolean::classify::winding::Windings;
use crate::boolean::complex::classes;
use crate::boolean::complex::ids::{FaceId, VertexId};
use crate::boolean::complex::operation::Operation;
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::planes::are_nearly_parallel;
use crate::boolean::complex::predicates::Perturbed;
use crate::boolean::complex::rounding::Rounding;
use crate::boolean::complex::{Complex, Motion, Operand};
use crate::boolean::cut::piece::has_low;
use crate::boolean::cut::{cut, plane_sums};
use crate::boolean::result::assemble::{Assembled, assemble};
use crate::boolean::result::origins::{Origins, Sequence};
use crate::boolean::tidy::{self, Flattening, Ground, tidy};
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::{Error, Mesh, Solid};

/// The most vertices of both operands together; the other half of all 32-bit numbers is left for crossings.
const MOST_VERTICES: usize = 1 << 31;

/// Settings of one combination.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings<'a> {
    /// Whether bodies that touch become one.
    pub(super) fuse: bool,
    /// Whether points at the same place become one where operands touch.
    pub(super) glue: bool,
    /// Whether vertices that nobody needs are removed.
    pub(super) remove_vertices: bool,
    /// Whether what lies in one plane but for rounding becomes one face.
    pub(super) flatten: bool,
    /// Whether it is asked if rounding may have made something cross.
    pub(super) find_low: bool,
    /// The result's group of each triangle of A and of B; empty if there are no groups.
    pub(super) groups: [&'a [u32]; 2],
    /// Where the triangles of A and of B come from, if attributes have to be kept.
    pub(super) attributed: Option<Attributed<'a>>,
}

/// What tells which faces have attributes in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attributed<'a> {
    /// The meshes with the attributes.
    pub(super) givens: &'a [&'a Solid],
    /// Where the triangles of A and of B come from.
    pub(super) origins: [&'a Origins; 2],
}

/// What combining two solids gives.
#[derive(Debug)]
pub(super) struct Combined {
    pub(super) arrays: Assembled,
    /// How many decisions plain coordinates left open.
    pub(super) contacts: u64,
}

/// Combines two solids. The steps are those of docs/algorithm.md.
///
/// # Errors
/// Limits, and [`Error::TooLarge`] where vertices, faces or points cannot be numbered.
pub(super) fn combine(
    operation: Operation,
    a: &Solid,
    b: &Solid,
    settings: Settings<'_>,
    runner: Runner<'_>,
) -> Result<Combined, Error> {
    let wanted = Wanted { parts: multiplicity::parts(operation), motion: motion(operation, settings.fuse) };
    combine_parts(wanted, [a.mesh(), b.mesh()], bounds(a, b), settings, runner)
}

/// What of a surface, which need not be closed, lies inside a solid, or outside it: the steps are the same, and of the solid nothing
/// is kept. Only what winds around the sheet is without meaning then, and nothing of that is asked.
///
/// # Errors
/// As [`combine`].
pub(super) fn trim(
    sheet: &Mesh,
    by: &Solid,
    keep: Keep,
    settings: Settings<'_>,
    runner: Runner<'_>,
) -> Result<Combined, Error> {
    let parts = [Part { operand: 0, keep, reversed: false }];
    let wanted = Wanted { parts: &parts, motion: Motion::Shrink };
    let bounds = [sheet.bounds(), by.bounds()].map(|bounds| bounds.unwrap_or(Bounds::NOTHING));
    combine_parts(wanted, [sheet, by.mesh()], bounds, settings, runner)
}

/// What is wanted of two surfaces.
#[derive(Clone, Copy)]
struct Wanted<'a> {
    parts: &'a [Part],
    /// Which way the first moves.
    motion: Motion,
}

fn combine_parts(
    wanted: Wanted<'_>,
    meshes: [&Mesh; 2],
    bounds: [Bounds; 2],
    settings: Settings<'_>,
    runner: Runner<'_>,
) -> Result<Combined, Error> {
    let operands = meshes
        .map(|mesh| Operand { positions: mesh.positions.as_slice(), triangles: mesh.triangles.as_slice() });
    check_size(&operands)?;
    let parts = wanted.parts;
    let _tables = runner.control.reserve(fixed_tables(&operands))?;

    // 1. Candidates: pairs of triangles that may meet.
    let mut overlap = Overlap::new(&operands, &bounds, runner)?;
    let near = std::mem::take(&mut overlap.near);
    // 2. Perturbation: the operands as one complex in general position.
    let attributed = settings.attributed.filter(|_| settings.remove_vertices);
    let sequences = attributed.map(|Attributed { origins, .. }| origins.map(Sequence::new));
    let origin = |operand: usize, face: u32| match &sequences {
        Some(sequences) => sequences[operand].at(face),
        None => Origin { operand: operand as u32, triangle: face, reversed: false },
    };
    let classes = attributed.map(|Attributed { givens, .. }| classes::Attributed { givens, origin: &origin });
    let complex = Complex::new(operands, settings.groups, wanted.motion, largest_coordinate(&bounds), near)
        .with_attributes(classes);
    let candidates = Candidates::new(&complex, &overlap, runner)?;
    // 3. Crossings: the intersection curve. Faces that touch and cannot be kept apart form sheets.
    let flush = settings.flatten.then(|| NearlyFlush::new(Rounding::up_to(complex.largest_coordinate())));
    let crossings = Crossings::find(&complex, &candidates, flush.as_ref(), runner)?;
    let nearly_flush = flush.map_or_else(Vec::new, NearlyFlush::into_pairs);
    let rule = sheet_rule(parts);
    let Touching { sheets, along_edges } =
        sheets::find_sheets(&complex, &candidates, crossings.contacts, rule, runner)?;
    drop(candidates);
    // 4. Order: the crossings along each edge, and by face.
    let curve = Curve::new(&complex, crossings, &sheets, runner)?;
    // 5. Winding numbers: what lies inside what.
    let asked = [0, 1].map(|operand| parts.iter().any(|part| part.operand == operand));
    let windings = Windings::new(&curve, &overlap, &bounds, asked, runner)?;
    // 6. Identification: crossings are located, and those that coincide become one point.
    let contacts = curve.contacts() + windings.contacts;
    let mut arrangement = Arrangement::new(curve, sheets, settings.remove_vertices, runner)?;

    let found = Found { contacts, nearly_flush: &nearly_flush, along_edges: &along_edges };
    let has_flush = !(arrangement.sheets.is_empty() && nearly_flush.is_empty());
    let mut result = Assembled::default();
    for parts in bodies(parts, settings.fuse && has_flush) {
        result = result.append(build(&mut arrangement, &windings, parts, &found, settings, runner)?)?;
    }
    Ok(Combined { arrays: result, contacts })
}

/// What was found on the way that the clean-up has to know.
#[derive(Clone, Copy)]
struct Found<'a> {
    /// How many decisions plain coordinates left open.
    contacts: u64,
    nearly_flush: &'a [[FaceId; 2]],
    along_edges: &'a [VertexId],
}

/// The sum of some parts of the result.
fn build(
    arrangement: &mut Arrangement<'_>,
    windings: &Windings,
    parts: &[Part],
    found: &Found<'_>,
    settings: Settings<'_>,
    runner: Runner<'_>,
) -> Result<Assembled, Error> {
    let rounding = Rounding::up_to(arrangement.curve.complex.largest_coordinate());
    // 7. Cutting: sheets first, then all other faces.
    let sums = plane_sums::add_up(Body { arrangement, windings, parts }, runner)?;
    arrangement
        .points
        .add(sums.crossings.into_iter().map(|crossing| AddedPoint::Crossing(Box::new(crossing))));
    let body = Body { arrangement, windings, parts };
    let cut = cut(body, &sums.done, rounding, runner)?;
    assert!(!cut.is_open, "all crossings are known");
    let mut pieces = sums.pieces;
    pieces.extend(cut.pieces);
    // 8. Tidying, near the curve only.
    let flatten = settings.flatten
        && (cut.has_slivers
            || !sums.done.is_empty()
            || !found.nearly_flush.is_empty()
            || has_nearly_parallel(arrangement));
    let tidy_settings = tidy::Settings {
        remove_vertices: settings.remove_vertices,
        rounding,
        glue: settings.glue,
        contacts: found.contacts,
        nearly_flush: found.nearly_flush,
        along_edges: found.along_edges,
        flatten,
        always: cut.has_slivers || flatten || !sums.done.is_empty(),
    };
    let tidied = tidy(Ground::Body(body), &pieces, &tidy_settings, runner)?;
    runner.control.check()?;
    // 9. The result: untouched triangles in their order, then the pieces.
    let (pieces, replaced, clean_up_stopped, flattening) = match tidied {
        None => (pieces, None, 0, Flattening::default()),
        Some(tidied) => {
            arrangement.points.add(tidied.copies.into_iter().map(AddedPoint::Copy));
            (tidied.new, Some(tidied.replaced), tidied.stopped, tidied.flattening)
        }
    };
    let body = Body { arrangement, windings, parts };
    let assembled = assemble(body, &pieces, replaced.as_ref(), runner)?;
    let has_inverted = cut.has_inverted;
    let may_cross = settings.find_low
        && (has_inverted || has_low(&pieces, rounding, |point| body.arrangement.points.position(point)));
    Ok(Assembled { has_inverted, may_cross, clean_up_stopped, flattening, ..assembled })
}

/// Whether two faces that cross lie in one plane, but for an angle that rounding can have made.
fn has_nearly_parallel(arrangement: &Arrangement<'_>) -> bool {
    let Curve { complex, crossings, .. } = &arrangement.curve;
    crossings.segments().any(|(_, segment)| {
        let [of_a, of_b] = segment.faces.map(|face| complex.positions(face));
        are_nearly_parallel(&of_a, &of_b)
    })
}

/// The parts that are summed up together. The halves of a symmetric difference share no inside and touch in the curve, so
/// they are bodies of their own; only where faces touch do walls between them have to vanish.
fn bodies(parts: &[Part], together: bool) -> std::slice::Chunks<'_, Part> {
    parts.chunks(if together { parts.len() } else { 2 })
}

/// Which way A moves.
fn motion(operation: Operation, fuse: bool) -> Motion {
    match operation {
        Operation::Union if fuse => Motion::Swell,
        // Bodies that touch come apart.
        Operation::Union | Operation::Intersection => Motion::Shrink,
        // What is taken off must grow against what it is taken from, or flush faces would leave a film.
        Operation::Difference => Motion::Shrink,
        // Faces that touch, whichever way they look, then cut one another, and can be added up.
        Operation::SymmetricDifference => Motion::Swell,
    }
}

/// Which faces that touch are added up.
fn sheet_rule(parts: &[Part]) -> Rule {
    match parts {
        // A part turned over looks the other way.
        [of_a, of_b] => Rule::AtSaddles { opposite: of_a.reversed == of_b.reversed },
        // Of a sheet alone there is nothing to add up: it moves against its front, wherever it touches the solid.
        [_] => Rule::AtSaddles { opposite: false },
        _ => Rule::All,
    }
}

/// The boxes of both; that of an empty operand meets nothing.
fn bounds(a: &Solid, b: &Solid) -> [Bounds; 2] {
    [a, b].map(|solid| solid.bounds().unwrap_or(Bounds::NOTHING))
}

fn largest_coordinate(bounds: &[Bounds; 2]) -> f64 {
    bounds.iter().flat_map(|b| b.low.iter().chain(&b.high)).fold(0.0, |most, x| most.max(x.abs()))
}

fn check_size(operands: &[Operand<'_>; 2]) -> Result<(), Error> {
    let vertices: usize = operands.iter().map(|operand| operand.positions.len()).sum();
    if vertices > MOST_VERTICES {
        return Err(Error::TooLarge { what: format!("{vertices} vertices in one operation") });
    }
    let triangles: usize = operands.iter().map(|operand| operand.triangles.len()).sum();
    if triangles >= u32::MAX as usize {
        return Err(Error::TooLarge { what: format!("{triangles} triangles in one operation") });
    }
    Ok(())
}

/// Bytes of the tables whose size the operands give: places, classes and winding numbers of vertices, the near triangles
/// (twice), the places of directions, and the result if nothing were left out.
fn fixed_tables(operands: &[Operand<'_>; 2]) -> u64 {
    const PER_VERTEX: usize = size_of::<Place>() + 5 * size_of::<u32>() + size_of::<[f64; 3]>();
    const PER_TRIANGLE: usize = 2 * size_of::<u32>() + size_of::<[u32; 3]>();
    let bytes = |of: &Operand<'_>| of.positions.len() * PER_VERTEX + of.triangles.len() * PER_TRIANGLE;
    operands.iter().map(|operand| bytes(operand) as u64).sum()
}

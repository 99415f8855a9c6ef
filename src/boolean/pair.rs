//! The pipeline for two operands, one function per step.

use rustc_hash::FxHashSet;

use crate::boolean::Operation;
use crate::boolean::arrangement::crossings;
use crate::boolean::arrangement::cut_edges::CutEdges;
use crate::boolean::arrangement::cut_faces::CutFaces;
use crate::boolean::arrangement::identify::Identification;
use crate::boolean::arrangement::plane_faces::PlaneFaces;
use crate::boolean::candidates::Candidates;
use crate::boolean::candidates::overlap::{Overlap, Place};
use crate::boolean::classify::multiplicity::{self, Part};
use crate::boolean::classify::winding;
use crate::boolean::complex::operands::{Operand, Operands};
use crate::boolean::complex::planes::Planes;
use crate::boolean::cut::Cutter;
use crate::boolean::cut::walls;
use crate::boolean::result::assemble::{Assembled, Ingredients, NewTriangle};
use crate::boolean::result::outcome::Origin;
use crate::boolean::tidy;
use crate::mesh::Bounds;
use crate::parallel::Runner;
use crate::{Error, Solid};

/// Edges and heights of new triangles up to so many units in the last place of the largest coordinate are rounding: each of
/// two points is off by less than one.
const ROUNDING_ULPS: f64 = 4.0;

/// So many vertices of both operands together leave numbers for crossings.
const MOST_VERTICES: usize = 1 << 31;

/// Settings of one combination.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings<'a> {
    /// Whether bodies that touch become one.
    pub(crate) fuse: bool,
    /// Whether points at the same place become one where operands touch.
    pub(crate) glue: bool,
    /// Whether vertices that nobody needs are removed.
    pub(crate) remove_vertices: bool,
    /// The result's group of each triangle of A and of B; empty if there are no groups.
    pub(crate) groups: [&'a [u32]; 2],
}

/// Combines two solids.
pub(crate) fn combine(
    operation: Operation,
    a: &Solid,
    b: &Solid,
    settings: Settings<'_>,
    runner: Runner<'_>,
) -> Result<Assembled, Error> {
    let (sides, bounds) = (sides(a, b), bounds(a, b));
    let vertices = sides[0].positions.len() + sides[1].positions.len();
    if vertices > MOST_VERTICES {
        return Err(Error::TooLarge { what: format!("{vertices} vertices in one operation") });
    }
    let parts = multiplicity::parts(operation);

    let _tables = runner.control.reserve(fixed_tables(&sides))?;
    let mut overlap = Overlap::new(&sides, &bounds, runner)?;
    let largest = largest_coordinate(&bounds);
    let near = std::mem::take(&mut overlap.near);
    let operands = Operands::new(sides, sense(operation, settings.fuse), largest, near);
    runner.control.check()?;

    let candidates = Candidates::new(&operands, &overlap, runner)?;
    let crossings = crossings::find(&operands, &candidates, runner)?;
    let mut edges = CutEdges::new(&operands, &crossings, runner)?;
    runner.control.check()?;
    let (faces_a, faces_b) = runner.both(
        || CutFaces::new(&operands, 0, &crossings, &edges),
        || CutFaces::new(&operands, 1, &crossings, &edges),
    );
    let mut faces = [faces_a, faces_b];
    runner.control.check()?;
    let winding_of = |side: usize| {
        winding::of_vertices(
            &operands,
            side,
            &overlap,
            &bounds[1 - side],
            &crossings,
            &edges,
            &faces[side],
            runner,
        )
    };
    let (windings_a, windings_b) = runner.both(|| winding_of(0), || winding_of(1));
    let windings = [windings_a?, windings_b?];
    let fuse = operation == Operation::SymmetricDifference && settings.fuse;
    let sheets = walls::touching_sheets(&operands, &candidates, parts, runner)?;
    drop(candidates);
    for side in 0..2 {
        let of_side = sheets.iter().flatten().filter(|face| face.0 == side).map(|face| face.1);
        faces[side].add_uncut(of_side);
    }
    let planes = Planes { operands: &operands, groups: settings.groups };
    let plane_faces = if settings.remove_vertices {
        let in_sheets: FxHashSet<(usize, u32)> = sheets.iter().flatten().copied().collect();
        let is_in_sheet = |side: usize, triangle: u32| in_sheets.contains(&(side, triangle));
        PlaneFaces::new(&planes, &crossings, &edges, &faces, is_in_sheet, runner)?
    } else {
        PlaneFaces::default()
    };
    edges.locate(&operands, &crossings, &plane_faces, runner)?;
    let identification =
        Identification::new(&operands, &crossings, &edges, &faces, &plane_faces, &sheets, runner)?;
    let rounding = ROUNDING_ULPS * f64::EPSILON * largest;
    // The halves of a symmetric difference share no inside and touch in the curve. Only where faces touch do walls between
    // them have to vanish.
    let together = if fuse && !sheets.is_empty() { parts.len() } else { 2 };
    let mut result = Assembled::default();
    for body in parts.chunks(together) {
        let mut cutter = Cutter {
            operands: &operands,
            crossings: &crossings,
            edges: &edges,
            extra: &[],
            faces: &faces,
            plane_faces: &plane_faces,
            windings: &windings,
            identification: &identification,
            rounding,
        };
        let sums = walls::add_up(&cutter, body, &sheets, runner)?;
        let with_more;
        if !sums.crossings.is_empty() {
            with_more = edges.with_more(&sums.crossings);
            cutter.edges = &with_more;
            cutter.extra = &sums.crossings;
        }
        let walls::Sums { pieces, done, .. } = &sums;
        result = result.beside(self::body(&cutter, body, pieces, done, settings, runner)?)?;
    }
    result.ties = operands.ties();
    Ok(result)
}

/// The sum of some parts of the result, tidied.
fn body(
    cutter: &Cutter<'_>,
    parts: &[Part],
    added_up: &[NewTriangle],
    done: &FxHashSet<(usize, u32)>,
    settings: Settings<'_>,
    runner: Runner<'_>,
) -> Result<Assembled, Error> {
    let (mut pieces, mut has_inverted, mut has_slivers) = (added_up.to_vec(), false, !done.is_empty());
    for &part in parts {
        let cut = cutter.cut(part, done, runner)?;
        has_inverted |= cut.has_inverted;
        has_slivers |= cut.has_slivers;
        pieces.extend(cut.pieces.into_iter().map(|piece| NewTriangle {
            corners: piece.corners,
            origin: Origin { operand: part.side as u32, triangle: piece.triangle, reversed: part.reversed },
            flat: false,
        }));
    }
    let tidy_settings = tidy::Settings {
        remove_vertices: settings.remove_vertices,
        glue: settings.glue,
        always: has_slivers,
    };
    let planes = Planes { operands: cutter.operands, groups: settings.groups };
    let tidied = tidy::tidy(cutter, &planes, parts, &pieces, &tidy_settings, runner)?;
    let (new, replaced, copies, clean_up_stopped) = match tidied {
        Some(tidied) => (tidied.new, Some(tidied.replaced), tidied.copies, tidied.stopped),
        None => (pieces, None, Vec::new(), 0),
    };
    runner.control.check()?;
    let ingredients = Ingredients {
        operands: cutter.operands,
        parts,
        faces: cutter.faces,
        windings: cutter.windings,
        identification: cutter.identification,
        edges: cutter.edges,
        new: &new,
        replaced: replaced.as_ref(),
        copies: &copies,
    };
    Ok(Assembled { has_inverted, clean_up_stopped, ..ingredients.assemble(runner)? })
}

/// Whether A swells by an infinitesimal (+1) or shrinks (-1).
fn sense(operation: Operation, fuse: bool) -> i32 {
    match operation {
        Operation::Union if fuse => 1,
        // Faces that touch, whichever way they look, then cut one another, and can be added up.
        Operation::SymmetricDifference => 1,
        _ => -1,
    }
}

fn sides<'a>(a: &'a Solid, b: &'a Solid) -> [Operand<'a>; 2] {
    [a, b].map(|solid| Operand {
        positions: solid.mesh().positions.as_slice(),
        triangles: solid.mesh().triangles.as_slice(),
    })
}

/// The boxes of both; that of an empty operand meets nothing.
fn bounds(a: &Solid, b: &Solid) -> [Bounds; 2] {
    [a, b].map(|solid| solid.bounds().unwrap_or(Bounds::NOTHING))
}

fn largest_coordinate(bounds: &[Bounds; 2]) -> f64 {
    bounds.iter().flat_map(|b| b.low.iter().chain(&b.high)).fold(0.0, |most, x| most.max(x.abs()))
}

/// Bytes of the tables whose size the operands give: places, classes and winding numbers of vertices, the near triangles
/// (twice), the places of directions, and the result if nothing were left out.
fn fixed_tables(sides: &[Operand<'_>; 2]) -> u64 {
    const PER_VERTEX: usize = size_of::<Place>() + 5 * size_of::<u32>() + size_of::<[f64; 3]>();
    const PER_TRIANGLE: usize = 2 * size_of::<u32>() + size_of::<[u32; 3]>();
    sides
        .iter()
        .map(|side| (side.positions.len() * PER_VERTEX + side.triangles.len() * PER_TRIANGLE) as u64)
        .sum()
}

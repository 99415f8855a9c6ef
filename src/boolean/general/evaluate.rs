//! From the arrangement to the arrays of a result.

use rustc_hash::FxHashSet;

use super::arrangement::General;
use super::shape::{Part, Shape};
use crate::Error;
use crate::boolean::arrangement::points::AddedPoint;
use crate::boolean::complex::ids::{FaceId, PointId};
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::planes::are_nearly_parallel;
use crate::boolean::complex::predicates::Perturbed;
use crate::boolean::complex::rounding::Rounding;
use crate::boolean::cut::piece::{Piece, has_low};
use crate::boolean::cut::plane_sums::{SheetEdge, SheetFaces, SheetSource};
use crate::boolean::cut::{Cut, Filler};
use crate::boolean::result::assemble::Assembled;
use crate::boolean::result::origins::Origins;
use crate::boolean::tidy::{self, Flattening, Ground, tidy};
use crate::exact::Projection;
use crate::mesh::BitSet;
use crate::parallel::Runner;

/// Faces that one thread cuts before the limits are checked.
const FACES_AT_ONCE: usize = 512;

/// One result of an arrangement.
#[derive(Debug)]
pub(crate) struct Evaluated {
    pub(crate) arrays: Assembled,
    /// Sheets whose faces could not be added up: walls may be left there.
    pub(crate) walls_left: u64,
}

/// How a result is finished.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Finish {
    /// Whether vertices that nobody needs are left out.
    pub(crate) remove_vertices: bool,
    /// The distance from 1 to the next number that coordinates are rounded to; what is thinner is cleaned up.
    pub(crate) unit: f64,
    /// Whether what lies in one plane but for rounding becomes one face.
    pub(crate) flatten: bool,
    /// Whether it is asked if rounding may have made something cross.
    pub(crate) find_low: bool,
}

/// The surface of the set of all labels that are `inside`.
///
/// # Errors
/// Only limits.
pub(crate) fn evaluate(
    general: &General,
    inside: &[bool],
    finish: Finish,
    runner: Runner<'_>,
) -> Result<Evaluated, Error> {
    Ok(evaluate_if_closed(general, inside, finish, runner)?.expect("all crossings are known"))
}

/// The same of an arrangement that may lack crossings; `None` where that shows, since what is kept of some face has no closed boundary.
///
/// # Errors
/// Only limits.
pub(crate) fn evaluate_if_closed(
    general: &General,
    inside: &[bool],
    finish: Finish,
    runner: Runner<'_>,
) -> Result<Option<Evaluated>, Error> {
    let rounding = Rounding::up_to(general.surfaces.largest_coordinate()).in_units_of(finish.unit);
    let mut shape = Shape::new(general, inside);
    // 1. Sheets are added up.
    let mut sums = add_up(&mut shape, runner)?;
    // 2. All other cut faces.
    let cut = cut(&shape, &sums.done, rounding, runner)?;
    if cut.is_open {
        return Ok(None);
    }
    sums.pieces.extend(cut.pieces);
    // 3. Tidying.
    let nearly_flush: &[_] = if finish.flatten { &general.crossings.nearly_flush } else { &[] };
    let flatten = finish.flatten
        && (cut.has_slivers
            || !sums.done.is_empty()
            || !nearly_flush.is_empty()
            || has_nearly_parallel(general));
    let settings = tidy::Settings {
        remove_vertices: finish.remove_vertices,
        rounding,
        // What one operand bounds from inside, another may bound from outside: where they meet in an edge, only the order round it
        // tells which faces bound the same material.
        glue: true,
        contacts: general.contacts,
        nearly_flush,
        along_edges: &general.crossings.along_edges,
        flatten,
        always: cut.has_slivers || flatten || !sums.done.is_empty(),
    };
    let tidied = tidy(Ground::Shape(&shape), &sums.pieces, &settings, runner)?;
    runner.control.check()?;
    // 4. The arrays.
    let (pieces, replaced, clean_up_stopped, flattening) = match tidied {
        None => (sums.pieces, None, 0, Flattening::default()),
        Some(tidied) => {
            shape.added.extend(tidied.copies.into_iter().map(AddedPoint::Copy));
            let [replaced, _] = tidied.replaced;
            (tidied.new, Some(replaced), tidied.stopped, tidied.flattening)
        }
    };
    let arrays = assemble(&shape, &pieces, replaced.as_ref());
    let has_inverted = cut.has_inverted;
    let may_cross =
        finish.find_low && (has_inverted || has_low(&pieces, rounding, |point| shape.position(point)));
    let arrays = Assembled { has_inverted, may_cross, clean_up_stopped, flattening, ..arrays };
    Ok(Some(Evaluated { arrays, walls_left: sums.declined }))
}

/// Whether two faces that cross lie in one plane, but for an angle that rounding can have made.
fn has_nearly_parallel(general: &General) -> bool {
    let positions = |face: FaceId| general.surfaces.positions(face);
    let mut segments = general.crossings.segments.iter();
    segments.any(|segment| {
        let [f, g] = segment.faces.map(positions);
        are_nearly_parallel(&f, &g)
    })
}

/// What is left of the faces of all sheets.
#[derive(Default)]
struct Sums {
    pieces: Vec<Piece>,
    /// The faces that have been added up.
    done: FxHashSet<FaceId>,
    /// Sheets whose shapes do not allow it.
    declined: u64,
}

/// Adds up the faces of each sheet. Where the shapes do not allow it they are left to be cut one by one, which is closed as
/// well.
fn add_up(shape: &mut Shape<'_>, runner: Runner<'_>) -> Result<Sums, Error> {
    let mut sums = Sums::default();
    let general = shape.general;
    for sheet in &general.sheets {
        runner.control.check()?;
        let mut crossings = Vec::new();
        let added = {
            let position = |point: PointId| *shape.position(point);
            let (mut edges, mut lines, mut sources) = (Vec::new(), Vec::new(), Vec::new());
            for &face in sheet {
                let corners = general.surfaces.positions(face);
                let first = lines.len() as u32;
                lines.extend((0..3).map(|k| [corners[k], corners[(k + 1) % 3]]));
                shape.for_boundary(face, Part::Both, |ends, side, count| {
                    let line = match side {
                        Some(k) => first + k as u32,
                        None => {
                            lines.push(ends.map(position));
                            lines.len() as u32 - 1
                        }
                    };
                    edges.push(SheetEdge { ends, count, line });
                });
                let source = |reversed| SheetSource { origin: shape.origin(face, reversed), corners };
                sources.extend([false, true].map(source));
            }
            let next = shape.next();
            let group = |&face: &FaceId| general.surfaces.group(face);
            let keep_borders = sheet.iter().any(|face| group(face) != group(&sheet[0]));
            let (position, crossings) = (&position, &mut crossings);
            SheetFaces { edges, lines, sources, keep_borders, position, next, crossings }.triangles()
        };
        match added {
            Some(left) => {
                sums.pieces.extend(left);
                shape.added.extend(crossings.into_iter().map(|of| AddedPoint::Crossing(Box::new(of))));
                sums.done.extend(sheet);
                sheet.iter().for_each(|face| shape.parted.insert(face.number()));
            }
            None => sums.declined += 1,
        }
    }
    Ok(sums)
}

/// The pieces of all cut faces but those `done` otherwise.
fn cut(
    shape: &Shape<'_>,
    done: &FxHashSet<FaceId>,
    rounding: Rounding,
    runner: Runner<'_>,
) -> Result<Cut, Error> {
    let general = shape.general;
    let cuts = runner.pieces(general.cut.len(), FACES_AT_ONCE, |range| {
        let (mut cut, mut filler) = (Cut::default(), Filler::default());
        for &face in &general.cut[range] {
            if !done.contains(&face) {
                cut_face(shape, face, rounding, &mut filler, &mut cut);
            }
        }
        cut
    })?;
    let mut all = Cut::default();
    cuts.into_iter().for_each(|cut| all.append(cut));
    Ok(all)
}

/// What a cut face keeps, and what of it is turned over.
fn cut_face(shape: &Shape<'_>, face: FaceId, rounding: Rounding, filler: &mut Filler, cut: &mut Cut) {
    let seen = Projection::of(&shape.general.surfaces.positions(face));
    for (part, seen) in [(Part::Kept, seen), (Part::Reversed, seen.reversed())] {
        let reversed = part == Part::Reversed;
        if reversed && !shape.has_reversed(face) {
            continue;
        }
        filler.boundary.clear();
        shape.for_boundary(face, part, |[from, to], _, count| {
            let edge = if (count > 0) != reversed { [from, to] } else { [to, from] };
            filler.boundary.extend(std::iter::repeat_n(edge, count.unsigned_abs() as usize));
        });
        let origin = shape.origin(face, reversed);
        filler.fill(|point| shape.position(point), seen, origin, rounding, cut);
    }
}

/// The arrays of whole faces and pieces.
fn assemble(shape: &Shape<'_>, pieces: &[Piece], replaced: Option<&BitSet>) -> Assembled {
    let general = shape.general;
    let is_whole = |face: FaceId| !replaced.is_some_and(|replaced| replaced.contains(face.number()));
    // 1. Which points are used, and their numbers.
    let mut numbers = vec![u32::MAX; shape.next().index()];
    shape.for_each_kept(|face, points, _| {
        if is_whole(face) {
            points.iter().for_each(|point| numbers[point.index()] = 0);
        }
    });
    pieces.iter().flat_map(|piece| piece.corners).for_each(|point| numbers[point.index()] = 0);
    let mut positions = Vec::new();
    for (point, number) in (0..).map(PointId::new).zip(&mut numbers) {
        if *number == 0 {
            *number = positions.len() as u32;
            positions.push(*shape.position(point));
        }
    }
    // 2. The triangles.
    let (mut triangles, mut origins) = (Vec::new(), Origins::default());
    let surfaces = &general.surfaces;
    let mut add = |[a, b, c]: [PointId; 3], face: FaceId, reversed: bool| {
        triangles.push([a, b, c].map(|point| numbers[point.index()]));
        origins.push(Origin { operand: surfaces.owner(face), triangle: surfaces.triangle(face), reversed });
    };
    shape.for_each_kept(|face, [a, b, c], count| {
        if is_whole(face) {
            let corners = if count < 0 { [a, c, b] } else { [a, b, c] };
            (0..count.unsigned_abs()).for_each(|_| add(corners, face, count < 0));
        }
    });
    for piece in pieces {
        add(piece.corners, FaceId::new(piece.origin.triangle), piece.origin.reversed);
    }
    let faces = pieces.iter().map(|piece| (FaceId::new(piece.origin.triangle), piece.origin.reversed));
    let origin = |(face, reversed)| Origin {
        operand: surfaces.owner(face),
        triangle: surfaces.triangle(face),
        reversed,
    };
    let mut cut: Vec<Origin> = faces.map(origin).collect();
    cut.dedup();
    Assembled { positions, triangles, origins, cut, ..Assembled::default() }
}

//! Fillings of all cells put together.

use glam::DVec3;

use super::boundaries::CellFace;
use super::cell_lines::corners_of;
use super::centre::{SpokeEnd, centre};
use super::filling::{Cell, Corner};
use super::lattice::{Key, unkey};
use super::loops::{LoopLink, chain, stretches};
use super::solve::{crossing, deviation};
use super::tables::{FaceLine, Tables};
use super::tetrahedra;
use crate::field::expression::Scratch;
use crate::field::work;
use crate::{Control, Error, Mesh};

/// Vertices inside cells are numbered from here until all are known.
const WITHIN: u32 = 1 << 31;

/// What a cell adds to the surface.
#[derive(Default)]
struct CellSurface {
    /// Vertices inside the cell.
    places: Vec<DVec3>,
    /// Triangles; vertices of the cell itself are `WITHIN` plus their position in `places`.
    triangles: Vec<[u32; 3]>,
    deviation: f64,
}

/// The surface, and for every cell the largest deviation found at the middles of its triangles.
pub(super) fn assemble(tables: &Tables<'_>, control: &Control) -> Result<(Mesh, Vec<f64>), Error> {
    let pieces = work::pieces(tables.cells.len(), 32, control, "surface", |range| {
        let mut scratch = Scratch::default();
        range
            .map(|cell| surface_of_cell(tables, cell, &mut scratch))
            .collect::<Result<Vec<CellSurface>, Error>>()
    })?;
    let mut mesh = Mesh::new(tables.places.iter().map(DVec3::to_array).collect(), Vec::new());
    let mut deviations = Vec::with_capacity(tables.cells.len());
    for piece in pieces.into_iter().flatten() {
        let first = u32::try_from(mesh.positions.len()).ok().filter(|&first| first < WITHIN);
        let Some(first) = first else {
            return Err(Error::TooLarge { what: "the surface has more than 2^31 vertices".into() });
        };
        let final_number = |vertex: u32| if vertex < WITHIN { vertex } else { first + (vertex - WITHIN) };
        mesh.positions.extend(piece.places.iter().map(DVec3::to_array));
        mesh.triangles.extend(piece.triangles.iter().map(|triangle| triangle.map(final_number)));
        deviations.push(piece.deviation);
    }
    drop_unused(&mut mesh);
    Ok((mesh, deviations))
}

fn surface_of_cell(tables: &Tables<'_>, cell: usize, scratch: &mut Scratch) -> Result<CellSurface, Error> {
    let mut piece = if tables.divided[cell] {
        tetrahedral(tables, cell, scratch)?
    } else {
        patched(tables, cell, scratch)?
    };
    let tape = tables.tape(cell)?;
    for triangle in &piece.triangles {
        let [a, b, c] = triangle.map(|vertex| match vertex {
            vertex if vertex < WITHIN => tables.places[vertex as usize],
            vertex => piece.places[(vertex - WITHIN) as usize],
        });
        piece.deviation = piece.deviation.max(deviation(tape, (a + b + c) / 3.0, scratch));
    }
    Ok(piece)
}

/// The fillings of a cell whose faces are cut in one line each.
fn patched(tables: &Tables<'_>, cell: usize, scratch: &mut Scratch) -> Result<CellSurface, Error> {
    let mut segments = Vec::new();
    for side in tables.boundaries.of(cell) {
        lines(tables, side, &mut segments);
    }
    let (low, high) = tables.lattice.corners(tables.cells[cell].cube);
    let shape = Cell { tape: tables.tape(cell)?, low, high, tolerance: tables.tolerance };
    let mut piece = CellSurface::default();
    for pieces in chain(&segments) {
        let corners: Vec<Corner> = corners_of(&pieces, |vertex| tables.places[vertex as usize]);
        if corners.len() < 3 {
            continue;
        }
        let filling = shape.fill(&corners, scratch);
        let apex = WITHIN + piece.places.len() as u32;
        piece.places.extend(filling.apex);
        piece.triangles.extend(
            filling.triangles.iter().map(|triangle| {
                triangle.map(|k| corners.get(k as usize).map_or(apex, |corner| corner.vertex))
            }),
        );
    }
    Ok(piece)
}

/// The lines in which the surface cuts a face, directed so that the inside is on the right seen from outside.
fn lines(tables: &Tables<'_>, side: CellFace<'_>, segments: &mut Vec<LoopLink>) {
    let CellFace { face, points: outline, inside } = side;
    // Most faces are not cut.
    if inside.iter().all(|&point| point == inside[0]) {
        return;
    }
    let next = |k: usize| outline[(k + 1) % outline.len()];
    match tables.line(face) {
        None => {}
        Some(FaceLine::Plain { kink }) => {
            for (enter, exit) in stretches(inside) {
                let from = tables.on_edge(outline[enter], next(enter));
                let to = tables.on_edge(outline[exit], next(exit));
                segments.push(LoopLink { from, to, kink: *kink });
            }
        }
        Some(FaceLine::Fanned { inside: middle, spokes }) => {
            for k in 0..outline.len() {
                let (a, b) = (outline[k], next(k));
                let vertex = |edge: usize| match edge {
                    0 => tables.on_edge(a, b),
                    1 => spoke(spokes, b),
                    _ => spoke(spokes, a),
                };
                let signs = [inside[k], inside[(k + 1) % outline.len()], *middle];
                for (enter, exit) in stretches(&signs) {
                    segments.push(LoopLink { from: vertex(enter), to: vertex(exit), kink: None });
                }
            }
        }
    }
}

/// The vertex between a face's middle and a point of its outline.
fn spoke(spokes: &[(Key, u32)], point: Key) -> u32 {
    spokes.iter().find(|spoke| spoke.0 == point).map_or(0, |spoke| spoke.1)
}

/// The surface in a cell divided into tetrahedra from a point in it over its faces' triangles.
fn tetrahedral(tables: &Tables<'_>, cell: usize, scratch: &mut Scratch) -> Result<CellSurface, Error> {
    let tape = tables.tape(cell)?;
    let (middle, value) = centre(tables, cell, tape, scratch)?;
    let mut piece = CellSurface::default();
    // Vertices between that point and a lattice point or the middle of a face.
    let mut within: Vec<(SpokeEnd, u32)> = Vec::new();
    for CellFace { face, points: outline, inside } in tables.boundaries.of(cell) {
        let (face_low, face_high) = tables.span(face);
        let face_middle = (face_low + face_high) * 0.5;
        let fan = tables.line(face);
        let face_inside = match fan {
            Some(FaceLine::Fanned { inside: middle, .. }) => *middle,
            _ => inside[0],
        };
        for k in 0..outline.len() {
            let (a, b) = (outline[k], outline[(k + 1) % outline.len()]);
            let corners =
                [(0, inside[k]), (1, inside[(k + 1) % outline.len()]), (2, face_inside), (3, value > 0.0)];
            let cut = |p: u32, q: u32| {
                let (p, q) = (p.min(q), p.max(q));
                let outer = match p {
                    0 => SpokeEnd::Point(a),
                    1 => SpokeEnd::Point(b),
                    _ => SpokeEnd::Face(face.centre_doubled()),
                };
                match (p, q, fan) {
                    (0, 1, _) => tables.on_edge(a, b),
                    (_, 2, Some(FaceLine::Fanned { spokes, .. })) => {
                        spoke(spokes, if p == 0 { a } else { b })
                    }
                    _ => *inner_vertex(&mut within, &mut piece.places, outer, || {
                        let (place, outer_value) = match outer {
                            SpokeEnd::Point(point) => {
                                (tables.lattice.place(unkey(point)), tables.value(point))
                            }
                            SpokeEnd::Face(_) => (face_middle, tape.value(face_middle.to_array(), scratch)),
                        };
                        // A face's middle may have another sign than its outline suggests; then half-way.
                        if (outer_value > 0.0) == (value > 0.0) {
                            (middle + place) * 0.5
                        } else {
                            crossing(tape, middle, place, [value, outer_value], 60, scratch)
                        }
                    }),
                }
            };
            tetrahedra::add(corners, cut, &mut piece.triangles);
        }
    }
    Ok(piece)
}

fn inner_vertex<'v>(
    known: &'v mut Vec<(SpokeEnd, u32)>,
    places: &mut Vec<DVec3>,
    outer: SpokeEnd,
    place: impl FnOnce() -> DVec3,
) -> &'v u32 {
    let at = known.iter().position(|entry| entry.0 == outer).unwrap_or_else(|| {
        known.push((outer, WITHIN + places.len() as u32));
        places.push(place());
        known.len() - 1
    });
    &known[at].1
}

/// Leaves out vertices that no triangle uses, such as kinks next to cells that ended up flat.
fn drop_unused(mesh: &mut Mesh) {
    let mut number = vec![u32::MAX; mesh.positions.len()];
    for &vertex in mesh.triangles.iter().flatten() {
        number[vertex as usize] = 0;
    }
    let mut kept = Vec::with_capacity(mesh.positions.len());
    for (position, number) in mesh.positions.iter().zip(&mut number) {
        if *number == 0 {
            *number = kept.len() as u32;
            kept.push(*position);
        }
    }
    mesh.positions = kept;
    for triangle in &mut mesh.triangles {
        *triangle = triangle.map(|vertex| number[vertex as usize]);
    }
}

//! Sums of the faces of a plane, where perturbation cannot keep faces that touch apart (`arrangement::sheets`).
//!
//! The kept pieces of all faces of a sheet are added up, with multiplicities, before they are triangulated: what cancels is
//! gone. Where the perturbation moves faces apart instead of through each other (at saddles), their edges do not cross, but
//! do so in the sum. Such crossings get a point, rounded once like the others.

use rustc_hash::{FxHashMap, FxHashSet};

use super::piece::Piece;
use super::sheet_origins::{FlatSource, SheetOrigins};
use crate::Error;
use crate::boolean::arrangement::points::SheetCrossing;
use crate::boolean::arrangement::sheets::Sheet;
use crate::boolean::classify::body::Body;
use crate::boolean::complex::ids::{FaceId, PointId};
use crate::boolean::complex::origin::Origin;
use crate::exact::perturbed::PerturbedPoint;
use crate::exact::{Projection, Sign, orient2d, position};
use crate::parallel::Runner;
use crate::polygon;

/// What is left of the faces of all sheets.
#[derive(Debug, Default)]
pub(crate) struct Sums {
    pub(crate) pieces: Vec<Piece>,
    /// The faces that have been added up.
    pub(crate) done: FxHashSet<FaceId>,
    /// Points where edges cross that the perturbation kept apart; they are numbered after all others.
    pub(crate) crossings: Vec<SheetCrossing>,
}

/// Adds up the faces of each sheet. Where the shapes do not allow it, its faces are left to be cut one by one, which is
/// closed as well.
///
/// # Errors
/// Only limits.
pub(crate) fn add_up(body: Body<'_>, runner: Runner<'_>) -> Result<Sums, Error> {
    let mut sums = Sums::default();
    for (i, sheet) in body.arrangement.sheets.iter().enumerate() {
        if i % SHEETS_AT_ONCE == 0 {
            runner.control.check()?;
        }
        let before = sums.crossings.len();
        let position = |point: PointId| *body.arrangement.points.position(point);
        let faces = faces_of_sheet(body, sheet, &position, &mut sums.crossings);
        match faces.and_then(SheetFaces::triangles) {
            Some(left) => {
                sums.pieces.extend(left);
                sums.done.extend(sheet);
            }
            None => sums.crossings.truncate(before),
        }
    }
    Ok(sums)
}

/// Sheets that are added up before the limits are checked: they are small, a handful of faces each.
const SHEETS_AT_ONCE: usize = 64;

/// One directed edge of a face of a sheet: its ends, how often it counts, and the line it is a part of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetEdge {
    pub(crate) ends: [PointId; 2],
    pub(crate) count: i32,
    /// Its place among the lines of the sheet.
    pub(crate) line: u32,
}

/// A face of a sheet that pieces can come from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetSource {
    pub(crate) origin: Origin,
    /// The corners of the face, as it is (not turned over, even if the origin is).
    pub(crate) corners: [[f64; 3]; 3],
}

/// The faces of one sheet, to be added up.
pub(crate) struct SheetFaces<'a> {
    /// The boundaries of what is kept of all faces.
    pub(crate) edges: Vec<SheetEdge>,
    /// Whole edges, of which those of the sheet are parts.
    pub(crate) lines: Vec<[[f64; 3]; 2]>,
    pub(crate) sources: Vec<SheetSource>,
    /// Whether faces are to stay apart from each other: they belong to different groups or classes.
    pub(crate) keep_borders: bool,
    /// Where a point is.
    pub(crate) position: &'a dyn Fn(PointId) -> [f64; 3],
    /// The number that the first of `crossings` has.
    pub(crate) next: PointId,
    /// Points where edges cross that the perturbation kept apart.
    pub(crate) crossings: &'a mut Vec<SheetCrossing>,
}

/// The sum of the faces of one sheet of a body.
fn faces_of_sheet<'a>(
    body: Body<'_>,
    sheet: &Sheet,
    position: &'a dyn Fn(PointId) -> [f64; 3],
    crossings: &'a mut Vec<SheetCrossing>,
) -> Option<SheetFaces<'a>> {
    let complex = body.complex();
    let (mut edges, mut lines, mut sources) = (Vec::new(), Vec::new(), Vec::new());
    // Every face's boundary, each edge with the line it is a part of: a side of the face, or a segment.
    for &id in sheet {
        let (operand, _) = complex.triangle(id);
        let face = body.arrangement.curve.faces[operand].find(id)?;
        let corners = complex.positions(id);
        let first = lines.len() as u32;
        lines.extend((0..3).map(|k| [corners[k], corners[(k + 1) % 3]]));
        for part in body.parts_of(operand) {
            body.for_boundary(part, face, |ends, of_side, count| {
                let line = match of_side {
                    Some(k) => first + k as u32,
                    None => {
                        lines.push(ends.map(position));
                        lines.len() as u32 - 1
                    }
                };
                edges.push(SheetEdge { ends, count: count as i32, line });
            });
            sources.push(SheetSource { origin: complex.origin(id, part.reversed), corners });
        }
    }
    let origin = |face: FaceId| complex.origin(face, false);
    let keep_borders = sheet.iter().any(|&face| !complex.belong_together(origin(face), origin(sheet[0])));
    Some(SheetFaces {
        edges,
        lines,
        sources,
        keep_borders,
        position,
        next: body.arrangement.points.next(),
        crossings,
    })
}

/// The sum of the faces of one sheet.
struct Sum<'a> {
    of: SheetFaces<'a>,
    /// How the plane is projected.
    seen: Projection,
    /// The sheet's points, and where they are in the projection.
    points: Vec<PointId>,
    flat: Vec<[f64; 2]>,
}

impl SheetFaces<'_> {
    /// The triangles left, or `None` where the shapes do not allow it.
    pub(crate) fn triangles(self) -> Option<Vec<Piece>> {
        let Some(first) = self.sources.first() else { return Some(Vec::new()) };
        let seen = Projection::of(&first.corners).along_axis();
        Sum { of: self, seen, points: Vec::new(), flat: Vec::new() }.triangles()
    }
}

impl Sum<'_> {
    fn project(&self, position: &[f64; 3]) -> [f64; 2] {
        self.seen.project(position)
    }

    /// The triangles left, or `None` where the shapes do not allow it.
    fn triangles(mut self) -> Option<Vec<Piece>> {
        // 1. The boundaries of what is kept of all faces, as they add up.
        let edges = self.edges();
        let mut at: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        for (i, &point) in (0..).zip(&self.points) {
            at.insert(bits(&(self.of.position)(point)), i);
        }
        // 2. The plane between them by winding number: opposite edges cancel, and where edges cross there is a new point,
        //    unless there is one already.
        let next = self.of.next;
        let mut flat = std::mem::take(&mut self.flat);
        let found = polygon::by_winding(&mut flat, &edges, |x, y, flat| {
            let crossing = self.crossing(x.line, y.line)?;
            let position = crossing.position;
            Some(*at.entry(bits(&position)).or_insert_with(|| {
                self.points.push(PointId::new(next.number() + self.of.crossings.len() as u32));
                self.of.crossings.push(crossing);
                flat.push(self.project(&position));
                flat.len() as u32 - 1
            }))
        })?;
        // 3. Each triangle comes from a face around it.
        self.flat = flat;
        self.attach_origins(&found)
    }

    /// The directed edges of all faces, with local numbers of the points.
    fn edges(&mut self) -> Vec<polygon::Edge> {
        self.points = self.of.edges.iter().flat_map(|edge| edge.ends).collect();
        self.points.sort_unstable();
        self.points.dedup();
        let number = |point: PointId| self.points.partition_point(|&p| p < point) as u32;
        let edges = self.of.edges.iter().map(|edge| polygon::Edge {
            ends: edge.ends.map(number),
            count: edge.count,
            line: edge.line,
            kept: self.of.keep_borders,
        });
        let edges = edges.collect();
        self.flat = self.points.iter().map(|&point| self.project(&(self.of.position)(point))).collect();
        edges
    }

    /// Where two lines cross, rounded as the nodes are; `None` if they only seem to because their parts were rounded.
    fn crossing(&self, x: u32, y: u32) -> Option<SheetCrossing> {
        let ([p, q], [a, b]) = (&self.of.lines[x as usize], &self.of.lines[y as usize]);
        if !polygon::cross_properly([p, q, a, b].map(|point| self.project(point))) {
            return None;
        }
        // The plane through the one that stands on the sheet in the direction of projection.
        let axis = self.seen.axis();
        let size = (0..3).fold(0.0f64, |size, k| size.max((b[k] - a[k]).abs()));
        let mut above = *a;
        // (Any other point above or below gives the same plane, if this one is lost beside a large coordinate.)
        let other = [a[axis] + size, a[axis].next_up(), a[axis].next_down()];
        above[axis] = other.into_iter().find(|&x| x != a[axis] && x.is_finite())?;
        let still =
            |position: &[f64; 3]| PerturbedPoint { position: *position, first: [0; 3], second: [0; 3] };
        let (edge, triangle) = ([p, q].map(still), [a, b, &above].map(still));
        let position = position::crossing_filter(p, q, [a, b, &above])
            .unwrap_or_else(|| position::crossing(&edge[0], &edge[1], triangle.each_ref()));
        Some(SheetCrossing { position, edge, triangle })
    }

    /// The triangles with the faces they come from.
    fn attach_origins(&self, found: &polygon::Found) -> Option<Vec<Piece>> {
        // 1. The faces each part of the body takes from the sheet, and which way they look.
        let sources = self.of.sources.iter().map(|source| {
            let corners = source.corners.map(|p| self.project(&p));
            let is_seen = orient2d(corners[0], corners[1], corners[2]) == Sign::Positive;
            FlatSource { origin: source.origin, looks_up: is_seen != source.origin.reversed, corners }
        });
        let origins = SheetOrigins::new(sources.collect());
        // 2. That of each triangle.
        let mut new = Vec::new();
        let slivers = found.slivers.iter().map(|&counted| (counted, true));
        for ((triangle, winding), is_flat) in
            found.triangles.iter().map(|&counted| (counted, false)).chain(slivers)
        {
            let upward = winding > 0;
            let origin = origins.find(triangle.map(|i| self.flat[i as usize]), upward)?;
            let [a, b, c] = triangle.map(|i| self.points[i as usize]);
            let corners = if upward { [a, b, c] } else { [a, c, b] };
            let piece = Piece { corners, origin, flat: is_flat };
            new.extend(std::iter::repeat_n(piece, winding.unsigned_abs() as usize));
        }
        Some(new)
    }
}

fn bits(position: &[f64; 3]) -> [u64; 3] {
    position.map(|x| (x + 0.0).to_bits())
}

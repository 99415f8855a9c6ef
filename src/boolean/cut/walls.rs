//! Walls without thickness.
//!
//! Where faces of the operands touch from opposite sides, the perturbation makes both vanish (or both stay), provided that
//! each vertex of A moves away from all its faces. At a saddle no direction does. A face there tilts through the face it
//! touches instead of moving off, and parts of both may be kept: two opposite sheets at the same place. They enclose nothing
//! and have the same outline, but not the same triangles. So faces of one plane that look opposite ways, near such vertices,
//! are added up before they are triangulated, and what cancels is gone.
//!
//! In a symmetric difference pieces of A and of B that coincide always cancel, whichever way they look, and so all faces that
//! touch are added up. That is right with any perturbation: as a chain the result tends to the boundary of what is in an odd
//! number of operands, so in each plane the sum of all pieces there is what is left of that boundary, once all faces of the
//! plane that overlap are in one sum.
//!
//! Where the perturbation moves faces apart instead of through each other (at saddles), their edges do not cross, but do so
//! in the sum. Such crossings get a vertex, rounded once like the others.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::Error;
use crate::boolean::arrangement::unrounded::ExtraCrossing;
use crate::boolean::candidates::Candidates;
use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::operands::Operands;
use crate::boolean::cut::Cutter;
use crate::boolean::result::assemble::NewTriangle;
use crate::boolean::result::outcome::Origin;
use crate::exact::perturbed::PerturbedPoint;
use crate::exact::{Projection, Sign, collinear, orient2d, orient3d, position};
use crate::mesh::SparseUnionFind;
use crate::parallel::Runner;
use crate::polygon;
use crate::spatial::{BoxTree, Frame};

/// Faces of one plane that are added up: side and triangle.
pub(crate) type Sheet = Vec<(usize, u32)>;

/// The sets of faces to add up: those of A at vertices without a direction, with all faces of B they touch from the
/// opposite side; in a symmetric difference all faces that touch. (Without ties there are none.)
pub(crate) fn touching_sheets(
    operands: &Operands<'_>,
    candidates: &Candidates,
    parts: &[Part],
    runner: Runner<'_>,
) -> Result<Vec<Sheet>, Error> {
    // A part turned over looks the other way.
    let wanted = match parts {
        [of_a, of_b] => Some(of_a.reversed == of_b.reversed),
        _ => None,
    };
    let stuck = operands.vertices_without_direction();
    if operands.ties() == 0 || (wanted.is_some() && stuck.is_none()) {
        return Ok(Vec::new());
    }
    let corners = |t: u32| operands.sides[0].triangles[t as usize];
    let is_stuck: FxHashSet<u32> = match stuck.filter(|_| wanted.is_some()) {
        Some(stuck) => {
            let near = operands.near(0).iter().copied();
            near.filter(|&t| corners(t).iter().any(|v| stuck.contains(v))).collect()
        }
        None => FxHashSet::default(),
    };
    let touching = candidates.visit(runner, |s, t, found| {
        let together = match wanted {
            Some(wanted) => is_stuck.contains(&s) && touch(operands, s, t) == Some(wanted),
            None => touch(operands, s, t).is_some(),
        };
        if together {
            found.push([s, t]);
        }
    })?;
    let mut sheets = SparseUnionFind::default();
    for [s, t] in touching {
        sheets.join((0, s), (1, t));
    }
    Ok(sheets.into_sets())
}

/// For triangles of A and of B in exactly the same plane whether they look opposite ways; `None` for others.
fn touch(operands: &Operands<'_>, s: u32, t: u32) -> Option<bool> {
    let a = operands.corners(0, s).map(|corner| corner.position);
    let b = operands.corners(1, t).map(|corner| corner.position);
    let coplanar = b.iter().all(|p| orient3d(&a[0], &a[1], &a[2], p) == Sign::Zero);
    if !coplanar || collinear(&a[0], &a[1], &a[2]) || collinear(&b[0], &b[1], &b[2]) {
        return None;
    }
    let seen = Projection::of(&a);
    let [p, q, r] = b.map(|p| seen.project(&p));
    Some(orient2d(p, q, r) != Sign::Positive)
}

/// What is left of the faces of all sheets.
#[derive(Debug, Default)]
pub(crate) struct Sums {
    pub(crate) pieces: Vec<NewTriangle>,
    /// The faces that have been added up.
    pub(crate) done: FxHashSet<(usize, u32)>,
    /// Points where edges cross that the perturbation kept apart; they are numbered after the nodes.
    pub(crate) crossings: Vec<ExtraCrossing>,
}

/// Adds up the faces of each sheet. Where the shapes do not allow it, its faces are left to be cut one by one, which is
/// closed as well.
pub(crate) fn add_up(
    cutter: &Cutter<'_>,
    parts: &[Part],
    sheets: &[Sheet],
    runner: Runner<'_>,
) -> Result<Sums, Error> {
    let mut sums = Sums::default();
    for (i, sheet) in sheets.iter().enumerate() {
        if i % 64 == 0 {
            runner.control.check()?;
        }
        let before = sums.crossings.len();
        match Sum::new(cutter, parts, sheet, &mut sums.crossings).triangles() {
            Some(left) => {
                sums.pieces.extend(left);
                sums.done.extend(sheet);
            }
            None => sums.crossings.truncate(before),
        }
    }
    Ok(sums)
}

/// The sum of the faces of one sheet.
struct Sum<'a> {
    cutter: &'a Cutter<'a>,
    parts: &'a [Part],
    sheet: &'a Sheet,
    /// How the plane is projected.
    seen: Projection,
    /// The sheet's points, and where they are in the projection.
    points: Vec<u32>,
    flat: Vec<[f64; 2]>,
    /// Whole edges, of which those of the sheet are parts.
    lines: Vec<[[f64; 3]; 2]>,
    crossings: &'a mut Vec<ExtraCrossing>,
}

impl<'a> Sum<'a> {
    fn new(
        cutter: &'a Cutter<'a>,
        parts: &'a [Part],
        sheet: &'a Sheet,
        crossings: &'a mut Vec<ExtraCrossing>,
    ) -> Self {
        let (side, triangle) = sheet[0];
        let corners = cutter.operands.corners(side, triangle).map(|corner| corner.position);
        let seen = Projection::of(&corners).along_axis();
        Self {
            cutter,
            parts,
            sheet,
            seen,
            points: Vec::new(),
            flat: Vec::new(),
            lines: Vec::new(),
            crossings,
        }
    }

    fn project(&self, position: &[f64; 3]) -> [f64; 2] {
        self.seen.project(position)
    }

    fn position(&self, point: u32) -> &[f64; 3] {
        let first = self.first_crossing();
        if point < first {
            self.cutter.position(point)
        } else {
            &self.crossings[(point - first) as usize].position
        }
    }

    /// The number of the first point where edges cross.
    fn first_crossing(&self) -> u32 {
        self.cutter.operands.vertex_count() + self.cutter.edges.positions.len() as u32
    }

    /// The triangles left, or `None` where the shapes do not allow it.
    fn triangles(mut self) -> Option<Vec<NewTriangle>> {
        let edges = self.edges()?;
        let mut at: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        for (i, &point) in (0..).zip(&self.points) {
            at.insert(bits(self.position(point)), i);
        }
        let mut flat = std::mem::take(&mut self.flat);
        let found = polygon::by_winding(&mut flat, &edges, |x, y, flat| {
            let crossing = self.crossing(x.line, y.line)?;
            let position = crossing.position;
            Some(*at.entry(bits(&position)).or_insert_with(|| {
                self.points.push(self.first_crossing() + self.crossings.len() as u32);
                self.crossings.push(crossing);
                flat.push(self.project(&position));
                flat.len() as u32 - 1
            }))
        })?;
        self.flat = flat;
        self.with_origins(&found)
    }

    /// The directed edges of all faces, with local numbers of the points.
    fn edges(&mut self) -> Option<Vec<polygon::Edge>> {
        let mut edges: Vec<polygon::Edge> = Vec::new();
        for &(side, triangle) in self.sheet {
            let face = self.cutter.faces[side].face(triangle)?;
            let corners = self.cutter.operands.corners(side, triangle).map(|corner| corner.position);
            let first = self.lines.len() as u32;
            self.lines.extend((0..3).map(|k| [corners[k], corners[(k + 1) % 3]]));
            for part in self.parts.iter().filter(|part| part.side == side) {
                self.cutter.for_boundary(*part, &face, |ends, of_side, count| {
                    let line = match of_side {
                        Some(k) => first + k as u32,
                        None => {
                            self.lines.push(ends.map(|point| *self.cutter.position(point)));
                            self.lines.len() as u32 - 1
                        }
                    };
                    edges.push(polygon::Edge { ends, count: count as i32, line });
                });
            }
        }
        self.points = edges.iter().flat_map(|edge| edge.ends).collect();
        self.points.sort_unstable();
        self.points.dedup();
        for edge in &mut edges {
            edge.ends = edge.ends.map(|point| self.points.partition_point(|&p| p < point) as u32);
        }
        self.flat = self.points.iter().map(|&point| self.project(self.position(point))).collect();
        Some(edges)
    }

    /// Where two lines cross, rounded as the nodes are; `None` if they only seem to because their parts were rounded.
    fn crossing(&self, x: u32, y: u32) -> Option<ExtraCrossing> {
        let ([p, q], [a, b]) = (&self.lines[x as usize], &self.lines[y as usize]);
        if !polygon::cross_properly([p, q, a, b].map(|point| self.project(point))) {
            return None;
        }
        // The plane through the one that stands on the sheet in the direction of projection.
        let axis = self.seen.axis();
        let size = (0..3).fold(0.0f64, |size, k| size.max((b[k] - a[k]).abs()));
        let mut above = *a;
        above[axis] += size;
        if above[axis] == a[axis] || !above[axis].is_finite() {
            return None;
        }
        let still =
            |position: &[f64; 3]| PerturbedPoint { position: *position, first: [0; 3], second: [0; 3] };
        let (edge, triangle) = ([p, q].map(still), [a, b, &above].map(still));
        let position = position::crossing_filter(p, q, [a, b, &above])
            .unwrap_or_else(|| position::crossing(&edge[0], &edge[1], triangle.each_ref()));
        Some(ExtraCrossing { position, edge, triangle })
    }

    /// The triangles with the faces they come from: those around their middle that look their way.
    fn with_origins(&self, found: &polygon::Found) -> Option<Vec<NewTriangle>> {
        let operands = self.cutter.operands;
        let corners =
            |&(side, triangle): &(usize, u32)| operands.corners(side, triangle).map(|corner| corner.position);
        let sources: Vec<(Origin, bool, [[f64; 2]; 3])> = self
            .sheet
            .iter()
            .flat_map(|face| {
                let flat = corners(face).map(|p| self.project(&p));
                let looks_up = orient2d(flat[0], flat[1], flat[2]) == Sign::Positive;
                self.parts.iter().filter(|part| part.side == face.0).map(move |part| {
                    let origin = Origin { operand: face.0 as u32, triangle: face.1, reversed: part.reversed };
                    (origin, looks_up != part.reversed, flat)
                })
            })
            .collect();
        let upright = |p: [f64; 2]| [p[0], p[1], 0.0];
        let all = || sources.iter().flat_map(|source| source.2);
        let low = all().fold([f64::INFINITY; 2], |low, p| [low[0].min(p[0]), low[1].min(p[1])]);
        let high = all().fold([f64::NEG_INFINITY; 2], |high, p| [high[0].max(p[0]), high[1].max(p[1])]);
        let frame = Frame::of(upright(low), upright(high));
        let numbers: Vec<u32> = (0..sources.len() as u32).collect();
        let box_of = |corners: &[[f64; 2]; 3]| {
            let corners = corners.map(upright);
            frame.triangle(corners.each_ref())
        };
        let tree = BoxTree::new(&numbers, |i| box_of(&sources[i as usize].2));
        let mut new = Vec::new();
        let slivers = found.slivers.iter().map(|&counted| (counted, true));
        for ((triangle, winding), is_flat) in
            found.triangles.iter().map(|&counted| (counted, false)).chain(slivers)
        {
            let flat = triangle.map(|i| self.flat[i as usize]);
            let [p, q, r] = flat;
            let middle = [0, 1].map(|k| p[k] / 3.0 + q[k] / 3.0 + r[k] / 3.0);
            let upward = winding > 0;
            let mut best = None;
            tree.meeting(&box_of(&flat), |i| {
                let source = &sources[i as usize];
                if source.1 == upward && best.is_none_or(|best| i < best) && contains(&source.2, middle) {
                    best = Some(i);
                }
            });
            let source = match best {
                Some(i) => &sources[i as usize],
                None => sources.iter().find(|source| source.1 == upward)?,
            };
            let [a, b, c] = triangle.map(|i| self.points[i as usize]);
            let corners = if upward { [a, b, c] } else { [a, c, b] };
            let piece = NewTriangle { corners, origin: source.0, flat: is_flat };
            new.extend(std::iter::repeat_n(piece, winding.unsigned_abs() as usize));
        }
        Some(new)
    }
}

fn bits(position: &[f64; 3]) -> [u64; 3] {
    position.map(|x| (x + 0.0).to_bits())
}

fn contains(triangle: &[[f64; 2]; 3], p: [f64; 2]) -> bool {
    let sides = [0, 1, 2].map(|k| orient2d(triangle[k], triangle[(k + 1) % 3], p));
    !(sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative))
}

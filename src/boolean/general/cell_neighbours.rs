//! What lies beside each other though no line leads from one to the other: lines within a face, and pieces of surface in space.

use std::cmp::Ordering;

use super::cells::{AROUND, Beside, Ground};
use super::face_view::{Both, Crossing, FaceView};
use super::pairs::FaceBoxes;
use crate::Error;
use crate::boolean::complex::Corner;
use crate::boolean::complex::ids::{FaceId, VertexId};
use crate::boolean::complex::predicates::{Perturbed, Predicates};
use crate::boolean::complex::rays::{Ray, coordinate_past, signed_crossing};
use crate::exact::{Sign, order};
use crate::mesh::{Bounds, UnionFind, cross};
use crate::parallel::Runner;

/// Cut faces that one thread looks at before the limits are checked.
const FACES_AT_ONCE: usize = 256;

/// Pairs of sectors that are in one cell.
///
/// # Errors
/// Only limits.
pub(super) fn find(
    sectors: &Beside<'_>,
    bounds: &Bounds,
    boxes: &FaceBoxes,
    runner: Runner<'_>,
) -> Result<Vec<[u32; 2]>, Error> {
    let Ground { surfaces, crossings, .. } = sectors.ground;
    // 1. Within faces.
    let cut: Vec<FaceId> = surfaces.faces().filter(|&face| !crossings.of_face(face).is_empty()).collect();
    let mut joins: Vec<[u32; 2]> = runner.gather(cut.len(), FACES_AT_ONCE, 0, |range, joins| {
        cut[range].iter().for_each(|&face| FaceView::new(sectors, face).join_parts(joins));
    })?;
    // 2. Between pieces of surface: along a line through each.
    let bodies = Bodies::new(sectors);
    let search = Search { sectors, bodies: &bodies, predicates: Predicates::new(surfaces) };
    let found = runner.pieces(bodies.widest.len(), 1, |range| {
        let mut joins = Vec::new();
        search.along_line(range.start, bounds, boxes, &mut joins);
        joins
    })?;
    joins.extend(found.into_iter().flatten());
    Ok(joins)
}

/// Faces that hang together by edges and segments.
struct Bodies {
    /// By face.
    of_face: Vec<u32>,
    /// Of each the face that is widest seen along x.
    widest: Vec<FaceId>,
}

impl Bodies {
    fn new(sectors: &Beside<'_>) -> Self {
        let Ground { surfaces, edges, crossings, .. } = sectors.ground;
        let mut sets = UnionFind::new(surfaces.face_count() as usize);
        for (edge, _) in edges.iter() {
            let sides = edges.sides(edge);
            sides[1..].iter().for_each(|side| sets.join(sides[0].face().number(), side.face().number()));
        }
        crossings.segments.iter().for_each(|segment| {
            let [f, g] = segment.faces;
            sets.join(f.number(), g.number());
        });
        let (count, of_face) = sets.labels();
        let mut widest = vec![(FaceId::NONE, -1.0); count];
        for (face, &body) in surfaces.faces().zip(&of_face) {
            let width = normal(&surfaces.positions(face))[0].abs();
            let widest = &mut widest[body as usize];
            if width > widest.1 {
                *widest = (face, width);
            }
        }
        Self { of_face, widest: widest.into_iter().map(|(face, _)| face).collect() }
    }
}

fn normal([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let from_a = |p: &[f64; 3]| std::array::from_fn(|k| p[k] - a[k]);
    cross(from_a(b), from_a(c))
}

/// Where a line meets a face.
struct Met {
    face: FaceId,
    x: f64,
    /// Whether it goes from the inner side to the outer side.
    leaves: bool,
}

struct Search<'a> {
    sectors: &'a Beside<'a>,
    bodies: &'a Bodies,
    predicates: Predicates<'a>,
}

impl Search<'_> {
    /// What lies between the faces that a line along x through a body meets one after the other.
    fn along_line(&self, body: usize, bounds: &Bounds, boxes: &FaceBoxes, joins: &mut Vec<[u32; 2]>) {
        /// Weights of a face's corners: no vertex or edge of a regular mesh lies straight behind the point they give.
        const WEIGHTS: [f64; 3] = [0.412_7, 0.306_9, 0.280_4];
        let surfaces = self.sectors.ground.surfaces;
        let corners = surfaces.positions(self.bodies.widest[body]);
        let within = |axis: usize| (0..3).map(|k| WEIGHTS[k] * corners[k][axis]).sum::<f64>();
        let [y, z] = [within(1), within(2)];
        let ends = [
            -coordinate_past(-bounds.high[0], -bounds.low[0]),
            coordinate_past(bounds.low[0], bounds.high[0]),
        ];
        // 1. The faces, with where they are met.
        let first = surfaces.vertex_count() + 2 * body as u32;
        let corner = |i: u32| Corner { id: VertexId::new(first + i), position: [ends[i as usize], y, z] };
        let ray = Ray { start: corner(0), end: corner(1) };
        let mut met: Vec<Met> = Vec::new();
        boxes.meeting([&ray.start.position, &ray.end.position], |face| {
            let sign = signed_crossing(&self.predicates, &surfaces.corners(face), &ray);
            if sign != 0 {
                met.push(Met { face, x: along_x(&surfaces.positions(face), y, z), leaves: sign > 0 });
            }
        });
        met.sort_by(|f, g| self.compare(&ray, f, g));
        // 2. What lies between those of different bodies, and around all.
        let body_of = |face: FaceId| self.bodies.of_face[face.index()];
        let mut views = Vec::new();
        let mut beside = |met: &Met| self.along(met.face, [met.x, y, z], &mut views);
        if let (Some(first), Some(last)) = (met.first(), met.last()) {
            joins.extend(beside(first).map(|[before, _]| [before, AROUND]));
            joins.extend(beside(last).map(|[_, after]| [after, AROUND]));
        }
        for pair in met.windows(2).filter(|pair| body_of(pair[0].face) != body_of(pair[1].face)) {
            if let (Some([_, after]), Some([before, _])) = (beside(&pair[0]), beside(&pair[1])) {
                joins.push([after, before]);
            }
        }
    }

    /// Which of two faces a line meets first: exactly, since what touches is told apart by the perturbation alone.
    fn compare(&self, ray: &Ray, f: &Met, g: &Met) -> Ordering {
        if f.face == g.face {
            return Ordering::Equal;
        }
        let surfaces = self.sectors.ground.surfaces;
        let [first, second] = [f.face, g.face].map(|face| surfaces.positions(face));
        let (start, end) = (&ray.start.position, &ray.end.position);
        let order =
            order::compare_filter(start, end, first.each_ref(), second.each_ref(), f.leaves, g.leaves)
                .unwrap_or_else(|| {
                    let point = |corner: &Corner| surfaces.perturbed(corner);
                    let [first, second] = [f.face, g.face].map(|face| surfaces.corners(face));
                    let (first, second) = (first.each_ref().map(point), second.each_ref().map(point));
                    order::compare(&point(&ray.start), &point(&ray.end), first.each_ref(), second.each_ref())
                });
        if order == Sign::Negative { Ordering::Less } else { Ordering::Greater }
    }

    /// The sectors before and after a face along x, at a point of it.
    fn along(&self, face: FaceId, point: [f64; 3], found: &mut Vec<Crossing>) -> Option<[u32; 2]> {
        let Ground { surfaces, crossings, .. } = self.sectors.ground;
        let [outer, inner]: Both = if crossings.of_face(face).is_empty() {
            self.sectors.side(face, 0, 0)
        } else {
            FaceView::new(self.sectors, face).at(&point, found)?
        };
        Some(if normal(&surfaces.positions(face))[0] > 0.0 { [inner, outer] } else { [outer, inner] })
    }
}

/// Where a line along x meets the plane of a face.
fn along_x(corners: &[[f64; 3]; 3], y: f64, z: f64) -> f64 {
    let (n, a) = (normal(corners), corners[0]);
    let x = a[0] - (n[1] * (y - a[1]) + n[2] * (z - a[2])) / n[0];
    let (low, high) = corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), corner| {
        (low.min(corner[0]), high.max(corner[0]))
    });
    if x.is_finite() { x.clamp(low, high) } else { 0.5 * low + 0.5 * high }
}

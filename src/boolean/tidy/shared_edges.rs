//! Edges in which surfaces touch: the same subdivision for all faces.
//!
//! Where both operands have the same edge, or part of it, the perturbation may let them cross somewhere along it: some faces
//! then pass along the whole edge and others along its parts. Bodies that touch in an edge only come apart if all faces
//! there meet in the same edges. So every edge gets the vertices of the shorter edges that run along it.

use std::cell::LazyCell;

use glam::Vec3A;
use obvhs::aabb::Aabb;

use super::patch::Patch;
use super::point_grid::PointGrid;
use super::source::Source;
use super::split_faces::{Edge, Splits, split_faces};
use super::zero_area::is_low;
use crate::boolean::complex::Complex;
use crate::exact::collinear;
use crate::mesh::Buckets;
use crate::mesh::{HalfEdges, Surface};
use crate::spatial::{BoxTree, Frame};
use crate::{Control, Error};

/// Rounds of splitting: halves may have vertices on them again.
const ROUNDS: usize = 4;
/// Splitting ends when the faces have become so many times as many.
const MOST_GROWTH: usize = 4;

/// Splits the edges between faces on which there are vertices, and then those within a face along which edges of the other
/// operand run.
///
/// Returns the half-edges of what has become of the patch.
pub(super) fn split(
    patch: &mut Patch<'_>,
    cutter: &Source<'_>,
    planes: Option<&Complex<'_>>,
    control: &Control,
) -> Result<HalfEdges, Error> {
    let half_edges = HalfEdges::of(patch);
    let half_edges = split_by(patch, half_edges, planes, |patch, edges| {
        splits_between_faces(patch, edges, cutter, control)
    })?;
    split_by(patch, half_edges, planes, |patch, edges| splits_along_edges(patch, edges, cutter, control))
}

/// So many edges are looked at between looks at the limits.
const EDGES_BETWEEN_CHECKS: usize = 1024;

/// Edges that pass more cells of the grid are long.
const MOST_CELLS: usize = 64;

fn split_by(
    patch: &mut Patch<'_>,
    mut half_edges: HalfEdges,
    planes: Option<&Complex<'_>>,
    splits: impl Fn(&Patch<'_>, &HalfEdges) -> Result<Splits, Error>,
) -> Result<HalfEdges, Error> {
    let most = MOST_GROWTH * patch.faces.len();
    for _ in 0..ROUNDS {
        let splits = splits(patch, &half_edges)?;
        if splits.is_empty() || patch.faces.len() > most {
            break;
        }
        split_faces(patch, &splits, planes);
        patch.cancel();
        half_edges = HalfEdges::of(patch);
    }
    Ok(half_edges)
}

/// Makes one point of those at the same place.
pub(super) fn identify(patch: &mut Patch<'_>) {
    let mut points = points(patch);
    let key = |&point: &u32| (patch.position(point).map(|x| (x + 0.0).to_bits()), point);
    points.sort_unstable_by_key(key);
    let same = |pair: &&[u32]| patch.position(pair[0]) == patch.position(pair[1]);
    let pairs: Vec<(u32, u32)> = points.windows(2).filter(same).map(|pair| (pair[0], pair[1])).collect();
    if !pairs.is_empty() {
        super::zero_area::identify(patch, &pairs);
    }
}

/// The points all of whose triangles are known, ascending.
fn points(patch: &Patch<'_>) -> Vec<u32> {
    let mut is_here = vec![false; patch.point_count()];
    for face in patch.faces.iter().filter(|face| face.alive) {
        face.corners.iter().for_each(|&point| is_here[point as usize] = true);
    }
    (0..patch.point_count() as u32).filter(|&x| is_here[x as usize] && patch.is_complete(x)).collect()
}

/// All edges on which there are vertices, with these from the lower end to the higher one. (Not those inside one face.)
fn splits_between_faces(
    patch: &Patch<'_>,
    half_edges: &HalfEdges,
    cutter: &Source<'_>,
    control: &Control,
) -> Result<Splits, Error> {
    let points = points(patch);
    let limits = |pick: fn(f64, f64) -> f64, from: f64| -> [f64; 3] {
        points.iter().fold([from; 3], |limit, &point| {
            std::array::from_fn(|k| pick(limit[k], patch.position(point)[k]))
        })
    };
    let frame = Frame::of(limits(f64::min, f64::INFINITY), limits(f64::max, f64::NEG_INFINITY));
    // A grid finds the points near short edges faster than a tree does, which is needed for long ones alone.
    let grid = PointGrid::new(&points, |point| patch.position(point));
    let tree = LazyCell::new(|| BoxTree::new(&points, |point| frame.triangle([patch.position(point); 3])));
    let mut splits = Splits::new(patch);
    let origin = |triangle: u32| patch.faces[triangle as usize].origin;
    for (i, (u, v, mut triangles)) in half_edges.edges_with_triangles().enumerate() {
        if i % EDGES_BETWEEN_CHECKS == 0 {
            control.check()?;
        }
        if !patch.is_complete(u) && !patch.is_complete(v) {
            continue;
        }
        let first = triangles.next().map(origin);
        if triangles.len() > 0 && triangles.all(|triangle| Some(origin(triangle)) == first) {
            continue;
        }
        let mut on: Vec<u32> = Vec::new();
        let (p, q) = (patch.position(u), patch.position(v));
        let mut look_at = |x: u32| {
            if x != u && x != v && lies_between(patch, cutter, u, x, v) {
                on.push(x);
            }
        };
        if !grid.in_box(p, q, MOST_CELLS, &mut look_at) {
            for along in boxes_along(frame.point(p), frame.point(q), points.len()) {
                tree.meeting(&along, &mut look_at);
            }
        }
        if !on.is_empty() {
            // Boxes have points in common, and points may be at the same place.
            sort_along(patch, u, &mut on);
            on.dedup_by(|x, y| patch.position(*x) == patch.position(*y));
            splits.insert((u, v), on);
        }
    }
    Ok(splits)
}

/// Sorts points by their distance from `u`.
fn sort_along(patch: &Patch<'_>, u: u32, on: &mut [u32]) {
    let start = *patch.position(u);
    let distance = |x: &u32| (0..3).map(|k| (patch.position(*x)[k] - start[k]).powi(2)).sum::<f64>();
    on.sort_by(|x, y| distance(x).total_cmp(&distance(y)).then(x.cmp(y)));
}

/// Edges of one operand along which edges of the other run.
fn splits_along_edges(
    patch: &Patch<'_>,
    half_edges: &HalfEdges,
    cutter: &Source<'_>,
    control: &Control,
) -> Result<Splits, Error> {
    // With a bit for each operand whose faces are there.
    let edges = half_edges.edges_with_triangles().map(|(u, v, triangles)| {
        let operand = |triangle: u32| patch.faces[triangle as usize].origin.operand;
        ((u, v), triangles.fold(0u8, |of, triangle| of | 1 << operand(triangle)))
    });
    let edges: Vec<(Edge, u8)> = edges.collect();
    // Each edge from both its ends, those of the same operands together.
    let from_ends = edges.iter().flat_map(|&((u, v), of)| [(u, (of, v)), (v, (of, u))]);
    let mut from_points = Buckets::new(patch.point_count(), from_ends);
    from_points.each_mut().for_each(<[(u8, u32)]>::sort_unstable);
    // Those of a point's edges that are of certain operands: where they lead to.
    fn neighbours(around: &[(u8, u32)], of: u8) -> impl Iterator<Item = u32> {
        let of_these = around.iter().skip_while(move |entry| entry.0 < of);
        of_these.take_while(move |entry| entry.0 == of).map(|entry| entry.1)
    }
    let mut splits = Splits::new(patch);
    for (i, &((u, v), of)) in edges.iter().enumerate() {
        if i % EDGES_BETWEEN_CHECKS == 0 {
            control.check()?;
        }
        if !patch.is_complete(u) || !patch.is_complete(v) {
            continue;
        }
        // From vertex to vertex along the edge.
        let mut on: Vec<u32> = Vec::new();
        let mut next = 0;
        let mut here = from_points.get(u as usize);
        loop {
            for x in (1..=BOTH).filter(|&of_x| of | of_x == BOTH).flat_map(|of_x| neighbours(here, of_x)) {
                if x != u && x != v && !on.contains(&x) && lies_between(patch, cutter, u, x, v) {
                    on.push(x);
                }
            }
            let Some(&x) = on.get(next) else { break };
            here = from_points.get(x as usize);
            next += 1;
        }
        if !on.is_empty() {
            sort_along(patch, u, &mut on);
            splits.insert((u, v), on);
        }
    }
    Ok(splits)
}

/// Boxes that cover a segment: its own, or those of equal parts of a long one that lies askew among many points, as its own is
/// mostly empty.
fn boxes_along(p: Vec3A, q: Vec3A, points: usize) -> impl Iterator<Item = Aabb> {
    /// From this second largest extent on, in units of the frame.
    const ASKEW: f32 = 0.05;
    const MANY_POINTS: usize = 50_000;
    const PARTS: u8 = 16;
    const MARGIN: f32 = 16.0 * f32::EPSILON;
    let [x, y, z] = (q - p).abs().to_array();
    let is_long = x.min(y).max(x.max(y).min(z)) > ASKEW;
    let parts = if is_long && points >= MANY_POINTS { PARTS } else { 1 };
    let margin = if parts == 1 { 0.0 } else { MARGIN * p.abs().max(q.abs()).max_element() };
    let at = move |i: u8| if i == parts { q } else { p + (q - p) * (f32::from(i) / f32::from(parts)) };
    (0..parts).map(move |i| {
        let (from, to) = (at(i), at(i + 1));
        Aabb { min: from.min(to) - margin, max: from.max(to) + margin }
    })
}

/// Faces of both operands.
const BOTH: u8 = 3;

/// Whether `x` lies on the segment from `u` to `v`, not at its ends: exactly as given, or before it was rounded. Both parts
/// are shorter than the whole, so splitting comes to an end.
fn lies_between(patch: &Patch<'_>, cutter: &Source<'_>, u: u32, x: u32, v: u32) -> bool {
    let (p, at, q) = (patch.position(u), patch.position(x), patch.position(v));
    // Nearly always one look says no: rounding moves a point by less than a unit in the last place.
    if !(0..3).all(|k| p[k].min(q[k]) <= at[k] && at[k] <= p[k].max(q[k])) {
        return false;
    }
    let length = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f64>();
    let [u_v, u_x]: [[f64; 3]; 2] = [q, at].map(|end| std::array::from_fn(|k| end[k] - p[k]));
    let twice_area = (0..3)
        .map(|k| (u_v[(k + 1) % 3] * u_x[(k + 2) % 3] - u_v[(k + 2) % 3] * u_x[(k + 1) % 3]).powi(2))
        .sum::<f64>();
    let is_off = twice_area > (2.0 * cutter.rounding).powi(2) * length(p, q);
    !is_off
        && length(p, at).max(length(at, q)) < length(p, q)
        && (collinear(p, at, q)
            || (is_low([p, at, q], cutter.rounding)
                && cutter.were_on_one_line([u, x, v].map(|point| patch.number(point)))))
}

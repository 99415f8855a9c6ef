//! Which vertices lie on which edges, exactly as given or before they were rounded.

use std::cell::LazyCell;

use glam::Vec3A;
use obvhs::aabb::Aabb;

use super::face::{Edge, LocalFace, LocalPoint};
use super::flatness::is_triangle_low;
use super::patch::Patch;
use super::point_grid::PointGrid;
use super::snap::complete_points;
use super::splits::Splits;
use crate::boolean::complex::rounding::distance_order;
use crate::exact::collinear;
use crate::mesh::{BitSet, Buckets, HalfEdges};
use crate::spatial::{BoxTree, Frame};
use crate::{Control, Error};

/// Edges tested between checks of the limits: bounds how long a cancelled operation goes on.
const EDGES_BETWEEN_CHECKS: usize = 1024;

/// Cells of the grid that the box of an edge may cover; longer edges are searched for in a tree instead.
const MOST_CELLS_PER_EDGE: usize = 64;

/// All edges of the patch, ascending: ends, and the faces there.
fn edges_with_faces(
    half_edges: &HalfEdges,
) -> impl Iterator<Item = (Edge, impl ExactSizeIterator<Item = LocalFace> + Clone)> {
    half_edges
        .edges_with_triangles()
        .map(|(u, v, triangles)| ((LocalPoint(u), LocalPoint(v)), triangles.map(LocalFace)))
}

/// Which edges are asked about.
#[derive(Clone, Copy)]
pub(super) enum Around<'a> {
    All,
    /// Those whose faces, or the edges at whose ends, may have changed: of changed faces these are the corners.
    Points(&'a BitSet),
}

impl Around<'_> {
    fn includes(self, point: LocalPoint) -> bool {
        match self {
            Self::All => true,
            Self::Points(points) => points.contains(point.0),
        }
    }
}

/// All edges on which there are vertices, with these from the lower end to the higher one. (Not those inside one face.)
pub(super) fn points_on_edges(
    patch: &Patch<'_>,
    half_edges: &HalfEdges,
    around: Around<'_>,
    control: &Control,
) -> Result<Splits, Error> {
    // 1. The points that edges may be split at, in a grid, which finds those near short edges faster than a tree does; that
    //    is needed for long ones alone.
    let points = complete_points(patch);
    let frame = frame_of(patch, &points);
    let grid = PointGrid::new(&points, |point| patch.position(point));
    let numbers: Vec<u32> = points.iter().map(|point| point.0).collect();
    let tree = LazyCell::new(|| {
        BoxTree::new(&numbers, |point| frame.triangle([patch.position(LocalPoint(point)); 3]))
    });
    let mut splits = Splits::new(patch);
    let origin = |face: LocalFace| patch[face].origin;
    for (i, ((u, v), mut faces)) in edges_with_faces(half_edges).enumerate() {
        if i % EDGES_BETWEEN_CHECKS == 0 {
            control.check()?;
        }
        if !around.includes(u) || !around.includes(v) {
            continue;
        }
        // 2. Edges all of whose faces are known, unless they are inside one face.
        if !patch.is_complete(u) && !patch.is_complete(v) {
            continue;
        }
        let first = faces.next().map(origin);
        if faces.len() > 0 && faces.all(|face| Some(origin(face)) == first) {
            continue;
        }
        // 3. The points near the edge that lie on it.
        let mut on: Vec<LocalPoint> = Vec::new();
        let (p, q) = (patch.position(u), patch.position(v));
        let mut test = |x: LocalPoint| {
            if x != u && x != v && lies_between(patch, u, x, v) {
                on.push(x);
            }
        };
        if !grid.visit_box(p, q, MOST_CELLS_PER_EDGE, &mut test) {
            for part in boxes_along(frame.point(p), frame.point(q), points.len()) {
                tree.meeting(&part, |point| test(LocalPoint(point)));
            }
        }
        if !on.is_empty() {
            // Boxes have points in common, and points may be at the same place.
            sort_by_distance(patch, u, &mut on);
            on.dedup_by(|x, y| patch.position(*x) == patch.position(*y));
            splits.insert((u, v), on);
        }
    }
    Ok(splits)
}

/// The frame of some points.
fn frame_of(patch: &Patch<'_>, points: &[LocalPoint]) -> Frame {
    let limits = |pick: fn(f64, f64) -> f64, from: f64| -> [f64; 3] {
        points.iter().fold([from; 3], |limit, &point| {
            std::array::from_fn(|k| pick(limit[k], patch.position(point)[k]))
        })
    };
    Frame::of(limits(f64::min, f64::INFINITY), limits(f64::max, f64::NEG_INFINITY))
}

/// Boxes that cover a segment: its own, or those of equal parts of a long one that lies askew among many points, as its own is
/// mostly empty.
fn boxes_along(p: Vec3A, q: Vec3A, points: usize) -> impl Iterator<Item = Aabb> {
    /// Second largest extent, in units of the frame (the points' box is 1 long), from which a segment's own box holds many
    /// points that are not near the segment.
    const ASKEW: f32 = 0.05;
    /// Points from which several boxes are searched: below, walking the tree again costs more than testing the points.
    const MANY_POINTS: usize = 50_000;
    /// Boxes for a segment.
    const PARTS: u8 = 16;
    /// What the ends of a part can be off, relative to the segment's largest coordinate.
    const MARGIN: f32 = 16.0 * f32::EPSILON;
    let [x, y, z] = (q - p).abs().to_array();
    let is_askew = x.min(y).max(x.max(y).min(z)) > ASKEW;
    let parts = if is_askew && points >= MANY_POINTS { PARTS } else { 1 };
    let margin = if parts == 1 { 0.0 } else { MARGIN * p.abs().max(q.abs()).max_element() };
    let at = move |i: u8| if i == parts { q } else { p + (q - p) * (f32::from(i) / f32::from(parts)) };
    (0..parts).map(move |i| {
        let (from, to) = (at(i), at(i + 1));
        Aabb { min: from.min(to) - margin, max: from.max(to) + margin }
    })
}

/// Operands as bits; of more than so many, some have one in common.
type Operands = u64;

fn bit(owner: u32) -> Operands {
    1 << (owner % Operands::BITS)
}

/// Edges of one operand along which edges of others run, with the vertices of these.
pub(super) fn points_along_edges(
    patch: &Patch<'_>,
    half_edges: &HalfEdges,
    around: Around<'_>,
    control: &Control,
) -> Result<Splits, Error> {
    // 1. All edges, with a bit for each operand whose faces are there.
    let edges = edges_with_faces(half_edges).map(|(edge, faces)| {
        let owner = |face: LocalFace| patch.source().owner(patch[face].origin);
        (edge, faces.fold(0, |of, face| of | bit(owner(face))))
    });
    let edges: Vec<(Edge, Operands)> = edges.collect();
    // 2. Each edge from both its ends, those of the same operands together.
    let from_ends = edges.iter().flat_map(|&((u, v), of)| [(u.0, (of, v)), (v.0, (of, u))]);
    let mut from_points = Buckets::new(patch.point_count(), from_ends);
    from_points.each_mut().for_each(<[(Operands, LocalPoint)]>::sort_unstable);
    // 3. For each edge the vertices on it that edges of other operands lead to.
    let mut splits = Splits::new(patch);
    for (i, &(edge, of)) in edges.iter().enumerate() {
        if i % EDGES_BETWEEN_CHECKS == 0 {
            control.check()?;
        }
        // (The walk begins with the edges at the lower end.)
        if !around.includes(edge.0) || !patch.is_complete(edge.0) || !patch.is_complete(edge.1) {
            continue;
        }
        let mut on = walk_along(patch, &from_points, edge, of);
        if !on.is_empty() {
            sort_by_distance(patch, edge.0, &mut on);
            splits.insert(edge, on);
        }
    }
    Ok(splits)
}

/// The vertices that one comes by on an edge from `u` to `v`, of the operands `of`, from vertex to vertex by edges that
/// are, together with it, of several operands.
fn walk_along(
    patch: &Patch<'_>,
    from_points: &Buckets<(Operands, LocalPoint)>,
    (u, v): Edge,
    of: Operands,
) -> Vec<LocalPoint> {
    let mut on: Vec<LocalPoint> = Vec::new();
    let mut next = 0;
    let mut around = from_points.get(u.index());
    loop {
        let ends = around.iter().filter(|entry| (of | entry.0).count_ones() > 1);
        for &(_, x) in ends {
            let is_new = x != u && x != v && !on.contains(&x);
            if is_new && patch.is_complete(x) && lies_between(patch, u, x, v) {
                on.push(x);
            }
        }
        let Some(&x) = on.get(next) else { return on };
        around = from_points.get(x.index());
        next += 1;
    }
}

/// Sorts points by their distance from `u`.
fn sort_by_distance(patch: &Patch<'_>, u: LocalPoint, on: &mut [LocalPoint]) {
    let start = patch.position(u);
    on.sort_by_cached_key(|&x| (distance_order(start, patch.position(x)), x));
}

/// Whether `x` lies on the segment from `u` to `v`, not at its ends: exactly as given, or before it was rounded. Both parts
/// are shorter than the whole, so splitting comes to an end.
fn lies_between(patch: &Patch<'_>, u: LocalPoint, x: LocalPoint, v: LocalPoint) -> bool {
    let (p, at, q) = (patch.position(u), patch.position(x), patch.position(v));
    // 1. Nearly always one look says no: rounding moves a point by less than a unit in the last place.
    if !(0..3).all(|k| p[k].min(q[k]) <= at[k] && at[k] <= p[k].max(q[k])) {
        return false;
    }
    // 2. Further from the line than rounding can move it.
    if !patch.source().rounding.is_near_line(p, at, q) {
        return false;
    }
    // 3. Both parts shorter, and on one line: now, or before rounding.
    let length = distance_order(p, q);
    distance_order(p, at).max(distance_order(at, q)) < length
        && (collinear(p, at, q)
            || (is_triangle_low(patch, [u, x, v])
                && patch.source().were_collinear([u, x, v].map(|point| patch.source_point(point)))))
}

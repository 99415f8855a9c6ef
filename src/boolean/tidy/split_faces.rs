//! Faces whose sides get vertices: triangulated anew, those of one plane side by side as one.
//!
//! A long side with many vertices makes a fan of needles of the triangle it belongs to; together with the triangle on the
//! other side of its diagonal it is a strip, which has a sound triangulation.

use super::face::{Edge, LocalFace, LocalPoint, edge_between};
use super::flatness::is_triangle_low;
use super::patch::Patch;
use super::splits::Splits;
use crate::mesh::{BitSet, Buckets, UnionFind};
use crate::polygon::Triangulator;

/// Splits the sides of all faces that are to be split. Diagonals are left alone, whatever else runs along them: they bound two
/// triangles of one face and so do not matter to others. With `merge`, faces on both sides of a coplanar edge are
/// triangulated together.
pub(super) fn split_faces(patch: &mut Patch<'_>, splits: &Splits, merge: bool) {
    let faces: Vec<LocalFace> = patch.face_numbers().filter(|&face| splits.concern(&patch[face])).collect();
    if merge {
        let mut triangulator = Triangulator::default();
        for strip in strips(patch, &faces, splits).each().filter(|strip| strip.len() > 1) {
            triangulate_strip(patch, strip, splits, &mut triangulator);
        }
    }
    for face in faces {
        split_face(patch, face, splits);
    }
}

/// The faces that are to be split, those of one plane side by side together.
fn strips(patch: &Patch<'_>, faces: &[LocalFace], splits: &Splits) -> Buckets<LocalFace> {
    // 1. Every side that is not to be split: its ends, whether it runs from the lower one, and the place of its face.
    let mut sides: Vec<(Edge, bool, u32)> = Vec::with_capacity(2 * faces.len());
    for (place, &face) in (0..).zip(faces).filter(|&(_, &face)| !patch[face].flat) {
        for (from, to) in patch[face].sides() {
            if !splits.contains(from, to) {
                sides.push((edge_between(from, to), from < to, place));
            }
        }
    }
    // 2. The borders between two of the faces.
    sides.sort_unstable();
    let between = sides.chunk_by(|x, y| x.0 == y.0).filter_map(|group| match *group {
        [(edge, false, one), (_, true, other)] => Some((edge, one, other)),
        _ => None,
    });
    let borders: Vec<(Edge, u32, u32)> = between.collect();
    // 3. Those that are coplanar edges, and needed by nobody else, join their faces.
    let are_crowded = find_crowded(patch, &borders);
    let origin = |place: u32| patch[faces[place as usize]].origin;
    let mut together = UnionFind::new(faces.len());
    for (&(_, one, other), is_crowded) in borders.iter().zip(are_crowded) {
        if !is_crowded && patch.source().are_mergeable(origin(one), origin(other)) {
            together.join(one, other);
        }
    }
    let (count, labels) = together.labels();
    Buckets::new(count, labels.iter().copied().zip(faces.iter().copied()))
}

/// For each of some edges, ascending, whether there are, or may be, more than two triangles: bodies touch there, and come apart
/// only if all of them keep the edge.
fn find_crowded(patch: &Patch<'_>, edges: &[(Edge, u32, u32)]) -> Vec<bool> {
    let mut lower_ends = BitSet::new(patch.point_count());
    edges.iter().for_each(|(edge, ..)| lower_ends.insert(edge.0.0));
    let mut triangles = vec![0u32; edges.len()];
    for (_, face) in patch.faces() {
        for (u, v) in face.sides() {
            let edge = edge_between(u, v);
            if lower_ends.contains(edge.0.0)
                && let Ok(place) = edges.binary_search_by_key(&edge, |entry| entry.0)
            {
                triangles[place] += 1;
            }
        }
    }
    let is_known = |&(u, v): &Edge| patch.is_complete(u) || patch.is_complete(v);
    edges.iter().zip(triangles).map(|((edge, ..), count)| count != 2 || !is_known(edge)).collect()
}

/// The outline of a strip.
struct Outline {
    /// Its directed edges, in [`border_order`].
    boundary: Vec<[LocalPoint; 2]>,
    /// Its points, ascending.
    points: Vec<LocalPoint>,
    /// The edges between faces of the strip, ascending.
    borders: Vec<Edge>,
}

/// The two directions of an edge side by side, the ascending one first.
fn border_order(&[u, v]: &[LocalPoint; 2]) -> (LocalPoint, LocalPoint, bool) {
    (u.min(v), u.max(v), u > v)
}

impl Outline {
    /// The sides of all faces, split, less those that cancel.
    fn of(patch: &Patch<'_>, strip: &[LocalFace], splits: &Splits) -> Self {
        let mut edges: Vec<[LocalPoint; 2]> = Vec::new();
        let mut path = Vec::new();
        for &face in strip {
            for (from, to) in patch[face].sides() {
                splits.trace(from, to, &mut path);
                edges.extend(path.windows(2).map(|pair| [pair[0], pair[1]]));
            }
        }
        edges.sort_unstable_by_key(border_order);
        let mut borders: Vec<Edge> = Vec::new();
        let mut boundary: Vec<[LocalPoint; 2]> = Vec::with_capacity(edges.len());
        for edge in edges {
            if boundary.last() == Some(&[edge[1], edge[0]]) {
                boundary.pop();
                borders.push((edge[1], edge[0]));
            } else {
                boundary.push(edge);
            }
        }
        let mut points: Vec<LocalPoint> = boundary.iter().map(|edge| edge[0]).collect();
        points.sort_unstable();
        points.dedup();
        Self { boundary, points, borders }
    }

    /// Whether some point of the strip is inside it: a triangulation of the outline would lose it.
    fn has_inner_point(&self) -> bool {
        let is_outer = |end: &LocalPoint| self.points.binary_search(end).is_ok();
        !self.borders.iter().all(|&(u, v)| [u, v].iter().all(is_outer))
    }

    /// Whether the strip has an edge already, inside or on its boundary, as directed.
    fn has_edge(&self, u: LocalPoint, v: LocalPoint) -> bool {
        self.borders.binary_search(&edge_between(u, v)).is_ok()
            || self.boundary.binary_search_by_key(&border_order(&[u, v]), border_order).is_ok()
    }
}

/// Triangulates some faces of one plane as one, if that is possible soundly.
fn triangulate_strip(
    patch: &mut Patch<'_>,
    strip: &[LocalFace],
    splits: &Splits,
    triangulator: &mut Triangulator,
) {
    // 1. The outline, by numbers without gaps.
    let outline = Outline::of(patch, strip, splits);
    if outline.has_inner_point() {
        return;
    }
    let Outline { boundary, points, .. } = &outline;
    let place = |point: LocalPoint| points.binary_search(&point).map_or(u32::MAX, |place| place as u32);
    let numbered: Vec<[u32; 2]> = boundary.iter().map(|edge| edge.map(place)).collect();
    // 2. Its triangulation in the plane.
    let projected = patch.project(points, patch[strip[0]].origin);
    let mut triangles = Vec::new();
    if !triangulator.soundly(&projected, &numbered, &mut triangles) {
        return;
    }
    // 3. It must have no needles, and no new edge that others may have too: those between points not all of whose triangles
    //    are in the patch.
    let triangles: Vec<[LocalPoint; 3]> =
        triangles.into_iter().map(|corners| corners.map(|place| points[place as usize])).collect();
    let is_known =
        |u: LocalPoint, v: LocalPoint| patch.is_complete(u) || patch.is_complete(v) || outline.has_edge(u, v);
    let is_fine = |&corners: &[LocalPoint; 3]| {
        !is_triangle_low(patch, corners) && (0..3).all(|k| is_known(corners[k], corners[(k + 1) % 3]))
    };
    if !triangles.iter().all(is_fine) {
        return;
    }
    // 4. The exchange.
    for &face in strip {
        patch.drop_face(face);
    }
    for corners in triangles {
        patch.add_part(strip[0], corners);
    }
}

/// Splits the sides of a face: a fan around the opposite corner for each.
fn split_face(patch: &mut Patch<'_>, face: LocalFace, splits: &Splits) {
    if !patch[face].alive {
        return;
    }
    // Triangles with, for each side from corner k, whether it is (part of) a side of the face.
    let mut stack = vec![(patch[face].corners, [true; 3])];
    let mut path = Vec::new();
    patch.drop_face(face);
    while let Some((corners, is_side)) = stack.pop() {
        let side = (0..3).find(|&k| is_side[k] && splits.contains(corners[k], corners[(k + 1) % 3]));
        let Some(k) = side else {
            patch.add_part(face, corners);
            continue;
        };
        let [from, to, opposite] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        splits.trace(from, to, &mut path);
        for (i, pair) in path.windows(2).enumerate() {
            let (first, last) = (i == 0, i + 2 == path.len());
            let sides = [true, last && is_side[(k + 1) % 3], first && is_side[(k + 2) % 3]];
            stack.push(([pair[0], pair[1], opposite], sides));
        }
    }
}

//! Faces whose sides get vertices: triangulated anew, those of one plane side by side as one.
//!
//! A long side with many vertices makes a fan of needles of the triangle it belongs to; together with the triangle beyond its
//! diagonal it is a strip, which has a sound triangulation.

use rustc_hash::FxHashMap;

use super::patch::{Face, Patch};
use super::zero_area::is_low;
use crate::boolean::complex::Complex;
use crate::mesh::BitSet;
use crate::mesh::Surface;
use crate::mesh::{Buckets, UnionFind};
use crate::polygon::Triangulator;

/// An edge, from its lower point to its higher one.
pub(super) type Edge = (u32, u32);

/// Edges to split, with the vertices on them.
pub(super) struct Splits {
    /// The vertices from the lower end to the higher one.
    on: FxHashMap<Edge, Vec<u32>>,
    /// The lower ends: most edges are told from those to split by this alone.
    lower_ends: BitSet,
}

impl Splits {
    pub(super) fn new(patch: &Patch<'_>) -> Self {
        Self { on: FxHashMap::default(), lower_ends: BitSet::new(patch.point_count()) }
    }

    pub(super) fn insert(&mut self, edge: Edge, on: Vec<u32>) {
        self.lower_ends.insert(edge.0);
        self.on.insert(edge, on);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.on.is_empty()
    }

    /// The vertices on the edge between two points, from its lower end to its higher one, if it is to be split.
    fn get(&self, from: u32, to: u32) -> Option<&Vec<u32>> {
        let edge = (from.min(to), from.max(to));
        if self.lower_ends.contains(edge.0) { self.on.get(&edge) } else { None }
    }

    /// Appends the way along an edge, but for its end.
    fn add_way(&self, from: u32, to: u32, way: &mut Vec<u32>) {
        way.push(from);
        match self.get(from, to) {
            Some(on) if from < to => way.extend(on),
            Some(on) => way.extend(on.iter().rev()),
            None => {}
        }
    }

    fn is_split(&self, face: &Face) -> bool {
        face.alive && (0..3).any(|k| self.get(face.corners[k], face.corners[(k + 1) % 3]).is_some())
    }
}

/// Splits the sides of all faces that are to be split. Diagonals are left alone, whatever else runs along them: they bound two
/// triangles of one face and so do not matter to others. Faces are put together where `planes` says that the border between
/// them means nothing.
pub(super) fn split_faces(patch: &mut Patch<'_>, splits: &Splits, planes: Option<&Complex<'_>>) {
    let faces: Vec<u32> = (0..patch.faces.len() as u32)
        .filter(|&index| splits.is_split(&patch.faces[index as usize]))
        .collect();
    if let Some(planes) = planes {
        let mut triangulator = Triangulator::default();
        for strip in strips(patch, &faces, splits, planes).each().filter(|strip| strip.len() > 1) {
            triangulate(patch, strip, splits, &mut triangulator);
        }
    }
    for index in faces {
        split_face(patch, index, splits);
    }
}

/// The faces that are to be split, those of one plane side by side together.
fn strips(patch: &Patch<'_>, faces: &[u32], splits: &Splits, planes: &Complex<'_>) -> Buckets<u32> {
    // Every side that is not to be split: its ends, whether it runs from the lower one, and the place of its face.
    let mut sides: Vec<(Edge, bool, u32)> = Vec::with_capacity(2 * faces.len());
    for (place, &index) in (0..).zip(faces) {
        let face = &patch.faces[index as usize];
        if face.flat {
            continue;
        }
        for k in 0..3 {
            let (from, to) = (face.corners[k], face.corners[(k + 1) % 3]);
            if splits.get(from, to).is_none() {
                sides.push(((from.min(to), from.max(to)), from < to, place));
            }
        }
    }
    sides.sort_unstable();
    let between = sides.chunk_by(|x, y| x.0 == y.0).filter_map(|group| match *group {
        [(edge, false, one), (_, true, other)] => Some((edge, one, other)),
        _ => None,
    });
    let borders: Vec<(Edge, u32, u32)> = between.collect();
    let is_crowded = crowded(patch, &borders);
    let origin = |place: u32| patch.faces[faces[place as usize] as usize].origin;
    let mut together = UnionFind::new(faces.len());
    for (&(_, one, other), is_crowded) in borders.iter().zip(is_crowded) {
        if !is_crowded && planes.are_mergeable(origin(one), origin(other)) {
            together.join(one, other);
        }
    }
    let (count, labels) = together.labels();
    Buckets::new(count, labels.iter().copied().zip(faces.iter().copied()))
}

/// For each of some edges, ascending, whether there are, or may be, more than two triangles: bodies touch there, and come apart
/// only if all of them keep the edge.
fn crowded(patch: &Patch<'_>, edges: &[(Edge, u32, u32)]) -> Vec<bool> {
    let mut lower_ends = BitSet::new(patch.point_count());
    edges.iter().for_each(|(edge, ..)| lower_ends.insert(edge.0));
    let mut triangles = vec![0u32; edges.len()];
    for face in patch.faces.iter().filter(|face| face.alive) {
        for k in 0..3 {
            let (u, v) = (face.corners[k], face.corners[(k + 1) % 3]);
            let edge = (u.min(v), u.max(v));
            if lower_ends.contains(edge.0)
                && let Ok(place) = edges.binary_search_by_key(&edge, |entry| entry.0)
            {
                triangles[place] += 1;
            }
        }
    }
    let is_known = |&(u, v): &Edge| patch.is_complete(u) || patch.is_complete(v);
    edges.iter().zip(triangles).map(|((edge, ..), count)| count != 2 || !is_known(edge)).collect()
}

/// Triangulates some faces of one plane as one, if that is possible soundly.
fn triangulate(patch: &mut Patch<'_>, strip: &[u32], splits: &Splits, triangulator: &mut Triangulator) {
    // The directed edges of all, less those that cancel: the borders between them.
    let mut edges: Vec<[u32; 2]> = Vec::new();
    let mut borders: Vec<Edge> = Vec::new();
    let mut way = Vec::new();
    for &index in strip {
        let corners = patch.faces[index as usize].corners;
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            way.clear();
            splits.add_way(from, to, &mut way);
            way.push(to);
            edges.extend(way.windows(2).map(|pair| [pair[0], pair[1]]));
        }
    }
    let order = |&[u, v]: &[u32; 2]| (u.min(v), u.max(v), u > v);
    edges.sort_unstable_by_key(order);
    let mut boundary: Vec<[u32; 2]> = Vec::with_capacity(edges.len());
    for edge in edges {
        if boundary.last() == Some(&[edge[1], edge[0]]) {
            boundary.pop();
            borders.push((edge[1], edge[0]));
        } else {
            boundary.push(edge);
        }
    }
    let mut points: Vec<u32> = boundary.iter().map(|edge| edge[0]).collect();
    points.sort_unstable();
    points.dedup();
    // A point inside would be lost.
    let all_on_boundary =
        borders.iter().all(|&(u, v)| [u, v].iter().all(|end| points.binary_search(end).is_ok()));
    if !all_on_boundary {
        return;
    }
    let face = patch.faces[strip[0] as usize];
    let flat = patch.projected(&points, face.origin);
    let local = |point: u32| points.binary_search(&point).map_or(u32::MAX, |place| place as u32);
    let local_boundary: Vec<[u32; 2]> = boundary.iter().map(|edge| edge.map(local)).collect();
    let mut triangles = Vec::new();
    if !triangulator.soundly(&flat, &local_boundary, &mut triangles) {
        return;
    }
    let triangles: Vec<[u32; 3]> =
        triangles.into_iter().map(|corners| corners.map(|place| points[place as usize])).collect();
    let is_known = |u: u32, v: u32| {
        // Others may lie beside an edge between points whose triangles are not all here.
        patch.is_complete(u)
            || patch.is_complete(v)
            || borders.binary_search(&(u.min(v), u.max(v))).is_ok()
            || boundary.binary_search_by_key(&order(&[u, v]), order).is_ok()
    };
    let is_fine = |corners: &[u32; 3]| {
        !is_low(corners.map(|point| patch.position(point)), patch.rounding())
            && (0..3).all(|k| is_known(corners[k], corners[(k + 1) % 3]))
    };
    if !triangles.iter().all(is_fine) {
        return;
    }
    for &index in strip {
        patch.faces[index as usize].alive = false;
    }
    patch.faces.extend(triangles.into_iter().map(|corners| Face { corners, untouched: false, ..face }));
}

/// Splits the sides of a face: a fan round the opposite corner for each.
fn split_face(patch: &mut Patch<'_>, index: u32, splits: &Splits) {
    let face = patch.faces[index as usize];
    if !face.alive {
        return;
    }
    patch.faces[index as usize].alive = false;
    // Triangles with, for each side from corner k, whether it is (part of) a side of the face.
    let mut stack = vec![(face.corners, [true; 3])];
    while let Some((corners, is_side)) = stack.pop() {
        let side = (0..3).find(|&k| is_side[k] && splits.get(corners[k], corners[(k + 1) % 3]).is_some());
        let Some(k) = side else {
            patch.faces.push(Face { corners, untouched: false, ..face });
            continue;
        };
        let [from, to, opposite] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let mut way = Vec::new();
        splits.add_way(from, to, &mut way);
        way.push(to);
        for (i, pair) in way.windows(2).enumerate() {
            let (first, last) = (i == 0, i + 2 == way.len());
            let sides = [true, last && is_side[(k + 1) % 3], first && is_side[(k + 2) % 3]];
            stack.push(([pair[0], pair[1], opposite], sides));
        }
    }
}

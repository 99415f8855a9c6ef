//! Edges in which surfaces touch: the same subdivision for all faces.
//!
//! Where both operands have the same edge, or part of it, the perturbation may let them cross somewhere along it: some faces
//! then pass along the whole edge and others along its parts. Bodies that touch in an edge only come apart if all faces
//! there meet in the same edges. So every edge gets the vertices of the shorter edges that run along it.

use rustc_hash::FxHashMap;

use super::super::cut::Cutter;
use super::patch::{Face, Patch};
use crate::exact::{Sign, collinear, orient3d};

/// An edge, from its lower point to its higher one.
pub(super) type Edge = (u32, u32);

/// Rounds of splitting: halves may have vertices on them again.
const ROUNDS: usize = 4;
/// Splitting ends when the faces have become so many times as many.
const MOST_GROWTH: usize = 4;

/// Splits the edges along which shorter ones run.
pub(super) fn split(patch: &mut Patch<'_>, cutter: &Cutter<'_>) {
    let most = MOST_GROWTH * patch.faces.len();
    for _ in 0..ROUNDS {
        let splits = splits(patch, cutter);
        if splits.is_empty() || patch.faces.len() > most {
            return;
        }
        for index in 0..patch.faces.len() {
            split_face(patch, index, &splits);
        }
        patch.cancel();
    }
}

/// Splits the sides of a face that are to be split. Diagonals are left alone, whatever else runs along them: they bound two
/// triangles of this face and so do not matter to others.
pub(super) fn split_face(patch: &mut Patch<'_>, index: usize, splits: &FxHashMap<Edge, Vec<u32>>) {
    let face = patch.faces[index];
    let on_side = |from: u32, to: u32| splits.get(&(from.min(to), from.max(to)));
    let is_split = |k: usize| on_side(face.corners[k], face.corners[(k + 1) % 3]).is_some();
    if !face.alive || !(0..3).any(is_split) {
        return;
    }
    patch.faces[index].alive = false;
    // Triangles with, for each side from corner k, whether it is (part of) a side of the face.
    let mut stack = vec![(face.corners, [true; 3])];
    while let Some((corners, is_side)) = stack.pop() {
        let side = (0..3).filter(|&k| is_side[k]).find_map(|k| {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            Some((k, on_side(from, to)?))
        });
        let Some((k, on)) = side else {
            patch.faces.push(Face { corners, untouched: false, ..face });
            continue;
        };
        // A fan round the opposite corner. The vertices are in order from the lower end of the edge.
        let [from, to, opposite] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let mut chain = Vec::with_capacity(on.len() + 2);
        chain.push(from);
        if from < to {
            chain.extend(on);
        } else {
            chain.extend(on.iter().rev());
        }
        chain.push(to);
        for (i, pair) in chain.windows(2).enumerate() {
            let (first, last) = (i == 0, i + 2 == chain.len());
            let sides = [true, last && is_side[(k + 1) % 3], first && is_side[(k + 2) % 3]];
            stack.push(([pair[0], pair[1], opposite], sides));
        }
    }
}

/// Edges to split, with the vertices on them from the lower end to the higher one: edges of one operand along which edges of
/// the other run.
fn splits(patch: &Patch<'_>, cutter: &Cutter<'_>) -> FxHashMap<Edge, Vec<u32>> {
    let edges = edges(patch);
    // Each edge from both its ends, so that those at one point are together.
    let mut from_points: Vec<(u32, u32, u8)> =
        edges.iter().flat_map(|&((u, v), of)| [(u, v, of), (v, u, of)]).collect();
    from_points.sort_unstable();
    let neighbours = |point: u32| {
        let first = from_points.partition_point(|entry| entry.0 < point);
        from_points[first..].iter().take_while(move |entry| entry.0 == point)
    };
    let mut splits = FxHashMap::default();
    let complete = |&&((u, v), _): &&(Edge, u8)| patch.is_complete(u) && patch.is_complete(v);
    for &((u, v), of) in edges.iter().filter(complete) {
        // From vertex to vertex along the edge.
        let mut on: Vec<u32> = Vec::new();
        let mut next = 0;
        let mut from = u;
        loop {
            for &(_, x, of_x) in neighbours(from) {
                let may_touch = of | of_x == BOTH && x != u && x != v;
                if may_touch && !on.contains(&x) && lies_between(patch, cutter, u, x, v) {
                    on.push(x);
                }
            }
            let Some(&x) = on.get(next) else { break };
            (from, next) = (x, next + 1);
        }
        if !on.is_empty() {
            let start = *patch.position(u);
            let distance = |x: &u32| (0..3).map(|k| (patch.position(*x)[k] - start[k]).powi(2)).sum::<f64>();
            on.sort_by(|x, y| distance(x).total_cmp(&distance(y)));
            splits.insert((u, v), on);
        }
    }
    splits
}

/// Faces of both operands.
const BOTH: u8 = 3;

/// All edges, from the lower point to the higher one, and whose faces are there: a bit for each operand.
fn edges(patch: &Patch<'_>) -> Vec<(Edge, u8)> {
    let mut sides: Vec<(Edge, u8)> = Vec::with_capacity(3 * patch.faces.len());
    for face in patch.faces.iter().filter(|face| face.alive) {
        let [a, b, c] = face.corners;
        sides.extend([(a, b), (b, c), (c, a)].map(|(u, v)| ((u.min(v), u.max(v)), 1 << face.origin.operand)));
    }
    sides.sort_unstable();
    sides
        .chunk_by(|x, y| x.0 == y.0)
        .map(|group| (group[0].0, group[0].1 | group[group.len() - 1].1))
        .collect()
}

/// Whether `x` lies on the segment from `u` to `v`, not at its ends: exactly as given, or before it was rounded. Both parts
/// are shorter than the whole, so splitting comes to an end.
fn lies_between(patch: &Patch<'_>, cutter: &Cutter<'_>, u: u32, x: u32, v: u32) -> bool {
    let (p, at, q) = (patch.position(u), patch.position(x), patch.position(v));
    // Nearly always one look says no: rounding moves a point by less than a unit in the last place.
    let is_within = (0..3).all(|k| p[k].min(q[k]) <= at[k] && at[k] <= p[k].max(q[k]));
    let length = |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f64>();
    let [u_v, u_x]: [[f64; 3]; 2] = [q, at].map(|end| std::array::from_fn(|k| end[k] - p[k]));
    let twice_area = (0..3)
        .map(|k| (u_v[(k + 1) % 3] * u_x[(k + 2) % 3] - u_v[(k + 2) % 3] * u_x[(k + 1) % 3]).powi(2))
        .sum::<f64>();
    let is_off = twice_area > (2.0 * cutter.rounding).powi(2) * length(p, q);
    is_within
        && !is_off
        && length(p, at).max(length(at, q)) < length(p, q)
        && (collinear(p, at, q) || were_on_one_line(cutter, [u, x, v]))
}

/// Whether three points lay on the line of some edge before nodes were rounded.
fn were_on_one_line(cutter: &Cutter<'_>, points: [u32; 3]) -> bool {
    points.iter().filter_map(|&point| Node::of(cutter, point)).any(|node| {
        let [a, b, c] = node.triangle;
        [node.edge, [a, b], [b, c], [c, a]]
            .iter()
            .any(|line| points.iter().all(|&point| was_on_line(cutter, point, line)))
    })
}

/// An edge and the triangle it crosses.
struct Node {
    edge: [[f64; 3]; 2],
    triangle: [[f64; 3]; 3],
}

impl Node {
    /// The node of a point; `None` for vertices and copies.
    fn of(cutter: &Cutter<'_>, point: u32) -> Option<Self> {
        let operands = cutter.operands;
        let index = point.checked_sub(operands.vertex_count())?;
        let crossing = cutter.crossings.nodes.get(index as usize)?;
        let other = 1 - operands.side_of(crossing.low);
        Some(Self {
            edge: [crossing.low, crossing.high].map(|vertex| *operands.position(vertex)),
            triangle: operands.corners(other, crossing.triangle).map(|corner| corner.position),
        })
    }
}

/// Whether a point lay on the line through two others before it was rounded. (True only where it did.)
fn was_on_line(cutter: &Cutter<'_>, point: u32, [p, q]: &[[f64; 3]; 2]) -> bool {
    let on_line = |c: &[f64; 3]| collinear(p, q, c);
    let Some(Node { edge, triangle: [a, b, c] }) = Node::of(cutter, point) else {
        return point < cutter.operands.vertex_count() && on_line(cutter.operands.position(point));
    };
    if edge.iter().all(on_line) {
        return true;
    }
    // The edge must pass through the triangle's plane in a point.
    let passes = edge.iter().any(|end| orient3d(&a, &b, &c, end) != Sign::Zero);
    passes
        && [(a, b), (b, c), (c, a)]
            .iter()
            .any(|(a, b)| on_line(a) && on_line(b) && orient3d(a, b, &edge[0], &edge[1]) == Sign::Zero)
}

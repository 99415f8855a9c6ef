//! Edges in which the operands touch: the same subdivision for all faces.
//!
//! Where both operands have the same edge, or part of it, the perturbation may let them cross somewhere along it: some faces
//! then pass along the whole edge and others along its parts. Bodies that touch in an edge only come apart if all faces
//! there meet in the same edges. So every edge between faces of different operands gets the vertices of the shorter such
//! edges that run along it.

use rustc_hash::FxHashMap;

use super::super::cut::Cutter;
use super::patch::{Face, Patch};
use crate::exact::{Sign, collinear, orient3d};

/// An edge between faces of both operands, from its lower point to its higher one.
type Edge = (u32, u32);

/// Rounds of splitting: halves may be shared edges with vertices on them again.
const ROUNDS: usize = 4;

/// Splits the edges at which faces of both operands meet.
pub(super) fn split(patch: &mut Patch<'_>, cutter: &Cutter<'_>) {
    for _ in 0..ROUNDS {
        let splits = splits(patch, cutter);
        if splits.is_empty() {
            return;
        }
        let mut index = 0;
        while index < patch.faces.len() {
            if !split_face(patch, index, &splits) {
                index += 1;
            }
        }
        patch.cancel();
    }
}

/// Splits one side of a face, if it is to be split: a fan round the opposite corner. The face itself becomes the last
/// triangle of the fan, which has the other two sides in part.
fn split_face(patch: &mut Patch<'_>, index: usize, splits: &FxHashMap<Edge, Vec<u32>>) -> bool {
    let face = patch.faces[index];
    if !face.alive {
        return false;
    }
    let corners = face.corners;
    let side = (0..3).find_map(|k| {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        splits.get(&(from.min(to), from.max(to))).map(|on| (from, to, corners[(k + 2) % 3], on))
    });
    let Some((from, to, opposite, on)) = side else { return false };
    // The vertices are in order from the lower end of the edge.
    let mut chain = Vec::with_capacity(on.len() + 2);
    chain.push(from);
    if from < to {
        chain.extend(on);
    } else {
        chain.extend(on.iter().rev());
    }
    chain.push(to);
    patch.faces[index].alive = false;
    for pair in chain.windows(2).filter(|pair| !pair.contains(&opposite)) {
        patch.faces.push(Face { corners: [pair[0], pair[1], opposite], untouched: false, ..face });
    }
    true
}

/// Edges to split, with the vertices on them from the lower end to the higher one.
fn splits(patch: &Patch<'_>, cutter: &Cutter<'_>) -> FxHashMap<Edge, Vec<u32>> {
    let shared = shared_edges(patch);
    // Each edge from both its ends, so that those at one point are together.
    let mut from_points: Vec<(u32, u32)> = shared.iter().flat_map(|&(u, v)| [(u, v), (v, u)]).collect();
    from_points.sort_unstable();
    let neighbours = |point: u32| {
        let first = from_points.partition_point(|pair| pair.0 < point);
        from_points[first..].iter().take_while(move |pair| pair.0 == point).map(|pair| pair.1)
    };
    let mut splits = FxHashMap::default();
    for &(u, v) in shared.iter().filter(|&&(u, v)| patch.is_complete(u) && patch.is_complete(v)) {
        // From vertex to vertex along the edge.
        let mut on: Vec<u32> = Vec::new();
        let mut next = 0;
        let mut from = u;
        loop {
            for x in neighbours(from) {
                if x != u && x != v && !on.contains(&x) && lies_between(patch, cutter, u, x, v) {
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

fn shared_edges(patch: &Patch<'_>) -> Vec<Edge> {
    let mut sides: Vec<(u32, u32, u32)> = Vec::new();
    for face in patch.faces.iter().filter(|face| face.alive) {
        for k in 0..3 {
            let (u, v) = (face.corners[k], face.corners[(k + 1) % 3]);
            sides.push((u.min(v), u.max(v), face.origin.operand));
        }
    }
    sides.sort_unstable();
    sides
        .chunk_by(|x, y| (x.0, x.1) == (y.0, y.1))
        .filter(|group| group[0].2 != group[group.len() - 1].2)
        .map(|group| (group[0].0, group[0].1))
        .collect()
}

/// Whether `x` lies on the segment from `u` to `v`, not at its ends: exactly as given, or before it was rounded.
fn lies_between(patch: &Patch<'_>, cutter: &Cutter<'_>, u: u32, x: u32, v: u32) -> bool {
    let (p, at, q) = (patch.position(u), patch.position(x), patch.position(v));
    // Along the axis on which the segment is longest; nearly always that says no.
    let axis =
        (1..3).fold(0, |best, k| if (q[k] - p[k]).abs() > (q[best] - p[best]).abs() { k } else { best });
    let is_within = if p[axis] < q[axis] {
        p[axis] < at[axis] && at[axis] < q[axis]
    } else {
        q[axis] < at[axis] && at[axis] < p[axis]
    };
    is_within && (collinear(p, at, q) || were_on_one_line(cutter, [u, x, v]))
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

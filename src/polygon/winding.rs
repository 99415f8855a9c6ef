//! What edges wind around, whatever they are: sums of regions of one plane.

use rustc_hash::FxHashMap;

use super::delaunay::triangulate_between;
use crate::exact::at_hand::{ROUNDING_ULPS, largest_beside, size_at_hand};
use crate::exact::{Sign, orient2d};
use crate::polygon::counted::{CountedEdge, CountedTriangle};

/// A directed edge that counts a number of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edge {
    pub(crate) ends: [u32; 2],
    pub(crate) count: i32,
    /// The line it is a part of: the caller's number, for finding crossings.
    pub(crate) line: u32,
    /// Whether it is an edge of triangles even where it counts 0 times in sum.
    pub(crate) kept: bool,
}

/// How often edges are split at most. Splitting moves an edge by no more than rounding, so few are left after the first time.
const ROUNDS: usize = 8;

/// What edges wind around.
#[derive(Debug)]
pub(crate) struct Found {
    /// Counter-clockwise triangles with their winding numbers.
    pub(crate) triangles: Vec<CountedTriangle>,
    /// Triangles whose area is zero up to rounding, between edges that run through vertices and the chains of edges in their
    /// place, and how often they count.
    pub(crate) slivers: Vec<CountedTriangle>,
}

/// Triangulates what edges, each with a count, wind around. The boundary of the sum of all triangles is the sum of the edges,
/// exactly. Where edges cross only because their ends were rounded, a vertex within rounding of an edge counts as lying on
/// it. Where they cross properly, `cross` is asked for a vertex (which it may append to the points); `None` if it has none.
pub(crate) fn by_winding(
    points: &mut Vec<[f64; 2]>,
    edges: &[Edge],
    mut cross: impl FnMut(&Edge, &Edge, &mut Vec<[f64; 2]>) -> Option<u32>,
) -> Option<Found> {
    let largest = edges
        .iter()
        .flat_map(|edge| edge.ends)
        .flat_map(|v| points[v as usize])
        .fold(0.0f64, |most, x| most.max(x.abs()));
    let mut slivers = Vec::new();
    let edges = join_places(points, &summed(edges), &mut slivers);
    let edges = split_at_vertices(points, &summed(&edges), largest, &mut slivers);
    let mut edges = summed(&edges);
    for _ in 0..ROUNDS {
        let counted: Vec<CountedEdge> = edges.iter().map(|edge| (edge.ends, edge.count)).collect();
        if let Ok(triangles) = triangulate_between(points, &counted) {
            return Some(Found { triangles, slivers });
        }
        let before = slivers.len();
        let mut split = split_at_vertices(points, &edges, largest, &mut slivers);
        if slivers.len() == before {
            split = split_at_crossings(points, &edges, &mut cross, &mut slivers);
        }
        if slivers.len() == before {
            return None;
        }
        edges = summed(&split);
    }
    None
}

/// The sum of edges: each once, from its lower vertex to its higher one, in order; none that counts 0 times, but those that are
/// kept.
fn summed(edges: &[Edge]) -> Vec<Edge> {
    let mut edges: Vec<Edge> = edges
        .iter()
        .map(|&Edge { ends: [u, v], count, line, kept }| {
            if u < v {
                Edge { ends: [u, v], count, line, kept }
            } else {
                Edge { ends: [v, u], count: -count, line, kept }
            }
        })
        .collect();
    edges.sort_unstable_by_key(|edge| (edge.ends, edge.line));
    edges
        .chunk_by(|x, y| x.ends == y.ends)
        .map(|group| Edge {
            count: group.iter().map(|edge| edge.count).sum(),
            kept: group.iter().any(|edge| edge.kept),
            ..group[0]
        })
        .filter(|edge| edge.count != 0 || edge.kept)
        .collect()
}

/// Replaces vertices by the first in their place, and adds the triangles without area that, together with the new edges, bound the
/// same. (Points that differ in space may be in one place in the plane.)
fn join_places(points: &[[f64; 2]], edges: &[Edge], slivers: &mut Vec<CountedTriangle>) -> Vec<Edge> {
    // 1. The first vertex in each place.
    let place = |v: u32| points[v as usize].map(|x| (x + 0.0).to_bits());
    let mut vertices: Vec<u32> = edges.iter().flat_map(|edge| edge.ends).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut first: FxHashMap<[u64; 2], u32> = FxHashMap::default();
    let first_of: Vec<u32> = vertices.iter().map(|&v| *first.entry(place(v)).or_insert(v)).collect();
    if first_of == vertices {
        return edges.to_vec();
    }
    let first_of = |v: u32| vertices.binary_search(&v).map_or(v, |i| first_of[i]);
    // 2. The edge from u to v is that from u to w, in the place of v, that from w to v, and the boundary of the triangle between
    //    them. What leads from w to v cancels in the end, since v is entered as often as it is left.
    let mut joined = Vec::with_capacity(edges.len());
    for edge in edges {
        let mut ends = edge.ends;
        let mut count = edge.count;
        for _ in 0..2 {
            let [u, v] = ends;
            let w = first_of(v);
            if w != v {
                joined.push(Edge { ends: [w, v], count, ..*edge });
                if u != w {
                    slivers.push(([u, v, w], count));
                }
            }
            (ends, count) = ([w, u], -count);
        }
        if ends[0] != ends[1] {
            joined.push(Edge { ends, count, ..*edge });
        }
    }
    joined
}

/// Replaces an edge by a chain through vertices on it, and adds the triangles without area that, together with the chain,
/// bound the same as the edge.
fn split_edge(edge: &Edge, on: &[u32], split: &mut Vec<Edge>, slivers: &mut Vec<CountedTriangle>) {
    let [u, v] = edge.ends;
    let mut from = u;
    for &x in on.iter().chain(&[v]) {
        split.push(Edge { ends: [from, x], ..*edge });
        if from != u {
            slivers.push(([u, x, from], edge.count));
        }
        from = x;
    }
}

/// Splits edges that run through vertices, or pass them no further than rounding of the coordinates there, of which `largest` is
/// the largest anywhere: each of the three points is off by half a unit in the last place in each coordinate.
fn split_at_vertices(
    points: &[[f64; 2]],
    edges: &[Edge],
    largest: f64,
    slivers: &mut Vec<CountedTriangle>,
) -> Vec<Edge> {
    let mut vertices: Vec<u32> = edges.iter().flat_map(|edge| edge.ends).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let at = |k: usize, v: u32| points[v as usize][k];
    // No vertex is further off than this.
    let rounding = ROUNDING_ULPS * f64::EPSILON * largest;
    // Along each axis; a list of either axis holds all that can lie on an edge.
    let sorted = [0, 1].map(|k| {
        let mut sorted = vertices.clone();
        sorted.sort_by(|&x, &y| at(k, x).total_cmp(&at(k, y)));
        sorted
    });
    let mut split = Vec::with_capacity(edges.len());
    for edge in edges {
        let [u, v] = edge.ends;
        let (p, q) = (points[u as usize], points[v as usize]);
        // Along the axis on which the edge is longer.
        let k = usize::from((q[1] - p[1]).abs() > (q[0] - p[0]).abs());
        let along = |x: u32| if q[k] > p[k] { at(k, x) } else { -at(k, x) };
        let is_on = |x: u32| {
            let at = points[x as usize];
            let is_near = || {
                let part = (at[k] - p[k]) / (q[k] - p[k]);
                let across = (at[1 - k] - (p[1 - k] + part * (q[1 - k] - p[1 - k]))).abs();
                let size = || size_at_hand(largest, largest_beside(&p, &at, &q, part));
                across <= rounding && across <= ROUNDING_ULPS * f64::EPSILON * size()
            };
            orient2d(p, q, at) == Sign::Zero || is_near()
        };
        let near = |k: usize| {
            let (low, high) = (p[k].min(q[k]) - rounding, p[k].max(q[k]) + rounding);
            let first = sorted[k].partition_point(|&x| at(k, x) < low);
            let end = sorted[k].partition_point(|&x| at(k, x) <= high);
            &sorted[k][first..end]
        };
        let near = [near(0), near(1)];
        let shorter = if near[0].len() < near[1].len() { near[0] } else { near[1] };
        let mut on: Vec<u32> = shorter
            .iter()
            .copied()
            .filter(|&x| x != u && x != v && along(u) < along(x) && along(x) < along(v))
            .filter(|&x| is_on(x))
            .collect();
        on.sort_by(|&x, &y| along(x).total_cmp(&along(y)).then(x.cmp(&y)));
        split_edge(edge, &on, &mut split, slivers);
    }
    split
}

/// Splits edges where they cross one another.
fn split_at_crossings(
    points: &mut Vec<[f64; 2]>,
    edges: &[Edge],
    cross: &mut impl FnMut(&Edge, &Edge, &mut Vec<[f64; 2]>) -> Option<u32>,
    slivers: &mut Vec<CountedTriangle>,
) -> Vec<Edge> {
    let at = |points: &[[f64; 2]], i: usize, end: usize| points[edges[i].ends[end] as usize];
    let range = |points: &[[f64; 2]], i: usize, k: usize| {
        let (p, q) = (at(points, i, 0)[k], at(points, i, 1)[k]);
        (p.min(q), p.max(q))
    };
    let mut order: Vec<usize> = (0..edges.len()).collect();
    order.sort_by(|&i, &j| range(points, i, 0).0.total_cmp(&range(points, j, 0).0));
    let mut on: FxHashMap<usize, Vec<u32>> = FxHashMap::default();
    for (place, &i) in order.iter().enumerate() {
        let ((_, end), (low, high)) = (range(points, i, 0), range(points, i, 1));
        for &j in &order[place + 1..] {
            if range(points, j, 0).0 > end {
                break;
            }
            let other = range(points, j, 1);
            if other.0 > high || low > other.1 {
                continue;
            }
            let ends = [at(points, i, 0), at(points, i, 1), at(points, j, 0), at(points, j, 1)];
            if !cross_properly(ends) {
                continue;
            }
            if let Some(x) = cross(&edges[i], &edges[j], points) {
                for i in [i, j] {
                    if !edges[i].ends.contains(&x) {
                        on.entry(i).or_default().push(x);
                    }
                }
            }
        }
    }
    let mut split = Vec::with_capacity(edges.len() + 2 * on.len());
    for (i, edge) in edges.iter().enumerate() {
        let mut on = on.remove(&i).unwrap_or_default();
        let [p, q] = [at(points, i, 0), at(points, i, 1)];
        let k = usize::from((q[1] - p[1]).abs() > (q[0] - p[0]).abs());
        let along = |x: u32| if q[k] > p[k] { points[x as usize][k] } else { -points[x as usize][k] };
        on.sort_by(|&x, &y| along(x).total_cmp(&along(y)).then(x.cmp(&y)));
        on.dedup();
        split_edge(edge, &on, &mut split, slivers);
    }
    split
}

/// Whether two edges cross in a point inside both.
pub(crate) fn cross_properly([p, q, a, b]: [[f64; 2]; 4]) -> bool {
    let opposite = |x: Sign, y: Sign| x != Sign::Zero && y != Sign::Zero && x != y;
    opposite(orient2d(p, q, a), orient2d(p, q, b)) && opposite(orient2d(a, b, p), orient2d(a, b, q))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// The sum of edges, by ascending ends.
    fn chain(edges: impl Iterator<Item = ([u32; 2], i32)>) -> BTreeMap<[u32; 2], i32> {
        let mut sum = BTreeMap::new();
        for ([u, v], count) in edges {
            *sum.entry([u.min(v), u.max(v)]).or_insert(0) += if u < v { count } else { -count };
        }
        sum.retain(|_, count| *count != 0);
        sum
    }

    #[test]
    fn points_in_one_place_are_one_vertex() {
        // A square, and another over it that is turned the other way and has its own copy of one corner or of all; with a point of
        // two copies on a side.
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        for copied in 1..=4 {
            let mut points = [square, square].concat();
            points.extend([[2.0, 0.0], [2.0, 0.0]]);
            let other = |k: u32| if k < copied { k + 4 } else { k };
            let edge = |ends: [u32; 2], count| Edge { ends, count, line: 0, kept: false };
            let mut edges: Vec<Edge> = (1..4).map(|k| edge([k, (k + 1) % 4], 1)).collect();
            edges.extend([[0, 8], [8, 1]].map(|ends| edge(ends, 1)));
            edges.extend((1..4).map(|k| edge([other(k), other((k + 1) % 4)], -1)));
            edges.extend([[other(0), 9], [9, other(1)]].map(|ends| edge(ends, -1)));
            let found = by_winding(&mut points, &edges, |_, _, _| None).expect("nothing crosses");
            assert!(found.triangles.is_empty(), "{copied}: {found:?}");
            let around = found
                .slivers
                .iter()
                .flat_map(|&([a, b, c], count)| [([a, b], count), ([b, c], count), ([c, a], count)]);
            assert_eq!(chain(around), chain(edges.iter().map(|edge| (edge.ends, edge.count))), "{copied}");
        }
    }
}

//! Constrained Delaunay triangulation: of big polygons, and of whatever edges bound, by winding number.

use rustc_hash::FxHashMap;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::exact::{Sign, orient2d};

/// A vertex that remembers its index.
struct Vertex {
    position: Point2<f64>,
    index: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// An edge, or a triangle, and how often it counts.
type CountedEdge = ([u32; 2], i32);
type CountedTriangle = ([u32; 3], i32);

/// Appends a triangulation of the region to the left of the rings and returns true; or returns false and appends nothing
/// where the shape does not allow one (coincident projections, crossing edges, a coordinate out of range).
pub(super) fn triangulate(points: &[[f64; 2]], rings: &[&[u32]], triangles: &mut Vec<[u32; 3]>) -> bool {
    attempt(points, rings).is_some_and(|found| {
        triangles.extend(found);
        true
    })
}

fn attempt(points: &[[f64; 2]], rings: &[&[u32]]) -> Option<Vec<[u32; 3]>> {
    let mut corners = 0;
    let mut edges = Vec::new();
    for ring in rings {
        corners += ring.len();
        edges.extend((0..ring.len()).map(|i| ([ring[i], ring[(i + 1) % ring.len()]], 1)));
    }
    let found = between(points, &edges)?;
    // Complete: the count of Euler's formula for one outline (vertices visited twice count twice).
    (found.len() + 4 == corners + 2 * rings.len() && found.iter().all(|&(_, winding)| winding == 1))
        .then(|| found.into_iter().map(|(triangle, _)| triangle).collect())
}

/// Vertices up to so many units in the last place of the largest coordinate from an edge may lie on it: each of the three
/// points is off by half a unit in each coordinate.
const ROUNDING_ULPS: f64 = 4.0;
/// Rounds of splitting edges at vertices. Splitting moves an edge by no more than rounding, so few are left after the first.
const ROUNDS: usize = 6;

/// Triangulates what edges, each with a count, wind round: triangles (counter-clockwise) with their winding numbers. The
/// boundary of their sum is the sum of the edges, exactly: where an edge runs through a vertex that is not its end, there
/// are triangles without area between it and the chain of edges in its place. Where edges cross because their ends were
/// rounded, a vertex so near an edge counts as lying on it. `None` for edges that cross in earnest.
pub(crate) fn by_winding(points: &[[f64; 2]], edges: &[([u32; 2], i32)]) -> Option<Vec<([u32; 3], i32)>> {
    let largest = edges
        .iter()
        .flat_map(|(edge, _)| edge)
        .flat_map(|&v| points[v as usize])
        .fold(0.0f64, |most, x| most.max(x.abs()));
    let (mut split, mut slivers) = split_at_vertices(points, edges, 0.0);
    let mut found = between(points, &split);
    for _ in 0..ROUNDS {
        if found.is_some() {
            break;
        }
        let (finer, more) = split_at_vertices(points, &split, ROUNDING_ULPS * f64::EPSILON * largest);
        if more.is_empty() {
            return None;
        }
        split = finer;
        slivers.extend(more);
        found = between(points, &split);
    }
    let mut found = found?;
    found.extend(slivers);
    Some(found)
}

/// Replaces edges that run through vertices, or pass them no further than `rounding`, by chains of edges, and returns with
/// them the triangles without area that, together with the chain, bound the same as the edge.
fn split_at_vertices(
    points: &[[f64; 2]],
    edges: &[([u32; 2], i32)],
    rounding: f64,
) -> (Vec<CountedEdge>, Vec<CountedTriangle>) {
    let mut vertices: Vec<u32> = edges.iter().flat_map(|(edge, _)| *edge).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut split = Vec::with_capacity(edges.len());
    let mut slivers = Vec::new();
    for &([u, v], count) in edges {
        let (p, q) = (points[u as usize], points[v as usize]);
        // Along the axis on which the edge is longer.
        let k = usize::from((q[1] - p[1]).abs() > (q[0] - p[0]).abs());
        let along = |x: u32| if q[k] > p[k] { points[x as usize][k] } else { -points[x as usize][k] };
        let is_on = |x: u32| {
            let at = points[x as usize];
            let across = || {
                let part = (at[k] - p[k]) / (q[k] - p[k]);
                (at[1 - k] - (p[1 - k] + part * (q[1 - k] - p[1 - k]))).abs()
            };
            orient2d(p, q, at) == Sign::Zero || (rounding > 0.0 && across() <= rounding)
        };
        let mut on: Vec<u32> = vertices
            .iter()
            .copied()
            .filter(|&x| x != u && x != v && along(u) < along(x) && along(x) < along(v))
            .filter(|&x| is_on(x))
            .collect();
        on.sort_by(|&x, &y| along(x).total_cmp(&along(y)));
        on.push(v);
        let mut from = u;
        for &x in &on {
            split.push(([from, x], count));
            if from != u {
                slivers.push(([u, x, from], count));
            }
            from = x;
        }
    }
    (split, slivers)
}

/// Triangulates the plane between edges that each count a number of times, and returns the counter-clockwise triangles
/// round which they wind, with the winding number. `None` where the triangulation does not hold every edge as it is.
fn between(points: &[[f64; 2]], edges: &[([u32; 2], i32)]) -> Option<Vec<([u32; 3], i32)>> {
    // How often an edge counts from its lower vertex to its higher one.
    let mut counts: FxHashMap<(u32, u32), i32> = FxHashMap::default();
    for &([u, v], count) in edges {
        if u == v {
            return None;
        }
        *counts.entry((u.min(v), u.max(v))).or_default() += if u < v { count } else { -count };
    }
    counts.retain(|_, count| *count != 0);
    let mut constraints: Vec<(u32, u32)> = counts.keys().copied().collect();
    constraints.sort_unstable();
    let mut indices: Vec<u32> = constraints.iter().flat_map(|&(u, v)| [u, v]).collect();
    indices.sort_unstable();
    indices.dedup();
    let place = |v: u32| indices.binary_search(&v).expect("collected above");
    // Spade takes nothing but zero below 2^-142; such a difference is far below an ulp of the polygon's size.
    let vertices: Vec<Vertex> = indices
        .iter()
        .map(|&index| {
            let [x, y] = points[index as usize].map(|x| if x.abs() < 1e-42 { 0.0 } else { x });
            Vertex { position: Point2::new(x, y), index }
        })
        .collect();
    let count = vertices.len();
    let pairs = constraints.iter().map(|&(u, v)| [place(u), place(v)]).collect();
    let mut conflict = false;
    let triangulation =
        ConstrainedDelaunayTriangulation::<Vertex>::try_bulk_load_cdt(vertices, pairs, |_| conflict = true)
            .ok()?;
    if conflict || triangulation.num_vertices() != count {
        return None;
    }
    // Flood from outside, where the winding number is 0; an edge passed from its right to its left adds its count.
    let mut winding: Vec<Option<i32>> = vec![None; triangulation.num_all_faces()];
    let outer = triangulation.outer_face();
    winding[outer.index()] = Some(0);
    let mut stack = vec![outer.fix()];
    let mut seen = 0;
    while let Some(face) = stack.pop() {
        let here = winding[face.index()]?;
        // Every edge once from each side, with its face to the left.
        let around: Vec<_> = match triangulation.face(face).as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => triangulation.convex_hull().map(|edge| edge.rev()).collect(),
        };
        for edge in around {
            let edge = if edge.face().fix() == face { edge } else { edge.rev() };
            let (from, to) = (edge.from().data().index, edge.to().data().index);
            let count = counts.get(&(from.min(to), from.max(to))).copied().unwrap_or(0);
            seen += usize::from(count != 0);
            // What lies to the left of an edge winds once more than what lies to its right.
            let there = here - if from < to { count } else { -count };
            let other = edge.rev().face().fix();
            match winding[other.index()] {
                None => {
                    winding[other.index()] = Some(there);
                    stack.push(other);
                }
                Some(known) if known != there => return None,
                Some(_) => {}
            }
        }
    }
    if seen != 2 * counts.len() {
        // Some edge runs through a vertex that is not its end.
        return None;
    }
    Some(
        triangulation
            .inner_faces()
            .filter_map(|face| {
                let winding = winding[face.fix().index()].filter(|&winding| winding != 0)?;
                Some((face.vertices().map(|vertex| vertex.data().index), winding))
            })
            .collect(),
    )
}

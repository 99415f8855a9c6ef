//! Constrained Delaunay triangulation: of large polygons, of regions, and between edges by winding number. Everything that
//! is set up for `spade` is set up here.

use rustc_hash::{FxHashMap, FxHashSet};
use spade::handles::{DirectedEdgeHandle, FixedVertexHandle};
use spade::{CdtEdge, ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::counted::{CountedEdge, CountedTriangle};
use crate::exact::{Sign, orient2d};

/// Why edges are not all edges of one triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Conflict {
    /// The vertex is where another one is, or differs from it by less than 2^-78 of the largest coordinate; or a coordinate
    /// is not finite.
    Place(u32),
    /// An edge that starts at the vertex crosses another edge.
    Crossing(u32),
}

type Result<T> = std::result::Result<T, Conflict>;

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

type Delaunay = ConstrainedDelaunayTriangulation<Vertex>;
type Edge<'a> = DirectedEdgeHandle<'a, Vertex, (), CdtEdge<()>, ()>;

/// The power of two by which coordinates are multiplied, the largest of which is `largest`: `spade` takes none above 2^201 and
/// none but zero below 2^-142, since it multiplies four of them. Between 2^-64 and 2^200 they are left as they are; others
/// are brought near 1.
fn scale_to_range(largest: f64) -> f64 {
    const LOW: f64 = f64::from_bits((1023 - 64) << 52);
    const HIGH: f64 = f64::from_bits((1023 + 200) << 52);
    const EXPONENT_BITS: u64 = 0x7ff << 52;
    if largest == 0.0 || (LOW..=HIGH).contains(&largest) {
        return 1.0;
    }
    f64::from_bits((1.0 / largest).clamp(f64::MIN_POSITIVE, f64::MAX).to_bits() & EXPONENT_BITS)
}

/// Vertices within the range of `spade`, and whether they are where they were, up to a power of two. What is too small becomes
/// zero: less than 2^-78 of the largest coordinate.
fn vertices_in_range(points: &[[f64; 2]], indices: impl Iterator<Item = u32> + Clone) -> (Vec<Vertex>, bool) {
    let coordinates = indices.clone().flat_map(|index| points[index as usize]);
    let scale = scale_to_range(coordinates.fold(0.0f64, |largest, x| largest.max(x.abs())));
    let mut are_exact = true;
    let mut coordinate = |x: f64| {
        let scaled = x * scale;
        let is_too_small = scaled.abs() < spade::MIN_ALLOWED_VALUE;
        are_exact &= !is_too_small || x == 0.0;
        if is_too_small { 0.0 } else { scaled }
    };
    let vertices = indices
        .map(|index| {
            let [x, y] = points[index as usize].map(&mut coordinate);
            Vertex { position: Point2::new(x, y), index }
        })
        .collect();
    (vertices, are_exact)
}

/// Triangles over the region that closed contours enclose by parity, in no particular order, each counter-clockwise.
/// Contours may touch in a vertex that lies on an edge, but not cross. O(n log n) for ordinary contours.
///
/// Where points lie on one circle the choice of diagonals depends on the order of points and edges, and on nothing else.
pub(crate) fn fill_region(
    points: &[[f64; 2]],
    edges: impl Iterator<Item = [u32; 2]>,
) -> Result<Vec<[u32; 3]>> {
    // 1. The vertices first: loading vertices and edges at once would depend on the order of a hash set where points lie on
    //    one circle.
    let (vertices, _) = vertices_in_range(points, 0..points.len() as u32);
    let mut triangulation = Delaunay::bulk_load(vertices).map_err(|_| Conflict::Place(0))?;
    if triangulation.num_vertices() != points.len() {
        return Err(Conflict::Place(missing_vertex(&triangulation, points.len())));
    }
    let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; points.len()];
    triangulation.vertices().for_each(|vertex| handles[vertex.data().index as usize] = Some(vertex.fix()));
    // 2. The edges, in order; one that runs through vertices is found in several parts, one that crosses another in none.
    for [u, v] in edges.filter(|[u, v]| u != v) {
        let ends = handles[u as usize].zip(handles[v as usize]);
        let found = ends.map(|(from, to)| triangulation.try_add_constraint(from, to));
        if found.is_none_or(|parts| parts.is_empty()) {
            return Err(Conflict::Crossing(u));
        }
    }
    // 3. What they enclose.
    let is_inside = flood(&triangulation, false, |side, edge| side != edge.is_constraint_edge());
    // Not every vertex has an even number of edges: two contours have one in common.
    let is_inside = is_inside.ok_or(Conflict::Crossing(0))?;
    let inside = triangulation.inner_faces().filter(|face| is_inside[face.fix().index()]);
    Ok(inside.map(|face| face.vertices().map(|vertex| vertex.data().index)).collect())
}

/// One triangulation of the plane between edges, from which the triangles of any polygon of such edges can be taken.
pub(crate) struct Overlay {
    triangulation: Delaunay,
    handles: Vec<FixedVertexHandle>,
    /// Whether the points are where they were.
    are_exact: bool,
}

impl Overlay {
    /// A triangulation with all points as vertices and with all edges that cross no earlier one. `None` where points are in one
    /// place. O(n log n).
    pub(crate) fn new(points: &[[f64; 2]], edges: &[[u32; 2]]) -> Option<Self> {
        // The vertices first, as above.
        let (vertices, are_exact) = vertices_in_range(points, 0..points.len() as u32);
        let mut triangulation = Delaunay::bulk_load(vertices).ok()?;
        if triangulation.num_vertices() != points.len() {
            return None;
        }
        let mut found: Vec<Option<FixedVertexHandle>> = vec![None; points.len()];
        triangulation.vertices().for_each(|vertex| found[vertex.data().index as usize] = Some(vertex.fix()));
        let handles: Vec<FixedVertexHandle> = found.into_iter().collect::<Option<_>>()?;
        for [u, v] in edges.iter().filter(|[u, v]| u != v) {
            triangulation.try_add_constraint(handles[*u as usize], handles[*v as usize]);
        }
        Some(Self { triangulation, handles, are_exact })
    }

    /// The triangles inside a simple polygon, each counter-clockwise as the polygon is. `None` unless all its sides are edges.
    pub(crate) fn inside(&self, points: &[[f64; 2]], outline: &[u32]) -> Option<Vec<[u32; 3]>> {
        let n = outline.len();
        let mut sides = FxHashSet::default();
        let mut stack = Vec::new();
        for k in 0..n {
            let [from, to] = [outline[k], outline[(k + 1) % n]].map(|v| self.handles[v as usize]);
            let edge = self.triangulation.get_edge_from_neighbors(from, to)?;
            if !edge.is_constraint_edge() {
                return None;
            }
            sides.insert(edge.as_undirected().fix());
            stack.push(edge.face().as_inner()?.fix());
        }
        let mut seen = FxHashSet::default();
        let mut found = Vec::new();
        while let Some(face) = stack.pop() {
            if !seen.insert(face) {
                continue;
            }
            let face = self.triangulation.face(face);
            found.push(face.vertices().map(|vertex| vertex.data().index));
            for edge in face.adjacent_edges() {
                if !sides.contains(&edge.as_undirected().fix()) {
                    stack.push(edge.rev().face().as_inner()?.fix());
                }
            }
        }
        // The order of a set is by chance; theirs is not.
        found.sort_unstable();
        let is_sound = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| points[corner as usize]);
            self.are_exact || orient2d(a, b, c) == Sign::Positive
        };
        found.iter().all(is_sound).then_some(found)
    }
}

/// The first of `count` vertices that a triangulation does not have.
fn missing_vertex(triangulation: &Delaunay, count: usize) -> u32 {
    let mut is_there = vec![false; count];
    triangulation.vertices().for_each(|vertex| is_there[vertex.data().index as usize] = true);
    is_there.iter().position(|&there| !there).unwrap_or(0) as u32
}

/// Appends a triangulation of the region to the left of the rings and returns true; or returns false and appends nothing
/// where the shape does not allow one (coincident projections, crossing edges, a coordinate out of range).
pub(super) fn triangulate_rings(
    points: &[[f64; 2]],
    rings: &[&[u32]],
    bridges: Bridges,
    triangles: &mut Vec<[u32; 3]>,
) -> bool {
    let mut corners = 0;
    let mut edges = Vec::new();
    for ring in rings {
        corners += ring.len();
        edges.extend((0..ring.len()).map(|i| ([ring[i], ring[(i + 1) % ring.len()]], 1)));
    }
    let Ok(found) = triangulate_counted(points, &edges, bridges) else { return false };
    // Complete: the count of Euler's formula for one outline (vertices visited twice count twice).
    let is_complete = found.len() + 4 == corners + 2 * rings.len();
    let is_whole = is_complete && found.iter().all(|&(_, winding)| winding == 1);
    if is_whole {
        triangles.extend(found.into_iter().map(|(triangle, _)| triangle));
    }
    is_whole
}

/// What becomes of edges that cancel, as the two ways over a bridge to a hole do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bridges {
    /// They are none of the triangulation's concern.
    Forgotten,
    /// They are edges of triangles, too.
    Kept,
}

/// How often edges count from their lower vertex to their higher one.
type Counts = FxHashMap<(u32, u32), i32>;

/// Triangulates the plane between edges that each count a number of times, and returns the counter-clockwise triangles
/// around which they wind, with the winding number. The triangulation holds every edge as it is, those that count 0 times too,
/// or there is a conflict.
pub(super) fn triangulate_between(
    points: &[[f64; 2]],
    edges: &[CountedEdge],
) -> Result<Vec<CountedTriangle>> {
    // Those that count 0 times are there to be kept.
    triangulate_counted(points, edges, Bridges::Kept)
}

fn triangulate_counted(
    points: &[[f64; 2]],
    edges: &[CountedEdge],
    bridges: Bridges,
) -> Result<Vec<CountedTriangle>> {
    // 1. What each edge counts in sum.
    let mut counts = sum_counts(edges)?;
    if bridges == Bridges::Forgotten {
        counts.retain(|_, count| *count != 0);
    }
    let mut constraints: Vec<(u32, u32)> = counts.keys().copied().collect();
    constraints.sort_unstable();
    // 2. Their ends first: loading vertices and edges at once would depend on the order of a hash set where points lie on
    // one circle.
    let (mut triangulation, handles, are_exact) = load_ends(points, &constraints)?;
    // 3. Then the edges, in order.
    for &(u, v) in &constraints {
        // (It is found in several parts if it runs through vertices, in none if it crosses another.)
        if triangulation.try_add_constraint(handles[&u], handles[&v]).len() != 1 {
            return Err(Conflict::Crossing(u));
        }
    }
    // 4. From outside, where the winding number is 0; an edge passed from its right to its left adds its count.
    let mut seen = 0;
    let windings = flood(&triangulation, 0, |winding, edge| {
        let (from, to) = (edge.from().data().index, edge.to().data().index);
        let known = counts.get(&(from.min(to), from.max(to)));
        seen += usize::from(known.is_some());
        let count = known.copied().unwrap_or(0);
        // What lies to the left of an edge winds once more than what lies to its right.
        winding - if from < to { count } else { -count }
    });
    // Every edge is passed from both sides, unless it runs through a vertex that is not its end.
    let windings = windings.filter(|_| seen == 2 * counts.len()).ok_or(Conflict::Crossing(0))?;
    let wound = triangulation.inner_faces().filter(|face| windings[face.fix().index()] != 0);
    let found: Vec<CountedTriangle> = wound
        .map(|face| (face.vertices().map(|vertex| vertex.data().index), windings[face.fix().index()]))
        .collect();
    // 5. What is sound where small coordinates are zero may be folded where they are not.
    let is_sound = |&([a, b, c], _): &CountedTriangle| {
        let [a, b, c] = [a, b, c].map(|corner| points[corner as usize]);
        orient2d(a, b, c) == Sign::Positive
    };
    match found.iter().find(|triangle| !are_exact && !is_sound(triangle)) {
        Some(&([first, ..], _)) => Err(Conflict::Place(first)),
        None => Ok(found),
    }
}

fn sum_counts(edges: &[CountedEdge]) -> Result<Counts> {
    let mut counts = Counts::default();
    for &([u, v], count) in edges {
        if u == v {
            return Err(Conflict::Place(u));
        }
        *counts.entry((u.min(v), u.max(v))).or_default() += if u < v { count } else { -count };
    }
    Ok(counts)
}

/// The triangulation of the ends of some edges, their handles in it, and whether they are where they were.
fn load_ends(
    points: &[[f64; 2]],
    edges: &[(u32, u32)],
) -> Result<(Delaunay, FxHashMap<u32, FixedVertexHandle>, bool)> {
    let mut ends: Vec<u32> = edges.iter().flat_map(|&(u, v)| [u, v]).collect();
    ends.sort_unstable();
    ends.dedup();
    let (vertices, are_exact) = vertices_in_range(points, ends.iter().copied());
    let first = ends.first().copied().unwrap_or(0);
    let triangulation = Delaunay::bulk_load(vertices).map_err(|_| Conflict::Place(first))?;
    if triangulation.num_vertices() != ends.len() {
        return Err(Conflict::Place(first));
    }
    let handles = triangulation.vertices().map(|vertex| (vertex.data().index, vertex.fix())).collect();
    Ok((triangulation, handles, are_exact))
}

/// A value for every face by index, from that of the outer one inwards: `pass` gives the value beyond an edge of a face, which
/// is directed so that the face is to its left. `None` where two ways lead to different values.
fn flood<T: Copy + PartialEq>(
    triangulation: &Delaunay,
    outside: T,
    mut pass: impl FnMut(T, Edge<'_>) -> T,
) -> Option<Vec<T>> {
    let mut values: Vec<Option<T>> = vec![None; triangulation.num_all_faces()];
    let outer = triangulation.outer_face();
    values[outer.fix().index()] = Some(outside);
    let mut stack = vec![outer.fix()];
    while let Some(face) = stack.pop() {
        let here = values[face.index()]?;
        // Every edge once from each side.
        let around: Vec<Edge<'_>> = match triangulation.face(face).as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => triangulation.convex_hull().collect(),
        };
        for edge in around {
            let edge = if edge.face().fix() == face { edge } else { edge.rev() };
            let beyond = pass(here, edge);
            let other = edge.rev().face().fix();
            match values[other.index()] {
                None => {
                    values[other.index()] = Some(beyond);
                    stack.push(other);
                }
                Some(known) if known != beyond => return None,
                Some(_) => {}
            }
        }
    }
    // Every face is reached.
    values.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_beside_a_huge_coordinate_is_not_taken_for_sound() {
        // A hole of size one in a square of 1e300 is a point there; a needle beside it is folded.
        let ring = |size: f64| [[-size, -size], [size, -size], [size, size], [-size, size]];
        let points = [ring(1e300), ring(1.0)].concat();
        let edges = |first: u32, step: u32| {
            (0..4).map(move |k| ([first + k, first + (k + step) % 4], 1)).collect::<Vec<CountedEdge>>()
        };
        assert!(triangulate_between(&points, &[edges(0, 1), edges(4, 3)].concat()).is_err());
        let folded = [[0.0, 0.0], [1e300, 0.0], [1e300, 1e300], [1e210, 1e-10], [1e200, 2e-10]];
        let outline: Vec<CountedEdge> = (0..5).map(|k| ([k, (k + 1) % 5], 1)).collect();
        if let Ok(found) = triangulate_between(&folded, &outline) {
            assert!(found.iter().all(|(t, _)| {
                let [a, b, c] = t.map(|corner| folded[corner as usize]);
                orient2d(a, b, c) == Sign::Positive
            }));
        }
    }

    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Corners of grid cells lie on common circles and lines, and any choice of diagonals is as good as another.
    #[test]
    fn the_same_input_gives_the_same_triangles() {
        let mut rng = ChaCha8Rng::seed_from_u64(62);
        for _ in 0..1_000 {
            let size = rng.random_range(3..12u32);
            let full = rng.random_range(0.1..0.9);
            // Turned a bit: hardly any point lies exactly on the circle through others.
            let turn = if rng.random() { 0.0 } else { 0.3 };
            let points: Vec<[f64; 2]> = (0..(size + 1) * (size + 1))
                .map(|i| {
                    let (x, y) = (f64::from(i % (size + 1)), f64::from(i / (size + 1)));
                    [x - turn * y, y + turn * x]
                })
                .collect();
            let mut edges: Vec<CountedEdge> = Vec::new();
            for cell in 0..size * size {
                if rng.random_bool(full) {
                    let a = cell / size * (size + 1) + cell % size;
                    let (b, c, d) = (a + 1, a + size + 2, a + size + 1);
                    edges.extend([[a, b], [b, c], [c, d], [d, a]].map(|edge| (edge, 1)));
                }
            }
            let first = triangulate_between(&points, &edges);
            assert!(edges.is_empty() || first.is_ok(), "no edges cross");
            for _ in 0..3 {
                assert_eq!(triangulate_between(&points, &edges), first);
            }
        }
    }
}

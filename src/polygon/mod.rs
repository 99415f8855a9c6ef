//! Triangulation of plane polygons that cannot fail.
//!
//! A region is given by the directed edges of its boundary, the region to their left. The result always uses every one of
//! them once and, besides, only diagonals in pairs of opposite direction: `v + 2h - 2` triangles for `v` vertices and `h`
//! holes, whatever rounding did to the shape. So triangles of neighbouring faces always fit together. Where the shape is
//! sound (exact tests on the given coordinates), all triangles are counter-clockwise.

mod counted;
mod delaunay;
mod ears;
mod face;
mod holes;
mod loops;
mod once;
mod region;
mod winding;

use delaunay::Bridges;

pub(crate) use delaunay::{Conflict, Overlay, fill_region};
pub(crate) use face::{FaceTriangulator, Tiling};
pub(crate) use once::winds_once;
pub(crate) use region::{Region, fill_wound, polygons, polygons_of_loops};
pub(crate) use winding::{Edge, Found, by_winding, cross_properly};

/// Area inside a ring, negative where it runs clockwise.
pub(crate) fn ring_area(ring: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = ring.first() else { return 0.0 };
    let twice = ring.windows(2).map(|edge| {
        let ([a, b], [c, d]) = (edge[0], edge[1]);
        (a - x) * (d - y) - (b - y) * (c - x)
    });
    0.5 * twice.sum::<f64>()
}

/// From this many vertices a constrained Delaunay triangulation (n log n) replaces ear clipping (at least quadratic). On random
/// star polygons it takes twice as long at 60 vertices and as long at 120; it bounds what a face with many holes can cost.
const DELAUNAY_FROM: usize = 40;
/// From this many vertices ears, which take the square of their number and more, come last: where constraints cross, as beside needles, triangles
/// by winding number are made first. (A turned plate less 100 flush cylinders, faces of 3,200 corners: 0.41 s with ears first, 0.19 s.)
const EARS_LAST_FROM: usize = 256;

/// How sound a triangulation is: what its worst triangle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Shape {
    /// All triangles are counter-clockwise, by exact test.
    Sound,
    /// Some have no area.
    Flat,
    /// Some are turned over.
    Folded,
}

/// Triangulates regions; keeps its scratch memory between calls.
#[derive(Debug, Default)]
pub(crate) struct Triangulator {
    tracer: loops::Tracer,
    ears: ears::EarClipper,
}

impl Triangulator {
    /// Appends to `triangles` a triangulation of the region bounded by `edges`. Vertices are indices into `points`; every
    /// vertex must be left as often as it is entered.
    pub(crate) fn triangulate(
        &mut self,
        points: &[[f64; 2]],
        edges: &[[u32; 2]],
        triangles: &mut Vec<[u32; 3]>,
    ) -> Shape {
        if let Some(corners) = single_triangle(edges) {
            triangles.push(corners);
            return ears::shape_of(points, corners);
        }
        let boundary = self.tracer.trace(points, edges);
        let before = triangles.len();
        let polygons = match boundary.len() {
            1 => boundary.into_iter().map(holes::Polygon::simple).collect(),
            _ => holes::group(points, boundary),
        };
        let mut fill = |most: usize, triangles: &mut Vec<[u32; 3]>| {
            let shapes = polygons.iter().map(|polygon| self.with_holes(points, polygon, most, triangles));
            shapes.max().unwrap_or(Shape::Sound)
        };
        let shape = fill(EARS_LAST_FROM, triangles);
        if shape < Shape::Folded {
            return shape;
        }
        // Loops that cross or touch in ways that tracing cannot tell: by winding number instead.
        let edges: Vec<Edge> =
            edges.iter().map(|&ends| Edge { ends, count: 1, line: 0, kept: false }).collect();
        let found = by_winding(&mut points.to_vec(), &edges, |_, _, _| None);
        triangles.truncate(before);
        let Some(found) = found else { return fill(usize::MAX, triangles) };
        let mut shape = Shape::Sound;
        for ([a, b, c], winding) in found.triangles.into_iter().chain(found.slivers) {
            let corners = if winding > 0 { [a, b, c] } else { [a, c, b] };
            shape = shape.max(ears::shape_of(points, corners));
            triangles.extend(std::iter::repeat_n(corners, winding.unsigned_abs() as usize));
        }
        shape
    }

    /// The same where the triangulation is sound, else appends nothing and returns false; large regions in no more than
    /// n log n steps.
    pub(crate) fn soundly(
        &mut self,
        points: &[[f64; 2]],
        edges: &[[u32; 2]],
        triangles: &mut Vec<[u32; 3]>,
    ) -> bool {
        let before = triangles.len();
        let boundary = self.tracer.trace(points, edges);
        let is_sound = holes::group(points, boundary).iter().all(|polygon| {
            if polygon.len() >= DELAUNAY_FROM {
                return delaunay::triangulate_rings(points, &polygon.rings(), Bridges::Forgotten, triangles);
            }
            self.with_holes(points, polygon, usize::MAX, triangles) == Shape::Sound
        });
        if !is_sound {
            triangles.truncate(before);
        }
        is_sound
    }

    /// Triangulates one closed loop.
    pub(crate) fn simple(
        &mut self,
        points: &[[f64; 2]],
        polygon: &[u32],
        triangles: &mut Vec<[u32; 3]>,
    ) -> Shape {
        if polygon.len() >= DELAUNAY_FROM
            && delaunay::triangulate_rings(points, &[polygon], Bridges::Forgotten, triangles)
        {
            return Shape::Sound;
        }
        self.ears.clip(points, polygon, triangles)
    }

    /// Triangulates a polygon; one of `most` vertices or more, of which not all triangles can be sound, is left out and said to be folded.
    fn with_holes(
        &mut self,
        points: &[[f64; 2]],
        polygon: &holes::Polygon,
        most: usize,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Shape {
        if polygon.len() >= DELAUNAY_FROM
            && delaunay::triangulate_rings(points, &polygon.rings(), Bridges::Forgotten, triangles)
        {
            return Shape::Sound;
        }
        if polygon.len() >= most {
            return Shape::Folded;
        }
        if polygon.holes.is_empty() {
            return self.ears.clip(points, &polygon.outer, triangles);
        }
        match holes::bridge(points, polygon) {
            Some(joined) => self.ears.clip(points, &joined, triangles),
            None => {
                // No sight line, so the shape is not sound: the loops one by one bound the same region as a chain.
                self.ears.clip(points, &polygon.outer, triangles);
                for hole in &polygon.holes {
                    self.ears.clip(points, hole, triangles);
                }
                Shape::Folded
            }
        }
    }
}

/// The corners, if three edges form one triangle: the commonest region.
fn single_triangle(edges: &[[u32; 2]]) -> Option<[u32; 3]> {
    let [first, second, third] = edges else { return None };
    let (next, last) = if second[0] == first[1] { (second, third) } else { (third, second) };
    (first[1] == next[0] && next[1] == last[0] && last[1] == first[0])
        .then_some([first[0], first[1], next[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{Sign, orient2d};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};
    use std::collections::BTreeMap;

    /// The boundary of the triangles as a chain equals the given edges.
    fn assert_complete(edges: &[[u32; 2]], triangles: &[[u32; 3]]) {
        let mut chain: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        let mut add = |u: u32, v: u32, sign: i32| {
            let (key, sign) = if u < v { ((u, v), sign) } else { ((v, u), -sign) };
            *chain.entry(key).or_default() += sign;
        };
        for t in triangles {
            for k in 0..3 {
                add(t[k], t[(k + 1) % 3], 1);
            }
        }
        for e in edges {
            add(e[0], e[1], -1);
        }
        assert!(chain.values().all(|&sum| sum == 0), "{edges:?} {triangles:?}");
    }

    fn area(points: &[[f64; 2]], t: &[u32; 3]) -> f64 {
        let [a, b, c] = t.map(|v| points[v as usize]);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }

    fn ring(first: u32, count: u32) -> Vec<[u32; 2]> {
        (0..count).map(|i| [first + i, first + (i + 1) % count]).collect()
    }

    fn check(points: &[[f64; 2]], edges: &[[u32; 2]], expected_area: f64, expected_triangles: usize) {
        let mut triangles = Vec::new();
        let sound = Triangulator::default().triangulate(points, edges, &mut triangles);
        assert_complete(edges, &triangles);
        assert_eq!(sound, Shape::Sound);
        assert_eq!(triangles.len(), expected_triangles);
        let sum: f64 = triangles.iter().map(|t| area(points, t)).sum();
        assert!((sum - expected_area).abs() < 1e-9, "{sum} {expected_area}");
        assert!(triangles.iter().all(|t| area(points, t) > 0.0));
    }

    #[test]
    fn collinear_vertices_on_the_sides_are_all_used() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0], [0.0, 0.5]];
        check(&points, &ring(0, 7), 3.0, 5);
        let flat = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]];
        check(&flat, &ring(0, 4), 1.0, 2);
    }

    #[test]
    fn squares_with_holes_and_islands() {
        let square = |c: [f64; 2], r: f64| {
            [[c[0] - r, c[1] - r], [c[0] + r, c[1] - r], [c[0] + r, c[1] + r], [c[0] - r, c[1] + r]]
        };
        let mut points = square([0.0, 0.0], 4.0).to_vec();
        points.extend(square([-2.0, 0.0], 1.0));
        points.extend(square([2.0, 0.0], 1.0));
        points.extend(square([2.0, 0.0], 0.5));
        let mut edges = ring(0, 4);
        edges.extend(ring(4, 4).iter().map(|e| [e[1], e[0]]));
        edges.extend(ring(8, 4).iter().map(|e| [e[1], e[0]]));
        edges.extend(ring(12, 4));
        // 12 vertices and 2 holes, and the island's 4.
        check(&points, &edges, 64.0 - 8.0 + 1.0, 12 + 4 - 2 + 2);
    }

    #[test]
    fn a_hole_that_touches_its_outline_in_a_vertex() {
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [2.0, 1.0], [1.0, 2.0]];
        let mut edges = ring(0, 4);
        edges.extend([[0, 5], [5, 4], [4, 0]]);
        check(&points, &edges, 16.0 - 1.5, 5);
    }

    #[test]
    fn two_triangles_that_share_a_vertex_stay_apart() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0]];
        let edges = [[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]];
        check(&points, &edges, 1.0, 2);
    }

    #[test]
    fn holes_in_something_huge_are_holes() {
        for size in [1e140, 1e160, 1e300] {
            let points = [
                [-size, -size],
                [size, -size],
                [0.0, size],
                [-1.0, -1.0],
                [1.0, -1.0],
                [1.0, 1.0],
                [-1.0, 1.0],
            ];
            let mut edges = ring(0, 3);
            edges.extend(ring(3, 4).iter().map(|e| [e[1], e[0]]));
            let mut triangles = Vec::new();
            let shape = Triangulator::default().triangulate(&points, &edges, &mut triangles);
            assert_complete(&edges, &triangles);
            assert_eq!((shape, triangles.len()), (Shape::Sound, 7), "{size:e}");
        }
    }

    #[test]
    fn many_holes_use_the_delaunay_path() {
        let mut points = vec![[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
        let mut edges = ring(0, 4);
        for i in 0..9 {
            for j in 0..9 {
                let first = points.len() as u32;
                let (x, y) = (1.0 + 2.0 * f64::from(i), 1.0 + 2.0 * f64::from(j));
                points.extend([[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]]);
                edges.extend(ring(first, 4).iter().map(|e| [e[1], e[0]]));
            }
        }
        check(&points, &edges, 400.0 - 81.0, 4 + 4 * 81 + 2 * 81 - 2);
    }

    #[test]
    fn opposite_regions_cancel_by_winding() {
        // A square, and half of it turned over with a vertex more on its border: the other half is left.
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.0], [1.0, 2.0]];
        let edge = |ends: [u32; 2], count: i32| Edge { ends, count, line: 0, kept: false };
        let mut edges: Vec<Edge> =
            [[0, 4], [4, 1], [1, 2], [2, 5], [5, 3], [3, 0]].map(|e| edge(e, 1)).to_vec();
        edges.extend([[0, 4], [4, 5], [5, 3], [3, 0]].map(|e| edge(e, -1)));
        let found = by_winding(&mut points.to_vec(), &edges, |_, _, _| None).expect("a sound shape");
        assert_eq!(found.triangles.len(), 2);
        assert!(found.triangles.iter().all(|(t, winding)| *winding == 1 && area(&points, t) == 1.0));
    }

    #[test]
    fn crossing_edges_get_a_vertex() {
        // A square less one that is moved by half its side: edges cross in two points that are not given.
        let square = |c: f64| [[c, c], [c + 2.0, c], [c + 2.0, c + 2.0], [c, c + 2.0]];
        let mut points = [square(0.0), square(1.0)].concat();
        let edges: Vec<Edge> = (0..8)
            .map(|i| Edge {
                ends: ring(i / 4 * 4, 4)[i as usize % 4],
                count: if i < 4 { 1 } else { -1 },
                line: i,
                kept: false,
            })
            .collect();
        assert!(by_winding(&mut points, &edges, |_, _, _| None).is_none(), "no vertex, no sum");
        let found = by_winding(&mut points, &edges, |x, y, points| {
            // Of a horizontal and a vertical edge.
            let is_upright = |edge: &Edge| edge.line % 2 == 1;
            let (upright, level) = if is_upright(x) { (x, y) } else { (y, x) };
            assert!(is_upright(upright) && !is_upright(level));
            let crossing = [points[upright.ends[0] as usize][0], points[level.ends[0] as usize][1]];
            points.push(crossing);
            Some(points.len() as u32 - 1)
        })
        .expect("two crossings");
        assert_eq!(points.len(), 10);
        let area_of = |sign: i32| -> f64 {
            let counted = found.triangles.iter().filter(|(_, winding)| winding.signum() == sign);
            counted.map(|(t, winding)| area(&points, t) * f64::from(winding.abs())).sum()
        };
        assert_eq!((area_of(1), area_of(-1)), (3.0, 3.0));
        let directed: Vec<[u32; 2]> = edges
            .iter()
            .map(|edge| if edge.count > 0 { edge.ends } else { [edge.ends[1], edge.ends[0]] })
            .collect();
        let all: Vec<[u32; 3]> = found
            .triangles
            .iter()
            .chain(&found.slivers)
            .flat_map(|&([a, b, c], winding)| {
                let corners = if winding > 0 { [a, b, c] } else { [a, c, b] };
                std::iter::repeat_n(corners, winding.unsigned_abs() as usize)
            })
            .collect();
        assert_complete(&directed, &all);
    }

    #[test]
    fn an_edge_through_a_vertex_is_kept_by_triangles_without_area() {
        let points = [[0.0, 0.0], [2.0, 0.0], [1.0, 2.0], [1.0, 0.0], [1.5, -1.0]];
        // A triangle with corner 3 on the side of another that does not have it.
        let edges = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 1], [1, 3]];
        let counted: Vec<Edge> =
            edges.iter().map(|&ends| Edge { ends, count: 1, line: 0, kept: false }).collect();
        let found = by_winding(&mut points.to_vec(), &counted, |_, _, _| None).expect("a sound shape");
        let triangles: Vec<[u32; 3]> = found
            .triangles
            .iter()
            .chain(&found.slivers)
            .flat_map(|(t, winding)| std::iter::repeat_n(*t, *winding as usize))
            .collect();
        assert_complete(&edges, &triangles);
        assert_eq!(triangles.iter().map(|t| area(&points, t)).sum::<f64>(), 2.5);
    }

    #[test]
    fn a_hole_along_its_outline_leaves_flat_triangles_only() {
        // Two sides of the hole lie on the outline, one corner is the outline's own.
        let points = [[0.0, 0.0], [2.0, 3.0], [0.0, 3.0], [1.0, 3.0], [1.0, 2.0], [0.0, 2.0]];
        let mut edges = vec![[0, 1], [1, 2], [2, 0]];
        edges.extend([[2, 3], [3, 4], [4, 5], [5, 2]]);
        let mut triangles = Vec::new();
        let shape = Triangulator::default().triangulate(&points, &edges, &mut triangles);
        assert_complete(&edges, &triangles);
        assert_eq!(shape, Shape::Flat);
        assert_eq!(triangles.iter().map(|t| area(&points, t)).sum::<f64>(), 2.0);
    }

    #[test]
    fn a_hole_that_rounding_pushed_through_its_outline() {
        // Corner 3 of the hole lies on the side from 0 to 1, less one unit in the last place.
        let third = 1.0 / 3.0;
        let points = [[0.0, 1.0], [1.0, 0.0], [2.0, 2.0], [third, 2.0 * third], [0.5, 0.75], [0.5, 1.0]];
        assert_eq!(orient2d(points[0], points[1], points[3]), Sign::Negative);
        let edges = [[0, 1], [1, 2], [2, 0], [4, 3], [5, 4], [3, 5]];
        let mut triangles = Vec::new();
        Triangulator::default().triangulate(&points, &edges, &mut triangles);
        assert_complete(&edges, &triangles);
        // Nothing is covered twice: no triangle of more than rounding is turned over.
        assert!(triangles.iter().all(|t| area(&points, t) > -1e-15), "{triangles:?}");
        let sum: f64 = triangles.iter().map(|t| area(&points, t)).sum();
        assert!((sum - (1.5 - 1.0 / 48.0)).abs() < 1e-15, "{sum}");
    }

    #[test]
    fn random_star_polygons() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        for round in 0..500 {
            let count = rng.random_range(3..if round % 10 == 0 { 200 } else { 20 });
            let points: Vec<[f64; 2]> = (0..count)
                .map(|i| {
                    let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
                    let radius = rng.random_range(0.2..1.0);
                    [radius * angle.cos(), radius * angle.sin()]
                })
                .collect();
            let edges = ring(0, count as u32);
            let expected: f64 = edges
                .iter()
                .map(|e| {
                    let (a, b) = (points[e[0] as usize], points[e[1] as usize]);
                    0.5 * (a[0] * b[1] - a[1] * b[0])
                })
                .sum();
            check(&points, &edges, expected, count as usize - 2);
        }
    }

    #[test]
    fn nonsense_is_still_complete() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        for round in 0..2_000 {
            // Random closed walks on few points, some of them coincident or collinear.
            let points: Vec<[f64; 2]> = (0..8)
                .map(|_| [f64::from(rng.random_range(0i32..3)), f64::from(rng.random_range(0i32..3))])
                .collect();
            let mut edges = Vec::new();
            for _ in 0..rng.random_range(1..4) {
                let length = rng.random_range(3..9);
                let mut walk: Vec<u32> = (0..8).collect();
                for i in 0..length {
                    let j = rng.random_range(i..8);
                    walk.swap(i, j);
                }
                edges.extend((0..length).map(|i| [walk[i], walk[(i + 1) % length]]));
            }
            let mut triangles = Vec::new();
            Triangulator::default().triangulate(&points, &edges, &mut triangles);
            assert_complete(&edges, &triangles);
            assert!(triangles.len() <= edges.len() * 2, "round {round}");
        }
    }
}

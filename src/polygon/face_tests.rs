use std::collections::BTreeMap;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::*;

/// Checks that the triangles use every edge of the polygon once and every other edge once each way, and returns how
/// well they tile.
fn triangulate(points: &[[f64; 3]]) -> (Tiling, Vec<[u32; 3]>) {
    let corners: Vec<u32> = (0..points.len() as u32).collect();
    let mut triangles = Vec::new();
    let tiling = FaceTriangulator::default().triangulate(points, &corners, &mut triangles);
    assert_eq!(triangles.len(), points.len() - 2);
    let mut uses = BTreeMap::new();
    let mut count = |from: u32, to: u32, step: i32| {
        *uses.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { step } else { -step };
    };
    for i in 0..corners.len() {
        count(corners[i], corners[(i + 1) % corners.len()], -1);
    }
    for triangle in &triangles {
        for i in 0..3 {
            count(triangle[i], triangle[(i + 1) % 3], 1);
        }
    }
    assert!(uses.values().all(|&sum| sum == 0), "edges do not cancel");
    (tiling, triangles)
}

/// Checks that all triangles have positive area seen from above. Since their boundary is the polygon, they then
/// cover every point as often as the polygon winds around it: a simple polygon is tiled.
fn assert_tiled(points: &[[f64; 2]], lift: impl Fn([f64; 2]) -> [f64; 3]) {
    let lifted: Vec<[f64; 3]> = points.iter().map(|&point| lift(point)).collect();
    let (tiling, triangles) = triangulate(&lifted);
    assert_eq!(tiling, Tiling::Proper, "{points:?}");
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        assert!(orient2d(a, b, c) == Sign::Positive, "triangle {triangle:?} of {points:?}");
    }
}

fn flat(point: [f64; 2]) -> [f64; 3] {
    [point[0], point[1], 0.0]
}

#[test]
fn convex_polygons_are_fanned_from_the_first_corner() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(triangulate(&square).1, [[0, 1, 2], [0, 2, 3]]);
    // Not quite flat, as decimals make it: the fan from the first corner, whichever that is.
    let pentagon = |i: usize| {
        let (sin, cos) = (i as f64 * 0.4 * std::f64::consts::PI).sin_cos();
        [(cos * 1e6).round() / 1e6, (sin * 1e6).round() / 1e6, ((cos + sin) * 1e6).round() / 1e6]
    };
    for start in 0..5 {
        let turned: Vec<[f64; 3]> = (0..5).map(|i| pentagon((start + i) % 5)).collect();
        assert_eq!(triangulate(&turned), (Tiling::Proper, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]]));
    }
}

#[test]
fn concave_polygons_are_tiled_in_every_orientation() {
    let shapes: [&[[f64; 2]]; 5] = [
        &[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]],
        &[[2.0, 0.0], [0.5, 0.5], [0.0, 2.0], [0.0, 0.0]],
        &[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 1.0], [1.0, 1.0], [0.0, 3.0]],
        // Flat corners on every side.
        &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]],
        // A hole reached over a bridge that is walked both ways.
        &[
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ],
    ];
    for shape in shapes {
        for start in 0..shape.len() {
            let turned: Vec<[f64; 2]> = (0..shape.len()).map(|i| shape[(start + i) % shape.len()]).collect();
            assert_tiled(&turned, flat);
            assert_tiled(&turned, |p| [0.0, p[0], p[1]]);
            assert_tiled(&turned, |p| [p[1], 0.0, p[0]]);
            assert_tiled(&turned, |p| [p[0], p[1], 0.3 * p[0] - 0.4 * p[1]]);
            assert_tiled(&turned, |p| [p[1], p[0], 7.0]);
            for scale in [1e-300, 1e-110, 1e110, 1e307] {
                assert_tiled(&turned, |p| [p[0] * scale, p[1] * scale, 0.0]);
            }
        }
    }
}

#[test]
fn a_boundary_that_passes_a_vertex_twice_is_tiled() {
    // Two squares that touch in vertex 2.
    let points = [[0, 0], [1, 0], [1, 1], [2, 1], [2, 2], [1, 2], [0, 1]]
        .map(|[x, y]| [f64::from(x), f64::from(y), 0.0]);
    let corners = [0, 1, 2, 3, 4, 5, 2, 6];
    for start in 0..corners.len() {
        let turned: Vec<u32> = (0..corners.len()).map(|i| corners[(start + i) % corners.len()]).collect();
        let mut triangles = Vec::new();
        let tiling = FaceTriangulator::default().triangulate(&points, &turned, &mut triangles);
        assert_eq!((tiling, triangles.len()), (Tiling::Proper, 6));
        triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        assert_eq!(triangles.len(), 4);
        for triangle in triangles {
            let [a, b, c] = triangle.map(|i| points[i as usize]).map(|[x, y, _]| [x, y]);
            assert!(orient2d(a, b, c) == Sign::Positive, "{triangle:?}");
        }
    }
}

#[test]
fn stars_combs_and_spirals_of_many_corners_are_tiled() {
    let seed = 20_261_122;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for corners in [5, 8, 33, 100, 1_000, 20_000] {
        let star: Vec<[f64; 2]> = (0..corners)
            .map(|i| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / corners as f64).sin_cos();
                let radius = random.random_range(0.01..1.0);
                [radius * cos, radius * sin]
            })
            .collect();
        assert_tiled(&star, flat);

        let mut comb: Vec<[f64; 2]> =
            (0..corners).map(|i| [i as f64, if i % 2 == 0 { 1.0 } else { 1000.0 }]).collect();
        comb.extend([[corners as f64, 0.0], [0.0, 0.0]]);
        comb.reverse();
        assert_tiled(&comb, flat);

        let arm = |i: usize, inner: f64| {
            let angle = i as f64 * 0.1;
            let (sin, cos) = angle.sin_cos();
            let radius = angle + 10.0 - inner;
            [radius * cos, radius * sin]
        };
        let spiral: Vec<[f64; 2]> =
            (0..corners).map(|i| arm(i, 0.0)).chain((0..corners).rev().map(|i| arm(i, 2.0))).collect();
        assert_tiled(&spiral, flat);
    }
}

#[test]
fn random_staircases_on_a_small_grid_are_tiled() {
    // Monotone chains over integers: many flat corners, coincident heights and narrow necks.
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..2_000 {
        let n = random.random_range(2..12);
        let lower: Vec<[f64; 2]> =
            (0..n).map(|x| [f64::from(x), f64::from(random.random_range(0..3))]).collect();
        let upper: Vec<[f64; 2]> =
            (0..n).rev().map(|x| [f64::from(x), f64::from(random.random_range(3..6))]).collect();
        let polygon: Vec<[f64; 2]> = lower.into_iter().chain(upper).collect();
        assert_tiled(&polygon, flat);
    }
}

#[test]
fn large_polygons_with_bridges_keep_their_corners_apart() {
    // A ring cut open: the bridge is walked both ways, between corners of their own or between the same vertices.
    let seed = 20_261_127;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for corners in [20, 100, 3_000] {
        let mut circle = |reach: f64| -> Vec<[f64; 2]> {
            let at = |i: i32| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(corners)).sin_cos();
                let radius = reach * random.random_range(0.8..1.0);
                [radius * cos, radius * sin]
            };
            (0..corners).map(at).collect()
        };
        let (outer, mut inner) = (circle(3.0), circle(1.0));
        inner.reverse();
        let closed = |ring: &[[f64; 2]]| ring.iter().chain(&ring[..1]).copied().collect::<Vec<_>>();
        // The inner ring starts where the outer one does, on the x axis.
        inner.rotate_right(1);
        let bridged = [closed(&outer), closed(&inner)].concat();
        assert_tiled(&bridged, flat);
        // With the same two vertices at both ends of the bridge.
        let (n, positions) = (corners as u32, [outer, inner].concat());
        let positions: Vec<[f64; 3]> = positions.into_iter().map(flat).collect();
        let walk: Vec<u32> = (0..n).chain([0]).chain(n..2 * n).chain([n]).collect();
        let mut triangles = Vec::new();
        let tiling = FaceTriangulator::default().triangulate(&positions, &walk, &mut triangles);
        assert_eq!((tiling, triangles.len()), (Tiling::Proper, walk.len() - 2));
        let area: f64 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| positions[v as usize]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            })
            .inspect(|&area| assert!(area > 0.0))
            .sum();
        assert!((15.0..28.0).contains(&area), "{area}");
    }
}

#[test]
fn mixed_magnitudes_are_told_apart() {
    // A notch of 1e-300 in a side of 1e300.
    let notched = [[-1e300, 0.0], [1e300, 0.0], [1e300, 1e300], [0.0, 1e-300], [-1e300, 1e300]];
    for start in 0..notched.len() {
        let turned: Vec<[f64; 2]> =
            (0..notched.len()).map(|i| notched[(start + i) % notched.len()]).collect();
        assert_tiled(&turned, flat);
    }
}

#[test]
fn a_polygon_that_winds_twice_is_reported() {
    // Twice around the first corner: every triangle of its fan has positive area, yet they overlap.
    let spiral: Vec<[f64; 3]> = std::iter::once([0.0; 3])
        .chain((0..14).map(|i| {
            let (sin, cos) = (f64::from(i) * 0.8).sin_cos();
            [cos, sin, 0.0]
        }))
        .collect();
    assert_eq!(triangulate(&spiral).0, Tiling::Improper);
}

#[test]
fn polygons_that_cross_themselves_are_completed_and_reported() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let bow_tie = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(triangulate(&bow_tie).0, Tiling::Improper);
    let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
    assert_eq!(triangulate(&line).0, Tiling::Improper);
    let point = [[1.0, 2.0, 3.0]; 9];
    assert_eq!(triangulate(&point).0, Tiling::Improper);
    for corners in [4, 5, 6, 10, 50, 5_000] {
        let tangle: Vec<[f64; 3]> =
            (0..corners).map(|_| [0; 3].map(|_: i32| random.random_range(-1.0..1.0))).collect();
        let _ = triangulate(&tangle);
        let coarse: Vec<[f64; 3]> =
            (0..corners).map(|_| [0; 3].map(|_: i32| f64::from(random.random_range(-2..3)))).collect();
        let _ = triangulate(&coarse);
    }
}

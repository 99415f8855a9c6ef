//! Regions: membership, booleans, triangles, and the solids made of them.
#![cfg(feature = "parametric")]
#![allow(clippy::print_stdout, reason = "measurements, shown with --nocapture")]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::common::parametric as common;
use crate::common::parametric::{assert_closed, determinant, distance, point, points, rng, volume};
use crate::common::planar::POLYGON;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use trisect::parametric::{
    Bezier, CubicSpline, Curve, CurveMeshing, EllipticArc, Extrusion, FillRule, GeometryError, Membership,
    Polygons, Polyline, Region, RegionOperation, Revolution, Segment, SharedCurve, Spacing, SplineEnds,
    Sweep,
};

/// A star-shaped closed curve round a random centre: splines, polygons or circles.
fn blob(rng: &mut ChaCha8Rng) -> SharedCurve<2> {
    let centre: [f64; 2] = point(rng);
    let count = rng.random_range(3..15);
    let corners: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(count)).sin_cos();
            let r = rng.random_range(0.2..1.0);
            [centre[0] + r * cos, centre[1] + r * sin]
        })
        .collect();
    match rng.random_range(0..3) {
        0 => Arc::new(EllipticArc::circle(centre, rng.random_range(0.2..1.0)).unwrap()),
        1 => Arc::new(Polyline::new(&corners, &Spacing::ChordLength, true).unwrap()),
        _ => Arc::new(CubicSpline::new(&corners, &SplineEnds::Periodic, &Spacing::ChordLength).unwrap()),
    }
}

fn region(rng: &mut ChaCha8Rng) -> Region {
    let count = rng.random_range(1..4);
    Region::new(&(0..count).map(|_| blob(rng)).collect::<Vec<_>>()).unwrap()
}

/// The same contours as polygons, point for point.
fn as_curves(polygons: &Polygons) -> Region {
    let contour =
        |c: &[[f64; 2]]| -> SharedCurve<2> { Arc::new(Polyline::new(c, &Spacing::Uniform, true).unwrap()) };
    Region::new(&polygons.contours().map(contour).collect::<Vec<_>>()).unwrap()
}

#[test]
fn turned_rays_and_exact_predicates_agree() {
    let tolerance = 1e-3;
    let (mut compared, mut near) = (0, 0);
    for seed in 0..150 {
        let mut rng = rng(seed);
        let region = region(&mut rng);
        let polygons = region.polygons(&CurveMeshing::new(tolerance)).unwrap();
        let straight = as_curves(&polygons);
        for _ in 0..200 {
            let p = point::<2>(&mut rng).map(|x| 2.0 * x);
            let exact = polygons.membership(p);
            // The same polygons by both tests: equal except within rounding of the boundary.
            if polygons.signed_distance(p).abs() > 1e-13 {
                assert_eq!(straight.membership(p), exact, "seed {seed}, {p:?}");
            }
            // The curves themselves: equal farther from the polygons than they deviate.
            if polygons.signed_distance(p).abs() > tolerance {
                assert_eq!(region.membership(p), exact, "seed {seed}, {p:?}");
                compared += 1;
            } else {
                near += 1;
            }
        }
    }
    println!("{compared} points compared, {near} nearer to the boundary than the tolerance");
}

/// Points level with corners, on edges, on corners: where careless rays go wrong.
#[test]
fn rays_through_corners_are_turned() {
    let corners = POLYGON;
    let polygons = Polygons::new(&[corners.to_vec()], FillRule::EvenOdd).unwrap();
    let curves = as_curves(&polygons);
    let mut counts = [0; 3];
    for i in -2..=14 {
        for j in -2..=12 {
            let p = [f64::from(i) / 2.0, f64::from(j) / 2.0];
            let exact = polygons.membership(p);
            assert_eq!(curves.membership(p), exact, "{p:?}");
            counts[exact as usize] += 1;
        }
    }
    // Three by five less the slot; Pick's theorem on the half-integer grid counts the same.
    let area = polygons.area();
    assert_eq!(area, 11.0);
    let [inside, boundary, _] = counts.map(f64::from);
    assert_eq!(4.0 * area, inside + boundary / 2.0 - 1.0);
    let circle = Region::new(&[Arc::new(EllipticArc::circle([0.0; 2], 1.0).unwrap())]).unwrap();
    assert_eq!(circle.membership([0.0, 0.0]), Membership::Inside);
    assert_eq!(circle.membership([-2.0, 1.0]), Membership::Outside, "the ray touches the circle");
    assert_eq!(circle.membership([1.0, 0.0]), Membership::Boundary);
}

#[test]
fn region_booleans_obey_their_identities() {
    for seed in 0..200 {
        let mut rng = rng(seed);
        let meshing = CurveMeshing::new(1e-2);
        let a = region(&mut rng).polygons(&meshing).unwrap();
        let b = region(&mut rng).polygons(&meshing).unwrap();
        let [union, common, difference, either] = [
            RegionOperation::Union,
            RegionOperation::Intersection,
            RegionOperation::Difference,
            RegionOperation::SymmetricDifference,
        ]
        .map(|operation| a.combined(operation, &b));
        let near = |x: f64, y: f64| (x - y).abs() < 1e-13;
        assert!(near(union.area() + common.area(), a.area() + b.area()), "seed {seed}");
        assert!(near(difference.area(), a.area() - common.area()), "seed {seed}");
        assert!(near(either.area(), union.area() - common.area()), "seed {seed}");
        for _ in 0..100 {
            let p = point::<2>(&mut rng).map(|x| 2.0 * x);
            if a.signed_distance(p).abs() < 1e-12 || b.signed_distance(p).abs() < 1e-12 {
                continue;
            }
            let [in_a, in_b] = [&a, &b].map(|r| r.membership(p) == Membership::Inside);
            let is_in = |r: &Polygons| r.membership(p) == Membership::Inside;
            assert_eq!(is_in(&union), in_a || in_b, "seed {seed}, {p:?}");
            assert_eq!(is_in(&common), in_a && in_b, "seed {seed}, {p:?}");
            assert_eq!(is_in(&difference), in_a && !in_b, "seed {seed}, {p:?}");
            assert_eq!(is_in(&either), in_a != in_b, "seed {seed}, {p:?}");
        }
        // Every vertex is one of the operands', bit for bit, or lies on an edge of both.
        let known: Vec<[f64; 2]> = a.contours().chain(b.contours()).flatten().copied().collect();
        for p in union.contours().flatten() {
            let crossing = a.signed_distance(*p).abs().max(b.signed_distance(*p).abs()) < 1e-15;
            assert!(known.contains(p) || crossing, "seed {seed}: {p:?}");
        }
        for result in [&union, &common, &difference, &either] {
            let mesh = result.triangulate().unwrap();
            let filled: f64 = mesh
                .triangles
                .iter()
                .map(|t| {
                    let [a, b, c] = t.map(|i| mesh.points[i as usize]);
                    let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                    assert!(twice >= 0.0, "seed {seed}: a triangle is turned over");
                    0.5 * twice
                })
                .sum();
            assert!(near(filled, result.area()), "seed {seed}");
        }
    }
}

#[test]
fn coinciding_edges_are_resolved_exactly() {
    let square = |x: f64, y: f64| Polygons::rectangle([x, y], [x + 1.0, y + 1.0]).unwrap();
    for scale in [1.0, 0.1, 1e-30, 3e20, 1e-200] {
        let scaled = |x: f64, y: f64| {
            Polygons::rectangle([x * scale, y * scale], [(x + 1.0) * scale, (y + 1.0) * scale]).unwrap()
        };
        let union = scaled(0.0, 0.0).union(&scaled(1.0, 0.0));
        assert_eq!(union.contours().map(<[_]>::len).collect::<Vec<_>>(), [4], "scale {scale}");
        assert!(scaled(0.0, 0.0).intersection(&scaled(1.0, 0.0)).is_empty(), "no dangling edges");
        assert!(scaled(0.0, 0.0).difference(&scaled(0.0, 0.0)).is_empty());
    }
    // A thousandth of an ulp decides: far from the origin two squares touch or do not.
    let far = 1e9;
    let touching = square(far, far).union(&square(far + 1.0, far));
    assert_eq!(touching.shapes().len(), 1);
    let apart = square(far, far).union(&square((far + 1.0).next_up(), far));
    assert_eq!(apart.shapes().len(), 2);
    // A hole that touches the outer contour, a bow tie, nested contours.
    let outer = Polygons::rectangle([0.0; 2], [4.0, 4.0]).unwrap();
    let diamond =
        Polygons::new(&[vec![[0.0, 2.0], [2.0, 0.0], [4.0, 2.0], [2.0, 4.0]]], FillRule::EvenOdd).unwrap();
    let corners = outer.difference(&diamond);
    assert_eq!(corners.area(), 8.0);
    let solid = Extrusion::new(1.0).mesh(&corners).unwrap();
    assert_closed(&solid);
    assert_eq!(volume(&solid), 8.0);
    let bow_tie = vec![[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
    assert_eq!(Polygons::new(std::slice::from_ref(&bow_tie), FillRule::EvenOdd).unwrap().area(), 2.0);
    let twice =
        vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert!(Polygons::new(std::slice::from_ref(&twice), FillRule::EvenOdd).unwrap().is_empty());
    assert_eq!(Polygons::new(&[twice], FillRule::NonZero).unwrap().area(), 1.0);
}

#[test]
fn area_of_curved_regions_is_exact() {
    let circle = |r: f64| -> SharedCurve<2> { Arc::new(EllipticArc::circle([5.0, -3.0], r).unwrap()) };
    let ring = Region::new(&[circle(1.0), circle(2.0), circle(0.5)]).unwrap();
    assert!((ring.area() - PI * (4.0 - 1.0 + 0.25)).abs() < 1e-13);
    for seed in 0..50 {
        let mut rng = rng(seed);
        let region = Region::new(&[blob(&mut rng)]).unwrap();
        let polygons = region.polygons(&CurveMeshing::new(1e-7)).unwrap();
        assert!((polygons.area() - region.area()).abs() < 1e-6, "seed {seed}");
    }
}

#[test]
fn extrusions_are_closed_and_have_the_right_volume() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let section = region(&mut rng).polygons(&CurveMeshing::new(0.01)).unwrap();
        let height = rng.random_range(0.5..2.0);
        let straight = Extrusion::new(height).mesh(&section).unwrap();
        assert_closed(&straight);
        assert!((volume(&straight) - section.area() * height).abs() < 1e-12, "seed {seed}");
        let top = if rng.random_bool(0.3) { 0.0 } else { rng.random_range(0.1..2.0) };
        let frustum = section.area() * height * (1.0 + top + top * top) / 3.0;
        let tapered = Extrusion::new(height).taper(top).about(point(&mut rng)).mesh(&section).unwrap();
        assert_closed(&tapered);
        assert!((volume(&tapered) - frustum).abs() < 1e-12, "seed {seed}");
        let twist = rng.random_range(-7.0..7.0);
        let tolerance = 0.01;
        let twisted = Extrusion::new(height).taper(top).twist(twist, tolerance).mesh(&section).unwrap();
        assert_closed(&twisted);
        let area: f64 = side_area(&twisted);
        assert!((volume(&twisted) - frustum).abs() <= tolerance * area, "seed {seed}");
        // Points of the exact twisted surface, over random places of the outline.
        for _ in 0..20 {
            let contours: Vec<&[[f64; 2]]> = section.contours().collect();
            let contour = contours[rng.random_range(0..contours.len())];
            let i = rng.random_range(0..contour.len());
            let (a, b, along) = (contour[i], contour[(i + 1) % contour.len()], rng.random_range(0.0..1.0));
            let corner: [f64; 2] = std::array::from_fn(|k| a[k] + along * (b[k] - a[k]));
            let w: f64 = rng.random_range(0.0..1.0);
            let (sin, cos) = (twist * w).sin_cos();
            let s = 1.0 + (top - 1.0) * w;
            let p = [
                s * (corner[0] * cos - corner[1] * sin),
                s * (corner[0] * sin + corner[1] * cos),
                height * w,
            ];
            assert!(to_mesh(p, &twisted) <= tolerance, "seed {seed}");
        }
    }
}

fn corners_of(mesh: &trisect::Mesh, t: [u32; 3]) -> [[f64; 3]; 3] {
    t.map(|i| mesh.positions[i as usize])
}

fn side_area(mesh: &trisect::Mesh) -> f64 {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = corners_of(mesh, *t).map(glam::DVec3::from);
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(area).sum()
}

/// Distance to the nearest triangle, by brute force.
fn to_mesh(p: [f64; 3], mesh: &trisect::Mesh) -> f64 {
    mesh.triangles.iter().map(|t| common::to_triangle(p, corners_of(mesh, *t))).fold(f64::MAX, f64::min)
}

#[test]
fn revolutions_are_closed_and_converge() {
    let disc: SharedCurve<2> = Arc::new(EllipticArc::circle([3.0, 1.0], 1.0).unwrap());
    let disc = Region::new(&[disc]).unwrap();
    let exact = 2.0 * PI * PI * 3.0;
    let mut errors = Vec::new();
    for tolerance in [0.1, 0.01, 0.001] {
        let section = disc.polygons(&CurveMeshing::new(tolerance)).unwrap();
        let torus = Revolution::new(tolerance).mesh(&section).unwrap();
        assert_closed(&torus);
        errors.push((exact - volume(&torus)) / exact);
        let part = Revolution::new(tolerance).angle(PI / 3.0).mesh(&section).unwrap();
        assert_closed(&part);
        assert!((volume(&part) / exact - 1.0 / 6.0).abs() < tolerance);
    }
    assert!(errors.iter().all(|e| *e > 0.0) && errors[2] < 0.02 * errors[0], "{errors:?}");
    // A section that touches the axis in an edge, in a corner, and in both.
    for profile in [
        vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        vec![[0.0, 0.0], [1.0, 0.5], [1.0, 1.0]],
        vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 2.0], [0.0, 3.0]],
    ] {
        let section = Polygons::new(&[profile], FillRule::EvenOdd).unwrap();
        for revolution in [Revolution::new(0.01), Revolution::new(0.01).angle(1.0)] {
            let mesh = revolution.mesh(&section).unwrap();
            assert_closed(&mesh);
            assert!(volume(&mesh) > 0.0);
        }
    }
    let across = Polygons::rectangle([-1.0, 0.0], [1.0, 1.0]).unwrap();
    assert!(matches!(Revolution::new(0.1).mesh(&across), Err(GeometryError::CrossesAxis { .. })));
    let unit = Polygons::rectangle([0.0, 0.0], [1.0, 1.0]).unwrap();
    assert!(matches!(Revolution::new(0.1).angle(7.0).mesh(&unit), Err(GeometryError::OutOfRange { .. })));
    assert!(matches!(Revolution::new(1e-14).mesh(&unit), Err(GeometryError::TooManyNodes { .. })));
}

#[test]
fn sweeps_are_closed_and_keep_the_section() {
    let section = Polygons::rectangle([-0.1, -0.2], [0.1, 0.2]).unwrap();
    // Mitred joints: with the section's centroid on the path the volume is area times length, exactly.
    let bent = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [2.0, 3.0, 1.0], [5.0, 5.0, 2.0]];
    let length: f64 = bent.windows(2).map(|e| distance(e[0], e[1])).sum();
    let path = Polyline::new(&bent, &Spacing::ChordLength, false).unwrap();
    let mesh = Sweep::new(0.01).up([0.0, 0.0, 1.0]).mesh(&section, &path).unwrap();
    assert_closed(&mesh);
    assert!((volume(&mesh) - section.area() * length).abs() < 1e-12);
    let frame = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let frame = Polyline::new(&frame, &Spacing::ChordLength, true).unwrap();
    let mesh = Sweep::new(0.01).mesh(&section, &frame).unwrap();
    assert_closed(&mesh);
    assert_eq!(mesh.triangles.len(), 4 * 4 * 2);
    assert!((volume(&mesh) - section.area() * 6.0).abs() < 1e-12);
    // A straight path is an extrusion.
    let straight = Segment::new([0.0; 3], [0.0, 0.0, 2.0]).unwrap();
    let mesh = Sweep::new(0.01).up([0.0, 1.0, 0.0]).mesh(&section, &straight).unwrap();
    let box_ = Extrusion::new(2.0).mesh(&section).unwrap();
    assert_eq!((mesh.triangles.len(), volume(&mesh)), (box_.triangles.len(), volume(&box_)));
    // A closed curve with torsion: the frame must close.
    let knot: Vec<[f64; 3]> = (0..24)
        .map(|i| {
            let t = TAU * f64::from(i) / 24.0;
            [t.sin() + 2.0 * (2.0 * t).sin(), t.cos() - 2.0 * (2.0 * t).cos(), -(3.0 * t).sin()]
        })
        .collect();
    let knot = CubicSpline::new(&knot, &SplineEnds::Periodic, &Spacing::ChordLength).unwrap();
    let fine = CurveMeshing::new(1e-6).mesh(&knot).unwrap().points;
    let exact = section.area() * fine.windows(2).map(|e| distance(e[0], e[1])).sum::<f64>();
    for tolerance in [0.02, 0.005, 0.00125] {
        let mesh = Sweep::new(tolerance).mesh(&section, &knot).unwrap();
        assert_closed(&mesh);
        let error = (volume(&mesh) - exact).abs();
        assert!(error <= tolerance * side_area(&mesh), "{tolerance}: {error}");
    }
    // Too large for the bend.
    let hairpin = Bezier::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.0, 0.1, 0.0]]).unwrap();
    assert!(matches!(Sweep::new(0.001).mesh(&section, &hairpin), Err(GeometryError::SweepFolds { .. })));
}

/// Along random curves in space the frame turns about the curve as little as possible: no faster than the
/// sections' normal bends.
#[test]
fn swept_points_stay_near_the_exact_surface() {
    for seed in 0..30 {
        let mut rng = rng(seed);
        let control = points::<3>(&mut rng, 4)
            .iter()
            .enumerate()
            .map(|(i, p)| [p[0], p[1], p[2] + 2.0 * i as f64])
            .collect::<Vec<_>>();
        let path = Bezier::new(&control).unwrap();
        let section = Polygons::rectangle([-0.05, -0.05], [0.05, 0.05]).unwrap();
        let coarse = Sweep::new(0.01).up([1.0, 0.0, 0.0]).mesh(&section, &path).unwrap();
        let fine = Sweep::new(1e-5).up([1.0, 0.0, 0.0]).mesh(&section, &path).unwrap();
        assert_closed(&coarse);
        assert_closed(&fine);
        for p in fine.positions.iter().step_by(fine.positions.len() / 100 + 1) {
            let deviation = to_mesh(*p, &coarse);
            assert!(deviation <= 0.01, "seed {seed}: {deviation}");
        }
        let p = path.point(0.5);
        assert!(determinant(p, p, p) == 0.0);
    }
}

#[test]
fn bad_regions_are_named() {
    let open: SharedCurve<2> = Arc::new(Segment::new([0.0; 2], [1.0, 0.0]).unwrap());
    assert!(matches!(Region::new(&[open]), Err(GeometryError::NotClosed { .. })));
    assert!(matches!(
        Polygons::new(&[vec![[0.0; 2], [1.0, 0.0]]], FillRule::EvenOdd),
        Err(GeometryError::TooFewPoints { .. })
    ));
    assert!(matches!(
        Polygons::new(&[vec![[0.0; 2], [1.0, 0.0], [f64::INFINITY, 1.0]]], FillRule::EvenOdd),
        Err(GeometryError::NotFinite { .. })
    ));
    let unit = Polygons::rectangle([0.0; 2], [1.0, 1.0]).unwrap();
    assert!(matches!(Extrusion::new(0.0).mesh(&unit), Err(GeometryError::OutOfRange { .. })));
    assert!(matches!(Extrusion::new(1.0).taper(-1.0).mesh(&unit), Err(GeometryError::OutOfRange { .. })));
    assert!(matches!(Extrusion::new(1.0).twist(1.0, 0.0).mesh(&unit), Err(GeometryError::OutOfRange { .. })));
    assert!(matches!(
        Extrusion::new(1.0).twist(f64::NAN, 0.1).mesh(&unit),
        Err(GeometryError::NotFinite { .. })
    ));
    assert!(matches!(
        Extrusion::new(1.0).twist(1e9, 1e-9).mesh(&unit),
        Err(GeometryError::TooManyNodes { .. })
    ));
    assert!(Extrusion::new(1.0).mesh(&Polygons::default()).unwrap().is_empty());
}

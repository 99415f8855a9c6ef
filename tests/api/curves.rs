//! Curves: evaluation, interpolation, continuity, bounds, meshes within a tolerance.
#![cfg(feature = "parametric")]
#![allow(clippy::print_stdout, reason = "measurements, shown with --nocapture")]

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use crate::common::parametric as common;
use crate::common::parametric::{distance, parameter, point, points, rng, to_segment};
use crate::common::planar::{DEGREE_9, POLYGON};
use rand::RngExt;
use trisect::parametric::{
    Bezier, Composite, CubicSpline, Curve, CurveMeshing, EllipticArc, GeometryError, HermiteSpline,
    LagrangeCurve, NurbsCurve, Polyline, Refinement, Reversed, Segment, SharedCurve, Spacing, SplineEnds,
    TangentRule,
};

/// Calls `check` with `count` random curves of all kinds, and prints the seed of each on failure.
fn for_random_curves<const D: usize>(count: u32, mut check: impl FnMut(&SharedCurve<D>, u64)) {
    for which in 0..count {
        let seed = 1000 * D as u64 + u64::from(which);
        let curve = common::curve::<D>(&mut rng(seed), which);
        check(&curve, seed);
    }
}

/// The greatest distance of the curve from the edge between consecutive nodes, sampled densely.
fn measured_deviation<const D: usize>(curve: &dyn Curve<D>, parameters: &[f64], points: &[[f64; D]]) -> f64 {
    let mut worst = 0.0_f64;
    for (t, p) in parameters.windows(2).zip(points.windows(2)) {
        for k in 1..40 {
            let sample = curve.point(t[0] + (t[1] - t[0]) * f64::from(k) / 40.0);
            worst = worst.max(to_segment(sample, p[0], p[1]));
        }
    }
    worst
}

#[test]
fn meshes_stay_within_the_tolerance_on_random_curves() {
    fn check<const D: usize>(count: u32) {
        for_random_curves::<D>(count, |curve, seed| {
            let mut rng = rng(seed);
            let tolerance = 10.0_f64.powf(rng.random_range(-5.0..-1.0));
            let nodes = rng.random_range(2..20);
            for refinement in [Refinement::Levelled, Refinement::Halving] {
                let meshing = CurveMeshing::new(tolerance).initial_nodes(nodes).refinement(refinement);
                let mesh = meshing.mesh(curve.as_ref()).unwrap();
                let deviation = measured_deviation(curve.as_ref(), &mesh.parameters, &mesh.points);
                assert!(deviation <= tolerance, "seed {seed}, {refinement:?}: {deviation} > {tolerance}");
                assert!(mesh.parameters.windows(2).all(|t| t[0] < t[1]), "seed {seed}");
                assert!(mesh.points.len() >= nodes, "seed {seed}");
                let [start, end] = curve.domain();
                for i in 0..nodes {
                    let node = start + (end - start) * i as f64 / (nodes - 1) as f64;
                    let nearest = mesh.parameters.iter().map(|t| (t - node).abs()).fold(f64::MAX, f64::min);
                    assert!(nearest <= 1e-8 * (end - start), "seed {seed}: initial node {i} is missing");
                }
                assert_eq!(mesh, meshing.mesh(curve.as_ref()).unwrap(), "seed {seed}: not deterministic");
            }
        });
    }
    check::<2>(500);
    check::<3>(500);
}

/// Smooth curves whose meshes are fine enough for the count to follow the square root of the tolerance.
#[test]
fn halving_the_tolerance_costs_a_factor_of_root_two() {
    let mut worst = 0.0_f64;
    let mut logs = 0.0;
    let mut measured = 0;
    for seed in 0..200 {
        let mut rng = rng(seed);
        let degree = rng.random_range(2..10);
        let curve = common::bezier::<3>(&mut rng, degree);
        let mut tolerance = 1e-3;
        let edges = |tolerance| CurveMeshing::new(tolerance).mesh(&curve).unwrap().points.len() - 1;
        let mut before = edges(tolerance);
        for _ in 0..8 {
            tolerance /= 2.0;
            let after = edges(tolerance);
            // A factor of whole numbers near 1.41 needs a few edges to begin with.
            if before >= 8 {
                let growth = after as f64 / before as f64;
                worst = worst.max(growth);
                logs += growth.ln();
                measured += 1;
            }
            before = after;
        }
    }
    let mean = f64::exp(logs / f64::from(measured));
    println!("growth over {measured} halvings: mean {mean:.4}, worst {worst:.4}");
    assert!(worst <= 1.6, "worst growth {worst}");
    assert!((1.39..1.44).contains(&mean), "mean growth {mean}");
}

#[test]
fn levelled_meshes_need_no_more_nodes_than_halving() {
    let (mut levelled, mut halved) = (0, 0);
    for_random_curves::<2>(220, |curve, seed| {
        let count = |refinement| {
            CurveMeshing::new(1e-3).refinement(refinement).mesh(curve.as_ref()).unwrap().points.len()
        };
        let counts = [count(Refinement::Levelled), count(Refinement::Halving)];
        assert!(counts[0] <= counts[1], "seed {seed}: {counts:?}");
        levelled += counts[0];
        halved += counts[1];
    });
    println!("nodes: levelled {levelled}, halving {halved}");
}

#[test]
fn derivatives_agree_with_differences() {
    for_random_curves::<3>(330, |curve, seed| {
        let mut rng = rng(seed);
        let [start, end] = curve.domain();
        let h = 1e-5 * (end - start);
        for _ in 0..5 {
            let t = parameter(&mut rng, curve.as_ref());
            let near_break = curve.breaks().iter().any(|b| (b - t).abs() < 2.0 * h);
            if near_break {
                continue;
            }
            let exact = curve.derivatives(t, 3);
            assert!(distance(exact[0], curve.point(t)) < 1e-13, "seed {seed}");
            let (before, after) = (curve.derivatives(t - h, 3), curve.derivatives(t + h, 3));
            for k in 0..3 {
                let size =
                    after.iter().chain([&exact[k]]).map(|d| distance(*d, [0.0; 3])).fold(1.0, f64::max);
                let difference: [f64; 3] = std::array::from_fn(|i| (after[k][i] - before[k][i]) / (2.0 * h));
                let error = distance(difference, exact[k + 1]);
                assert!(
                    error < 1e-4 * size / (end - start).min(1.0),
                    "seed {seed}, order {}: {error}",
                    k + 1
                );
            }
        }
    });
}

#[test]
fn control_polygons_enclose_their_part() {
    for_random_curves::<2>(330, |curve, seed| {
        let mut rng = rng(seed);
        for piece in curve.breaks().windows(2) {
            let mut ends = [rng.random_range(piece[0]..piece[1]), rng.random_range(piece[0]..piece[1])];
            ends.sort_by(f64::total_cmp);
            for [a, b] in [[piece[0], piece[1]], ends] {
                let mut polygon = Vec::new();
                curve.control_polygon(a, b, &mut polygon);
                assert!(distance(polygon[0], curve.point(a)) < 1e-12, "seed {seed}");
                assert!(distance(*polygon.last().unwrap(), curve.point(b)) < 1e-12, "seed {seed}");
                for _ in 0..20 {
                    let p = curve.point(rng.random_range(a..b));
                    // The hull contains p if in every direction some point of the polygon reaches as far.
                    for k in 0..16 {
                        let (sin, cos) = (f64::from(k) * TAU / 16.0).sin_cos();
                        let reach = |q: &[f64; 2]| q[0] * cos + q[1] * sin;
                        let most = polygon.iter().map(reach).fold(f64::MIN, f64::max);
                        assert!(reach(&p) <= most + 1e-12, "seed {seed}: {a}..{b}");
                    }
                }
            }
        }
        let [low, high] = curve.bounds();
        for _ in 0..50 {
            let p = curve.point(parameter(&mut rng, curve.as_ref()));
            assert!((0..2).all(|i| low[i] - 1e-12 <= p[i] && p[i] <= high[i] + 1e-12), "seed {seed}");
        }
    });
}

#[test]
fn nurbs_form_is_the_same_set_of_points() {
    for_random_curves::<2>(330, |curve, seed| {
        let nurbs = curve.to_nurbs();
        let ([a, b], [c, d]) = (curve.domain(), nurbs.domain());
        assert!(distance(curve.point(a), nurbs.point(c)) < 1e-12, "seed {seed}");
        assert!(distance(curve.point(b), nurbs.point(d)) < 1e-12, "seed {seed}");
        let fine = CurveMeshing::new(1e-5).mesh(curve.as_ref()).unwrap().points;
        let coarse = CurveMeshing::new(1e-2).mesh(&nurbs).unwrap().points;
        for p in coarse {
            let nearest = fine.windows(2).map(|e| to_segment(p, e[0], e[1])).fold(f64::MAX, f64::min);
            assert!(nearest < 1.1e-5, "seed {seed}: {nearest}");
        }
    });
}

#[test]
fn curves_go_through_their_points() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let count = rng.random_range(3..12);
        let given = points::<3>(&mut rng, count);
        let tangents = points::<3>(&mut rng, count);
        let t = |curve: &dyn Curve<3>| curve.breaks();
        let through = |curve: &dyn Curve<3>, t: &[f64]| {
            for (i, p) in given.iter().enumerate() {
                let error = distance(curve.point(t[i]), *p);
                assert!(error < 1e-12, "seed {seed}, point {i}: {error}");
            }
        };
        let polyline = Polyline::new(&given, &Spacing::ChordLength, false).unwrap();
        through(&polyline, &t(&polyline));
        let hermite = HermiteSpline::with_tangents(&given, &tangents, &Spacing::ChordLength, true).unwrap();
        through(&hermite, &t(&hermite));
        for (i, q) in tangents.iter().enumerate() {
            let error = distance(hermite.derivatives(t(&hermite)[i], 1)[1], *q);
            assert!(error < 1e-12, "seed {seed}, tangent {i}: {error}");
        }
        let ends = [point(&mut rng), point(&mut rng)];
        let spline = CubicSpline::new(&given, &SplineEnds::Clamped(ends), &Spacing::Centripetal).unwrap();
        through(&spline, &t(&spline));
        let [start, end] = spline.domain();
        assert!(distance(spline.derivatives(start, 1)[1], ends[0]) < 1e-12, "seed {seed}");
        assert!(distance(spline.derivatives(end, 1)[1], ends[1]) < 1e-12, "seed {seed}");
        let lagrange = LagrangeCurve::new(&given, &Spacing::ChordLength).unwrap();
        through(&lagrange, &t(&polyline));
    }
}

/// Jumps of the derivatives at inner breaks, and at the closing point of a closed curve.
fn greatest_jump(curve: &dyn Curve<2>, order: usize, closed: bool) -> f64 {
    let breaks = curve.breaks();
    let last = breaks.len() - 1;
    let mut worst = 0.0_f64;
    for i in usize::from(!closed)..last {
        let before = if i == 0 { breaks[last] } else { breaks[i].next_down() };
        let (left, right) =
            (curve.derivatives(before, order)[order], curve.derivatives(breaks[i], order)[order]);
        let size = distance(left, [0.0; 2]).max(1.0);
        worst = worst.max(distance(left, right) / size);
    }
    worst
}

#[test]
fn splines_are_as_smooth_as_they_claim() {
    for seed in 0..200 {
        let mut rng = rng(seed);
        let count = rng.random_range(3..12);
        let given = points::<2>(&mut rng, count);
        let spacing = [Spacing::Uniform, Spacing::ChordLength, Spacing::Centripetal];
        let spacing = &spacing[rng.random_range(0..3)];
        let natural = CubicSpline::new(&given, &SplineEnds::Natural, spacing).unwrap();
        let periodic = CubicSpline::new(&given, &SplineEnds::Periodic, spacing).unwrap();
        for order in 0..=2 {
            let jump = greatest_jump(&natural, order, false);
            assert!(jump < 1e-10, "seed {seed}, natural, order {order}: {jump}");
            let jump = greatest_jump(&periodic, order, true);
            assert!(jump < 1e-10, "seed {seed}, periodic, order {order}: {jump}");
        }
        let [start, end] = natural.domain();
        assert!(distance(natural.derivatives(start, 2)[2], [0.0; 2]) < 1e-10, "seed {seed}");
        assert!(distance(natural.derivatives(end, 2)[2], [0.0; 2]) < 1e-10, "seed {seed}");
        assert_eq!(periodic.point(periodic.domain()[1]), periodic.point(periodic.domain()[0]));
        for rule in [TangentRule::Central, TangentRule::NearerNeighbour, TangentRule::FartherNeighbour] {
            let hermite = HermiteSpline::through(&given, rule, spacing, true).unwrap();
            for order in 0..=1 {
                let jump = greatest_jump(&hermite, order, true);
                assert!(jump < 1e-12, "seed {seed}, {rule:?}, order {order}: {jump}");
            }
        }
    }
}

/// The printed formulas, for unit steps.
#[test]
fn tangent_rules_are_the_papers() {
    let p: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 2.0], [4.0, 3.0], [5.0, 0.0]];
    let s = [f64::sqrt(5.0), f64::sqrt(10.0), f64::sqrt(10.0)];
    let tangents =
        |rule| HermiteSpline::through(&p, rule, &Spacing::Uniform, false).unwrap().tangents().to_vec();
    let component = |w0: f64, w1: f64, i: usize, k: usize| {
        (w0 * (p[i][k] - p[i - 1][k]) + w1 * (p[i + 1][k] - p[i][k])) / (w0 + w1)
    };
    for i in 1..3 {
        for k in 0..2 {
            let central = (p[i + 1][k] - p[i - 1][k]) / 2.0;
            assert!((tangents(TangentRule::Central)[i][k] - central).abs() < 1e-15);
            let nearer = component(s[i], s[i - 1], i, k);
            assert!((tangents(TangentRule::NearerNeighbour)[i][k] - nearer).abs() < 1e-15);
            let farther = component(s[i - 1], s[i], i, k);
            assert!((tangents(TangentRule::FartherNeighbour)[i][k] - farther).abs() < 1e-15);
        }
    }
    let central = tangents(TangentRule::Central);
    for k in 0..2 {
        assert!((central[0][k] - (2.0 * (p[1][k] - p[0][k]) - central[1][k])).abs() < 1e-15);
        assert!((central[3][k] - (2.0 * (p[3][k] - p[2][k]) - central[2][k])).abs() < 1e-15);
    }
}

#[test]
fn bezier_algebra_keeps_the_curve() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let degree = rng.random_range(1..12);
        let curve = common::bezier::<3>(&mut rng, degree);
        let raised = curve.raised_to(degree + 5);
        assert_eq!(raised.degree(), degree + 5);
        let cut = rng.random_range(0.1..0.9);
        let [left, right] = curve.split(cut);
        for _ in 0..20 {
            let t = rng.random_range(0.0..1.0);
            assert!(distance(curve.point(t), raised.point(t)) < 1e-13, "seed {seed}");
            assert!(distance(curve.point(cut * t), left.point(t)) < 1e-13, "seed {seed}");
            assert!(distance(curve.point(cut + (1.0 - cut) * t), right.point(t)) < 1e-13, "seed {seed}");
            assert!(distance(curve.derivatives(t, 1)[1], curve.hodograph().point(t)) < 1e-12, "seed {seed}");
        }
    }
}

#[test]
fn knot_insertion_keeps_the_curve() {
    for seed in 0..200 {
        let mut rng = rng(seed);
        let curve = common::bspline::<3>(&mut rng);
        let mut finer = curve.clone();
        for _ in 0..5 {
            finer = finer.with_knot(parameter(&mut rng, &curve)).unwrap();
        }
        for _ in 0..20 {
            let t = parameter(&mut rng, &curve);
            assert!(distance(curve.point(t), finer.point(t)) < 1e-13, "seed {seed}");
            let [start, end] = curve.domain();
            let reversed = curve.reversed().point(start + (end - t));
            assert!(distance(curve.point(t), reversed) < 1e-12, "seed {seed}");
        }
    }
}

#[test]
fn circles_are_round_and_close() {
    let circle = EllipticArc::circle([1.0, 2.0], 3.0).unwrap();
    assert_eq!(circle.point(0.0), [4.0, 2.0]);
    assert_eq!(circle.point(FRAC_PI_2), [1.0, 5.0]);
    assert_eq!(circle.point(TAU), circle.point(0.0));
    let nurbs = circle.to_nurbs();
    for k in 0..100 {
        let p = nurbs.point(nurbs.domain()[1] * f64::from(k) / 99.0);
        assert!((distance(p, [1.0, 2.0]) - 3.0).abs() < 1e-14);
    }
    assert!(nurbs.corners().is_empty());
    let backwards = EllipticArc::arc([0.0; 2], 1.0, 0.0, -FRAC_PI_2).unwrap();
    assert_eq!(backwards.point(FRAC_PI_2), [0.0, -1.0]);
}

#[test]
fn composites_are_spliced_flat() {
    let segment = |a: [f64; 2], b: [f64; 2]| -> SharedCurve<2> { Arc::new(Segment::new(a, b).unwrap()) };
    let first = Composite::new(&[segment([0.0, 0.0], [1.0, 0.0]), segment([1.0, 0.0], [1.0, 1.0])]).unwrap();
    let whole = Composite::closed(&[Arc::new(first), segment([1.0, 1.0], [0.0, 0.0])]).unwrap();
    assert_eq!(whole.segments().len(), 3);
    assert_eq!(whole.domain(), [0.0, 3.0]);
    assert_eq!(whole.point(1.5), [1.0, 0.5]);
    assert_eq!(whole.corners(), [1.0, 2.0]);
    let backwards = Reversed::new(Arc::new(whole));
    assert_eq!(backwards.point(0.5), [0.5, 0.5]);
    assert_eq!(backwards.corners(), [1.0, 2.0]);
}

#[test]
fn worked_cases_of_choporov_2017() {
    let curve = Bezier::new(&DEGREE_9).unwrap();
    let meshing = CurveMeshing::new(0.02).initial_nodes(41);
    let mesh = meshing.clone().refinement(Refinement::Halving).mesh(&curve).unwrap();
    assert!(measured_deviation(&curve, &mesh.parameters, &mesh.points) <= 0.02);
    assert_eq!(mesh.points.first(), mesh.points.last());
    println!("degree 9: {} edges from 40", mesh.points.len() - 1);

    let polygon = Polyline::new(&POLYGON, &Spacing::Uniform, true).unwrap();
    for tolerance in [1.0, 1e-3, 1e-9] {
        let mesh = CurveMeshing::new(tolerance).initial_nodes(13).mesh(&polygon).unwrap();
        assert_eq!(mesh.points, polygon.points(), "the tolerance has no effect on a polygon");
    }
}

#[test]
fn bad_input_is_named() {
    let p = |x: f64| [x, 0.0];
    assert!(matches!(Bezier::new(&[p(0.0)]), Err(GeometryError::TooFewPoints { needed: 2, found: 1, .. })));
    assert!(matches!(Bezier::new(&[p(1.0), p(1.0), p(1.0)]), Err(GeometryError::CoincidentPoints { .. })));
    assert!(matches!(Segment::new(p(f64::NAN), p(1.0)), Err(GeometryError::NotFinite { index: 0, .. })));
    let repeated = [p(0.0), p(1.0), p(1.0), p(2.0)];
    for result in [
        Polyline::new(&repeated, &Spacing::Uniform, false).err(),
        CubicSpline::new(&repeated, &SplineEnds::Natural, &Spacing::ChordLength).err(),
        HermiteSpline::through(&repeated, TangentRule::Central, &Spacing::ChordLength, false).err(),
        LagrangeCurve::new(&repeated, &Spacing::Centripetal).err(),
    ] {
        assert!(matches!(result, Some(GeometryError::CoincidentPoints { first: 1, second: 2, .. })));
    }
    let control = [p(0.0), p(1.0), p(2.0), p(3.0)];
    let spline = |knots: &[f64]| NurbsCurve::bspline(2, knots, &control).err();
    assert!(matches!(spline(&[0.0; 6]), Some(GeometryError::CountMismatch { expected: 7, found: 6, .. })));
    assert!(matches!(
        spline(&[0.0, 0.0, 0.0, 2.0, 1.0, 3.0, 3.0]),
        Some(GeometryError::BadKnots { index: 4, .. })
    ));
    assert!(matches!(spline(&[0.0; 7]), Some(GeometryError::BadKnots { .. })));
    let torn = NurbsCurve::bspline(1, &[0.0, 0.0, 1.0, 1.0, 2.0, 2.0], &control);
    assert!(matches!(torn, Err(GeometryError::BadKnots { .. })));
    let weights =
        NurbsCurve::nurbs(3, &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], &control, &[1.0, -1.0, 1.0, 1.0]);
    assert!(matches!(weights, Err(GeometryError::BadWeight { index: 1, .. })));
    let unsorted = Spacing::Given(vec![0.0, 2.0, 1.0, 3.0]);
    assert!(matches!(
        Polyline::new(&control, &unsorted, false),
        Err(GeometryError::ParametersNotIncreasing { index: 2 })
    ));
    assert!(matches!(EllipticArc::circle([0.0; 2], -1.0), Err(GeometryError::OutOfRange { .. })));
    let flat = EllipticArc::new([0.0; 2], [1.0, 1.0], [2.0, 2.0], 0.0, 1.0);
    assert!(matches!(flat, Err(GeometryError::Degenerate { .. })));
    let gap: [SharedCurve<2>; 2] =
        [Arc::new(Segment::new(p(0.0), p(1.0)).unwrap()), Arc::new(Segment::new(p(1.5), p(2.0)).unwrap())];
    assert!(matches!(
        Composite::new(&gap),
        Err(GeometryError::SegmentsDoNotMeet { segment: 0, next: 1, .. })
    ));
    let open: [SharedCurve<2>; 1] = [Arc::new(Segment::new(p(0.0), p(1.0)).unwrap())];
    assert!(matches!(Composite::closed(&open), Err(GeometryError::NotClosed { .. })));
    let circle = EllipticArc::circle([0.0; 2], 1.0).unwrap();
    assert!(matches!(CurveMeshing::new(0.0).mesh(&circle), Err(GeometryError::OutOfRange { .. })));
    assert!(matches!(CurveMeshing::new(f64::NAN).mesh(&circle), Err(GeometryError::OutOfRange { .. })));
    assert!(matches!(CurveMeshing::new(1e-20).mesh(&circle), Err(GeometryError::ToleranceTooSmall { .. })));
    assert!(matches!(
        CurveMeshing::new(1e-10).most_nodes(1000).mesh(&circle),
        Err(GeometryError::TooManyNodes { limit: 1000, .. })
    ));
    // Parameters outside the domain, even NaN, never give a point that is not on the curve.
    assert_eq!(circle.point(-1.0), circle.point(0.0));
    assert_eq!(circle.point(f64::NAN), circle.point(0.0));
    assert_eq!(Bezier::new(&control).unwrap().point(7.0), p(3.0));
}

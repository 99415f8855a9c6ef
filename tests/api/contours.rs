//! Plane regions: distances of polygons, contours of fields, bounds.

use crate::common::planar::POLYGON;
use rand::{RngExt, SeedableRng};
use trisect::field::{
    ContourDistance, ContourExtraction, Contours, Expression, Extraction, Formula, System, extrude,
};
use trisect::spatial::Side;
use trisect::{Control, Error};

fn field(text: &str) -> Expression {
    Formula::parse(text)
        .and_then(|f| f.compile(System::R0, &[], &[]))
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The polygon of Choporov 2017, and a square hole in a square.
fn shapes() -> Vec<Contours> {
    let square = |half: f64| vec![[-half, -half], [half, -half], [half, half], [-half, half]];
    vec![Contours { loops: vec![POLYGON.to_vec()] }, Contours { loops: vec![square(2.0), square(1.0)] }]
}

fn brute(contours: &Contours, [x, y]: [f64; 2]) -> f64 {
    let mut best = f64::INFINITY;
    for points in &contours.loops {
        for k in 0..points.len() {
            let (a, b) = (points[k], points[(k + 1) % points.len()]);
            let along = [b[0] - a[0], b[1] - a[1]];
            let t = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / (along[0].powi(2) + along[1].powi(2));
            let t = t.clamp(0.0, 1.0);
            best = best.min((x - a[0] - t * along[0]).hypot(y - a[1] - t * along[1]));
        }
    }
    best
}

#[test]
fn polygon_distances_equal_brute_force() {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1);
    for contours in shapes() {
        let distance = ContourDistance::new(&contours).expect("polygons");
        for _ in 0..5000 {
            let q = [0; 2].map(|_| random.random::<f64>() * 9.0 - 3.0);
            let found = distance.at(q);
            assert!((found.abs() - brute(&contours, q)).abs() < 1e-14, "{q:?}");
            let (_, g) = distance.gradient(q);
            assert!((g[0].hypot(g[1]) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn sides_of_polygons_are_exact_at_corners_and_in_line_with_edges() {
    let distance = ContourDistance::new(&shapes()[0]).expect("a polygon");
    // Rays along edges and through corners.
    for (q, side) in [
        ([0.5, 1.0], Side::Inside),
        ([0.5, 4.0], Side::Inside),
        ([1.5, 2.0], Side::Outside),
        ([-1.0, 0.0], Side::Outside),
        ([-1.0, 5.0], Side::Outside),
        ([2.5, 3.5], Side::Inside),
        ([2.5, 2.5], Side::Outside),
        ([0.0, 0.0], Side::On),
        ([1.0, 2.5], Side::On),
        ([3.0, 2.0], Side::On),
        ([1.5, 1.0], Side::On),
    ] {
        assert_eq!(distance.side(q), side, "{q:?}");
        assert_eq!(distance.at(q) == 0.0, side == Side::On, "{q:?}");
    }
    let frame = ContourDistance::new(&shapes()[1]).expect("a frame");
    assert_eq!(frame.side([0.0, 0.0]), Side::Outside);
    assert_eq!(frame.side([1.5, 0.0]), Side::Inside);
    assert_eq!(frame.at([0.0, 0.0]), -1.0);
}

#[test]
fn contours_keep_corners_and_orientation() {
    let text = "min(1 - abs(x), 0.5 - abs(y)) and not circle(x, y, 0.3)";
    let found = ContourExtraction::new([-2.0; 2], [2.0; 2], 1e-4).run(&field(text)).expect("contours");
    assert_eq!(found.loops.len(), 2);
    let expected = 2.0 - std::f64::consts::PI * 0.09;
    assert!((found.area() - expected).abs() < 1e-4, "{} {expected}", found.area());
    for corner in [[1.0, 0.5], [-1.0, 0.5], [-1.0, -0.5], [1.0, -0.5]] {
        let near = |p: &[f64; 2]| (p[0] - corner[0]).hypot(p[1] - corner[1]);
        let nearest = found.loops.iter().flatten().map(near).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-9, "{corner:?}: {nearest}");
    }
    let mut areas: Vec<f64> =
        found.loops.iter().map(|l| Contours { loops: vec![l.clone()] }.area()).collect();
    areas.sort_by(f64::total_cmp);
    assert!(areas[0] < -0.28 && areas[1] > 1.99, "{areas:?}");
}

#[test]
fn crossing_lines_come_out_as_closed_polygons_that_do_not_cross() {
    // A lemniscate crosses itself at the origin; lines cross in a checkerboard.
    for text in [
        "2 * (x^2 - y^2) - (x^2 + y^2)^2",
        "x * y and 1 - x^2 - y^2",
        "sin(9 * x) * sin(9 * y) and 4 - x^2 - y^2",
    ] {
        let found = ContourExtraction::new([-2.2; 2], [2.2; 2], 2e-3).run(&field(text)).expect("contours");
        assert!(found.area() > 0.0);
        // Extrusion refuses contours that cross or touch.
        extrude(&found, 0.0, 1.0).unwrap_or_else(|error| panic!("{text}: {error}"));
    }
}

#[test]
fn bounds_are_found_or_said_to_be_missing() {
    let bounds = |text: &str| field(text).positive_bounds(None, &Control::new());
    for (text, low, high) in [
        ("sphere(x - 100, y, z, 0.5)", [99.5, -0.5, -0.5], [100.5, 0.5, 0.5]),
        ("1 - length(x, y, z) and not sphere(x - 1, y, z, 0.9)", [-1.0; 3], [0.6, 1.0, 1.0]),
        ("min(2000 - abs(x), 1 - abs(y), 0.01 - abs(z))", [-2000.0, -1.0, -0.01], [2000.0, 1.0, 0.01]),
    ] {
        let [found_low, found_high] = bounds(text).expect(text).expect(text);
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        for k in 0..3 {
            assert!(found_low[k] <= low[k] && found_low[k] > low[k] - 0.06 * size, "{text}: {found_low:?}");
            // The second shape's end in x is where two surfaces meet: not less, but perhaps a little more.
            assert!(
                found_high[k] >= high[k] && found_high[k] < high[k] + 0.2 * size,
                "{text}: {found_high:?}"
            );
        }
    }
    assert_eq!(bounds("-1 - x^2").expect("nowhere"), None);
    assert!(
        matches!(bounds("1 - x^2 - y^2"), Err(Error::Field(what)) if what.to_string().contains("along z"))
    );
    assert!(matches!(bounds("x"), Err(Error::Field(_))));
}

#[test]
fn clipping_closes_what_does_not_end() {
    let column = field("1 - x^2 - y^2");
    let extraction = Extraction::new([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0], 0.01);
    assert!(
        matches!(extraction.run(&column), Err(Error::Field(what)) if what.to_string().contains("does not end"))
    );
    let clipped = extraction.clip(true).run(&column).expect("a cylinder").mesh;
    let heights = clipped.positions.iter().map(|p| p[2]);
    let (low, high) = heights.fold((1.0f64, -1.0f64), |(l, h), z| (l.min(z), h.max(z)));
    assert!((low + 1.0).abs() < 1e-6 && (high - 1.0).abs() < 1e-6, "{low} {high}");
}

#[test]
fn absurd_settings_are_refused() {
    let ball = field("sphere(x, y, z, 1)");
    let refused = |extraction: Extraction| matches!(extraction.run(&ball), Err(Error::InvalidArgument(_)));
    assert!(refused(Extraction::new([1.0; 3], [-1.0; 3], 0.1)));
    assert!(refused(Extraction::new([-2.0; 3], [f64::INFINITY; 3], 0.1)));
    assert!(refused(Extraction::new([-2.0; 3], [2.0; 3], 0.0)));
    assert!(refused(Extraction::new([-2.0; 3], [2.0; 3], 1e-9)));
    assert!(refused(Extraction::new([-2.0; 3], [2.0; 3], 0.1).resolution(f64::NAN)));
    assert!(ContourExtraction::new([0.0; 2], [0.0, 1.0], 0.1).run(&ball).is_err());
    let empty = Extraction::new([5.0; 3], [6.0; 3], 0.1).run(&ball).expect("nothing there");
    assert!(empty.mesh.is_empty());
}

//! Curves, regions, patches and solids as JSON and SVG.
#![cfg(feature = "parametric")]

use std::f64::consts::PI;

use crate::common::parametric as common;
use crate::common::parametric::{assert_closed, distance, rng, volume};
use rand::RngExt;
use serde_json::{Value, json};
use trisect::parametric::json::{
    AnyCurve, bezier_to_json, bspline_to_json, curve, named_patches, parse, patch, patch_to_json, region,
    region_to_json, solid,
};
use trisect::parametric::svg::{Ink, Picture, curves_of_path, path_data, read_paths};
use trisect::parametric::{
    Bezier, Composite, Curve, CurveMeshing, EllipticArc, FillRule, GeometryError, NurbsCurve, Patch,
    RegionOperation, Segment, SharedCurve,
};
use trisect::{Control, Error};

fn plane(value: &Value) -> SharedCurve<2> {
    match curve(value).unwrap() {
        AnyCurve::Plane(curve) => curve,
        AnyCurve::Space(_) => panic!("{value} is a curve of space"),
    }
}

fn space(value: &Value) -> SharedCurve<3> {
    match curve(value).unwrap() {
        AnyCurve::Space(curve) => curve,
        AnyCurve::Plane(_) => panic!("{value} is a curve of the plane"),
    }
}

#[test]
fn every_kind_of_curve_is_read() {
    let points = json!([[0, 0], [1, 2], [3, 1], [4, 4]]);
    let kinds = [
        (json!({ "type": "segment", "points": [[0, 0], [4, 4]] }), [0.0, 0.0], [4.0, 4.0]),
        (
            json!({ "type": "line", "point": [0, 1], "direction": [2, 0], "domain": [-1, 2] }),
            [-2.0, 1.0],
            [4.0, 1.0],
        ),
        (json!({ "type": "circle", "center": [1, 1], "radius": 2 }), [3.0, 1.0], [3.0, 1.0]),
        (
            json!({ "type": "ellipse", "center": [0, 0], "radii": [2, 1], "rotation": 90 }),
            [0.0, 2.0],
            [0.0, 2.0],
        ),
        (
            json!({ "type": "arc", "center": [0, 0], "radius": 1, "start": 90, "sweep": -90 }),
            [0.0, 1.0],
            [1.0, 0.0],
        ),
        (json!({ "type": "polyline", "points": points, "spacing": "uniform" }), [0.0, 0.0], [4.0, 4.0]),
        (json!({ "type": "polyline", "points": points, "closed": true }), [0.0, 0.0], [0.0, 0.0]),
        (json!({ "type": "hermite", "points": points, "tangents": "nearer" }), [0.0, 0.0], [4.0, 4.0]),
        (
            json!({ "type": "hermite", "points": [[0, 0], [1, 1]], "tangents": [[1, 0], [0, 1]] }),
            [0.0, 0.0],
            [1.0, 1.0],
        ),
        (json!({ "type": "cubic_spline", "points": points }), [0.0, 0.0], [4.0, 4.0]),
        (json!({ "type": "cubic_spline", "points": points, "ends": "periodic" }), [0.0, 0.0], [0.0, 0.0]),
        (
            json!({ "type": "cubic_spline", "points": points, "ends": { "clamped": [[1, 0], [0, 1]] },
                "spacing": [0, 1, 2, 4] }),
            [0.0, 0.0],
            [4.0, 4.0],
        ),
        (json!({ "type": "lagrange", "points": points, "spacing": "centripetal" }), [0.0, 0.0], [4.0, 4.0]),
        (json!({ "type": "bezier", "name": "b", "points": points }), [0.0, 0.0], [4.0, 4.0]),
        (json!({ "type": "bspline", "degree": 2, "points": points }), [0.0, 0.0], [4.0, 4.0]),
        (
            json!({ "type": "bspline", "degree": 3, "points": points, "knots": [0, 0, 0, 0, 1, 1, 1, 1],
                "weights": [1, 2, 2, 1] }),
            [0.0, 0.0],
            [4.0, 4.0],
        ),
        (
            json!({ "type": "composite", "segments": [
                { "type": "segment", "points": [[0, 0], [1, 0]] },
                { "type": "arc", "center": [1, 1], "radius": 1, "start": -90, "sweep": 90 } ] }),
            [0.0, 0.0],
            [2.0, 1.0],
        ),
        (
            json!({ "type": "reversed", "curve": { "type": "bezier", "points": points } }),
            [4.0, 4.0],
            [0.0, 0.0],
        ),
        (json!({ "type": "svg_path", "d": "M0 0 C 1 -2 3 -1 4 -4" }), [0.0, 0.0], [4.0, 4.0]),
    ];
    for (value, start, end) in kinds {
        let curve = plane(&value);
        let [a, b] = curve.domain().map(|t| curve.point(t));
        assert!(distance(a, start) < 1e-12 && distance(b, end) < 1e-12, "{value}: {a:?} {b:?}");
    }
    let helix = space(&json!({ "type": "cubic_spline", "points": [[1, 0, 0], [0, 1, 1], [-1, 0, 2]] }));
    assert_eq!(helix.point(helix.domain()[1]), [-1.0, 0.0, 2.0]);
    let arc = json!({ "type": "arc", "center": [0, 0, 1], "a": [1, 0, 0], "b": [0, 0, 1], "sweep": 90 });
    assert_eq!(space(&arc).point(space(&arc).domain()[1]), [0.0, 0.0, 2.0]);
}

#[test]
fn curves_and_patches_survive_writing_and_reading_bit_for_bit() {
    for seed in 0..100 {
        let mut rng = rng(seed);
        let degree = rng.random_range(1..8);
        let bezier = common::bezier::<3>(&mut rng, degree);
        let text = bezier_to_json(&bezier).to_string();
        assert_eq!(space(&parse(&text).unwrap()).to_nurbs().control(), bezier.control());
        let spline = common::bspline::<2>(&mut rng);
        let back = plane(&parse(&bspline_to_json(&spline).to_string()).unwrap()).to_nurbs();
        assert_eq!(back, spline, "seed {seed}");
    }
    let sphere = Patch::sphere([0.1, 0.2, 0.3], 0.7).unwrap();
    assert_eq!(patch(&parse(&patch_to_json(&sphere).to_string()).unwrap()).unwrap(), sphere);
}

#[test]
fn faults_in_json_are_told_with_their_place() {
    let fault = |text: &str| match parse(text).and_then(|value| curve(&value)) {
        Err(fault) => fault.to_string(),
        Ok(curve) => panic!("{curve:?}"),
    };
    assert_eq!(fault("{\n  \"type\": }"), "line 2, column 11: not valid JSON: expected value");
    assert_eq!(fault("[]"), "document: expected an object, found an array");
    assert_eq!(fault("{}"), "document: \"type\" is missing");
    assert!(
        fault(r#"{"type": "bezzier"}"#)
            .starts_with("document: unknown type \"bezzier\" of a curve; known: segment,")
    );
    assert_eq!(
        fault(r#"{"type": "bezier", "points": [[0, 0], [1, 0, 0]]}"#),
        "/points/1: expected 2 numbers, found 3"
    );
    assert!(
        fault(r#"{"type": "bezier", "points": [[0, 0], [1, "x"]]}"#)
            .starts_with("/points/1/1: invalid type: string")
    );
    assert!(fault(r#"{"type": "bezier", "point": [[0, 0]]}"#).contains("unknown field `point`"));
    assert!(fault(r#"{"type": "circle", "center": [0, 0]}"#).contains("missing field `radius`"));
    assert_eq!(
        fault(r#"{"type": "composite", "segments": [{"type": "bezier", "points": [[0, 0], [0, 0]]}]}"#),
        "/segments/0: points 0 and 1 of the Bezier curve coincide; remove one of them"
    );
    let place = match curve(&json!({ "type": "circle", "center": [0, 0], "radius": -1 })) {
        Err(GeometryError::At { fault, .. }) => *fault,
        other => panic!("{other:?}"),
    };
    assert!(matches!(place, GeometryError::OutOfRange { .. }));
    let three = json!({ "type": "svg_path", "d": "M0 0L1 0M2 0L3 0" });
    assert!(curve(&three).unwrap_err().to_string().contains("2 parts"));
    let leaf = json!({ "type": "extrusion", "region": { "type": "region", "contours": [
        { "type": "segment", "points": [[0, 0], [1, 0]] }] }, "height": 1, "tolerance": 0.1 });
    let Err(Error::Geometry(fault)) = solid(&leaf, &Control::new()) else { panic!("an open contour") };
    assert!(fault.to_string().starts_with("/region: the contour is not closed"), "{fault}");
}

#[test]
fn regions_and_their_operations_are_read() {
    let meshing = CurveMeshing::new(1e-3);
    let plate = json!({ "type": "difference", "regions": [
        { "type": "rectangle", "low": [0, 0], "high": [4, 2] },
        { "type": "circle", "center": [1, 1], "radius": 0.5 },
        { "type": "region", "contours": [
            { "type": "circle", "center": [3, 1], "radius": 0.5 },
            { "type": "circle", "center": [3, 1], "radius": 0.25 } ] } ] });
    let made = region(&plate, &meshing).unwrap();
    let exact = 8.0 - PI * 0.25 - PI * (0.25 - 0.0625);
    assert!((made.area() - exact).abs() < 1e-2);
    let back = region(&region_to_json(&made), &meshing).unwrap();
    assert_eq!(back, made);
    let by_svg = json!({ "type": "svg_path", "d": "M0 0H4V-2H0Z M1 -0.5 A.5 .5 0 1 0 1 -1.5 A.5 .5 0 1 0 1 -.5", "fill_rule": "evenodd" });
    let by_svg = region(&by_svg, &meshing).unwrap();
    assert!((by_svg.area() - (8.0 - PI * 0.25)).abs() < 1e-2, "{}", by_svg.area());
    let nothing = json!({ "type": "union", "regions": [] });
    assert!(region(&nothing, &meshing).is_err());
    // The slot of the one is filled by the other, except where both are open.
    let union = made.combined(RegionOperation::Union, &by_svg);
    assert!((union.area() - by_svg.area()).abs() < 1e-2);
}

#[test]
fn solids_are_read_and_closed() {
    let control = Control::new();
    let square = json!({ "type": "rectangle", "low": [1, 0], "high": [2, 1] });
    let cases = [
        (json!({ "type": "extrusion", "region": square, "height": 3, "tolerance": 0.01 }), 3.0),
        (
            json!({ "type": "extrusion", "region": square, "height": 3, "tolerance": 0.001, "twist": 90, "top_scale": 0.5,
                "center": [1.5, 0.5] }),
            3.0 * (1.0 + 0.5 + 0.25) / 3.0,
        ),
        (json!({ "type": "revolution", "region": square, "tolerance": 0.0001 }), 3.0 * PI),
        (json!({ "type": "revolution", "region": square, "tolerance": 0.0001, "angle": 180 }), 1.5 * PI),
        (
            json!({ "type": "sweep", "region": { "type": "circle", "center": [0, 0], "radius": 0.1 }, "tolerance": 0.0005,
                "path": { "type": "bezier", "points": [[0, 0, 0], [1, 0, 0], [2, 0, 0]] }, "up": [0, 0, 1] }),
            0.01 * PI * 2.0,
        ),
        (
            json!({ "type": "patches", "tolerance": 0.001, "patches": [
                { "type": "cylinder", "base": [0, 0, 0], "radius": 1, "height": 2, "name": "side" },
                { "type": "disc", "center": [0, 0, 0], "radius": 1, "name": "floor" },
                { "type": "disc", "center": [0, 0, 2], "radius": 1, "name": "roof" } ] }),
            2.0 * PI,
        ),
        (
            json!({ "type": "patches", "tolerance": 0.001, "patches": [{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }] }),
            4.0 / 3.0 * PI,
        ),
    ];
    for (value, exact) in cases {
        let mesh = solid(&value, &control).unwrap();
        assert_closed(&mesh);
        assert!((volume(&mesh) / exact - 1.0).abs() < 0.01, "{value}: {}", volume(&mesh));
    }
    let aircraft: Value = parse(include_str!("../../examples/parametric/aircraft.json")).unwrap();
    let patches = named_patches(&aircraft).unwrap();
    assert_eq!(patches.iter().map(|p| p.0.as_str()).collect::<String>(), "ABCDEF");
}

#[test]
fn svg_paths_survive_writing_and_reading() {
    for seed in 0..200 {
        let mut rng = rng(seed);
        let cubic = common::bezier::<2>(&mut rng, 3);
        let end = *cubic.control().last().unwrap();
        let quadratic = Bezier::new(&[end, common::point(&mut rng), common::point(&mut rng)]).unwrap();
        let corner = quadratic.point(1.0);
        let line = Segment::new(corner, common::point(&mut rng)).unwrap();
        let at = line.point(1.0);
        let (a, b): ([f64; 2], [f64; 2]) = (common::point(&mut rng), common::point(&mut rng));
        let sweep = rng.random_range(0.1..6.2) * if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let arc = EllipticArc::new([at[0] - a[0], at[1] - a[1]], a, b, 0.0, sweep).unwrap();
        let parts: Vec<SharedCurve<2>> = vec![
            std::sync::Arc::new(cubic.clone()),
            std::sync::Arc::new(quadratic),
            std::sync::Arc::new(line),
            std::sync::Arc::new(arc.clone()),
        ];
        let whole = Composite::new(&parts).unwrap();
        let data = path_data(&whole, 1e-3).unwrap();
        let back = curves_of_path(&data).unwrap();
        let back = back.open.first().or(back.closed.first()).unwrap_or_else(|| panic!("seed {seed}: {data}"));
        // Polynomial pieces come back bit for bit.
        assert_eq!(back.segments()[0].to_nurbs(), cubic.to_nurbs(), "seed {seed}");
        // The arc comes back in parts, as the same points.
        let fine = CurveMeshing::new(1e-6).mesh(&arc).unwrap().points;
        for segment in &back.segments()[3..] {
            for k in 0..=10 {
                let [s, e] = segment.domain();
                let p = segment.point(s + (e - s) * f64::from(k) / 10.0);
                let off = fine.windows(2).map(|e| common::to_segment(p, e[0], e[1])).fold(f64::MAX, f64::min);
                assert!(off < 1e-5, "seed {seed}: {off}");
            }
        }
    }
    let high = common::bezier::<2>(&mut rng(1), 7);
    let data = path_data(&high, 1e-3).unwrap();
    let back = curves_of_path(&data).unwrap().open.remove(0);
    for k in 0..=50 {
        let p = back.point(back.domain()[1] * f64::from(k) / 50.0);
        let fine = CurveMeshing::new(1e-6).mesh(&high).unwrap().points;
        let off = fine.windows(2).map(|e| common::to_segment(p, e[0], e[1])).fold(f64::MAX, f64::min);
        assert!(off <= 1.1e-3);
    }
}

#[test]
fn svg_commands_are_understood() {
    let ends = |d: &str| {
        let found = curves_of_path(d).unwrap();
        let all: Vec<_> = found.open.iter().chain(&found.closed).collect();
        all.iter().map(|c| (c.segments().len(), c.point(c.domain()[1]))).collect::<Vec<_>>()
    };
    assert_eq!(ends("M1 1 l2 0 v3 h-1 V10 H7"), [(5, [7.0, -10.0])]);
    assert_eq!(ends("M0 0 c1 0 1 1 2 1 s1 1 2 1 q 1 0 1 1 t 1 1"), [(4, [6.0, -4.0])]);
    assert_eq!(ends("M0 0 L1 0 L1 1 Z"), [(3, [0.0, 0.0])]);
    assert_eq!(ends("M0 0 L1 0 L1 1 z m5 5 l1 0"), [(1, [6.0, -5.0]), (3, [0.0, 0.0])]);
    assert_eq!(ends("M0 0 A 0 1 0 0 0 5 0"), [(1, [5.0, 0.0])], "a radius of zero is a line");
    assert_eq!(ends("M0 0 A 1 1 0 0 0 4 0")[0].0, 1, "radii too small are scaled up");
    assert_eq!(ends(""), []);
    for bad in ["M0 0 L", "0 0 L 1 1", "M0 0 X1", "M0 0 L1 nan"] {
        assert!(matches!(curves_of_path(bad), Err(GeometryError::Svg { .. })), "{bad}");
    }
}

#[test]
fn svg_files_are_read_with_transforms() {
    let text = r#"<?xml version="1.0"?>
        <svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">
          <defs><path d="M0 0L9 9"/></defs>
          <g transform="translate(10 0) scale(2)">
            <path id="a" transform="rotate(90)" fill-rule="evenodd" d="M1 0 A1 1 0 0 1 -1 0"/>
            <rect width="3" height="2"/>
          </g>
          <path id="b" d="M0 0h1v1z"/>
        </svg>"#;
    let (paths, passed_over) = read_paths(text).unwrap();
    assert_eq!((paths.len(), passed_over), (2, 1));
    assert_eq!((paths[0].id.as_str(), paths[0].fill_rule), ("a", FillRule::EvenOdd));
    let arc = &paths[0].contours.open[0];
    let [start, middle, end] = [0.0, 0.5, 1.0].map(|w| arc.point(w * arc.domain()[1]));
    // (1, 0) turned by 90 degrees, doubled, moved: (10, 2); y is negated.
    assert!(distance(start, [10.0, -2.0]) < 1e-12 && distance(end, [10.0, 2.0]) < 1e-12);
    assert!(distance(middle, [8.0, 0.0]) < 1e-12, "{middle:?}");
    assert_eq!(paths[1].contours.closed.len(), 1);
    for bad in [
        "",
        "<svg><path</svg>",
        "<html/>",
        "<svg><path d='M0 0 L'/></svg>",
        "<svg><g transform='turn(1)'/></svg>",
    ] {
        assert!(matches!(read_paths(bad), Err(GeometryError::Svg { .. })), "{bad}");
    }
}

#[test]
fn pictures_are_valid_svg() {
    let mut picture = Picture::new();
    let curve = NurbsCurve::clamped_uniform(3, &common::points::<2>(&mut rng(4), 7)).unwrap();
    picture.control_polygon(curve.control(), Ink::Faint);
    picture.curve(&curve, Ink::Main).unwrap();
    picture.text([0.0, 0.0], "a < b & c");
    let svg = picture.svg(500.0);
    let (paths, _) = read_paths(&svg).unwrap();
    assert_eq!(paths.len(), 2);
}

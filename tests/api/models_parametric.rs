//! Curves, regions and patches as leaves of model files: the wing profile and the aircraft of Choporov 2017.
#![cfg(feature = "parametric")]
#![allow(clippy::print_stdout, reason = "figures for the documentation, shown with --nocapture")]

use std::path::Path;

use crate::common::surface::{manifold, volume};
use trisect::Error;
use trisect::model::{Evaluation, Model};

fn example(name: &str) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/models").join(name);
    Model::load(&path).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn parse(text: &str) -> Result<Model, Error> {
    Model::parse(text, &Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/models"))
}

fn fails(text: &str, expected: &[&str]) {
    let outcome = parse(text).and_then(|model| Evaluation::new().tolerance(0.05).run(&model));
    let error = outcome.err().unwrap_or_else(|| panic!("accepted: {text}"));
    let said = error.to_string();
    for part in expected {
        assert!(said.contains(part), "{text}\n  says: {said}\n  without: {part}");
    }
}

/// The area between the two quintics: the integral of y dx is exact for polynomials, here by Simpson's rule over so
/// many parts that its error is far below the tolerances.
fn profile_area() -> f64 {
    let points = [
        [0.0, 0.0],
        [1.14034, 2.44284],
        [11.1025, 3.65375],
        [30.8809, 1.13309],
        [39.9276, 0.09712],
        [40.0, 0.0],
    ];
    let at = |t: f64| {
        let weights = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
        let mut sum = [0.0; 2];
        for (k, point) in points.iter().enumerate() {
            let weight = weights[k] * t.powi(k as i32) * (1.0 - t).powi(5 - k as i32);
            sum = [sum[0] + weight * point[0], sum[1] + weight * point[1]];
        }
        sum
    };
    let steps = 100_000;
    let trapezium = |k: u32| {
        let [a, b] = [k, k + 1].map(|k| at(f64::from(k) / f64::from(steps)));
        (b[0] - a[0]) * (a[1] + b[1]) * 0.5
    };
    2.0 * (0..steps).map(trapezium).sum::<f64>()
}

#[test]
fn naca_profile_with_holes_by_both_routes() {
    let tolerance = 2e-3;
    let evaluation = Evaluation::new().tolerance(tolerance);
    let expected = profile_area() - 6.0 * 3.0 - std::f64::consts::PI * 1.5 * 1.5 - 4.0;
    // Every boundary may be off by the tolerance along its length.
    let allowed = tolerance * (82.0 + 18.0 + 9.5 + 8.0);
    for name in ["naca0011-holes.json", "naca0011-holes-exact.json"] {
        let model = example(name);
        let contours = evaluation.contours(&model, 0.0).expect(name);
        println!("{name}: area {}, expected {expected}, {} points", contours.area(), contours.len());
        assert_eq!(contours.loops.len(), 4, "{name}");
        assert!((contours.area() - expected).abs() < allowed, "{name}: {}", contours.area());
        let mesh = evaluation.run(&model).expect(name).mesh;
        assert_eq!(manifold(&mesh), (1, 3), "{name}");
        assert!((volume(&mesh) - 10.0 * contours.area()).abs() < 1e-9, "{name}");
    }
}

#[test]
fn the_aircraft_is_one_solid() {
    // The exact volume, by integration over the patches (docs/parametric.md).
    let exact = 34.681153;
    let mut before = f64::INFINITY;
    for tolerance in [0.04, 0.01, 0.0025] {
        let mesh =
            Evaluation::new().tolerance(tolerance).run(&example("aircraft.json")).expect("six patches").mesh;
        assert_eq!(manifold(&mesh), (1, 0));
        let off = (volume(&mesh) - exact).abs();
        println!("tolerance {tolerance}: {} triangles, volume {}", mesh.triangles.len(), volume(&mesh));
        assert!(off < 10.0 * tolerance && off < before, "{off}");
        before = off;
    }
    // As a field it is the distance of that solid.
    let field = Evaluation::new().field(&example("aircraft.json")).expect("a field");
    assert!(field.at([4.0, 0.0, 0.5]) > 0.3 && field.at([4.0, 0.0, -0.5]) < -0.05);
    let (height, [_, _, slope]) = field.gradient([4.0, 0.0, -1.0]);
    assert!(height < -0.5 && slope > 0.9);
}

#[test]
fn the_aircraft_with_engines_by_both_routes() {
    let tolerance = 0.02;
    let evaluation = Evaluation::new().tolerance(tolerance);
    let exact = evaluation.run(&example("aircraft-with-engines-exact.json")).expect("exact").mesh;
    let field = evaluation.run(&example("aircraft-with-engines.json")).expect("field").mesh;
    println!(
        "exact: {} triangles, volume {}; field: {} triangles, volume {}",
        exact.triangles.len(),
        volume(&exact),
        field.triangles.len(),
        volume(&field)
    );
    assert_eq!(manifold(&exact), manifold(&field));
    // The body's surface is about 90, that of the engines about 20; either may be off by the tolerance.
    assert!((volume(&exact) - volume(&field)).abs() < 110.0 * tolerance);
    // More than the body, less than body and engines side by side.
    assert!(volume(&field) > 34.7 && volume(&field) < 34.7 + 2.0 * 3.2);
}

#[test]
fn solids_of_regions_are_leaves() {
    let ring = r#"{"kind": "revolution", "tolerance": 0.002,
        "region": {"type": "circle", "center": [2, 0], "radius": 0.5}}"#;
    let rod = r#"{"kind": "extrusion", "height": 6, "twist": 90,
        "region": {"type": "rectangle", "low": [-0.4, -0.4], "high": [0.4, 0.4]},
        "transform": [{"translate": [2, 0, -3]}]}"#;
    let run = |text: &str| Evaluation::new().run(&parse(text).expect(text)).expect(text).mesh;
    let torus = 2.0 * std::f64::consts::PI.powi(2) * 2.0 * 0.25;
    assert!((volume(&run(ring)) - torus).abs() < 0.02 * torus);
    // Without a tolerance a thousandth of the size is kept.
    assert!((volume(&run(rod)) - 6.0 * 0.64).abs() < 0.05);
    let both = format!(r#"{{"kind": "union", "operands": [{ring}, {rod}]}}"#);
    assert_eq!(manifold(&run(&both)), (1, 1));
    let sweep = r#"{"kind": "sweep", "tolerance": 0.01,
        "region": {"type": "circle", "center": [0, 0], "radius": 0.2},
        "path": {"type": "bezier", "points": [[0, 0, 0], [2, 0, 0], [2, 2, 1], [4, 2, 1]]}}"#;
    assert_eq!(manifold(&run(sweep)), (1, 0));
    // A region in a field is the same at every height, until something ends it.
    let field = r#"{"kind": "intersection", "evaluate": "field", "tolerance": 0.01, "operands": [
        {"kind": "region", "region": {"type": "circle", "center": [0, 0], "radius": 1}},
        {"kind": "box", "low": [-2, -2, 0], "high": [2, 2, 0.5]}]}"#;
    assert!((volume(&run(field)) - std::f64::consts::PI / 2.0).abs() < 0.04);
}

#[test]
fn descriptions_are_files_too() {
    let run = |text: &str| Evaluation::new().tolerance(0.01).run(&parse(text).expect(text)).expect(text).mesh;
    let named = run(r#"{"kind": "parametric", "file": "../parametric/naca0011.json"}"#);
    let alone = run(r#"{"kind": "union", "operands": ["../parametric/naca0011.json"]}"#);
    assert_eq!(named.triangles.len(), alone.triangles.len());
    assert_eq!(manifold(&named), (1, 3));
    // A closed curve is the region inside it.
    let plate = run(r#"{"kind": "parametric", "file": "../parametric/degree9.json", "extrude": [-1, 1]}"#);
    assert_eq!(manifold(&plate), (1, 0));
}

#[test]
fn faults_are_named_by_node_and_place() {
    fails(
        r#"{"nodes": {"w": {"kind": "patches", "patches": [{"type": "bezier", "points": [[[0, 0, 0]]]}]}}, "result": "w"}"#,
        &["`w` (/nodes/w)", "/patches/0"],
    );
    fails(
        r#"{"kind": "patches", "patches": [{"type": "plane", "origin": [0, 0, 0], "a": [1, 0, 0], "b": [0, 1, 0]}]}"#,
        &["open boundaries", "patch 0"],
    );
    fails(r#"{"kind": "extrusion", "height": 1, "width": 2, "region": {}}"#, &["unknown field `width`"]);
    fails(
        r#"{"kind": "extrusion", "height": -1, "region": {"type": "rectangle", "low": [0, 0], "high": [1, 1]}}"#,
        &["height"],
    );
    fails(r#"{"kind": "region", "extrude": 1}"#, &["`region` is missing"]);
    fails(r#"{"kind": "region", "region": {"type": "blob"}, "extrude": 1}"#, &["unknown type \"blob\""]);
    fails(
        r#"{"kind": "contour", "bezier": [[[[0, 0], [1, 0]], [[2, 0], [0, 0]]]], "extrude": 1}"#,
        &["/contours/0"],
    );
    fails(r#"{"kind": "parametric", "file": "none.json"}"#, &["cannot read", "none.json"]);
    fails(r#"{"kind": "parametric", "file": "polygon.json", "extrude": 1}"#, &["\"type\" is missing"]);
    fails(r#"{"kind": "patches", "patches": [], "tolerance": -1}"#, &["`tolerance` must be positive"]);
    fails(
        r#"{"kind": "parametric", "file": "../parametric/naca0011.json", "extrude": 1}"#,
        &["can be extruded"],
    );
}

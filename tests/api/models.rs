//! Model files: the worked solids of the papers, hybrid solids, and everything a model file can get wrong.
#![allow(clippy::print_stdout, reason = "figures for the documentation, shown with --nocapture")]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common::shapes;
use crate::common::surface::{manifold, volume};
use trisect::field::Contours;
use trisect::model::{Evaluation, LeafKind, Model};
use trisect::{Control, Error, Failure, Mesh};

fn example(name: &str) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/models").join(name);
    Model::load(&path).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The area of where `inside` holds in a rectangle, by counting midpoints.
fn area(low: [f64; 2], high: [f64; 2], inside: impl Fn(f64, f64) -> bool) -> f64 {
    let n = 4000;
    let step = [0, 1].map(|k| (high[k] - low[k]) / f64::from(n));
    let row = |i: u32| {
        let x = low[0] + (f64::from(i) + 0.5) * step[0];
        (0..n).filter(|&j| inside(x, low[1] + (f64::from(j) + 0.5) * step[1])).count()
    };
    (0..n).map(row).sum::<usize>() as f64 * step[0] * step[1]
}

/// The volume of where `inside` holds in a box, by counting midpoints.
fn cubature(low: [f64; 3], high: [f64; 3], inside: impl Fn(f64, f64, f64) -> bool) -> f64 {
    let n = 320;
    let step: [f64; 3] = std::array::from_fn(|k| (high[k] - low[k]) / f64::from(n));
    let at = |k: usize, i: u32| low[k] + (f64::from(i) + 0.5) * step[k];
    let mut count = 0u64;
    for i in 0..n {
        for j in 0..n {
            count += (0..n).filter(|&k| inside(at(0, i), at(1, j), at(2, k))).count() as u64;
        }
    }
    count as f64 * step.iter().product::<f64>()
}

fn circle(x: f64, y: f64, r: f64) -> bool {
    x * x + y * y < r * r
}

/// Checks contour area, extrusion volume and topology of a plane model against its logic, written by hand.
fn plane(
    name: &str,
    height: f64,
    holes: i64,
    low: [f64; 2],
    high: [f64; 2],
    inside: impl Fn(f64, f64) -> bool,
) {
    let model = example(name);
    let evaluation = Evaluation::new().tolerance(1e-4 * (high[0] - low[0]));
    let expected = area(low, high, inside);
    let contours = evaluation.contours(&model, 0.0).unwrap_or_else(|error| panic!("{name}: {error}"));
    let found = contours.area();
    println!("{name}: area {found}, quadrature {expected}, {} points", contours.len());
    assert!((found - expected).abs() <= 1e-3 * expected, "{name}: {found} {expected}");
    assert_eq!(contours.loops.len() as i64, 1 + holes, "{name}");
    let mesh = evaluation.run(&model).expect(name).mesh;
    assert_eq!(manifold(&mesh), (1, holes), "{name}");
    assert!((volume(&mesh) - height * expected).abs() <= 1e-3 * height * expected, "{name}");
}

#[test]
fn plane_solids_of_choporov_2010() {
    plane("w1-bar.json", 0.2, 0, [-0.2, -0.2], [0.6, 0.6], |x, y| {
        x + 0.1 > y && y + 0.1 > x && x + y < 0.8 && x + y > 0.0
    });
    plane("w2-disc-with-hole.json", 0.2, 1, [-1.0; 2], [1.0; 2], |x, y| {
        circle(x, y, 1.0) && !circle(x, y, 0.5)
    });
    plane("w3-parabola.json", 0.2, 1, [-1.0, 0.0], [1.0, 1.0], |x, y| {
        y > x * x && y < 0.81 && !circle(x, y - 0.4, 0.2)
    });
    plane("w4-square-and-circles.json", 0.3, 0, [-2.0, -1.0], [2.0, 1.0], |x, y| {
        (x.abs() < 1.0 && y.abs() < 1.0) || circle(x - 1.0, y, 1.0) || circle(x + 1.0, y, 1.0)
    });
    plane("w5-ribbon.json", 1.0, 0, [-5.0; 2], [5.0; 2], |x, y| {
        y > (x + 0.5).sin() && y < x.sin() + 2.0 && circle(x, y, 5.0)
    });
    plane("w6-plate.json", 0.1, 2, [-1.0; 2], [1.0; 2], |x, y| {
        let outline = x + 0.7 > y && x + y > -0.8 && x < 0.95 && y.abs() < 0.55;
        outline && !circle(x, y, 0.4) && !(x > 0.6 && x < 0.8 && y.abs() < 0.2)
    });
}

/// Checks volume and topology of a solid model against its logic, written by hand.
fn solid(
    name: &str,
    tolerance: f64,
    (pieces, genus): (usize, i64),
    low: [f64; 3],
    high: [f64; 3],
    inside: impl Fn(f64, f64, f64) -> bool,
) {
    let model = example(name);
    let found =
        Evaluation::new().tolerance(tolerance).run(&model).unwrap_or_else(|error| panic!("{name}: {error}"));
    let expected = cubature(low, high, inside);
    let enclosed = volume(&found.mesh);
    println!("{name}: volume {enclosed}, cubature {expected}, off by {:e}", (enclosed - expected) / expected);
    assert_eq!(manifold(&found.mesh), (pieces, genus), "{name}");
    assert!((enclosed - expected).abs() <= 1e-3 * expected, "{name}: {enclosed} {expected}");
    let report = found.extraction.expect("an extraction");
    assert!(report.deviation <= report.tolerance, "{name}: {report:?}");
}

#[test]
fn blended_plate_of_choporov_2010() {
    solid("w7-blended-plate.json", 5e-3, (1, 0), [-3.5, -3.5, 1.0], [3.5, 3.5, 2.0], |x, y, z| {
        let and = |a: f64, b: f64| a + b - a.hypot(b);
        let (q1, q2) = (8.0 - x * x, 8.0 - y * y);
        let q4 = and(q1, q2) + 1.0 / (1.0 + q1 * q1 + q2 * q2);
        let q5 = 15.0 - (x - 4.0).powi(2) - (y - 4.0).powi(2);
        let q7 = and(q4, q5) + 5.0 / (1.0 + q4 * q4 + q5 * q5);
        q7 > 0.0 && z > 1.0 && z < 2.0
    });
}

#[test]
fn pawn_of_choporov_2010() {
    solid("w8-pawn.json", 5e-3, (1, 0), [-3.1, -0.1, -3.1], [3.1, 8.1, 3.1], |x, y, z| {
        let around = x.hypot(z);
        let body = (around - 4.0).powi(2) > y && around < 3.0 && y > 0.0 && y < 7.0;
        let head = x * x + (y - 7.0).powi(2) + z * z < 1.0;
        let collar = x * x + 9.0 * (y - 6.0).powi(2) + z * z < 2.0;
        body || head || collar
    });
}

#[test]
fn atom_of_choporov_2010() {
    // Three tori through six common places, round a ball: a graph of six vertices and twelve edges has genus seven.
    let torus = |a: f64, b: f64, c: f64| (a.hypot(c) - 5.0).hypot(b) < 1.0;
    solid("w9-atom.json", 4e-3, (2, 7), [-6.1; 3], [6.1; 3], |x, y, z| {
        torus(x, y, z) || torus(y, x, z) || torus(x, z, y) || x * x + y * y + z * z < 9.0
    });
}

#[cfg(feature = "parametric")]
#[test]
fn contours_of_choporov_2017() {
    let exact = [("polygon.json", 11.0), ("bezier-contour.json", f64::NAN), ("naca0011.json", f64::NAN)];
    for (name, expected) in exact {
        let model = example(name);
        let contours = Evaluation::new().contours(&model, 0.0).expect(name);
        assert_eq!(contours.loops.len(), 1, "{name}");
        let enclosed = contours.area().abs();
        let expected = if expected.is_nan() { bezier_area(name) } else { expected };
        println!("{name}: {enclosed} {expected}");
        assert!((enclosed - expected).abs() <= 1e-2 * expected, "{name}: {enclosed} {expected}");
        assert_eq!(manifold(&Evaluation::new().run(&model).expect(name).mesh), (1, 0), "{name}");
    }
}

#[cfg(feature = "parametric")]
/// The area inside the Bezier curves of a contour model: half the integral of x dy - y dx, by the midpoint rule.
fn bezier_area(name: &str) -> f64 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/models").join(name);
    let value: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).expect(name)).expect(name);
    let contour = if value["bezier"].is_array() { &value } else { &value["nodes"]["outline"] };
    let curves: Vec<Vec<[f64; 2]>> = serde_json::from_value(contour["bezier"][0].clone()).expect(name);
    let at = |curve: &[[f64; 2]], t: f64| {
        let n = curve.len() - 1;
        let mut sum = [0.0; 2];
        let mut binomial = 1.0;
        for (k, point) in curve.iter().enumerate() {
            let weight = binomial * t.powi(k as i32) * (1.0 - t).powi((n - k) as i32);
            sum = [sum[0] + weight * point[0], sum[1] + weight * point[1]];
            binomial *= (n - k) as f64 / (k + 1) as f64;
        }
        sum
    };
    let steps = 20_000;
    let mut doubled = 0.0;
    for curve in &curves {
        for k in 0..steps {
            let [a, b] = [k, k + 1].map(|k| at(curve, f64::from(k) / f64::from(steps)));
            doubled += a[0] * b[1] - b[0] * a[1];
        }
    }
    doubled.abs() / 2.0
}

#[test]
fn torpedo_of_choporov_2017() {
    solid("torpedo.json", 5e-4, (1, 0), [0.0, -1.0, -1.0], [4.0, 1.0, 1.0], |x, y, z| {
        let r = if x <= 1.0 {
            1.0 - 0.5 * x
        } else if x <= 3.0 {
            0.5
        } else {
            0.5 - 0.5 * (x - 3.0)
        };
        circle(y, z, r)
    });
}

#[test]
fn hybrid_bracket_is_one_piece_with_its_holes() {
    let found = Evaluation::new().run(&example("hybrid-bracket.json")).expect("bracket");
    assert_eq!(manifold(&found.mesh), (1, 2));
}

/// A kind of leaf of the caller's own.
struct Brick;

impl LeafKind for Brick {
    fn mesh(
        &self,
        value: &serde_json::Value,
        tolerance: Option<f64>,
        _: &Path,
        _: &Control,
    ) -> Result<Mesh, Error> {
        assert_eq!(tolerance, Some(0.05));
        let length = value["length"].as_f64().ok_or_else(|| Error::Model("`length` is missing".into()))?;
        Ok(shapes::cuboid([0.0; 3], [length, 1.0, 1.0]))
    }
}

#[test]
fn callers_may_add_kinds_of_leaves() {
    let text = |length: &str| {
        format!(
            r#"{{"kind": "union", "operands": [{{"kind": "x-brick"{length}}},
                {{"kind": "x-brick", "length": 1, "transform": [{{"translate": [0, 2, 0]}}]}}]}}"#
        )
    };
    let model = parse(&text(r#", "length": 4"#)).expect("a model");
    let error = Evaluation::new().run(&model).expect_err("nobody evaluates bricks");
    assert!(error.to_string().contains("`x-brick` cannot be evaluated here"), "{error}");
    let evaluation = Evaluation::new().tolerance(0.05).leaf_kind("x-brick", Arc::new(Brick));
    assert_eq!(volume(&evaluation.run(&model).expect("two bricks").mesh), 5.0);
    let field = evaluation.field(&model).expect("a field");
    assert!((field.at([0.25, 0.5, 0.5]) > 0.0) && (field.at([2.0, 2.5, 0.5]) < 0.0));
    let error = evaluation.run(&parse(&text("")).expect("a model")).expect_err("no length");
    assert!(error.to_string().contains("node /operands/0: model: `length` is missing"), "{error}");
}

fn parse(text: &str) -> Result<Model, Error> {
    Model::parse(text, Path::new("."))
}

fn fails(text: &str, expected: &[&str]) {
    let outcome = parse(text).and_then(|model| Evaluation::new().tolerance(0.05).run(&model));
    let error = outcome.err().unwrap_or_else(|| panic!("accepted: {text}"));
    let said = error.to_string();
    for part in expected {
        assert!(said.contains(part), "{text}\n  says: {said}\n  without: {part}");
    }
}

#[test]
fn bad_models_are_refused_by_name_and_place() {
    fails("{", &["not JSON", "line 1"]);
    fails("[1]", &["a model is an object"]);
    fails(r#"{"nodes": {}}"#, &["`result` is missing"]);
    fails(r#"{"kind": "sphere", "radus": 1}"#, &["unknown field `radus`", "radius"]);
    fails(r#"{"kind": "sphere", "radius": -1}"#, &["the radius must be positive"]);
    fails(r#"{"kind": "ball"}"#, &["unknown kind `ball`", "sphere"]);
    fails(r#"{"kind": "union", "operands": []}"#, &["at least one operand"]);
    fails(r#"{"kind": "union", "operands": ["missing"]}"#, &["operands/0", "no node named `missing`"]);
    fails(r#"{"operation": "join", "left": "a.obj", "right": "b.obj"}"#, &["unknown operation `join`"]);
    fails(r#"{"kind": "box", "size": [1, 1, 1], "low": [0, 0, 0]}"#, &["`low` and `high`, or `size`"]);
    fails(r#"{"kind": "box", "size": [1, 1]}"#, &["length 2"]);
    fails(
        r#"{"nodes": {"a": "b", "b": "c", "c": "a"}, "result": "a"}"#,
        &["cyclic reference", "`a`", "`b`", "`c`"],
    );
    fails(
        r#"{"nodes": {"f": {"kind": "formula", "formula": "f + 1"}}, "result": "f"}"#,
        &["cyclic reference", "`f`"],
    );
    fails(r#"{"kind": "mesh", "file": "not-there.obj"}"#, &["cannot read", "not-there.obj"]);
    fails(r#"{"nodes": {"m": "not-there.obj"}, "result": "m"}"#, &["`m`", "not-there.obj"]);
    fails(
        r#"{"nodes": {"f": {"kind": "formula", "formula": "1 - foo(x)"}}, "result": "f"}"#,
        &["`f` (/nodes/f)", "line 1, column 5", "unknown function `foo`"],
    );
    fails(r#"{"kind": "formula", "formula": "1 - x^2 - y^2"}"#, &["unbounded", "along z"]);
    fails(
        r#"{"kind": "formula", "formula": "1 - x^2 - y^2", "bounds": [[-2, -2, -2], [2, 2, 2]]}"#,
        &["does not end inside the box"],
    );
    fails(
        r#"{"kind": "formula", "formula": "sqrt(0.5 - x^2 - y^2 - z^2) - 0.1", "bounds": [[-1,-1,-1],[1,1,1]]}"#,
        &["not a number at"],
    );
    fails(r#"{"kind": "formula", "formula": "1", "bounds": [[1, 0, 0], [0, 1, 1]]}"#, &["`bounds`"]);
    fails(r#"{"kind": "sphere", "radius": 1, "transform": [{"scale": 0}]}"#, &["flattens space"]);
    fails(r#"{"kind": "sphere", "radius": 1, "transform": [{"turn": 3}]}"#, &["unknown variant `turn`"]);
    fails(r#"{"kind": "sphere", "radius": 1, "evaluate": "maybe"}"#, &["`exact`, `field`", "not `maybe`"]);
    fails(
        r#"{"kind": "sphere", "radius": 1, "evaluate": "field", "tolerance": 0}"#,
        &["`tolerance` must be positive"],
    );
    fails(
        r#"{"kind": "complement", "operands": [{"kind": "sphere", "radius": 1}], "evaluate": "exact"}"#,
        &["complement is unbounded"],
    );
    fails(r#"{"kind": "torus", "radius": 1, "tube": 2}"#, &["crosses itself"]);
    fails(r#"{"kind": "contour", "polygons": [[[0, 0], [1, 0]]], "extrude": 1}"#, &["at least 3"]);
    fails(r#"{"kind": "sphere", "radius": 1, "system": "R9"}"#, &["unknown system"]);
    let mut nested = r#"{"kind": "sphere", "radius": 1}"#.to_owned();
    for _ in 0..500 {
        nested = format!(r#"{{"kind": "union", "operands": [{nested}]}}"#);
    }
    assert!(parse(&nested).is_err());
    let chain: Vec<String> = (0..1000).map(|k| format!(r#""n{k}": "n{}""#, k + 1)).collect();
    let chain = format!(
        r#"{{"nodes": {{{}, "n1000": {{"kind": "sphere", "radius": 1}}}}, "result": "n0"}}"#,
        chain.join(",")
    );
    fails(&chain, &["nested more than"]);
}

#[test]
fn errors_have_the_right_kind() {
    let missing =
        parse(r#"{"kind": "mesh", "file": "not-there.obj"}"#).and_then(|m| Evaluation::new().run(&m));
    assert_eq!(missing.expect_err("missing").failure(), Failure::Unreadable);
    let bad = parse(r#"{"kind": "ball"}"#).expect_err("unknown kind");
    assert_eq!(bad.failure(), Failure::Unusable);
    let token = trisect::CancelToken::new();
    token.cancel();
    let model = example("w8-pawn.json");
    let cancelled = Evaluation::new().control(Control::new().cancel(&token)).run(&model);
    assert!(matches!(cancelled, Err(Error::Limit(trisect::Limit::Cancelled))));
    let limited = Evaluation::new().control(Control::new().memory_limit(1000)).run(&model);
    assert!(matches!(limited, Err(Error::Limit(trisect::Limit::Memory { .. }))));
}

#[test]
fn the_binary_shape_and_files_are_accepted() {
    let folder: PathBuf = std::env::temp_dir().join(format!("trisect-models-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let mut text = String::new();
    let cube = shapes::cuboid([0.0; 3], [1.0; 3]);
    for [x, y, z] in &cube.positions {
        text += &format!("v {x} {y} {z}\n");
    }
    for t in &cube.triangles {
        text += &format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    std::fs::write(folder.join("cube.obj"), text).expect("written");
    let model = Model::parse(
        r#"{"operation": "difference", "evaluate": "field", "left": "cube.obj",
            "right": {"operation": "union", "left": {"kind": "sphere", "radius": 0.4}, "right": "cube.obj",
                      "transform": [{"translate": [0.5, 0.5, 0.5]}]}}"#,
        &folder,
    )
    .expect("the binary shape");
    assert_eq!(model.files(), [folder.join("cube.obj")]);
    let mesh = Evaluation::new().tolerance(0.01).run(&model).expect("a solid").mesh;
    std::fs::remove_dir_all(&folder).expect("removed");
    manifold(&mesh);
    // The cube without its upper eighth and without the half of a ball that is not in that eighth.
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.4f64.powi(3);
    let expected = 1.0 - 0.125 - ball * 7.0 / 8.0;
    assert!((volume(&mesh) - expected).abs() < 0.01, "{} {expected}", volume(&mesh));
}

#[test]
fn transforms_move_fields_and_meshes_alike() {
    let steps = r#"[{"scale": [1, 2, 0.5]}, {"rotate": {"axis": [1, 2, 3], "angle": 40, "about": [1, 0, 0]}},
                    {"mirror": [1, 1, 0]}, {"translate": [3, -1, 2]}, {"rotate": {"axis": [0, 0, 1], "angle": 90}}]"#;
    let leaf = |mode: &str| {
        format!(r#"{{"kind": "box", "size": [1, 2, 3], "evaluate": "{mode}", "transform": {steps}}}"#)
    };
    let exact = Evaluation::new().run(&parse(&leaf("exact")).expect("exact")).expect("exact").mesh;
    let field =
        Evaluation::new().tolerance(0.01).run(&parse(&leaf("field")).expect("field")).expect("field").mesh;
    assert!((volume(&exact) - 6.0).abs() < 1e-12);
    assert!((volume(&field) - 6.0).abs() < 1e-3, "{}", volume(&field));
    for corner in &exact.positions {
        let near = |p: &[f64; 3]| (0..3).map(|k| (p[k] - corner[k]).powi(2)).sum::<f64>().sqrt();
        let nearest = field.positions.iter().map(near).fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.01, "{corner:?}: {nearest}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let model = example("w8-pawn.json");
    let run = || Evaluation::new().tolerance(0.05).run(&model).expect("a pawn").mesh;
    let reference = run();
    assert_eq!(run(), reference);
    #[cfg(feature = "parallel")]
    for threads in [1, 2, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        assert_eq!(pool.install(run), reference, "{threads} threads");
    }
}

#[test]
fn an_empty_result_is_a_success() {
    let model = parse(
        r#"{"kind": "intersection", "evaluate": "field",
            "operands": [{"kind": "sphere", "radius": 1}, {"kind": "sphere", "radius": 1, "center": [5, 0, 0]}]}"#,
    );
    let found = Evaluation::new().run(&model.expect("a model")).expect("nothing is something");
    assert!(found.mesh.is_empty());
    assert!(Contours::default().is_empty());
}

//! Models evaluated exactly: by the mesh booleans, and against the same trees evaluated as fields.
#![allow(clippy::print_stdout, reason = "figures for the documentation, shown with --nocapture")]

use std::path::Path;

use crate::common::surface::{manifold, volume};
use trisect::field::{SignRule, SignedDistance};
use trisect::model::{Evaluation, Model};
use trisect::{Control, Mesh};

fn model(text: &str) -> Model {
    Model::parse(text, Path::new(".")).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn run(text: &str, tolerance: f64) -> Mesh {
    Evaluation::new()
        .tolerance(tolerance)
        .run(&model(text))
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .mesh
}

/// The tree with `evaluate` set to `mode`.
fn tree(operation: &str, operands: &[&str], mode: &str) -> String {
    format!(r#"{{"kind": "{operation}", "evaluate": "{mode}", "operands": [{}]}}"#, operands.join(", "))
}

/// The largest distance of points of `from` (corners and middles of triangles) to the surface of `to`.
fn one_sided_distance(from: &Mesh, to: &Mesh) -> f64 {
    let distance = SignedDistance::of_mesh(to, SignRule::Winding);
    let mut points = from.positions.clone();
    points.extend(from.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| from.positions[v as usize]);
        std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
    }));
    let values = distance.at_all(&points, &Control::new()).expect("no limits");
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

const BOX: &str = r#"{"kind": "box", "size": [2, 1.5, 1]}"#;
const BALL: &str = r#"{"kind": "sphere", "radius": 0.7, "center": [0.9, 0.6, 0.4]}"#;
const ROD: &str = r#"{"kind": "cylinder", "radius": 0.3, "height": 3,
    "transform": [{"rotate": {"axis": [1, 0.3, 0], "angle": 37}}]}"#;

#[test]
fn extraction_agrees_with_the_exact_booleans() {
    let tolerance = 4e-3;
    let trees = [
        ("union", vec![BOX, BALL]),
        ("difference", vec![BOX, BALL]),
        ("intersection", vec![BOX, BALL]),
        ("difference", vec![BOX, BALL, ROD]),
        ("union", vec![BOX, BALL, ROD]),
    ];
    for (operation, operands) in trees {
        // The primitives' own meshes are far finer than the tolerance compared to.
        let exact = run(&tree(operation, &operands, "exact"), tolerance / 8.0);
        let field = run(&tree(operation, &operands, "field"), tolerance);
        assert_eq!(manifold(&exact), manifold(&field), "{operation} of {}", operands.len());
        let (apart, back) = (one_sided_distance(&field, &exact), one_sided_distance(&exact, &field));
        println!("{operation} of {}: {apart:.2e} {back:.2e}", operands.len());
        assert!(apart <= 1.25 * tolerance && back <= 1.25 * tolerance);
        let area = 12.0;
        assert!((volume(&exact) - volume(&field)).abs() <= area * tolerance);
    }
}

#[test]
fn exact_trees_have_exact_volumes() {
    let boxes = [
        r#"{"kind": "box", "low": [0, 0, 0], "high": [1, 1, 1]}"#,
        r#"{"kind": "box", "low": [0.5, 0.5, 0.5], "high": [1.5, 1.5, 1.5]}"#,
    ];
    for (operation, expected) in
        [("union", 1.875), ("intersection", 0.125), ("difference", 0.875), ("xor", 1.75)]
    {
        let mesh = run(&tree(operation, &boxes, "exact"), 0.1);
        assert!((volume(&mesh) - expected).abs() < 1e-14, "{operation}: {}", volume(&mesh));
    }
}

#[test]
fn trees_mix_exact_and_field_parts() {
    let wave = r#"{"kind": "formula", "evaluate": "field", "formula": "0.3 + 0.1*sin(4*x) - z and 4 - x^2 - y^2 and z + 2"}"#;
    let exact = run(&tree("intersection", &[BOX, wave], "exact"), 1e-2);
    let field = run(&tree("intersection", &[BOX, wave], "field"), 1e-2);
    assert_eq!(manifold(&exact), manifold(&field));
    assert!((volume(&exact) - volume(&field)).abs() < 0.01);
    let inner = tree("difference", &[BOX, ROD], "exact");
    let mixed = run(&tree("union", &[&inner, BALL], "field"), 1e-2);
    let whole = run(&tree("union", &[&inner, BALL], "exact"), 1e-3);
    assert_eq!(manifold(&mixed), manifold(&whole));
    assert!((volume(&mixed) - volume(&whole)).abs() < 0.02);
}

//! Surfaces extracted from fields: closed, manifold, sharp, within the tolerance.
#![allow(clippy::print_stdout, reason = "figures for the documentation, shown with --nocapture")]

use crate::common::surface::{manifold, volume};
use trisect::field::{Expression, Extracted, Extraction, Formula, System};

fn field(text: &str) -> Expression {
    Formula::parse(text)
        .and_then(|formula| formula.compile(System::R0, &[], &[]))
        .unwrap_or_else(|e| panic!("{e}"))
}

fn extract(text: &str, half: f64, tolerance: f64) -> Extracted {
    Extraction::new([-half; 3], [half; 3], tolerance)
        .run(&field(text))
        .unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn report(name: &str, found: &Extracted) {
    println!(
        "{name}: {} triangles, {} cells, {} divided, smallest {:.2e}, deviation {:.2e}",
        found.mesh.triangles.len(),
        found.cells,
        found.divided_cells,
        found.smallest_cell,
        found.deviation
    );
}

#[test]
fn a_sphere_is_one_piece_within_the_tolerance() {
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let found = extract("sphere(x - 0.1, y, z, 1)", 1.2, tolerance);
        report("sphere", &found);
        assert_eq!(manifold(&found.mesh), (1, 0));
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((volume(&found.mesh) - exact).abs() < 4.0 * std::f64::consts::PI * tolerance);
        for p in &found.mesh.positions {
            let radius = ((p[0] - 0.1).powi(2) + p[1].powi(2) + p[2].powi(2)).sqrt();
            assert!((radius - 1.0).abs() <= tolerance, "{p:?}");
        }
        assert!(found.deviation <= tolerance);
    }
}

#[test]
fn a_box_keeps_its_edges_and_corners() {
    let found = extract("min(1 - abs(x), 1 - abs(y), 1 - abs(z))", 1.1, 1e-3);
    report("box", &found);
    assert_eq!(manifold(&found.mesh), (1, 0));
    assert!((volume(&found.mesh) - 8.0).abs() < 1e-9, "{}", volume(&found.mesh));
    for corner in 0..8 {
        let place = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 });
        let near = |p: &[f64; 3]| (0..3).map(|k| (p[k] - place[k]).powi(2)).sum::<f64>().sqrt();
        let nearest = found.mesh.positions.iter().map(near).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-9, "corner {place:?} is {nearest} away");
    }
    assert!(found.mesh.triangles.len() < 10_000);
}

#[test]
fn a_turned_box_with_a_bore_keeps_volume_and_genus() {
    let text = "u = 0.8*x - 0.6*y; v = 0.6*x + 0.8*y; w = z + 0.3*x;
        min(1 - abs(u), 0.7 - abs(v), 0.5 - abs(w)) and not (0.1 - u^2 - v^2)";
    let found = extract(text, 2.0, 2e-3);
    report("bored box", &found);
    assert_eq!(manifold(&found.mesh), (1, 1));
    let exact = 2.0 * 1.4 * 1.0 - std::f64::consts::PI * 0.1;
    assert!((volume(&found.mesh) - exact).abs() < 2e-3 * exact, "{} {exact}", volume(&found.mesh));
}

#[test]
fn touching_and_nearly_touching_pieces_stay_manifold() {
    for gap in [0.0, 1e-3, -1e-3, 0.02] {
        let text = format!(
            "sphere(x - {0}, y, z, 1) or sphere(x + {0}, y, z, 1) or min(0.5-abs(x-0.5), 0.5-abs(y-1.5), 0.5-abs(z))
             or min(0.5-abs(x+0.5), 0.5-abs(y-2.5), 0.5-abs(z))",
            1.0 + gap
        );
        let found = extract(&text, 3.2, 5e-3);
        report(&format!("gap {gap}"), &found);
        manifold(&found.mesh);
    }
}

#[test]
fn random_trees_of_primitives_are_manifold() {
    use rand::{RngExt, SeedableRng};
    for seed in 0..12u64 {
        let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(seed);
        let mut number = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let mut text = "sphere(x, y, z, 1)".to_owned();
        for _ in 0..5 {
            let [x, y, z, r] = [number(-0.8, 0.8), number(-0.8, 0.8), number(-0.8, 0.8), number(0.3, 0.7)];
            let shape = match number(0.0, 3.0) as u32 {
                0 => format!("sphere(x - {x}, y - {y}, z - {z}, {r})"),
                1 => format!("block(x - {x}, y - {y}, z - {z}, {r}, {r}, 1.1)"),
                _ => format!("({r}^2 - (x - {x})^2 - (z - {z})^2) and 1 - y^2"),
            };
            let operation = ["or", "and not", "or"][number(0.0, 3.0) as usize];
            text = format!("({text}) {operation} ({shape})");
        }
        let found = extract(&text, 2.0, 1e-2);
        report(&format!("seed {seed}"), &found);
        let (pieces, genus) = manifold(&found.mesh);
        println!("  pieces {pieces}, genus {genus}, volume {}", volume(&found.mesh));
        assert!(genus >= 0);
    }
}

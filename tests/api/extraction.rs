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
fn a_convex_wedge_has_no_tunnels() {
    // The edge of the cap passes a plane of the lattice where the sphere is nearly parallel to it: for a few cells in a row the points of that
    // plane within the cap are each the only one of a cell, and the middles of these cells are outside.
    let cap = field("min(x + y + z - 1.0488, sphere(x, y, z, 1))");
    for smooth in [false, true] {
        let found = Extraction::new([-1.2; 3], [1.2; 3], 4.157e-3).smooth(smooth).run(&cap).unwrap();
        assert!(found.divided_cells > 0);
        assert_eq!(manifold(&found.mesh), (1, 0));
        if smooth {
            let most = turns(&cap, &found).into_iter().fold(0.0, f64::max);
            assert!(most < 5.0, "{most}");
        }
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

/// How the facets of a surface face: for every triangle the degrees between its normal and the gradient at its middle, reversed, in
/// order; those with a corner where the gradient jumps are left out.
fn turns(field: &Expression, found: &Extracted) -> Vec<f64> {
    let outward = |p: glam::DVec3| -glam::DVec3::from_array(field.gradient(p.to_array()).1).normalize();
    let mut turns: Vec<f64> = found
        .mesh
        .triangles
        .iter()
        .filter_map(|t| {
            let [a, b, c] = t.map(|k| glam::DVec3::from_array(found.mesh.positions[k as usize]));
            let middle = (a + b + c) / 3.0;
            let way = outward(middle);
            let smooth = [a, b, c].iter().all(|corner| outward(corner.lerp(middle, 0.02)).dot(way) > 0.9);
            smooth.then(|| (b - a).cross(c - a).normalize().angle_between(way).to_degrees())
        })
        .collect();
    turns.sort_by(f64::total_cmp);
    turns
}

/// The smallest angle of every triangle in degrees, in order.
fn least_angles(found: &Extracted) -> Vec<f64> {
    let mut angles: Vec<f64> = found
        .mesh
        .triangles
        .iter()
        .map(|t| {
            let p = t.map(|k| glam::DVec3::from_array(found.mesh.positions[k as usize]));
            let at = |k: usize| (p[(k + 1) % 3] - p[k]).angle_between(p[(k + 2) % 3] - p[k]).to_degrees();
            (0..3).map(at).fold(180.0, f64::min)
        })
        .collect();
    angles.sort_by(f64::total_cmp);
    angles
}

#[test]
fn smooth_surfaces_face_the_way_of_the_field() {
    let texts = [
        ("sphere(x - 0.1, y, z, 1)", 4e-3),
        ("torus(x, y, z, 0.8, 0.25)", 4e-3),
        ("torus(x, y, z, 0.9, 0.12)", 8e-3),
        ("min(1 - abs(x), 1 - abs(y), 1 - abs(z)) and not sphere(x - 1, y - 1, z - 1, 0.8)", 8e-3),
    ];
    for (text, tolerance) in texts {
        let field = field(text);
        let extraction = Extraction::new([-1.2; 3], [1.2; 3], tolerance);
        let rough = extraction.clone().smooth(false).run(&field).unwrap_or_else(|e| panic!("{text}: {e}"));
        let found = extraction.run(&field).unwrap_or_else(|e| panic!("{text}: {e}"));
        report(text, &found);
        assert_eq!(manifold(&found.mesh), manifold(&rough.mesh), "{text}");
        assert!((volume(&found.mesh) - volume(&rough.mesh)).abs() < 16.0 * tolerance, "{text}");
        let solid = trisect::Solid::try_from(found.mesh.clone()).expect("closed");
        let crossings = solid.self_crossings(&trisect::Control::new()).expect("no limits");
        assert!(crossings.is_clean(), "{text}: {crossings:?}");
        assert!(found.deviation <= tolerance, "{text}: {}", found.deviation);
        assert!(4 * found.mesh.triangles.len() < 3 * rough.mesh.triangles.len(), "{text}");
        let usual = |sorted: &[f64]| sorted[(sorted.len() - 1) * 95 / 100];
        let turns = turns(&field, &found);
        println!(
            "  {} of {} triangles, normals {:.2}",
            turns.len(),
            found.mesh.triangles.len(),
            usual(&turns)
        );
        assert!(
            usual(&turns) <= 5.0 && found.normal_deviation <= 5.0,
            "{text}: {} {}",
            usual(&turns),
            found.normal_deviation
        );
        let angles = least_angles(&found);
        assert!(angles[angles.len() / 20] > 8.0, "{text}: {}", angles[angles.len() / 20]);
    }
}

#[test]
fn smooth_surfaces_are_on_the_zero_set_and_none_of_their_facets_is_turned() {
    for text in ["sphere(x - 0.1, y, z, 1)", "torus(x, y, z, 0.8, 0.25)"] {
        let field = field(text);
        let found = extract(text, 1.2, 4e-3);
        for p in &found.mesh.positions {
            let (value, gradient) = field.gradient(*p);
            let off = value.abs() / gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
            assert!(off < 2e-15, "{text}: {p:?} is off by {off:e}");
        }
        let turns = turns(&field, &found);
        assert!(turns.len() == found.mesh.triangles.len() && turns[turns.len() - 1] < 10.0, "{text}");
    }
}

#[test]
fn smoothing_leaves_plane_faces_and_their_edges_exact() {
    // A box needs no more than twelve triangles.
    let found = extract("min(1 - abs(x), 0.7 - abs(y), 0.5 - abs(z))", 1.1, 1e-2);
    assert_eq!(manifold(&found.mesh), (1, 0));
    assert!(found.mesh.triangles.len() < 30, "{}", found.mesh.triangles.len());
    assert!((volume(&found.mesh) - 2.8).abs() < 1e-12 && found.normal_deviation < 1e-5);
    // The edge of a bored plate is where the cylinder and the plane meet.
    let found = extract("min(1 - abs(x), 1 - abs(y), 0.3 - abs(z)) and not (0.25 - x^2 - y^2)", 1.2, 5e-3);
    assert_eq!(manifold(&found.mesh), (1, 1));
    let rim = found.mesh.positions.iter().filter(|p| {
        ((p[0] * p[0] + p[1] * p[1]).sqrt() - 0.5).abs() < 1e-9 && (p[2].abs() - 0.3).abs() < 1e-9
    });
    assert!(rim.count() > 40);
    assert!(found.deviation <= 5e-3 && found.normal_deviation <= 5.0, "{}", found.normal_deviation);
}

#[test]
fn smooth_surfaces_are_the_same_on_any_number_of_threads() {
    let field = field("torus(x, y, z, 0.8, 0.25) or min(0.5 - abs(x), 0.4 - abs(y), 0.6 - abs(z))");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| Extraction::new([-1.2; 3], [1.2; 3], 8e-3).run(&field).expect("extracted"))
    };
    let (one, four) = (on(1), on(4));
    assert_eq!(one.mesh.triangles, four.mesh.triangles);
    let bits =
        |found: &Extracted| found.mesh.positions.iter().flatten().map(|x| x.to_bits()).collect::<Vec<u64>>();
    assert_eq!(bits(&one), bits(&four));
    assert_eq!(one.normal_deviation.to_bits(), four.normal_deviation.to_bits());
}

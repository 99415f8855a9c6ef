//! Contacts that are off by less and less: offsets and angles of 1e-1 down to 1e-17, and nothing at all.

use trisect::Operation::{Difference, Intersection, SymmetricDifference, Union};
use trisect::{Mesh, Solid, primitives};

use crate::common::{cuboid, same_bits, solid};
use crate::judge::oracle;
use crate::judge::surface::volume;
use crate::trial::{Expected, Trial};

/// 1e-1 to 1e-17, three to a power of ten, and 0; both signs.
fn amounts() -> Vec<f64> {
    let powers = (1..=17).flat_map(|power| [1.0, 0.5, 0.2].map(|x| x * 10f64.powi(-power)));
    powers.flat_map(|x| [x, -x]).chain([0.0]).collect()
}

/// All operations, both ways, given the volume shared; and the oracle.
fn run(trial: &mut Trial, context: &str, a: &Solid, b: &Solid, shared: f64, tolerance: f64) {
    let (va, vb) = (volume(a.mesh()), volume(b.mesh()));
    for (first, second, v) in [(a, b, va), (b, a, vb)] {
        for (operation, expected) in [
            (Union, va + vb - shared),
            (Intersection, shared),
            (Difference, v - shared),
            (SymmetricDifference, va + vb - 2.0 * shared),
        ] {
            let expected = Expected { volume: Some(expected), tolerance, ..Expected::default() };
            let Some(result) = trial.run(context, operation, [first, second], &expected) else { continue };
            let verdict = oracle::judge(operation, &[first.mesh(), second.mesh()], result.mesh(), 60, 11);
            if let Some(mistake) = verdict.mistakes.first() {
                trial.note(format!("{context} {operation:?}: {mistake:?}"));
            }
        }
    }
}

/// The length that two intervals share.
fn overlap(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[1].min(b[1]) - a[0].max(b[0])).max(0.0)
}

#[test]
fn boxes_nearly_flush() {
    let _bits = same_bits::group("battery boxes nearly flush");
    let mut trial = Trial::default();
    let a = cuboid([0.0; 3], [1.0; 3]);
    // Beside one another, on one another, nearly the same; moved along one axis or all.
    let places =
        [([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]), ([0.25, 0.25, 1.0], [0.75, 0.75, 2.0]), ([0.0; 3], [1.0; 3])];
    for (low, high) in places {
        for direction in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]] {
            for amount in amounts() {
                let place = |p: [f64; 3]| [0, 1, 2].map(|k| p[k] + amount * direction[k]);
                let (low, high) = (place(low), place(high));
                let shared = (0..3).map(|k| overlap([0.0, 1.0], [low[k], high[k]])).product();
                let context = format!("box {low:?} {high:?}");
                // Tidying may take off what is no thicker than 4 units in the last place, all round.
                let area = 6.0;
                run(&mut trial, &context, &a, &cuboid(low, high), shared, 4.0 * f64::EPSILON * area);
            }
        }
    }
    trial.finish(7_000);
}

#[test]
fn boxes_nearly_parallel() {
    let _bits = same_bits::group("battery boxes nearly parallel");
    let mut trial = Trial::default();
    let mesh = primitives::cuboid([-0.5; 3], [0.5; 3]).expect("a cube");
    let a = solid(mesh.clone());
    for angle in amounts().into_iter().filter(|angle| angle.abs() < 0.2) {
        // Turned about an axis of the cube.
        let (sin, cos) = angle.sin_cos();
        let turned = |[x, y, z]: [f64; 3]| [cos * x - sin * y, sin * x + cos * y, z];
        let b = solid(Mesh::new(mesh.positions.iter().map(|&p| turned(p)).collect(), mesh.triangles.clone()));
        // Unit squares turned about their middle share 2 / (1 + sin + cos).
        let shared = 2.0 / (1.0 + sin.abs() + cos);
        run(&mut trial, &format!("turned by {angle:e}"), &a, &b, shared, 1e-15);
        // On one another, and turned about the normal of the face they share.
        let b = solid(b.into_mesh().translated([0.0, 0.0, 1.0]));
        run(&mut trial, &format!("on it, turned by {angle:e}"), &a, &b, 0.0, 1e-15);
    }
    trial.finish(800);
}

#[test]
fn slopes_nearly_flush() {
    let _bits = same_bits::group("battery slopes nearly flush");
    // A wedge on the slope of another: the contact is in a plane in which no coordinates are equal.
    let mut trial = Trial::default();
    let profile = [[0.0, 0.0], [3.0, 0.0], [0.0, 1.0]];
    let below = solid(primitives::extrusion(&profile, &[], 1.0).expect("a wedge"));
    let area = |height: f64| 0.5 * 3.0 * height * height;
    for amount in amounts() {
        // The box less what is under the line from (3, amount) to (0, 1 + amount).
        let (right, left) = (amount, 1.0 + amount);
        let above = primitives::extrusion(&[[0.0, left], [3.0, right], [3.0, 2.0], [0.0, 2.0]], &[], 1.0);
        let above = solid(above.expect("a simple polygon"));
        // Sunk in by so much, they share a strip of the triangle.
        let shared = if left < 1.0 { area(1.0) - area(left) } else { 0.0 };
        run(&mut trial, &format!("wedge off by {amount:e}"), &below, &above, shared, 1e-15);
    }
    trial.finish(800);
}

#[test]
fn round_bodies_nearly_the_same() {
    let _bits = same_bits::group("battery round bodies nearly the same");
    let mut trial = Trial::default();
    let bodies = [
        primitives::geodesic_sphere(1.0, 3).expect("a ball"),
        primitives::torus(1.0, 0.4, 9, 7).expect("a torus"),
    ];
    for mesh in bodies {
        let a = solid(mesh.clone());
        for amount in amounts().into_iter().step_by(2) {
            let b = solid(mesh.clone().translated([amount, 0.5 * amount, -0.3 * amount]));
            let shared = crate::common::run(Intersection, &[&a, &b]);
            let shared = volume(shared.solid().mesh());
            run(&mut trial, &format!("moved by {amount:e}"), &a, &b, shared, 1e-14);
        }
    }
    trial.finish(800);
}

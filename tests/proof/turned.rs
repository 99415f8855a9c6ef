//! Assemblies whose bodies were flush before they were turned: what lies in one plane but for rounding is one face.

use trisect::Operation::{Difference, Union};
use trisect::{BooleanOptions, Control, Embed, Mesh, Operation, Outcome, Solid, primitives};

use crate::common::solid;
use crate::contacts::menger;

/// Angles, in degrees, and axes.
const TURNS: [(f64, [f64; 3]); 3] =
    [(42.084, [1.0, 2.0, 3.0]), (17.0, [0.2, -1.0, 0.5]), (1e-7, [1.0, 1.0, 0.0])];

fn turned(solids: &[Solid], (angle, axis): (f64, [f64; 3])) -> Vec<Solid> {
    let turn = |of: &Solid| solid(of.mesh().clone().rotated(axis, angle).expect("an axis"));
    solids.iter().map(turn).collect()
}

fn run(operation: Operation, operands: &[Solid], embed: Embed) -> Outcome {
    BooleanOptions::new().embed(embed).run(operation, operands).expect("no limits")
}

/// Closed, a 2-manifold of the volume that is expected, without a crossing.
fn assert_sound(outcome: &Outcome, volume: f64, what: &str) {
    let certificate = outcome.certificate();
    assert!(certificate.closed && certificate.manifold, "{what}: {certificate}");
    assert!((certificate.volume - volume).abs() <= 1e-9 * volume, "{what}: {certificate}, not {volume}");
    assert_eq!(certificate.embedding.map(|done| done.left), Some(0), "{what}");
    let crossings = outcome.solid().self_crossings(&Control::new()).expect("no limits");
    assert_eq!((crossings.count, crossings.tolerated), (0, 0), "{what}: {crossings}");
}

#[test]
fn turned_sponges_have_hardly_more_triangles_than_others() {
    let parts = menger(2);
    let plain = run(Difference, &parts, Embed::Never).certificate().clone();
    for turn in TURNS {
        let sponge = run(Difference, &turned(&parts, turn), Embed::NearCut);
        assert_sound(&sponge, 400.0, &format!("{turn:?}"));
        let certificate = sponge.certificate();
        assert!(certificate.triangles * 4 <= plain.triangles * 5, "{turn:?}: {certificate}, not {plain}");
        // Coordinates are up to 13.
        assert!(certificate.flattening.vertices > 0, "{turn:?}");
        assert!(certificate.flattening.displacement <= 1e-13, "{turn:?}: {:?}", certificate.flattening);
    }
}

#[test]
fn turned_bars_united_have_hardly_more_triangles_than_others() {
    let bars = &menger(2)[1..];
    let plain = run(Union, bars, Embed::Never).certificate().clone();
    for turn in TURNS {
        let united = run(Union, &turned(bars, turn), Embed::NearCut);
        assert_sound(&united, plain.volume, &format!("{turn:?}"));
        let certificate = united.certificate();
        assert!(certificate.triangles * 4 <= plain.triangles * 5, "{turn:?}: {certificate}, not {plain}");
    }
}

#[test]
fn turned_cubes_that_touch_in_one_mesh_become_one() {
    let mut cubes = Mesh::default();
    for cell in 0..27 {
        let low = [cell % 3, cell / 3 % 3, cell / 9].map(f64::from);
        let cube = primitives::cuboid(low, low.map(|x| x + 1.0)).expect("a box");
        cubes.append(&cube).expect("few");
    }
    for turn in TURNS {
        let [cubes] = &turned(&[solid(cubes.clone())], turn)[..] else { panic!("one operand") };
        let one = BooleanOptions::new().embed(Embed::NearCut).resolve(cubes).expect("no limits");
        assert_sound(&one, 27.0, &format!("{turn:?}"));
        assert!(one.certificate().triangles <= 24, "{turn:?}: {}", one.certificate());
    }
}

#[test]
fn what_is_to_stay_as_it_is_rounded_stays() {
    let parts = turned(&menger(1), TURNS[0]);
    let certificate = run(Difference, &parts, Embed::Never).certificate().clone();
    assert_eq!(certificate.flattening.vertices, 0);
}

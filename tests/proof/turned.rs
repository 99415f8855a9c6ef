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

/// A gear between two heights.
fn gear(teeth: u32, low: f64, high: f64) -> Solid {
    let outline: Vec<[f64; 2]> = (0..teeth)
        .flat_map(|tooth| {
            [(0.0, 8.0), (0.3, 8.0), (0.4, 10.0), (0.7, 10.0)].map(|(part, radius)| {
                let angle = std::f64::consts::TAU * (f64::from(tooth) + part) / f64::from(teeth) + 0.1;
                [radius * angle.cos(), radius * angle.sin()]
            })
        })
        .collect();
    let gear = primitives::extrusion(&outline, &[], high - low).expect("an outline");
    solid(gear.translated([0.0, 0.0, low]))
}

/// A plate, and pegs that end where it does.
fn plate_and_pegs(peg: impl Fn() -> Mesh) -> Vec<Solid> {
    let plate = primitives::cuboid([0.0; 3], [6.0, 6.0, 1.0]).expect("a box");
    let pegs = (0..9).map(|cell| {
        let [x, y] = [cell % 3, cell / 3].map(|k| f64::from(2 * k + 1));
        solid(peg().translated([x, y, 0.0]))
    });
    std::iter::once(solid(plate)).chain(pegs).collect()
}

/// That a result of operands turned together is that of the operands as they were: sound, connected alike, and of hardly more
/// triangles.
fn assert_as_not_turned(what: &str, operation: Operation, operands: &[Solid]) {
    let plain = run(operation, operands, Embed::Never);
    for turn in TURNS {
        let what = format!("{what}, {turn:?}");
        let outcome = run(operation, &turned(operands, turn), Embed::NearCut);
        assert_sound(&outcome, plain.certificate().volume, &what);
        let [is, was] =
            [&outcome, &plain].map(|outcome| (outcome.solid().components(), outcome.solid().genus()));
        assert_eq!(is, was, "{what}");
        let [is, was] = [&outcome, &plain].map(|outcome| outcome.certificate().triangles);
        assert!(is * 4 <= was * 5 + 48, "{what}: {is} triangles, not {was}");
    }
}

#[test]
fn turned_gears_are_flush_as_before() {
    let pair = [gear(12, 0.0, 2.0), gear(12, 1.0, 3.0)];
    assert_as_not_turned("gears, one half into the other", Union, &pair);
    assert_as_not_turned("what of a gear is not in the other", Difference, &pair);
    assert_as_not_turned("a gear on another", Union, &[gear(12, 0.0, 2.0), gear(12, 2.0, 3.0)]);
}

#[test]
fn turned_plates_have_holes_without_films() {
    let square = || primitives::cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]).expect("a box");
    let angular = plate_and_pegs(square);
    assert_as_not_turned("square holes", Difference, &angular);
    assert_as_not_turned("square holes with their pegs", Union, &angular);
    let round = plate_and_pegs(|| primitives::cylinder(0.6, 1.0, 16).expect("a cylinder"));
    assert_as_not_turned("round holes", Difference, &round);
    assert_as_not_turned("round holes with their pegs", Union, &round);
}

#[test]
fn turned_rows_of_boxes_become_one() {
    let row: Vec<Solid> = (0..12)
        .map(|k| {
            let low = [f64::from(k), 0.0, 0.0];
            solid(primitives::cuboid(low, low.map(|x| x + 1.0)).expect("a box"))
        })
        .collect();
    assert_as_not_turned("boxes in a row", Union, &row);
    let cubes: Vec<Solid> = (0..27)
        .map(|cell| {
            let low = [cell % 3, cell / 3 % 3, cell / 9].map(f64::from);
            solid(primitives::cuboid(low, low.map(|x| x + 1.0)).expect("a box"))
        })
        .collect();
    assert_as_not_turned("27 cubes", Union, &cubes);
}

#[test]
fn what_is_to_stay_as_it_is_rounded_stays() {
    let parts = turned(&menger(1), TURNS[0]);
    let certificate = run(Difference, &parts, Embed::Never).certificate().clone();
    assert_eq!(certificate.flattening.vertices, 0);
}

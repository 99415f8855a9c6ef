//! Seven small cases with known answers. Most engines get at least one of them wrong without a word.

use trisect::Operation::{Difference, Union};
use trisect::{Control, Mesh, MeshError, Operation, Solid, boolean, primitives};

use super::surface::Properties;

fn cube(low: [f64; 3], side: f64) -> Mesh {
    primitives::cuboid(low, low.map(|x| x + side)).expect("a box")
}

fn solid(mesh: Mesh) -> Solid {
    Solid::try_from(mesh).expect("a closed mesh")
}

/// The result, asserted sound.
fn run(operation: Operation, a: &Solid, b: &Solid) -> Properties {
    let outcome = boolean(operation, a, b).expect("small enough");
    let found = Properties::of(outcome.solid().mesh());
    assert!(found.closed && found.manifold && found.zero_area == 0, "{found:?}");
    found
}

/// The unit cube and the same moved by 0.3.
fn pair() -> [Mesh; 2] {
    [cube([0.0; 3], 1.0), cube([0.3; 3], 1.0)]
}

#[test]
fn a_cube_less_a_shifted_cube() {
    let [a, b] = pair().map(solid);
    let volume = run(Difference, &a, &b).volume;
    assert!((volume - 0.657).abs() <= 1e-15, "{volume}");
}

#[test]
fn the_same_far_from_the_origin() {
    let far = [500_000.0, 4_649_776.0, 120.0];
    let [a, b] = pair().map(|mesh| solid(mesh.translated(far)));
    let found = run(Difference, &a, &b);
    // Coordinates are on a grid of 1e-9 there.
    assert!((found.volume - 0.657).abs() <= 1e-8, "{}", found.volume);
    let moved = boolean(Difference, &a, &b).expect("small enough");
    let near = pair().map(solid);
    let still = boolean(Difference, &near[0], &near[1]).expect("small enough");
    for p in &moved.solid().mesh().positions {
        let back = [0, 1, 2].map(|k| p[k] - far[k]);
        let off = |q: &[f64; 3]| (0..3).map(|k| (q[k] - back[k]).abs()).fold(0.0, f64::max);
        let nearest = still.solid().mesh().positions.iter().map(off).fold(f64::INFINITY, f64::min);
        assert!(nearest <= 1e-9, "{p:?} is off by {nearest:e}");
    }
}

#[test]
fn an_operand_that_overlaps_itself_counts_once() {
    let mut both = cube([1.0; 3], 1.0);
    both.append(&cube([1.5; 3], 1.0)).expect("few");
    let both = solid(both);
    let crossings = both.self_crossings(&Control::new()).expect("no limits");
    assert!(!crossings.is_clean() && !crossings.places.is_empty(), "{crossings}");
    for crossing in &crossings.places {
        assert!(crossing.place.iter().all(|x| (1.5..=2.0).contains(x)), "{crossing:?}");
    }
    // 27 less 1.875, whether it is united first or not.
    let body = solid(cube([0.0; 3], 3.0));
    assert_eq!(run(Difference, &body, &both).volume, 25.125);
    let united =
        boolean(Union, &solid(cube([1.0; 3], 1.0)), &solid(cube([1.5; 3], 1.0))).expect("small enough");
    assert_eq!(run(Difference, &body, united.solid()).volume, 25.125);
}

#[test]
fn an_open_operand_is_refused_with_places() {
    let mut open = cube([1.0; 3], 1.0);
    open.triangles.truncate(10);
    match Solid::try_from(open) {
        Err(MeshError::NotClosed(diagnosis)) => assert_eq!(diagnosis.open_edges.count, 4),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_cube_less_itself_is_empty() {
    let [a, _] = pair().map(solid);
    let nothing = boolean(Difference, &a, &a).expect("an empty result is a success");
    assert!(nothing.solid().is_empty());
    assert_eq!(nothing.certificate().volume, 0.0);
    // And an operand like any other.
    assert_eq!(run(Union, nothing.solid(), &a).volume, 1.0);
}

#[test]
fn boxes_that_share_a_face_become_one() {
    let (a, b) = (solid(cube([0.0; 3], 1.0)), solid(cube([1.0, 0.0, 0.0], 1.0)));
    let found = run(Union, &a, &b);
    assert_eq!((found.volume, found.components), (2.0, 1));
}

#[test]
fn what_is_not_a_number_and_what_is_inside_out_are_refused() {
    let mut mesh = cube([0.0; 3], 1.0);
    mesh.positions[3][1] = f64::NAN;
    assert!(matches!(Solid::try_from(mesh), Err(MeshError::NotFinite { vertex: 3, .. })));
    let mut mesh = cube([0.0; 3], 1.0);
    mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    match Solid::try_from(mesh) {
        Err(MeshError::InsideOut { volume }) => assert_eq!(volume, -1.0),
        other => panic!("{other:?}"),
    }
}

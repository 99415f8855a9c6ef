//! Booleans of cages: topology, untouched bits, distances.

use glam::{DQuat, DVec3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt as _, SeedableRng as _};

use super::{FreeForm, FreeFormOutcome, VertexOrigin};
use crate::spatial::TriangleTree;
use crate::subdivision::{ControlMesh, Corner, Crease, Place, Rules, Tags};
use crate::{Error, Operation, Solid, primitives};

const SHARP: f64 = f64::INFINITY;

pub(super) fn ball(level: u32) -> ControlMesh {
    let mesh = primitives::icosphere(1.0, level).expect("a ball");
    ControlMesh::new(mesh.positions, mesh.triangles, Tags::default(), Rules::Loop).expect("a surface")
}

/// A cylinder along z with creased rims.
fn cylinder(sides: u32, rows: u32, radius: f64, low: f64, high: f64) -> ControlMesh {
    let mut positions = vec![[0.0, 0.0, low], [0.0, 0.0, high]];
    for j in 0..=rows {
        for i in 0..sides {
            let turn = std::f64::consts::TAU * (f64::from(i) + 0.5 * f64::from(j % 2)) / f64::from(sides);
            let z = low + (high - low) * f64::from(j) / f64::from(rows);
            positions.push([radius * turn.cos(), radius * turn.sin(), z]);
        }
    }
    let at = |j: u32, i: u32| 2 + j * sides + i % sides;
    let (mut faces, mut tags) = (Vec::new(), Tags::default());
    for i in 0..sides {
        faces.push([0, at(0, i + 1), at(0, i)]);
        faces.push([1, at(rows, i), at(rows, i + 1)]);
        for j in 0..rows {
            let (a, b, c, d) = (at(j, i), at(j, i + 1), at(j + 1, i), at(j + 1, i + 1));
            faces.extend(if j % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] });
        }
        for j in [0, rows] {
            tags.creases.push(Crease { edge: [at(j, i), at(j, i + 1)], sharpness: SHARP });
        }
    }
    ControlMesh::new(positions, faces, tags, Rules::Loop).expect("a surface")
}

fn torus(around: u32, across: u32, radius: f64, thick: f64) -> ControlMesh {
    tube(around, across, thick, |a| DVec3::new(radius * a.cos(), radius * a.sin(), 0.0))
}

/// A closed tube along a curve that goes round once from 0 to 2 pi and is nowhere upright.
pub(super) fn tube(around: u32, across: u32, thick: f64, curve: impl Fn(f64) -> DVec3) -> ControlMesh {
    let mut positions = Vec::new();
    for i in 0..around {
        let a = std::f64::consts::TAU * f64::from(i) / f64::from(around);
        let aside = (curve(a + 1e-4) - curve(a - 1e-4)).cross(DVec3::Z).normalize();
        for j in 0..across {
            let b = std::f64::consts::TAU * (f64::from(j) + 0.5 * f64::from(i % 2)) / f64::from(across);
            positions.push((curve(a) + thick * (b.cos() * aside + b.sin() * DVec3::Z)).to_array());
        }
    }
    let at = |i: u32, j: u32| (i % around) * across + j % across;
    let mut faces = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            faces.extend(if i % 2 == 0 { [[a, b, c], [c, b, d]] } else { [[a, b, d], [a, d, c]] });
        }
    }
    ControlMesh::new(positions, faces, Tags::default(), Rules::Loop).expect("a surface")
}

pub(super) fn moved(cage: &ControlMesh, map: impl Fn(DVec3) -> DVec3) -> ControlMesh {
    let positions = cage.positions().iter().map(|&p| map(p.into()).to_array()).collect();
    ControlMesh::new(positions, cage.faces().to_vec(), cage.tags().clone(), cage.rules()).expect("a surface")
}

pub(super) fn diagonal(outcome: &FreeFormOutcome) -> f64 {
    let bounds = outcome.exact().solid().bounds().expect("not empty");
    (DVec3::from(bounds.high) - DVec3::from(bounds.low)).length()
}

/// What holds for every result: a manifold of the exact result's kind, and kept points with their bits.
pub(super) fn check(outcome: &FreeFormOutcome, operands: &[&ControlMesh], name: &str) {
    let cage = outcome.surface();
    let solid = Solid::try_from(cage.mesh()).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(solid.is_manifold(), "{name}");
    let exact = outcome.exact().solid();
    assert_eq!(solid.euler_characteristic(), exact.euler_characteristic(), "{name}");
    assert_eq!(outcome.origins().len(), cage.positions().len(), "{name}");
    for (v, origin) in outcome.origins().iter().enumerate() {
        if let VertexOrigin::Kept { operand, vertex } = *origin {
            let before = operands[operand].positions()[vertex as usize];
            assert_eq!(before.map(f64::to_bits), cage.positions()[v].map(f64::to_bits), "{name}: vertex {v}");
        }
    }
}

pub(super) fn seeded(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// The largest distance of points at random on the cage's surface from the exact result.
pub(super) fn sampled(outcome: &FreeFormOutcome, random: &mut ChaCha8Rng) -> f64 {
    let (cage, tree) = (outcome.surface(), TriangleTree::new(outcome.exact().solid().mesh()));
    let evaluator = cage.evaluator();
    (0..300)
        .map(|_| {
            let (mut u, mut v) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let face = random.random_range(0..cage.faces().len() as u32);
            let point = evaluator.at(Place { face, weights: [1.0 - u - v, u, v] }).expect("a face");
            tree.closest(point.position).expect("not empty").squared_distance.sqrt()
        })
        .fold(0.0, f64::max)
}

#[test]
fn a_bored_ball_is_as_near_as_it_was_seen_to_be() {
    let ball = ball(2);
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.3);
    let bore = moved(&cylinder(8, 6, 0.45, -1.6, 1.6), |p| turn * (p + DVec3::new(0.1, 0.05, 0.0)));
    let native = FreeForm::new().attempts(0).run(Operation::Difference, &ball, &bore).expect("a cage");
    check(&native, &[&ball, &bore], "native");
    let report = native.report();
    let d = diagonal(&native);
    assert!(report.errors.largest() < 1.3e-3 * d, "{report:?}");
    assert!(report.added <= 125 && report.valence <= 9, "{report:?}");
    assert_eq!((report.chains, report.features), (2, 0));
    // Faces of half the size: a third of the distance, around the curve and away from it.
    let finer =
        FreeForm::new().attempts(0).refine(1).run(Operation::Difference, &ball, &bore).expect("a cage");
    check(&finer, &[&ball, &bore], "finer");
    assert!(finer.report().errors.largest() < 6e-4 * d, "{:?}", finer.report());
    assert!(finer.report().errors.outside < 3e-4 * d, "{:?}", finer.report());
    // Twice the same: the same bits.
    let again = FreeForm::new().attempts(0).run(Operation::Difference, &ball, &bore).expect("a cage");
    assert_eq!(again.surface().to_obj(), native.surface().to_obj());
}

/// Each level of details makes the surface at least three times as near.
#[test]
fn details_come_nearer_level_by_level() {
    let ball = ball(1);
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.3);
    let bore = moved(&cylinder(8, 4, 0.5, -1.6, 1.6), |p| turn * p);
    let mut before = f64::INFINITY;
    for levels in 0..=2 {
        let settings = FreeForm::new().tolerance(1e-4).attempts(0).details(levels);
        let outcome = settings.run(Operation::Difference, &ball, &bore).expect("a cage");
        let report = outcome.report();
        assert_eq!((report.levels, outcome.surface().details().len()), (levels, levels));
        assert!(report.errors.forward * 3.0 < before, "level {levels}: {report:?}");
        before = report.errors.forward;
        // The details are the surface's, not the report's alone.
        let fine = outcome.surface().limit_mesh_of_steps(4).expect("not too fine");
        let tree = TriangleTree::new(outcome.exact().solid().mesh());
        let far = |p: &[f64; 3]| tree.closest(*p).expect("not empty").squared_distance.sqrt();
        let far = fine.mesh().positions.iter().map(far).fold(0.0, f64::max);
        assert!(far <= report.errors.largest() + report.errors.allowance, "{far} {report:?}");
    }
}

#[test]
fn where_nothing_is_cut_all_bits_stay() {
    let (one, far) = (ball(1), moved(&ball(1), |p| p + DVec3::new(5.0, 0.0, 0.0)));
    let small = moved(&ball(1), |p| p * 0.4);
    for (operation, a, b, vertices) in [
        (Operation::Union, &one, &far, 84),
        (Operation::Union, &one, &one, 42),
        (Operation::Intersection, &one, &one, 42),
        (Operation::Intersection, &one, &small, 42),
        (Operation::Difference, &one, &far, 42),
        (Operation::Difference, &one, &small, 84),
        (Operation::Union, &one, &small, 42),
    ] {
        let outcome = FreeForm::new().tolerance(0.05).run(operation, a, b).expect("a cage");
        check(&outcome, &[a, b], operation.name());
        let report = outcome.report();
        assert_eq!((report.vertices, report.unchanged), (vertices, vertices), "{operation:?}");
        assert_eq!(report.errors.largest(), 0.0);
        assert!(report.reached);
    }
    for (operation, a, b) in [(Operation::Difference, &one, &one), (Operation::Intersection, &one, &far)] {
        let outcome = FreeForm::new().tolerance(0.05).run(operation, a, b).expect("an empty result");
        assert!(outcome.surface().faces().is_empty() && outcome.report().reached);
    }
}

/// Figure 3 of the paper: a handle is united with the body, then the inside is taken out.
#[test]
fn a_mug() {
    let body = cylinder(12, 6, 1.0, 0.0, 2.4);
    let turned = torus(12, 6, 0.65, 0.16);
    // The map turns the surface over, so faces are turned back.
    let mut mesh = moved(&turned, |p| DVec3::new(p.x + 1.05, p.z + 0.02, p.y + 1.2)).mesh();
    mesh.triangles.iter_mut().for_each(|face| face.swap(1, 2));
    let handle =
        ControlMesh::new(mesh.positions, mesh.triangles, Tags::default(), Rules::Loop).expect("valid");
    let inside = cylinder(12, 6, 0.85, 0.2, 2.8);

    let first = FreeForm::new().attempts(0).run(Operation::Union, &body, &handle).expect("a cage");
    check(&first, &[&body, &handle], "handle");
    assert!(first.report().errors.largest() < 2e-3 * diagonal(&first), "{:?}", first.report());
    let united = first.surface();
    let mug = FreeForm::new().attempts(0).run(Operation::Difference, united, &inside).expect("a cage");
    check(&mug, &[united, &inside], "inside");
    let report = mug.report();
    assert!(report.errors.largest() < 2e-3 * diagonal(&mug), "{report:?}");
    assert!(report.vertices <= 600 && report.valence <= 9, "{report:?}");
    assert!(report.unchanged * 2 >= united.positions().len(), "{report:?}");
    assert_eq!(Solid::try_from(mug.surface().mesh()).expect("closed").euler_characteristic(), 0);
}

#[test]
fn a_curve_through_a_crease_has_corners_there() {
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, 1.0, 0.2).normalize(), 1.1);
    let block = cylinder(8, 4, 0.6, -1.0, 1.0);
    let other = moved(&ball(2), |p| turn * (p * 0.7) + DVec3::new(0.5, 0.1, 0.9));
    for operation in [Operation::Union, Operation::Difference, Operation::Intersection] {
        let outcome = FreeForm::new().attempts(1).run(operation, &block, &other).expect("a cage");
        check(&outcome, &[&block, &other], operation.name());
        assert_eq!(outcome.report().features, 2, "{:?}", outcome.report());
        assert!(outcome.report().errors.largest() < 1e-2 * diagonal(&outcome), "{:?}", outcome.report());
    }
}

/// A cage at random: a shape roughened, turned and moved, with creases and corners in half of the cases.
fn random_cage(random: &mut ChaCha8Rng) -> ControlMesh {
    let base = match random.random_range(0..5) {
        0 => ball(1),
        1 => moved(&ball(2), |p| p * 0.9),
        2 => torus(14, 8, 0.8, 0.35),
        3 => cylinder(8, 4, 0.6, -1.0, 1.0),
        _ => cylinder(10, 6, 0.35, -1.5, 1.5),
    };
    let rough = random.random_range(0.0..0.08);
    let mut tags = base.tags().clone();
    if random.random_range(0..2) == 0 {
        for face in base.faces() {
            if random.random_range(0..25) == 0 {
                tags.creases.push(Crease { edge: [face[0], face[1]], sharpness: SHARP });
            }
        }
        let vertex = random.random_range(0..base.positions().len() as u32);
        tags.corners.push(Corner { vertex, sharpness: SHARP });
    }
    let mut one = || random.random_range(-1.0..1.0);
    let turn = DQuat::from_axis_angle(DVec3::new(one(), one(), one() + 1.1).normalize(), 3.0 * one());
    let way = DVec3::new(one(), one(), one()) * 0.6;
    let positions = base
        .positions()
        .iter()
        .map(|&p| (turn * (DVec3::from(p) + DVec3::new(one(), one(), one()) * rough) + way).to_array())
        .collect();
    ControlMesh::new(positions, base.faces().to_vec(), tags, Rules::Loop).expect("a surface")
}

#[test]
fn pairs_at_random() {
    let mut cut = 0;
    for seed in 0..12 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (a, b) = (random_cage(&mut random), random_cage(&mut random));
        let operation =
            [Operation::Union, Operation::Intersection, Operation::Difference][random.random_range(0..3)];
        let name = format!("seed {seed}");
        match FreeForm::new().tolerance(0.02).attempts(0).allow_tangent(true).run(operation, &a, &b) {
            Ok(outcome) if outcome.surface().faces().is_empty() => {}
            Ok(outcome) => {
                check(&outcome, &[&a, &b], &name);
                let errors = outcome.report().errors;
                let far = sampled(&outcome, &mut random);
                assert!(far <= errors.largest() + errors.allowance, "{name}: {far} {errors:?}");
                cut += 1;
            }
            Err(error) => panic!("{name}: {error}"),
        }
    }
    assert!(cut > 8, "{cut}");
}

#[test]
fn what_cannot_be_is_refused() {
    let ball = ball(1);
    let open = {
        let mut faces = ball.faces().to_vec();
        faces.pop();
        ControlMesh::new(ball.positions().to_vec(), faces, Tags::default(), Rules::Loop).expect("valid")
    };
    let refused = |result: Result<FreeFormOutcome, Error>| result.map(|_| ()).unwrap_err().to_string();
    assert!(refused(FreeForm::new().run(Operation::Union, &ball, &open)).contains("operand 2"));
    assert!(refused(FreeForm::new().run(Operation::SymmetricDifference, &ball, &ball)).contains("xor"));
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let text = refused(FreeForm::new().tolerance(tolerance).run(Operation::Union, &ball, &ball));
        assert!(text.contains("tolerance"), "{text}");
    }
}

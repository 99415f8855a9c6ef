//! The minimiser, tried on engines that are wrong on purpose.

use trisect::{BooleanOptions, Mesh, Operation, Solid, primitives};

use crate::judge::minimise::{Pair, minimised};
use crate::judge::oracle;

type Engine = fn(Operation, &Pair) -> Mesh;

fn right(operation: Operation, pair: &Pair) -> Mesh {
    let solids = pair.each_ref().map(|mesh| Solid::try_from(mesh.clone()).expect("closed"));
    BooleanOptions::new()
        .threads(1)
        .run(operation, [&solids[0], &solids[1]])
        .expect("no limits")
        .into_solid()
        .into_mesh()
}

/// Forgets the second operand wherever it has a vertex higher than every vertex of the first.
fn forgetful(operation: Operation, pair: &Pair) -> Mesh {
    let top = |mesh: &Mesh| mesh.positions.iter().fold(f64::NEG_INFINITY, |top, p| top.max(p[2]));
    if top(&pair[1]) > top(&pair[0]) { pair[0].clone() } else { right(operation, pair) }
}

/// Moves the first vertex that the operation made.
fn displacing(operation: Operation, pair: &Pair) -> Mesh {
    let mut mesh = right(operation, pair);
    let is_old = |p: &[f64; 3]| pair.iter().any(|operand| operand.positions.contains(p));
    if let Some(at) = mesh.positions.iter().position(|p| !is_old(p)) {
        mesh.positions[at][0] += 0.05;
    }
    mesh
}

/// Whether an engine is wrong about a pair, to the oracle.
fn is_wrong(engine: Engine, operation: Operation, pair: &Pair) -> bool {
    let result = engine(operation, pair);
    !oracle::judge(operation, &[&pair[0], &pair[1]], &result, 400, 7).mistakes.is_empty()
}

/// Balls of a few hundred triangles, one with a bite taken out.
fn pair() -> Pair {
    let ball = |frequency: u32| primitives::geodesic_sphere(1.0, frequency).expect("a ball");
    let bitten = right(Operation::Difference, &[ball(4), ball(3).translated([1.1, 0.1, 0.2])]);
    [bitten, ball(4).translated([0.3, 0.4, 0.5])]
}

#[test]
fn wrong_engines_are_shown_by_a_few_triangles() {
    let large = pair();
    let count = |pair: &Pair| pair.iter().map(|mesh| mesh.triangles.len()).sum::<usize>();
    assert!(count(&large) > 400, "{}", count(&large));
    for (name, engine) in [("forgetful", forgetful as Engine), ("displacing", displacing)] {
        let small = minimised(&large, |pair| is_wrong(engine, Operation::Union, pair));
        assert!(count(&small) <= 16, "{name}: {} triangles are left", count(&small));
        // What is written is what failed, to the bit.
        let read = crate::regressions::written_and_read(&small, name);
        assert_eq!(read, small, "{name}");
        assert!(is_wrong(engine, Operation::Union, &read), "{name}");
        assert!(!is_wrong(right, Operation::Union, &read), "{name}");
    }
}

#[test]
#[should_panic(expected = "does not fail")]
fn a_pair_that_does_not_fail_is_refused() {
    minimised(&pair(), |pair| is_wrong(right, Operation::Union, pair));
}

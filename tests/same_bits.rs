//! The same input gives the same bits, however often it is asked.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{BooleanOptions, Mesh, Operation, Solid, primitives};

/// A box on a small grid, or a cylinder of few sides beside it: corners on common planes, lines and circles.
fn piece(rng: &mut ChaCha8Rng, grid: i32, degrees: f64) -> Solid {
    let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
    for k in 0..3 {
        let start = rng.random_range(0..grid);
        (low[k], high[k]) = (f64::from(start), f64::from(rng.random_range(start + 1..=grid)));
    }
    let mesh: Mesh = if rng.random_bool(0.4) {
        let sides = [4, 6, 8, 12][rng.random_range(0..4)];
        let radius = (0.5 * (high[0] - low[0])).max(0.5);
        primitives::cylinder(radius, high[2] - low[2], sides).unwrap().translated([
            low[0] + 1.0,
            low[1] + 1.0,
            low[2],
        ])
    } else {
        primitives::cuboid(low, high).unwrap()
    };
    Solid::try_from(mesh.rotated([1.0, 2.0, 3.0], degrees).unwrap()).unwrap()
}

fn sum(rng: &mut ChaCha8Rng, grid: i32, degrees: f64, count: usize) -> Solid {
    let pieces: Vec<Solid> = (0..count).map(|_| piece(rng, grid, degrees)).collect();
    BooleanOptions::new().run(Operation::Union, &pieces).unwrap().into_solid()
}

#[test]
fn repeated_operations_give_the_same_bits() {
    // The last three once did not: a library filled a hash set with what it could not triangulate at once.
    for seed in (0..20).chain([859, 1961, 1975]) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let grid = [3, 4, 6, 9][rng.random_range(0..4)];
        let (degrees, count) = [(0.0, 10), (30.0, 3), (37.0, 3)][rng.random_range(0..3)];
        let (a, b) = (sum(&mut rng, grid, degrees, count), sum(&mut rng, grid, degrees, count));
        for operation in [Operation::Union, Operation::Difference, Operation::SymmetricDifference] {
            let run = || {
                let outcome = BooleanOptions::new().run(operation, [&a, &b]).unwrap();
                let mesh = outcome.solid().mesh();
                let bits: Vec<u64> = mesh.positions.iter().flatten().map(|x| x.to_bits()).collect();
                (bits, mesh.triangles.clone(), outcome.origins().to_vec())
            };
            let first = run();
            for _ in 0..3 {
                assert!(run() == first, "seed {seed}, {operation:?}");
            }
        }
    }
}

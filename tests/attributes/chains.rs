//! Cut after cut: nothing drifts.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{BooleanOptions, Operation, Solid, primitives};

use crate::common::shapes;
use crate::maps::{judge, solid};

#[test]
fn ten_cuts_do_not_drift() {
    for seed in 0..6 {
        let mut rng = ChaCha8Rng::seed_from_u64(7_000 + seed);
        let bodies = [
            primitives::cuboid([-1.0; 3], [1.0; 3]).unwrap(),
            shapes::torus(1.0, 0.5, 30, 16),
            primitives::icosphere(1.2, 3).unwrap(),
        ];
        let mut body: Solid = solid(bodies[seed as usize % 3].clone(), 0);
        for cut in 0..10 {
            let tool = match cut % 3 {
                0 => primitives::icosphere(rng.random_range(0.2..0.6), 2).unwrap(),
                1 => primitives::cuboid([-0.3; 3], [0.3, 0.2, 0.6]).unwrap(),
                _ => primitives::cylinder(0.25, 1.5, 24).unwrap(),
            };
            let axis = [0; 3].map(|_| rng.random_range(-1.0..1.0));
            let tool = tool.rotated(axis, rng.random_range(0.0..360.0)).unwrap();
            let tool = tool.translated([0; 3].map(|_| rng.random_range(-1.0..1.0)));
            let tool = solid(tool, 100_000 * (cut + 1));
            let outcome = BooleanOptions::new().run(Operation::Difference, [&body, &tool]).unwrap();
            body = outcome.into_solid();
            let error = judge(body.mesh(), &format!("seed {seed}, cut {cut}"));
            assert!(error < 1e-9, "seed {seed}, cut {cut}: {error:e}");
        }
    }
}

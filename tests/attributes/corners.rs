//! Every corner of a result has the value of its face there; what is untouched has its bits.

use std::collections::HashMap;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::mesh::Attribute;
use trisect::{BooleanOptions, Embed, Expression, Grid, Mesh, Operation, Solid, primitives};

use crate::common::shapes;
use crate::maps::{judge, map, mapped, solid};

/// A millionth of a millionth, for coordinates and values near 1: what is asked of them is a millionth.
const ERROR: f64 = 1e-12;

fn shape(rng: &mut ChaCha8Rng) -> Mesh {
    let mesh = match rng.random_range(0..5) {
        0 => primitives::cuboid([-1.0; 3], [1.0, 0.8, 1.2]).unwrap(),
        1 => primitives::icosphere(1.0, 2).unwrap(),
        2 => shapes::torus(0.8, 0.4, 17, 9),
        // Needles: a thousand times as long as wide.
        3 => primitives::cylinder(0.9, 1.4, 200).unwrap(),
        _ => shapes::sphere([0.0; 3], 1.0, 12, 0.2),
    };
    let axis = [0; 3].map(|_| rng.random_range(-1.0..1.0));
    let turned = mesh.rotated(axis, rng.random_range(0.0..360.0)).unwrap();
    turned.translated([0; 3].map(|_| rng.random_range(-0.7..0.7)))
}

#[test]
fn every_corner_has_what_its_face_has_there() {
    let mut worst = 0.0f64;
    for seed in 0..60 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let operands = [solid(shape(&mut rng), 0), solid(shape(&mut rng), 100_000)];
        for operation in Operation::ALL {
            let context = format!("seed {seed}, {operation:?}");
            let outcome = BooleanOptions::new().run(operation, &operands).unwrap();
            worst = worst.max(judge(outcome.solid().mesh(), &context));
            assert!(worst < ERROR, "{context}: {worst:e}");
            let other = BooleanOptions::new().threads(3).run(operation, &operands).unwrap();
            assert_eq!(outcome.solid().mesh().attributes, other.solid().mesh().attributes, "{context}");
        }
    }
    println!("largest error {worst:e}");
}

#[test]
fn many_operands_and_expressions() {
    for seed in 0..12 {
        let mut rng = ChaCha8Rng::seed_from_u64(1_000 + seed);
        let operands: Vec<Solid> = (0..5).map(|i| solid(shape(&mut rng), i * 100_000)).collect();
        let options = BooleanOptions::new();
        for operation in Operation::ALL {
            let outcome = options.run(operation, &operands).unwrap();
            let error = judge(outcome.solid().mesh(), &format!("seed {seed}, {operation:?}"));
            assert!(error < ERROR, "seed {seed}, {operation:?}: {error:e}");
        }
        let expression: Expression = "a - (b + c) + (d & e)".parse().unwrap();
        let outcome = options.evaluate(&expression, &operands).unwrap();
        assert!(judge(outcome.solid().mesh(), &format!("seed {seed}, expression")) < ERROR);
    }
}

#[test]
fn what_crosses_itself_is_resolved_with_its_values() {
    for seed in 0..12 {
        let mut rng = ChaCha8Rng::seed_from_u64(2_000 + seed);
        let both = Mesh::merged([&shape(&mut rng), &shape(&mut rng)]).unwrap();
        let operand = solid(both, 0);
        let outcome = BooleanOptions::new().resolve(&operand).unwrap();
        assert!(judge(outcome.solid().mesh(), &format!("seed {seed}")) < ERROR);
    }
}

#[test]
fn results_on_a_grid_have_values_to_its_digits() {
    for (grid, error) in [(Grid::Double, ERROR), (Grid::Single, 1e-6)] {
        for seed in 0..12 {
            let mut rng = ChaCha8Rng::seed_from_u64(3_000 + seed);
            let operands = [solid(shape(&mut rng), 0), solid(shape(&mut rng), 100_000)];
            let options = BooleanOptions::new().embed(Embed::OnGrid(grid));
            let outcome = options.run(Operation::Difference, &operands).unwrap();
            let found = judge(outcome.solid().mesh(), &format!("seed {seed}, {grid:?}"));
            assert!(found < error, "seed {seed}, {grid:?}: {found:e}");
        }
    }
}

#[test]
fn both_sides_of_a_cut_agree_to_the_bit() {
    let mut shared = 0;
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(4_000 + seed);
        let operands = [solid(shape(&mut rng), 0), solid(shape(&mut rng), 100_000)];
        let mut known: HashMap<(u64, [u64; 3]), Vec<u64>> = HashMap::new();
        for operation in [Operation::Difference, Operation::Intersection, Operation::Union] {
            let outcome = BooleanOptions::new().run(operation, &operands).unwrap();
            let mesh = outcome.solid().mesh();
            let [face, uv] = ["_FACE", "TEXCOORD_0"].map(|name| mesh.attribute(name).unwrap());
            for (t, triangle) in mesh.triangles.iter().enumerate() {
                for k in 0..3 {
                    let place = mesh.positions[triangle[k] as usize].map(f64::to_bits);
                    let value: Vec<u64> = uv.at(t, k).unwrap().iter().map(|x| x.to_bits()).collect();
                    let key = (face.at(t, k).unwrap()[0].to_bits(), place);
                    if let Some(other) = known.insert(key, value.clone()) {
                        shared += 1;
                        assert_eq!(other, value, "seed {seed}, {operation:?}, triangle {t}");
                    }
                }
            }
        }
    }
    assert!(shared > 10_000, "{shared}");
}

/// Where faces have one map together, new vertices on their edges have one value: no seam arises.
#[test]
fn no_seams_arise() {
    let smooth = |mesh: Mesh| {
        let mut mesh = mesh;
        let mut uv = Attribute::new("TEXCOORD_0", 2);
        uv.of_corner = mesh.triangles.as_flattened().to_vec();
        uv.values = mesh.positions.iter().flat_map(|&p| map(7.0, p)).collect();
        mesh.attributes.push(uv);
        crate::common::solid(mesh)
    };
    let body = smooth(shapes::torus(2.0, 0.7, 40, 20));
    let tool = smooth(primitives::icosphere(0.9, 3).unwrap().translated([2.03, 0.11, 0.07]));
    for operation in Operation::ALL {
        let outcome = BooleanOptions::new().run(operation, [&body, &tool]).unwrap();
        let mesh = outcome.solid().mesh();
        let uv = mesh.attribute("TEXCOORD_0").unwrap();
        let mut of_vertex: HashMap<(u32, u32), u32> = HashMap::new();
        for ((triangle, indices), origin) in
            mesh.triangles.iter().zip(uv.of_corner.chunks(3)).zip(outcome.origins())
        {
            for k in 0..3 {
                let known = of_vertex.insert((origin.operand, triangle[k]), indices[k]);
                assert!(known.is_none_or(|known| known == indices[k]), "{operation:?}: a seam");
            }
        }
    }
}

#[test]
fn an_operation_that_touches_nothing_changes_no_bit() {
    let body = solid(shapes::torus(2.0, 0.7, 40, 20), 0);
    let far = solid(primitives::icosphere(1.0, 2).unwrap().translated([20.0, 0.0, 0.0]), 100_000);
    let outcome = BooleanOptions::new().run(Operation::Difference, [&body, &far]).unwrap();
    assert_eq!(outcome.solid().mesh(), body.mesh());
    let both = BooleanOptions::new().run(Operation::Union, [&body, &far]).unwrap();
    let mesh = both.solid().mesh();
    let (uv, of_body) = (mesh.attribute("TEXCOORD_0").unwrap(), body.mesh().attribute("TEXCOORD_0").unwrap());
    assert_eq!(uv.values[..of_body.values.len()], of_body.values);
    assert_eq!(uv.of_corner[..of_body.of_corner.len()], of_body.of_corner);
    assert_eq!(mesh.attributes[0].of_corner.len(), 3 * mesh.triangles.len());
}

#[test]
fn results_are_the_same_mesh_as_without_attributes() {
    // Where every face has a map of its own, nothing is merged; where one map goes on over a plane, all is as without.
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(5_000 + seed);
        let bare = [shape(&mut rng), shape(&mut rng)];
        let one_map = bare.clone().map(|mesh| crate::common::solid(mapped(mesh, |_| 3.0)));
        let bare = bare.map(crate::common::solid);
        for operation in Operation::ALL {
            let plain = BooleanOptions::new().run(operation, &bare).unwrap();
            let with = BooleanOptions::new().run(operation, &one_map).unwrap();
            let (plain, with) = (plain.solid().mesh(), with.solid().mesh());
            assert_eq!(plain.triangles, with.triangles, "seed {seed}, {operation:?}");
            assert_eq!(plain.positions, with.positions);
            assert!(judge(with, "one map") < ERROR);
        }
    }
}

#[test]
fn corners_are_told_for_data_of_ones_own() {
    for seed in 0..20 {
        let mut rng = ChaCha8Rng::seed_from_u64(6_000 + seed);
        let operands = [shape(&mut rng), shape(&mut rng)].map(crate::common::solid);
        let outcome = BooleanOptions::new().run(Operation::Difference, &operands).unwrap();
        let mesh = outcome.solid().mesh();
        let [a, b] = &operands;
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            for k in 0..3 {
                let from = outcome.corner(&[a, b], t, k).unwrap();
                let of = operands[from.operand as usize].mesh();
                let corners = of.triangles[from.triangle as usize].map(|v| of.positions[v as usize]);
                let sum: f64 = from.weights.iter().sum();
                assert!((sum - 1.0).abs() < 1e-15 && from.weights.iter().all(|w| *w >= 0.0));
                for axis in 0..3 {
                    let place: f64 = (0..3).map(|i| from.weights[i] * corners[i][axis]).sum();
                    let off = place - mesh.positions[triangle[k] as usize][axis];
                    assert!(off.abs() < 1e-14, "seed {seed}, triangle {t}: {off:e}");
                }
            }
        }
        assert_eq!(outcome.corner(&[a, b], mesh.triangles.len(), 0), None);
        assert_eq!(outcome.corner(&[a, b], 0, 3), None);
        assert_eq!(outcome.corner(&[], 0, 0), None);
    }
}

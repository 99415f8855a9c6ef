//! Whole assemblies on the lattice: sponges, stacks of cubes in any order, gears.

use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use trisect::Operation::{Difference, Union};
use trisect::{Mesh, Solid};

use super::convex::{Twin, run};
use crate::common::{cube, cuboid, same_bits};
use crate::judge::cells::{CellSurface, Cells};
use crate::judge::surface::Properties;
use crate::trial::{Expected, Trial, one_in};

/// Asserts that a solid is what cells are, exactly.
fn assert_is(solid: &Solid, cells: &Cells, context: &str) {
    let CellSurface { squares, components, euler, .. } = cells.surface();
    let mut found = Properties::of(solid.mesh());
    // A sum of square roots is not exact even where the surface is.
    found.area = (found.area * 1e9).round() / 1e9;
    let expected = Properties {
        closed: true,
        manifold: true,
        components,
        euler,
        zero_area: 0,
        volume: cells.count() as f64,
        area: squares as f64,
    };
    assert_eq!(found, expected, "{context}");
}

fn in_sponge(mut p: [i64; 3]) -> bool {
    while p.iter().any(|&x| x > 0) {
        if p.iter().filter(|&&x| x % 3 == 1).count() >= 2 {
            return false;
        }
        p = p.map(|x| x / 3);
    }
    true
}

#[test]
fn menger_sponges_bored_one_bar_at_a_time() {
    let _bits = same_bits::group("battery sponges");
    for depth in 1..=2u32 {
        let size = 3i64.pow(depth);
        let mut sponge = cube([0.0; 3], size as f64);
        let mut bars = Vec::new();
        for level in 1..=depth {
            let width = size / 3i64.pow(level);
            for i in 0..3i64.pow(level) {
                for j in 0..3i64.pow(level) {
                    if i % 3 == 1 && j % 3 == 1 {
                        bars.extend((0..3).map(|axis| (axis, [i * width, j * width], width)));
                    }
                }
            }
        }
        bars.shuffle(&mut ChaCha8Rng::seed_from_u64(u64::from(depth)));
        for (axis, [u, v], width) in bars {
            // Flush at both ends: the bar is as long as the cube.
            let (mut low, mut high) = ([0.0; 3], [size as f64; 3]);
            for (k, x) in [((axis + 1) % 3, u), ((axis + 2) % 3, v)] {
                low[k] = x as f64;
                high[k] = (x + width) as f64;
            }
            let bar = cuboid(low, high);
            sponge = same_bits::run(Difference, &[&sponge, &bar]).into_solid();
        }
        assert_is(&sponge, &Cells::new([0; 3], [size; 3], in_sponge), &format!("depth {depth}"));
    }
}

#[test]
fn the_menger_sponge_of_depth_three_in_one_operation() {
    let _bits = same_bits::group("battery sponge of depth 3");
    let size = 27i64;
    let mut operands = vec![cube([0.0; 3], size as f64)];
    for axis in 0..3 {
        let cells = Cells::new([0; 3], [size; 3], |p| {
            let (mut u, mut v) = (p[(axis + 1) % 3], p[(axis + 2) % 3]);
            while u > 0 || v > 0 {
                if u % 3 == 1 && v % 3 == 1 {
                    return true;
                }
                (u, v) = (u / 3, v / 3);
            }
            false
        });
        operands.push(Solid::try_from(cells.surface().mesh).expect("closed"));
    }
    let operands: Vec<&Solid> = operands.iter().collect();
    let sponge = same_bits::run(Difference, &operands);
    assert_is(sponge.solid(), &Cells::new([0; 3], [size; 3], in_sponge), "depth 3");
}

#[test]
fn cubes_of_a_grid_united_in_sampled_orders() {
    let _bits = same_bits::group("battery cubes in sampled orders");
    // Not all 27: after each step the union is some set of cubes, which touch in edges and vertices.
    for seed in (0..40u64).step_by(one_in(4)) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut places: Vec<[i64; 3]> = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]).collect();
        places.shuffle(&mut random);
        let mut sum = Solid::empty();
        for (step, &place) in places.iter().enumerate() {
            let one = cube(place.map(|x| x as f64), 1.0);
            let operands = if random.random() { [&sum, &one] } else { [&one, &sum] };
            sum = same_bits::run(Union, &operands).into_solid();
            let so_far = Cells::new([0; 3], [3; 3], |cell| places[..=step].contains(&cell));
            assert_is(&sum, &so_far, &format!("seed {seed}, step {step}"));
        }
        assert_eq!(sum.mesh().triangles.len(), 12, "seed {seed}");
    }
}

#[test]
fn cubes_of_a_grid_united_in_a_tree_and_all_at_once() {
    let _bits = same_bits::group("battery cubes in trees");
    let cubes: Vec<Solid> =
        (0..27).map(|i| cube([f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)], 1.0)).collect();
    let whole = Cells::new([0; 3], [3; 3], |_| true);
    for seed in 0..6 {
        let mut parts = cubes.clone();
        parts.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
        let operands: Vec<&Solid> = parts.iter().collect();
        let at_once = same_bits::run(Union, &operands);
        assert_is(at_once.solid(), &whole, &format!("seed {seed}, at once"));
        assert_eq!(at_once.solid().mesh().triangles.len(), 12, "seed {seed}");
        while parts.len() > 1 {
            let united = |pair: &[Solid]| {
                let operands: Vec<&Solid> = pair.iter().collect();
                same_bits::run(Union, &operands).into_solid()
            };
            parts = parts.chunks(2).map(united).collect();
        }
        assert_is(&parts[0], &whole, &format!("seed {seed}, tree"));
    }
}

#[test]
fn checkerboards_touch_everywhere() {
    let _bits = same_bits::group("battery checkerboards");
    // Cells that touch one another along edges and in vertices only, against their complement.
    let board = |parity: i64| Cells::new([0; 3], [4; 3], |[x, y, z]| (x + y + z) % 2 == parity);
    let solid = |cells: &Cells| Solid::try_from(cells.surface().mesh).expect("closed");
    let (black, white) = (board(0), board(1));
    let mut trial = Trial::default();
    for operation in crate::judge::cases::OPERATIONS {
        let result = black.combined(operation, &white);
        let surface = result.surface();
        let expected = Expected {
            volume: Some(result.count() as f64),
            area: Some(surface.squares as f64),
            components: Some(surface.components),
            euler: Some(surface.euler),
            ..Expected::default()
        };
        trial.run("checkerboards", operation, [&solid(&black), &solid(&white)], &expected);
    }
    trial.finish(4);
}

/// A gear with so many teeth, its corners rounded to integers.
fn gear(teeth: usize, turned: bool) -> Vec<[f64; 2]> {
    let mut polygon = Vec::new();
    for i in 0..4 * teeth {
        let radius = if (i % 4 < 2) != turned { 1000.0 } else { 800.0 };
        let angle = std::f64::consts::TAU * i as f64 / (4 * teeth) as f64;
        polygon.push([radius * angle.cos(), radius * angle.sin()].map(f64::round));
    }
    polygon
}

#[test]
fn gears() {
    let _bits = same_bits::group("battery gears");
    let mut trial = Trial::default();
    for (teeth, height, by) in [
        (6, 200.0, [0.0, 0.0, 0.0]),
        (9, 200.0, [0.0, 0.0, 100.0]),
        (12, 300.0, [0.0, 0.0, 200.0]),
        (5, 200.0, [900.0, 0.0, 0.0]),
    ] {
        let a = Twin::star(&gear(teeth, false), 200.0, |mesh| mesh);
        // Half a tooth on: the flanks lie on one another.
        let b = Twin::star(&gear(teeth, true), height, |mesh: Mesh| mesh.translated(by));
        run(&mut trial, &format!("gears of {teeth} teeth"), &a, &b);
        let same = Twin::star(&gear(teeth, false), height, |mesh: Mesh| mesh.translated(by));
        run(&mut trial, &format!("equal gears of {teeth} teeth"), &a, &same);
    }
    trial.finish(64);
}

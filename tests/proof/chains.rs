//! Long chains of operations: each result is the next operand. `TRISECT_PROOF=all` runs a thousand steps.

use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use trisect::Operation::{Difference, Intersection, Union};
use trisect::{Mesh, Operation, Solid, primitives};

use crate::common::{cuboid, same_bits, solid};
use crate::judge::cells::Cells;
use crate::judge::oracle;
use crate::judge::placement::{moved, rotated, rotation};
use crate::judge::surface::{Properties, volume};
use crate::trial::one_in;

/// A thousand steps, or so many that the plain test run stays short.
fn steps(usual: usize) -> usize {
    if one_in(2) == 1 { 1000 } else { usual }
}

fn run(operation: Operation, operands: &[&Solid]) -> Solid {
    same_bits::run(operation, operands).into_solid()
}

fn assert_sound(found: &Properties, context: &str) {
    assert!(found.closed && found.manifold && found.zero_area == 0, "{context}: {found:?}");
}

#[test]
fn drilling_square_holes() {
    let _bits = same_bits::group("chain of drilling");
    let steps = steps(250);
    // Places in a grid of 40 columns, in any order; the drill is flush with both faces of the plate.
    let mut places: Vec<usize> = (0..steps).collect();
    places.shuffle(&mut ChaCha8Rng::seed_from_u64(1));
    let size = [2.0 * 40.0 + 1.0, 2.0 * (steps.div_ceil(40) as f64) + 1.0];
    let mut plate = cuboid([0.0; 3], [size[0], size[1], 1.0]);
    for (step, &place) in places.iter().enumerate() {
        let low = [2.0 * (place % 40) as f64 + 1.0, 2.0 * (place / 40) as f64 + 1.0];
        plate = run(Difference, &[&plate, &cuboid([low[0], low[1], 0.0], [low[0] + 1.0, low[1] + 1.0, 1.0])]);
        let holes = step + 1;
        if holes % 10 == 0 || holes == steps {
            let found = Properties::of(plate.mesh());
            assert_sound(&found, &format!("{holes} holes"));
            assert_eq!(found.volume, size[0] * size[1] - holes as f64);
            assert_eq!((found.components, found.euler), (1, 2 - 2 * holes as i64));
            // No more than such a plate must have: 8 vertices and 8 for each hole.
            assert_eq!(plate.mesh().positions.len(), 8 + 8 * holes);
        }
    }
}

#[test]
fn stacking_bricks() {
    let _bits = same_bits::group("chain of stacking");
    let steps = steps(300);
    // Bricks of one by two by one, crosswise and half off one another, as a child would: each touches what is there.
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut cells = Cells::default();
    let mut heap = Solid::empty();
    let mut top = 0;
    for step in 0..steps {
        let (x, y, across) =
            (random.random_range(0..9i64), random.random_range(0..9i64), random.random::<bool>());
        let (width, depth) = if across { (2, 1) } else { (1, 2) };
        let brick_at = |z: i64| Cells::new([x, y, z], [x + width, y + depth, z + 1], |_| true);
        // It falls onto what is there.
        let is_blocked = |z: &i64| !cells.combined(Intersection, &brick_at(*z)).is_empty();
        let height = (0..top).rev().find(is_blocked).map_or(0, |z| z + 1);
        top = top.max(height + 1);
        let low = [x as f64, y as f64, height as f64];
        let brick = cuboid(low, [low[0] + width as f64, low[1] + depth as f64, low[2] + 1.0]);
        heap = run(Union, &[&heap, &brick]);
        cells = cells.combined(Union, &brick_at(height));
        if step % 10 == 9 || step + 1 == steps {
            let found = Properties::of(heap.mesh());
            let surface = cells.surface();
            assert_sound(&found, &format!("{step} bricks"));
            assert_eq!(found.volume, 2.0 * (step + 1) as f64);
            assert!((found.area - surface.squares as f64).abs() < 1e-9);
            assert_eq!((found.components, found.euler), (surface.components, surface.euler), "{step} bricks");
            // Two triangles for each unit square are always enough.
            assert!(heap.mesh().triangles.len() <= 2 * surface.squares, "{step} bricks");
        }
    }
}

/// A tool turned at random at a place.
fn tool(random: &mut ChaCha8Rng, size: f64, at: [f64; 3]) -> Mesh {
    let mesh = match random.random_range(0..3) {
        0 => primitives::cuboid([-size; 3], [size; 3]),
        1 => primitives::octahedron(1.4 * size),
        _ => primitives::icosphere(1.2 * size, 0),
    };
    moved(&rotated(&mesh.expect("a tool"), &rotation(random)), at)
}

#[test]
fn carving_with_tools_that_do_not_meet() {
    let _bits = same_bits::group("chain of carving");
    let steps = steps(150);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let block = solid(primitives::geodesic_sphere(10.0, 8).expect("a ball"));
    let mut places: Vec<[f64; 3]> = Vec::new();
    for x in -10..=10 {
        for y in -10..=10 {
            for z in -10..=10 {
                let p = [x, y, z].map(|c| 1.1 * f64::from(c));
                // Near the surface.
                if (9.0..10.5).contains(&p.iter().map(|c| c * c).sum::<f64>().sqrt()) {
                    places.push(p);
                }
            }
        }
    }
    places.shuffle(&mut random);
    assert!(places.len() >= 1000, "{}", places.len());
    let (mut left, mut expected) = (block.clone(), volume(block.mesh()));
    let mut tools = Vec::new();
    for &at in &places[..steps] {
        let tool = solid(tool(&mut random, 0.3, at));
        left = run(Difference, &[&left, &tool]);
        // What one tool takes does not depend on the others.
        expected -= volume(run(Intersection, &[&block, &tool]).mesh());
        tools.push(tool);
    }
    let found = Properties::of(left.mesh());
    assert_sound(&found, "carved");
    assert!((found.volume - expected).abs() < 1e-9, "{} {expected}", found.volume);
    let operands: Vec<&Mesh> = [&block].into_iter().chain(&tools).map(Solid::mesh).collect();
    let verdict = oracle::judge(Difference, &operands, left.mesh(), 400, 5);
    assert!(verdict.mistakes.is_empty(), "{:?}", verdict.mistakes);
    // Each tool adds its own triangles and what its curve cuts.
    assert!(
        left.mesh().triangles.len() < block.mesh().triangles.len() + 60 * steps,
        "{}",
        left.mesh().triangles.len()
    );
}

#[test]
fn milling_along_a_path() {
    let _bits = same_bits::group("chain of milling");
    let steps = steps(150);
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let block = cuboid([0.0; 3], [20.0, 20.0, 2.0]);
    let mut left = block.clone();
    let (mut at, mut heading) = ([10.0f64, 10.0], 0.0f64);
    let mut tools = Vec::new();
    let mut most = 0;
    for step in 0..steps {
        // Each place of the tool overlaps the one before.
        let bit = primitives::cylinder(0.4, 3.0, 9).expect("a bit");
        let depth = 1.0 + 0.5 * (0.05 * step as f64).sin();
        let bit = solid(bit.translated([at[0], at[1], depth]));
        left = run(Difference, &[&left, &bit]);
        tools.push(bit);
        heading += random.random_range(-0.3..0.3);
        let next = [at[0] + 0.25 * heading.cos(), at[1] + 0.25 * heading.sin()];
        if next.iter().any(|x| !(1.0..19.0).contains(x)) {
            heading += 1.5;
        } else {
            at = next;
        }
        most = most.max(left.mesh().triangles.len());
    }
    let found = Properties::of(left.mesh());
    assert_sound(&found, "milled");
    let operands: Vec<&Mesh> = [&block].into_iter().chain(&tools).map(Solid::mesh).collect();
    let verdict = oracle::judge(Difference, &operands, left.mesh(), 400, 6);
    assert!(verdict.mistakes.is_empty(), "{:?}", verdict.mistakes);
    // The same all at once.
    let all: Vec<&Solid> = [&block].into_iter().chain(&tools).collect();
    let at_once = run(Difference, &all);
    assert!(
        (volume(at_once.mesh()) - found.volume).abs() < 1e-10,
        "{} {}",
        volume(at_once.mesh()),
        found.volume
    );
    assert!(most < 100 * steps, "{most} triangles");
}

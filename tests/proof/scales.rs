//! Sizes far apart, and coordinates far from one: half-spaces as people write them, needles, flat operands, operands in single
//! precision, coordinates of 1e12. Volumes add up to the rounding of the new vertices themselves, by exact sums; where operands
//! are convex, what they share is as large as it exactly is; points next to the smaller operand are on the right side.

use dashu::base::Abs;
use dashu::integer::IBig;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::Operation::{Difference, Intersection, SymmetricDifference, Union};
use trisect::{BooleanOptions, Mesh, Solid, primitives};

use crate::judge::placement::{anywhere, mapped, moved, rotated, rotation};
use crate::judge::vector::Point;
use crate::judge::{surface, wide};

/// A vertex of a result may be off by half a unit in the last place, and what the clean-up took for rounding is up to 64 units.
const ULPS: u32 = 2;
/// Points judged for each pair.
const POINTS: usize = 24;

/// What is wrong with the booleans of a pair; nothing, it is hoped.
fn faults(a: &Mesh, b: &Mesh, are_convex: bool, seed: u64) -> Vec<String> {
    let solids = [a, b].map(|mesh| Solid::try_from(mesh.clone()).expect("closed"));
    let run = |operation, order: [usize; 2]| {
        let operands = order.map(|k| &solids[k]);
        BooleanOptions::new().run(operation, operands).expect("no limits")
    };
    let mut found = Vec::new();
    let all = [
        (Union, [0, 1]),
        (Intersection, [0, 1]),
        (Difference, [0, 1]),
        (Difference, [1, 0]),
        (SymmetricDifference, [0, 1]),
    ];
    let results: Vec<Mesh> = all
        .iter()
        .map(|&(operation, order)| {
            let outcome = run(operation, order);
            let properties = surface_of(outcome.solid().mesh());
            if properties != (true, true) {
                found.push(format!("{operation:?} {order:?}: closed, manifold: {properties:?}"));
            }
            outcome.into_solid().into_mesh()
        })
        .collect();
    // 1. Volumes add up.
    let six = |mesh: &Mesh| wide::six_volumes(mesh);
    let (of_a, of_b) = (six(a), six(b));
    let volumes: Vec<IBig> = results.iter().map(six).collect();
    let slack = |k: usize| wide::six_volumes_of_rounding(&results[k], &[a, b], ULPS);
    let slacks: Vec<IBig> = (0..5).map(slack).collect();
    let mut sum = |name: &str, difference: IBig, slack: IBig| {
        let difference = difference.abs();
        if difference > slack {
            let logarithms = [&difference, &slack].map(wide::logarithm);
            found.push(format!("{name}: off by 1e{:.1}, not 1e{:.1}", logarithms[0], logarithms[1]));
        }
    };
    let [u, i, ab, ba, x] = [0, 1, 2, 3, 4].map(|k| &volumes[k]);
    sum("|A| + |B| = |A u B| + |A n B|", &of_a + &of_b - u - i, &slacks[0] + &slacks[1]);
    sum("|A| = |A - B| + |A n B|", &of_a - ab - i, &slacks[2] + &slacks[1]);
    sum("|B| = |B - A| + |A n B|", &of_b - ba - i, &slacks[3] + &slacks[1]);
    sum("|A xor B| = |A - B| + |B - A|", x - ab - ba, &slacks[4] + &slacks[2] + &slacks[3]);
    if are_convex {
        // A unit for each cone that is rounded.
        sum("|A n B|", wide::six_shared(a, b) - i, &slacks[1] + 100_000);
    }
    // 2. Points are on the right side.
    let mut judged = 0;
    let points = wide::points_beside(a, b, &results, POINTS, seed);
    for (&(operation, order), result) in all.iter().zip(&results) {
        let verdict = wide::judge(operation, order.map(|k| [a, b][k]), result, &points);
        judged += verdict.0;
        found.extend(verdict.1.iter().map(|p| format!("{operation:?} {order:?}: wrong round {p:?}")));
    }
    assert!(judged > 20, "{judged} points judged");
    found
}

fn surface_of(mesh: &Mesh) -> (bool, bool) {
    let properties = surface::Properties::of(mesh);
    (properties.closed, properties.manifold)
}

fn assert_right(cases: impl IntoIterator<Item = (String, Mesh, Mesh, bool)>) {
    let mut failures = Vec::new();
    let mut count = 0;
    for (index, (name, a, b, are_convex)) in cases.into_iter().enumerate() {
        count += 1;
        let faults = faults(&a, &b, are_convex, index as u64);
        failures.extend(faults.into_iter().map(|fault| format!("{name}: {fault}")));
    }
    let text = failures.iter().take(20).map(String::as_str).collect::<Vec<_>>().join("\n");
    assert!(failures.is_empty(), "{} faults in {count} pairs:\n{text}", failures.len());
}

fn ball(radius: f64) -> Mesh {
    primitives::geodesic_sphere(radius, 2).expect("a ball")
}

fn cuboid(low: Point, high: Point) -> Mesh {
    primitives::cuboid(low, high).expect("a box")
}

/// Multiplied by a number; exact for powers of two.
fn times(mesh: &Mesh, factor: f64) -> Mesh {
    mapped(mesh, false, |p| p.map(|x| x * factor))
}

/// Sizes of the boxes that stand for half-spaces: from the ball's own to nearly the largest there is, the largest number in
/// single precision among them.
const SIZES: [f64; 9] = [4e4, 1e6, 1e9, 1e12, 1e16, 1e20, 3.4e38, 1e100, 1e300];

#[test]
fn half_spaces_as_people_write_them() {
    const RADIUS: f64 = 25_400.0;
    let mut cases = Vec::new();
    for size in SIZES {
        // One face, two (an edge) or three (a corner) through the ball; each face once.
        for (axes, at) in
            [([2, 3, 3], -100.0), ([0, 3, 3], 7_000.0), ([0, 1, 3], 100.0), ([0, 1, 2], -2_000.0)]
        {
            for from_below in [true, false] {
                let (mut low, mut high) = ([-size; 3], [size; 3]);
                for axis in axes.into_iter().filter(|&axis| axis < 3) {
                    if from_below { high[axis] = at } else { low[axis] = at }
                }
                let name = format!("a box of {size:e}, {axes:?} from {at}");
                cases.push((name, cuboid(low, high), ball(RADIUS), true));
            }
        }
    }
    assert_right(cases);
}

/// The columns of three times a rotation, in integers.
const TURNED: [Point; 3] = [[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]];

#[test]
fn half_spaces_turned() {
    let mut cases = Vec::new();
    for exponent in [10, 40, 100, 130, 400, 1000] {
        let size = 2f64.powi(exponent);
        for corner in 0..4 {
            // A face, an edge or a corner of the box exactly at the origin; the ball beside it.
            let low = [0, 1, 2].map(|k| if k < corner { 0.0 } else { -1.0 });
            let unit = cuboid(low, [1.0, 1.0, 1.0]);
            let turned = mapped(&unit, false, |p| {
                [0, 1, 2].map(|k| size * (0..3).map(|j| TURNED[k][j] * p[j]).sum::<f64>())
            });
            let ball = moved(&ball(2.0), [0.25, -0.125, 0.5]);
            cases.push((format!("2^{exponent}, {corner} faces at the origin"), turned, ball, true));
        }
    }
    assert_right(cases);
}

#[test]
fn sizes_apart() {
    let mut random = ChaCha8Rng::seed_from_u64(1_401);
    let mut cases = Vec::new();
    for power in [1, 3, 6, 9, 12, 15, 18, 30, 60, 100, 150, 200, 250, 290] {
        for _ in 0..3 {
            let factor = 10f64.powi(power);
            let small = anywhere(&primitives::octahedron(1.0).expect("a shape"), 0.2, &mut random);
            // Large tetrahedra of which some face passes near the origin: a corner there, or not far off.
            let large = loop {
                let mut corners = [0; 4].map(|_| [0; 3].map(|_| factor * random.random_range(-1.0..1.0)));
                corners[0] = [0; 3].map(|_| random.random_range(-0.5..0.5));
                if let Ok(mesh) = primitives::tetrahedron(corners)
                    && Solid::try_from(mesh.clone()).is_ok()
                {
                    break mesh;
                }
            };
            // Moved down in size, so that the largest stays finite.
            let down = 2f64.powi(-random.random_range(0..200));
            cases.push((format!("1e{power}"), times(&large, down), times(&small, down), true));
        }
    }
    assert_right(cases);
}

#[test]
fn needles_and_flat_operands() {
    let mut random = ChaCha8Rng::seed_from_u64(1_402);
    let mut cases = Vec::new();
    for _ in 0..12 {
        let body = anywhere(&ball(1.0), 0.1, &mut random);
        let needle = anywhere(&cuboid([-1.0, -1e-6, -1e-6], [1.0, 1e-6, 1e-6]), 0.2, &mut random);
        let tilted = anywhere(&cuboid([-3.0, -3e-6, -1e-3], [1.0, 3e-6, 1e-3]), 0.2, &mut random);
        let flat = anywhere(&cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1e-9]), 0.1, &mut random);
        cases.push(("a needle in a ball".into(), body.clone(), needle.clone(), false));
        cases.push(("a needle in a needle".into(), needle, tilted.clone(), false));
        cases.push(("a needle through a sheet".into(), tilted, flat.clone(), false));
        cases.push(("a sheet through a ball".into(), body, flat, false));
    }
    assert_right(cases);
}

#[test]
fn single_precision_and_far_away() {
    let mut random = ChaCha8Rng::seed_from_u64(1_403);
    let single = |mesh: &Mesh| mapped(mesh, false, |p| p.map(|x| f64::from(x as f32)));
    let mut cases = Vec::new();
    for _ in 0..12 {
        let matrix = rotation(&mut random);
        let body = rotated(&cuboid([-1.0; 3], [1.0; 3]), &matrix);
        // Flush before it was turned and rounded.
        let tool = rotated(&cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]), &matrix);
        cases.push(("single precision".into(), single(&body), single(&tool), false));
        let by = [1e12, -3e12, 2e12];
        cases.push(("about 1e12".into(), moved(&ball(1.0), by), moved(&body, by), false));
        cases.push(("about 1e12, flush".into(), moved(&body, by), moved(&tool, by), false));
    }
    assert_right(cases);
}

#[test]
fn a_corner_of_something_huge_passes_through_a_hole() {
    // All three faces at the corner cut a torus, and one of them all around its hole; the far corners are so far that the squares of
    // heights beside them vanish, and those of areas overflow.
    let torus = primitives::torus(0.6, 0.2, 12, 10).expect("a torus");
    let mut cases = Vec::new();
    for size in [1e12, 1e100, 1e160, 1e189, 1e280] {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for k in 0..3 {
            let matrix = rotation(&mut rng);
            let corner = Mesh::new(
                vec![
                    [0.11, -0.4, 0.35],
                    [-0.5 * size, 3.2 * size, -2.6 * size],
                    [-0.2 * size, -size, -2.9 * size],
                    [-4.0 * size, 2.0 * size, -2.8 * size],
                ],
                vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            );
            cases.push((format!("{size:e} {k}"), corner, rotated(&torus, &matrix), false));
        }
    }
    assert_right(cases);
}

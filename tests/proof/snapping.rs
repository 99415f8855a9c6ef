//! Snapping: what is flush, but for a distance, is exactly flush afterwards; nothing else changes; what was moved is told.
//!
//! Bodies of small boxes are placed by k * 0.1, or turned together, or moved apart by less than the distance, and judged by the
//! cells of the integers that they stand for. Seeds are printed where a case fails.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{BooleanOptions, Control, Mesh, Operation, Solid, primitives};

/// Boxes of the integers in one mesh, each corner where `place` says.
fn boxes(boxes: &[[[i32; 3]; 2]], mut place: impl FnMut([f64; 3]) -> [f64; 3]) -> Solid {
    let mut mesh = Mesh::default();
    for [low, high] in boxes {
        let part = primitives::cuboid(low.map(f64::from), high.map(f64::from)).unwrap();
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(part.positions.iter().map(|p| place(*p)));
        mesh.triangles.extend(part.triangles.iter().map(|corners| corners.map(|v| v + first)));
    }
    Solid::try_from(mesh).unwrap()
}

fn random_boxes(rng: &mut ChaCha8Rng, count: usize) -> Vec<[[i32; 3]; 2]> {
    let one = |rng: &mut ChaCha8Rng| {
        let (mut low, mut high) = ([0; 3], [0; 3]);
        for k in 0..3 {
            low[k] = rng.random_range(0..5);
            high[k] = rng.random_range(low[k] + 1..=6);
        }
        [low, high]
    };
    (0..count).map(|_| one(rng)).collect()
}

/// The volume and the area of a set of cells.
fn of_cells(is_in: impl Fn([i32; 3]) -> bool) -> (f64, f64) {
    let (mut volume, mut area) = (0, 0);
    for i in 0..512 {
        let cell = [i % 8 - 1, i / 8 % 8 - 1, i / 64 - 1];
        let here = is_in(cell);
        volume += i32::from(here);
        for axis in 0..3 {
            let mut beyond = cell;
            beyond[axis] += 1;
            area += i32::from(is_in(beyond) != here);
        }
    }
    (f64::from(volume), f64::from(area))
}

fn contain(boxes: &[[[i32; 3]; 2]], cell: [i32; 3]) -> bool {
    boxes.iter().any(|[low, high]| (0..3).all(|k| low[k] <= cell[k] && cell[k] < high[k]))
}

const OPERATIONS: [Operation; 4] =
    [Operation::Union, Operation::Intersection, Operation::Difference, Operation::SymmetricDifference];

fn combined(operation: Operation, a: bool, b: bool) -> bool {
    match operation {
        Operation::Union => a || b,
        Operation::Intersection => a && b,
        Operation::Difference => a && !b,
        _ => a != b,
    }
}

#[test]
fn what_is_flush_but_for_rounding_becomes_flush() {
    for seed in 0..60 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let counts = [0; 2].map(|_| rng.random_range(1..4));
        let [a, b] = counts.map(|count| random_boxes(&mut rng, count));
        let kind = rng.random_range(0..4);
        let mut noise = ChaCha8Rng::seed_from_u64(seed);
        // A tenth, turned together, off by up to 1e-7 in each corner, or turned together and in single precision.
        let (distance, scale): (f64, f64) = [(1e-12, 0.1), (1e-12, 1.0), (1e-6, 1.0), (1e-5, 1.0)][kind];
        let turned = |[x, y, z]: [f64; 3]| {
            let (s, c) = 0.7345f64.sin_cos();
            let [x, y] = [c * x - s * y, s * x + c * y];
            let (s, c) = 0.31f64.sin_cos();
            [c * x - s * z, y, s * x + c * z]
        };
        let mut place = |p: [f64; 3]| match kind {
            0 => p.map(|x| x * 0.1),
            1 => turned(p),
            2 => p.map(|x| x + noise.random_range(-1e-7..1e-7)),
            _ => turned(p).map(|x| f64::from(x as f32)),
        };
        let solids = [boxes(&a, &mut place), boxes(&b, &mut place)];
        for operation in OPERATIONS {
            let context = format!("seed {seed}, kind {kind}, {operation}");
            let outcome = BooleanOptions::new().snap(distance).run(operation, &solids).unwrap();
            let (volume, area) = of_cells(|cell| combined(operation, contain(&a, cell), contain(&b, cell)));
            let certificate = outcome.certificate();
            assert!(certificate.closed && certificate.manifold, "{context}: {certificate:?}");
            let snapping = certificate.snapping.expect("it was asked for");
            assert!(snapping.farthest <= distance && !snapping.unfinished, "{context}: {snapping:?}");
            let [volume, area] = [volume * scale.powi(3), area * scale.powi(2)];
            let slack = 200.0 * scale * scale * distance;
            let solid = outcome.solid();
            assert!((solid.volume() - volume).abs() <= slack, "{context}: {} for {volume}", solid.volume());
            // Films and gaps would have twice their area.
            let right = (solid.area() - area).abs() <= slack / scale;
            assert!(right, "{context}: {} for {area} {certificate:?}", solid.area());
            assert!(solid.self_crossings(&Control::new()).unwrap().is_clean(), "{context}");
            let triangles = solid.mesh().triangles.len();
            assert_eq!(outcome.origins().len(), triangles);
            let of_operand =
                |origin: &trisect::Origin| solids[origin.operand as usize].mesh().triangles.len();
            assert!(outcome.origins().iter().all(|origin| (origin.triangle as usize) < of_operand(origin)));
        }
    }
}

#[test]
fn bars_turned_in_single_precision_are_united_as_if_they_were_not() {
    // Three layers of bars that cross in three directions, as a scaffold.
    let bars = || {
        let bar = |axis: usize, i: i32, j: i32| {
            let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
            for (k, (from, to)) in [(-1, 10), (3 * i, 3 * i + 1), (3 * j, 3 * j + 1)].into_iter().enumerate()
            {
                (low[(axis + k) % 3], high[(axis + k) % 3]) = (f64::from(from), f64::from(to));
            }
            primitives::cuboid(low, high).unwrap()
        };
        (0..27).map(move |n| bar(n / 9, n as i32 / 3 % 3, n as i32 % 3))
    };
    let united = |meshes: Vec<Mesh>, snap: Option<f64>| {
        let solids: Vec<Solid> = meshes.into_iter().map(|mesh| Solid::try_from(mesh).unwrap()).collect();
        let options = snap.map_or_else(BooleanOptions::new, |distance| BooleanOptions::new().snap(distance));
        options.run(Operation::Union, &solids).unwrap()
    };
    let turned = || {
        bars().map(|bar| {
            let mut bar = bar.rotated([1.0, 2.0, 3.0], 42.0).unwrap();
            bar.positions.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
            bar
        })
    };
    let plain = united(bars().collect(), None);
    let exact = united(turned().collect(), None);
    let snapped = united(turned().collect(), Some(1e-5));
    let count = |outcome: &trisect::Outcome| outcome.solid().mesh().triangles.len();
    assert!(count(&exact) > 2 * count(&plain), "{} for {}", count(&exact), count(&plain));
    assert!(count(&snapped) <= count(&plain) * 11 / 10, "{} for {}", count(&snapped), count(&plain));
    assert_eq!((snapped.solid().components(), snapped.solid().genus()), (1, plain.solid().genus()));
    assert!((snapped.solid().volume() - plain.solid().volume()).abs() < 1e-4);
    assert!(snapped.solid().self_crossings(&Control::new()).unwrap().is_clean());
    // The same in one file, which lies on itself.
    let all = united(vec![Mesh::merged(&turned().collect::<Vec<_>>()).unwrap()], Some(1e-5));
    assert_eq!(all.solid().genus(), plain.solid().genus());
    assert!(count(&all) <= count(&plain) * 11 / 10, "{} for {}", count(&all), count(&plain));
}

#[test]
fn an_opening_a_hair_short_goes_through() {
    let plate = Solid::try_from(primitives::cuboid([0.0; 3], [4.0, 4.0, 1.0]).unwrap()).unwrap();
    let short =
        Solid::try_from(primitives::cuboid([1.0, 1.0, 1e-7], [3.0, 3.0, 1.0 - 1e-7]).unwrap()).unwrap();
    let exact = plate.difference(&short).unwrap();
    assert_eq!((exact.solid().components(), exact.solid().genus()), (2, Some(0)));
    let snapped = BooleanOptions::new().snap(1e-6).run(Operation::Difference, [&plate, &short]).unwrap();
    assert_eq!((snapped.solid().components(), snapped.solid().genus()), (1, Some(1)));
    assert_eq!(snapped.solid().volume(), 12.0);
    let snapping = snapped.certificate().snapping.unwrap();
    assert!(snapping.moved > 0 && snapping.farthest <= 1e-6, "{snapping:?}");
    // What is no larger than the distance vanishes, and that is told.
    let none = BooleanOptions::new().snap(5.0).run(Operation::Difference, [&plate, &short]).unwrap();
    let snapping = none.certificate().snapping.unwrap();
    assert!(none.solid().is_empty() && (snapping.vanished, snapping.collapsed) == (2, 24), "{snapping:?}");
    // Nothing is snapped unasked, and nothing that is further apart.
    let exact_again = BooleanOptions::new().snap(1e-9).run(Operation::Difference, [&plate, &short]).unwrap();
    assert!(exact_again.solid() == exact.solid());
    assert!(exact.certificate().snapping.is_none());
}

#[test]
fn round_bodies_that_nothing_is_near_stay_as_they_are() {
    let ball = |x: f64| {
        let ball = primitives::geodesic_sphere(1.0, 12).unwrap().rotated([1.0, 2.0, 3.0], 40.0 * x).unwrap();
        Solid::try_from(ball.translated([x, 0.01, 0.02])).unwrap()
    };
    let operands = [ball(0.0), ball(0.813)];
    for operation in OPERATIONS {
        let exact = BooleanOptions::new().run(operation, &operands).unwrap();
        let snapped = BooleanOptions::new().snap(1e-13).run(operation, &operands).unwrap();
        assert!(snapped.solid() == exact.solid(), "{operation}");
        assert!(snapped.origins() == exact.origins(), "{operation}");
    }
}

#[test]
fn large_distances_leave_closed_surfaces() {
    // Bodies whose own edges are shorter than the distance: they lose triangles, or vanish, and what is left is closed.
    for seed in 0..4 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut body = || {
            let body = primitives::geodesic_sphere(1.0, 6).unwrap();
            let by = [0; 3].map(|_| rng.random_range(-0.5..0.5));
            Solid::try_from(body.translated(by)).unwrap()
        };
        let operands = [body(), body()];
        for distance in [0.01, 0.3, 5.0] {
            let snap = BooleanOptions::new().snap(distance);
            let outcome = snap.run(Operation::Union, &operands).unwrap();
            let certificate = outcome.certificate();
            assert!(certificate.closed, "seed {seed}, {distance}");
            let snapping = certificate.snapping.unwrap();
            let most = f64::from(2 * snapping.rounds + 1) * distance;
            assert!(snapping.farthest <= most, "seed {seed}, {distance}: {snapping:?}");
        }
    }
}

#[test]
fn distances_that_are_none_are_refused() {
    let cube = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3]).unwrap()).unwrap();
    for distance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = BooleanOptions::new().snap(distance).run(Operation::Union, [&cube]);
        assert!(refused.unwrap_err().to_string().contains("positive and finite"));
    }
}

//! The decisions: nanoseconds for one `orient3d`, order or position of crossings, by how hard the input is.
//!
//! Each benchmark runs through a thousand inputs, so that branches are predicted as in earnest; throughput is in decisions.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use trisect::exact::perturbed::{self, PerturbedPoint, jitter};
use trisect::exact::{order, orient3d, position};

const COUNT: usize = 1000;

type Point = [f64; 3];

/// How points lie: anywhere, nearly or exactly in a plane that is askew, or on a grid of small integers in one plane.
#[derive(Clone, Copy)]
enum Lie {
    General,
    NearlyPlane,
    Grid,
}

fn point(lie: Lie, random: &mut ChaCha8Rng) -> Point {
    let [x, y, z]: Point = std::array::from_fn(|_| random.random_range(-1.0..1.0));
    match lie {
        Lie::General => [x, y, z],
        Lie::NearlyPlane => [x, y, (0.3 * x + 0.7 * y) * (1.0 + 2.0 * f64::EPSILON * z)],
        Lie::Grid => [(x * 100.0).round(), (y * 100.0).round(), 7.0],
    }
}

fn perturbed_point(lie: Lie, random: &mut ChaCha8Rng, index: u64) -> PerturbedPoint {
    let first = std::array::from_fn(|_| random.random_range(-511..512));
    PerturbedPoint { position: point(lie, random), first, second: jitter(index) }
}

fn orientation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("orient3d");
    group.throughput(Throughput::Elements(COUNT as u64));
    for (name, lie) in [("general", Lie::General), ("nearly_plane", Lie::NearlyPlane), ("grid", Lie::Grid)] {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let plain: Vec<[Point; 4]> =
            (0..COUNT).map(|_| std::array::from_fn(|_| point(lie, &mut random))).collect();
        group.bench_function(format!("plain/{name}"), |bencher| {
            bencher.iter(|| {
                plain
                    .iter()
                    .filter(|[a, b, c, d]| orient3d(a, b, c, d) == trisect::exact::Sign::Positive)
                    .count()
            });
        });
        let moving: Vec<[PerturbedPoint; 4]> = (0..COUNT as u64)
            .map(|i| std::array::from_fn(|k| perturbed_point(lie, &mut random, 4 * i + k as u64)))
            .collect();
        group.bench_function(format!("perturbed/{name}"), |bencher| {
            bencher.iter(|| {
                let positive = |[a, b, c, d]: &&[PerturbedPoint; 4]| {
                    perturbed::orient3d([a, b, c, d]) == trisect::exact::Sign::Positive
                };
                moving.iter().filter(positive).count()
            });
        });
    }
    group.finish();
}

/// An edge and two triangles that it crosses.
type Crossed = ([PerturbedPoint; 2], [[PerturbedPoint; 3]; 2]);

fn crossed(random: &mut ChaCha8Rng, index: u64) -> Crossed {
    let mut identity = 8 * index;
    let mut at = |x: f64, random: &mut ChaCha8Rng| {
        identity += 1;
        let mut made = perturbed_point(Lie::General, random, identity);
        made.position[0] = x + 0.2 * made.position[0];
        made
    };
    let edge = [at(-2.0, random), at(2.0, random)];
    let triangles = [-0.5, 0.5].map(|x| std::array::from_fn(|_| at(x, random)));
    (edge, triangles)
}

fn crossings(criterion: &mut Criterion) {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let inputs: Vec<Crossed> = (0..COUNT as u64).map(|i| crossed(&mut random, i)).collect();
    let mut group = criterion.benchmark_group("crossing");
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function("position/filter", |bencher| {
        bencher.iter(|| {
            for ([p, q], [t, _]) in &inputs {
                let corners = [&t[0].position, &t[1].position, &t[2].position];
                black_box(position::crossing_filter(&p.position, &q.position, corners));
            }
        });
    });
    group.bench_function("position/exact", |bencher| {
        bencher.iter(|| {
            for ([p, q], [t, _]) in &inputs {
                black_box(position::crossing(p, q, [&t[0], &t[1], &t[2]]));
            }
        });
    });
    group.bench_function("order/filter", |bencher| {
        bencher.iter(|| {
            for ([p, q], triangles) in &inputs {
                let [first, second] =
                    [0, 1].map(|i: usize| [0, 1, 2].map(|k: usize| &triangles[i][k].position));
                black_box(order::compare_filter(&p.position, &q.position, first, second, true, true));
            }
        });
    });
    group.bench_function("order/exact", |bencher| {
        bencher.iter(|| {
            for ([p, q], triangles) in &inputs {
                let [first, second] = [0, 1].map(|i: usize| [0, 1, 2].map(|k: usize| &triangles[i][k]));
                black_box(order::compare(p, q, first, second));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, orientation, crossings);
criterion_main!(benches);

//! The decisions: nanoseconds for one `orient3d` or `orient2d`, by how hard the input is.
//!
//! Each benchmark runs through a thousand inputs, so that branches are predicted no better than in use; throughput is in
//! decisions.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use trisect::exact::{Sign, orient2d, orient3d, orient3d_perturbed};

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

fn orientation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("orient3d");
    group.throughput(Throughput::Elements(COUNT as u64));
    for (name, lie) in [("general", Lie::General), ("nearly_plane", Lie::NearlyPlane), ("grid", Lie::Grid)] {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let plain: Vec<[Point; 4]> =
            (0..COUNT).map(|_| std::array::from_fn(|_| point(lie, &mut random))).collect();
        group.bench_function(format!("plain/{name}"), |bencher| {
            bencher
                .iter(|| plain.iter().filter(|[a, b, c, d]| orient3d(a, b, c, d) == Sign::Positive).count());
        });
        let directions: Vec<[[i32; 3]; 4]> = (0..COUNT)
            .map(|_| std::array::from_fn(|_| std::array::from_fn(|_| random.random_range(-511..512))))
            .collect();
        group.bench_function(format!("perturbed/{name}"), |bencher| {
            bencher.iter(|| {
                let positive = |(points, directions): &(&[Point; 4], &[[i32; 3]; 4])| {
                    orient3d_perturbed(points.each_ref(), **directions) == Sign::Positive
                };
                plain.iter().zip(&directions).filter(positive).count()
            });
        });
    }
    group.finish();
}

fn plane_orientation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("orient2d");
    group.throughput(Throughput::Elements(COUNT as u64));
    for (name, lie) in [("general", Lie::General), ("grid", Lie::Grid)] {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let points: Vec<[Point; 3]> =
            (0..COUNT).map(|_| std::array::from_fn(|_| point(lie, &mut random))).collect();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let flat = |[x, y, _]: Point| [x, y];
                let left = |[a, b, c]: &&[Point; 3]| orient2d(flat(*a), flat(*b), flat(*c)) == Sign::Positive;
                points.iter().filter(left).count()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, orientation, plane_orientation);
criterion_main!(benches);

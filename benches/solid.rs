//! The gate: what it costs to make a solid of a mesh. `RAYON_NUM_THREADS=1 cargo bench --bench solid` for one thread.
//!
//! Throughput is in triangles. Cloning the mesh and dropping the solid are not timed.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use rand::seq::SliceRandom;
use rand::{SeedableRng, rngs::ChaCha8Rng};
use trisect::mesh::diagnose;
use trisect::{Control, Mesh, Solid, primitives};

/// The same mesh with its vertices and triangles in random order: the worst for caches.
fn shuffled(mesh: &Mesh) -> Mesh {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.shuffle(&mut random);
    let mut positions = mesh.positions.clone();
    for (&target, &position) in order.iter().zip(&mesh.positions) {
        positions[target as usize] = position;
    }
    let mut triangles: Vec<_> =
        mesh.triangles.iter().map(|triangle| triangle.map(|corner| order[corner as usize])).collect();
    triangles.shuffle(&mut random);
    Mesh::new(positions, triangles)
}

/// The same mesh with three vertices of its own for every triangle, as STL has it.
fn soup(mesh: &Mesh) -> Mesh {
    let corners = mesh.triangles.iter().flatten();
    let positions: Vec<_> = corners.map(|&corner| mesh.positions[corner as usize]).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]);
    Mesh::new(positions, triangles.collect())
}

fn gate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gate");
    group.sample_size(20);
    for level in [7, 8] {
        let sphere = primitives::icosphere(1.0, level).expect("the level is small");
        let meshes = [("sphere", sphere.clone()), ("shuffled", shuffled(&sphere)), ("soup", soup(&sphere))];
        group.throughput(Throughput::Elements(sphere.triangles.len() as u64));
        for (name, mesh) in meshes {
            group.bench_function(format!("{name}/{}", mesh.triangles.len()), |bencher| {
                bencher.iter_batched(|| mesh.clone(), Solid::try_from, BatchSize::LargeInput);
            });
        }
    }
    group.finish();
}

fn measures(criterion: &mut Criterion) {
    let mesh = primitives::icosphere(1.0, 7).expect("the level is small");
    let mut group = criterion.benchmark_group("measure");
    group.sample_size(10).throughput(Throughput::Elements(mesh.triangles.len() as u64));
    group.bench_function("volume", |bencher| bencher.iter(|| mesh.volume()));
    group.bench_function("area", |bencher| bencher.iter(|| mesh.area()));
    group.bench_function("diagnose", |bencher| bencher.iter(|| diagnose(&mesh)));
    group.bench_function("oriented", |bencher| {
        bencher.iter_batched(|| mesh.clone(), Mesh::oriented, BatchSize::LargeInput);
    });
    group.finish();
}

/// What the program asks of every operand, of a solid that nobody has asked anything yet.
fn facts(criterion: &mut Criterion) {
    let sphere = primitives::icosphere(1.0, 7).expect("the level is small");
    let solid = Solid::try_from(sphere).expect("closed");
    let mut group = criterion.benchmark_group("facts");
    group.sample_size(10).throughput(Throughput::Elements(solid.mesh().triangles.len() as u64));
    let control = Control::new();
    group.bench_function("self-crossings", |bencher| {
        bencher.iter_batched(
            || solid.clone(),
            |solid| solid.self_crossings(&control).map(|found| found.count),
            BatchSize::LargeInput,
        );
    });
    group.bench_function("shells", |bencher| {
        bencher.iter_batched(|| solid.clone(), |solid| solid.components(), BatchSize::LargeInput);
    });
    group.finish();
}

criterion_group!(benches, gate, measures, facts);
criterion_main!(benches);

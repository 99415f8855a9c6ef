//! Whole operations on solids, on one thread and, where that can help, on all.
//!
//! `cargo bench --bench boolean` for all, `cargo bench --bench boolean -- one/spheres` for some. Throughput is in triangles
//! of the operands. The comparison with other engines is in `benches/compare`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use trisect::Operation::{Difference, Union};
use trisect::{BooleanOptions, Operation, Solid};

mod shapes;

/// A name, how its operands are made and combined, and whether more threads can help.
type Case = (&'static str, fn() -> Vec<Solid>, Operation, bool);

const CASES: [Case; 20] = [
    ("spheres/20k", || shapes::spheres(5), Union, true),
    ("spheres/80k", || shapes::spheres(6), Union, true),
    ("spheres/330k", || shapes::spheres(7), Union, true),
    ("local/330k", || shapes::local(7), Difference, true),
    ("local/1.3M", || shapes::local(8), Difference, true),
    ("bumpy/80k", || shapes::bumpy(6), Union, true),
    ("bumpy/330k", || shapes::bumpy(7), Union, true),
    ("menger/2", || shapes::menger(2), Difference, false),
    ("menger/3", || shapes::menger(3), Difference, true),
    ("cubes/1000", || shapes::cubes(10), Union, true),
    ("crowd/200", || shapes::crowd(200), Union, true),
    ("knot/short", || shapes::knot_and_cylinders(50, 0.75), Difference, true),
    ("knot/long", || shapes::knot_and_cylinders(10, 6.0), Difference, true),
    ("tiny", shapes::tiny, Difference, false),
    ("needles/1000", || shapes::needles(1000), Union, true),
    ("fans/1000", || shapes::fans(1000), Union, true),
    ("urchins/5k", || shapes::urchins(4), Union, true),
    ("crossing/few", || shapes::pimpled(7), Difference, true),
    ("crossing/none", || shapes::smooth(7), Difference, true),
    ("crossing/two", || shapes::doubled(7), Union, true),
];

fn operations(criterion: &mut Criterion) {
    for (name, make, operation, parallel) in CASES {
        let mut operands = None;
        for (threads, options) in [("one", BooleanOptions::new().threads(1)), ("all", BooleanOptions::new())]
        {
            if threads == "all" && !parallel {
                continue;
            }
            let mut group = criterion.benchmark_group(threads);
            group.sample_size(10);
            group.bench_function(name, |bencher| {
                // Only if the filter lets the case through.
                let solids = operands.get_or_insert_with(make);
                bencher.iter_with_large_drop(|| options.run(operation, &*solids).expect("no limits"));
            });
            group.finish();
        }
    }
}

/// From a mesh to a mesh: making the solids (with all checks), the operation, the result's mesh.
fn from_meshes(criterion: &mut Criterion) {
    for (name, make, operation, _) in CASES {
        let mut operands = None;
        let mut group = criterion.benchmark_group("from_meshes");
        group.sample_size(10);
        group.bench_function(name, |bencher| {
            let solids = operands.get_or_insert_with(make);
            let meshes: Vec<_> = solids.iter().map(|solid| solid.mesh().clone()).collect();
            bencher.iter_batched(
                || meshes.clone(),
                |meshes| {
                    let solids: Vec<Solid> = meshes
                        .into_iter()
                        .map(|mesh| Solid::try_from(mesh).expect("a solid's mesh"))
                        .collect();
                    let made = BooleanOptions::new().threads(1).run(operation, &solids).expect("no limits");
                    made.into_solid().into_mesh()
                },
                criterion::BatchSize::PerIteration,
            );
        });
        group.finish();
    }
}

/// What comes after: the certificate and the curves; and the check of an operand for crossings with itself.
fn around(criterion: &mut Criterion) {
    let spheres = shapes::spheres(7);
    let made = BooleanOptions::new().run(Union, &spheres).expect("no limits");
    let mut group = criterion.benchmark_group("around");
    group.sample_size(10).throughput(Throughput::Elements(made.solid().mesh().triangles.len() as u64));
    group.bench_function("certificate/330k", |bencher| {
        bencher.iter_batched(
            || made.clone(),
            |made| made.certificate().volume,
            criterion::BatchSize::LargeInput,
        );
    });
    group.bench_function("curves/330k", |bencher| bencher.iter(|| made.curves().len()));
    group.bench_function("self_crossings/330k", |bencher| {
        bencher.iter_batched(
            // (A copy of a solid that has been looked through would know the answer.)
            || Solid::try_from(spheres[0].mesh().clone()).expect("closed"),
            |solid| solid.self_crossings(&trisect::Control::new()).expect("no limits").count,
            criterion::BatchSize::LargeInput,
        );
    });
    group.finish();
    // Caps fanned from their centres: the time for a side must not grow with the sides.
    let mut group = criterion.benchmark_group("self_crossings of fan cylinders");
    group.sample_size(10);
    for sides in [64, 512, 4096, 8192] {
        let solid = shapes::fan_cylinder(sides);
        group.throughput(Throughput::Elements(u64::from(sides)));
        group.bench_function(sides.to_string(), |bencher| {
            bencher.iter_batched(
                || solid.clone(),
                |solid| solid.self_crossings(&trisect::Control::new()).expect("no limits").count,
                criterion::BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, operations, from_meshes, around);
criterion_main!(benches);

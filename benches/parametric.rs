//! Meshing speed of curves and patches, regions, joining; and triangle counts against a uniform grid whose sampled
//! deviation is the same. `cargo bench --bench parametric`; the table of counts comes first.
#![allow(clippy::print_stdout, reason = "the table of triangle counts")]
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

#[path = "../tests/common/planar.rs"]
mod planar;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use trisect::parametric::json::{named_patches, parse};
use trisect::parametric::{
    Bezier, CurveJoin, CurveMeshing, EllipticArc, JointAt, Patch, PatchMeshing, Refinement, Region,
    SharedCurve,
};

fn aircraft() -> Vec<Patch> {
    let value = parse(include_str!("../examples/parametric/aircraft.json")).expect("a sound file");
    named_patches(&value).expect("sound patches").into_iter().map(|named| named.1).collect()
}

/// A sheet with one steep bump in an otherwise nearly flat bicubic surface.
fn bump() -> Patch {
    let height = |i: usize, j: usize| if (i, j) == (2, 2) { 3.0 } else { 0.0 };
    let rows: Vec<Vec<[f64; 3]>> =
        (0..9).map(|i| (0..9).map(|j| [i as f64, j as f64, height(i, j)]).collect()).collect();
    let mut knots = vec![0.0; 3];
    knots.extend((0..=6).map(|i| i as f64));
    knots.extend([6.0; 3]);
    Patch::bspline([3, 3], [&knots, &knots], &rows).expect("a sound patch")
}

fn cases() -> Vec<(&'static str, Vec<Patch>)> {
    vec![
        ("aircraft", aircraft()),
        ("sphere", vec![Patch::sphere([0.0; 3], 1.0).expect("a sphere")]),
        ("torus", vec![Patch::torus([0.0; 3], 2.0, 0.5).expect("a torus")]),
        ("cylinder", vec![Patch::cylinder([0.0; 3], 1.0, 5.0).expect("a cylinder")]),
        ("bump", vec![bump()]),
    ]
}

/// Greatest sampled distance of the patch from the triangles of a uniform grid.
fn grid_deviation(patch: &Patch, n: usize, m: usize) -> f64 {
    let [[u0, u1], [v0, v1]] = patch.domain();
    let point = |i: f64, j: f64| {
        DVec3::from(patch.point(u0 + (u1 - u0) * i / n as f64, v0 + (v1 - v0) * j / m as f64))
    };
    let mut worst = 0.0_f64;
    for cell in 0..n * m {
        let (i, j) = ((cell / m) as f64, (cell % m) as f64);
        let q = [point(i, j), point(i + 1.0, j), point(i + 1.0, j + 1.0), point(i, j + 1.0)];
        for sample in 0..25 {
            let (a, b) = (f64::from(sample / 5) / 4.0, f64::from(sample % 5) / 4.0);
            let corners = if a >= b { [q[0], q[1], q[2]] } else { [q[0], q[2], q[3]] };
            worst = worst.max(to_triangle(point(i + a, j + b), corners));
        }
    }
    worst
}

fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let edges = [(a, b), (b, c), (c, a)];
    if normal.length() > 0.0 && edges.iter().all(|(u, v)| normal.cross(*v - *u).dot(p - *u) >= 0.0) {
        return normal.dot(p - a).abs() / normal.length();
    }
    let to_edge = |(u, v): (DVec3, DVec3)| {
        let square = (v - u).length_squared();
        let along = if square > 0.0 { ((p - u).dot(v - u) / square).clamp(0.0, 1.0) } else { 0.0 };
        p.distance(u + (v - u) * along)
    };
    edges.into_iter().map(to_edge).fold(f64::INFINITY, f64::min)
}

/// Triangles of the smallest uniform grid within the tolerance, over several proportions of its cells.
fn grid_triangles(patch: &Patch, tolerance: f64) -> usize {
    let fewest = |proportion: f64| {
        let other = |n: usize| ((n as f64 * proportion).round() as usize).max(1);
        let within = |n: usize| grid_deviation(patch, n, other(n)) <= tolerance;
        let mut high = 1;
        while !within(high) {
            high *= 2;
        }
        let mut low = high / 2;
        while low + 1 < high {
            let middle = usize::midpoint(low, high);
            if within(middle) { high = middle } else { low = middle }
        }
        2 * high * other(high)
    };
    [0.25, 0.5, 1.0, 2.0, 4.0].map(fewest).into_iter().min().unwrap_or(0)
}

fn table(_: &mut Criterion) {
    println!("case       tolerance  levelled  halving  uniform grid  levelled / uniform");
    for (name, patches) in cases() {
        for tolerance in [0.01, 0.002] {
            let count = |refinement| {
                let meshing = PatchMeshing::new(tolerance).refinement(refinement);
                meshing.surface(&patches).expect("a mesh").mesh.triangles.len()
            };
            let (levelled, halving) = (count(Refinement::Levelled), count(Refinement::Halving));
            let uniform: usize = patches.iter().map(|patch| grid_triangles(patch, tolerance)).sum();
            let ratio = levelled as f64 / uniform as f64;
            println!("{name:10} {tolerance:<10} {levelled:<9} {halving:<8} {uniform:<13} {ratio:.2}");
        }
    }
}

fn curves(c: &mut Criterion) {
    let degree9 = Bezier::new(&planar::DEGREE_9).expect("a curve");
    let mut group = c.benchmark_group("curve mesh, degree 9");
    for refinement in [Refinement::Levelled, Refinement::Halving] {
        for tolerance in [1e-3, 1e-5] {
            let meshing = CurveMeshing::new(tolerance).refinement(refinement);
            let nodes = meshing.mesh(&degree9).expect("a mesh").points.len();
            group.throughput(Throughput::Elements(nodes as u64));
            group.bench_function(format!("{refinement:?} {tolerance:e}, {nodes} nodes"), |b| {
                b.iter(|| meshing.mesh(black_box(&degree9)));
            });
        }
    }
}

fn patches(c: &mut Criterion) {
    let mut group = c.benchmark_group("patch mesh");
    group.sample_size(10);
    for (name, patches) in cases() {
        for refinement in [Refinement::Levelled, Refinement::Halving] {
            let meshing = PatchMeshing::new(0.001).refinement(refinement);
            let triangles = meshing.surface(&patches).expect("a mesh").mesh.triangles.len();
            group.throughput(Throughput::Elements(triangles as u64));
            group.bench_function(format!("{name} {refinement:?}, {triangles} triangles"), |b| {
                b.iter(|| meshing.surface(black_box(&patches)));
            });
        }
    }
}

fn regions(c: &mut Criterion) {
    let disc = |x: f64| {
        let circle: SharedCurve<2> =
            std::sync::Arc::new(EllipticArc::circle([x, 0.1 * x], 1.0).expect("a circle"));
        let region = Region::new(&[circle]).expect("a region");
        region.polygons(&CurveMeshing::new(1e-6)).expect("polygons")
    };
    let (a, b) = (disc(0.0), disc(1.0));
    let count = a.contours().map(<[_]>::len).sum::<usize>();
    c.bench_function(&format!("region union, 2 x {count} edges"), |bench| {
        bench.iter(|| black_box(&a).union(&b));
    });
    c.bench_function(&format!("triangulation, {count} edges"), |bench| {
        bench.iter(|| black_box(&a).triangulate());
    });
}

fn joins(c: &mut Criterion) {
    let p = Bezier::new(&[[0.0, 0.0], [2.0, 5.0], [6.0, 6.0], [9.5, 2.5]]).expect("a curve");
    let q = Bezier::new(&[[10.5, 3.0], [13.0, -1.5], [17.0, -4.0], [20.0, 1.0]]).expect("a curve");
    let join = CurveJoin::new().fix_ends();
    c.bench_function("join two cubics, ends fixed", |b| b.iter(|| join.join(black_box(&p), &q)));
    let best = join.clone().joint(JointAt::Best);
    c.bench_function("the same, best joint", |b| b.iter(|| best.join(black_box(&p), &q)));
    let (p10, q10) = (p.raised_to(10), q.raised_to(10));
    c.bench_function("join two curves of degree 10", |b| b.iter(|| join.join(black_box(&p10), &q10)));
}

criterion_group!(benches, table, curves, patches, regions, joins);
criterion_main!(benches);

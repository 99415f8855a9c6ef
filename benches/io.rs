//! Reading and writing a sphere of a million triangles in every format, in bytes of the file per second.
//!
//! `RAYON_NUM_THREADS=1 cargo bench --bench io` measures one thread. "copy" is a plain copy of the same bytes into fresh
//! memory, the bar for the binary formats.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use trisect::Mesh;
use trisect::io::{Encoding, Format, Precision, ReadOptions, WriteOptions, read, write};

/// A sphere of rings of quadrilaterals, closed at the poles: `2 * around * (rings - 1)` triangles.
fn sphere(around: u32, rings: u32) -> Mesh {
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for ring in 1..rings {
        let (radius, height) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
        positions.extend((0..around).map(|step| {
            let (sin, cos) = (TAU * f64::from(step) / f64::from(around)).sin_cos();
            [radius * cos, radius * sin, height]
        }));
    }
    positions.push([0.0, 0.0, -1.0]);
    let vertex = |ring: u32, step: u32| match ring {
        0 => 0,
        _ if ring == rings => (rings - 1) * around + 1,
        _ => 1 + (ring - 1) * around + step % around,
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for step in 0..around {
            let [a, b] = [vertex(ring, step), vertex(ring, step + 1)];
            let [c, d] = [vertex(ring + 1, step), vertex(ring + 1, step + 1)];
            if ring > 0 {
                triangles.push([a, c, b]);
            }
            if ring + 1 < rings {
                triangles.push([b, c, d]);
            }
        }
    }
    Mesh::new(positions, triangles)
}

fn formats(criterion: &mut Criterion) {
    let mesh = sphere(1000, 501);
    let plain = WriteOptions::new;
    let cases = [
        ("obj", Format::Obj, plain()),
        ("obj_single", Format::Obj, plain().precision(Precision::Single)),
        ("gltf", Format::Gltf, plain()),
        ("glb", Format::Glb, plain()),
        ("stl", Format::Stl, plain()),
        ("stl_ascii", Format::Stl, plain().encoding(Encoding::Ascii)),
        ("ply", Format::Ply, plain()),
        ("ply_single", Format::Ply, plain().precision(Precision::Single)),
        ("ply_big_endian", Format::Ply, plain().encoding(Encoding::BinaryBigEndian)),
        ("ply_ascii", Format::Ply, plain().encoding(Encoding::Ascii)),
        ("off", Format::Off, plain()),
    ];
    for (name, format, options) in cases {
        let mut bytes = Vec::new();
        write(&mesh, format, &mut bytes, &options).unwrap();
        let loaded = read(&bytes, format, &ReadOptions::new()).unwrap();
        assert_eq!(loaded.mesh.triangles.len(), mesh.triangles.len());

        let mut group = criterion.benchmark_group(name);
        group.sample_size(10).throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(BenchmarkId::new("copy", bytes.len()), |bencher| {
            bencher.iter_with_large_drop(|| black_box(&bytes).clone());
        });
        group.bench_function(BenchmarkId::new("read", bytes.len()), |bencher| {
            bencher.iter_with_large_drop(|| read(black_box(&bytes), format, &ReadOptions::new()).unwrap());
        });
        let mut output = Vec::with_capacity(bytes.len());
        group.bench_function(BenchmarkId::new("write", bytes.len()), |bencher| {
            bencher.iter(|| {
                output.clear();
                write(black_box(&mesh), format, &mut output, &options).unwrap();
            });
        });
        group.finish();
    }
}

criterion_group!(benches, formats);
criterion_main!(benches);

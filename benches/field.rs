//! Fields, timed: `cargo bench --bench field -- MODEL.off|MODEL.ply [POINTS.npy [OUT]]` for signed distances of a million
//! points (or the given ones) and a grid of 256 points a side; `cargo bench --bench field -- extract` for extractions, `-- smooth [MESH DISTANCE]...` for
//! surfaces as the cells give them beside smooth ones, of formulas, a model file, and offsets by parts of the diagonal.
//!
//! Prints one line of `key value` pairs per measurement, for `benches/libigl_distance.py` to set beside libigl's.
#![allow(clippy::print_stdout, reason = "a benchmark reports on standard output")]

#[path = "../tests/common/files.rs"]
mod files;
#[path = "field/smooth.rs"]
mod smooth;

use std::time::Instant;

use trisect::Control;
use trisect::field::{Extraction, Formula, Grid, SignRule, SignedDistance, System};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let Some(model) = arguments.first() else {
        println!("no model named: nothing measured");
        return;
    };
    if model == "extract" {
        return extractions();
    }
    if model == "smooth" {
        return smooth::rows(&arguments[1..]);
    }
    let mesh = files::read(model);
    let points = arguments.get(1).map_or_else(|| random_points(&mesh, 1_000_000), |path| files::points(path));
    for rule in [SignRule::PseudoNormal, SignRule::Winding, SignRule::Parity, SignRule::FastWinding] {
        let start = Instant::now();
        let distance = SignedDistance::of_mesh(&mesh, rule);
        let built = start.elapsed();
        let values = distance.at_all(&points, &Control::new()).expect("no limits");
        let all = start.elapsed();
        println!(
            "rule {rule:?} triangles {} points {} build_s {:.3} total_s {:.3} memory_mb {:.1} sum {:.12}",
            mesh.triangles.len(),
            points.len(),
            built.as_secs_f64(),
            all.as_secs_f64(),
            distance.memory() as f64 / 1e6,
            values.iter().sum::<f64>(),
        );
        if rule == SignRule::PseudoNormal
            && let Some(path) = arguments.get(2)
        {
            std::fs::write(path, values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
                .expect("written");
        }
    }
    if arguments.len() < 3 {
        grids(&mesh);
    }
}

/// A narrow band of three cells on a grid of 256 points along the longest side, and all of it.
fn grids(mesh: &trisect::Mesh) {
    let distance = SignedDistance::of_mesh(mesh, SignRule::PseudoNormal);
    let Some([low, high]) = distance.tree().bounds() else { return };
    let spacing = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max) / 255.0;
    let grid = || {
        let longest = std::array::from_fn(|axis| low[axis] + 255.0 * spacing);
        Grid::over(low, longest, spacing).expect("a grid")
    };
    let start = Instant::now();
    let banded = grid().banded(&distance, 3.0 * spacing, &Control::new()).expect("no limits");
    println!("grid {:?} band 3 cells seconds {:.3}", banded.shape, start.elapsed().as_secs_f64());
    let start = Instant::now();
    let dense = grid().dense(&distance, &Control::new()).expect("no limits");
    println!("grid {:?} dense seconds {:.3}", dense.shape, start.elapsed().as_secs_f64());
}

/// Extraction time against the number of triangles.
fn extractions() {
    let texts = [
        ("ball", "1 - length(x, y, z)", 1.2),
        (
            "box minus ball",
            "min(1 - abs(x), 1 - abs(y), 1 - abs(z)) and not sphere(x - 1, y - 1, z - 1, 0.8)",
            1.2,
        ),
        ("three tori", "t(a, b, c) = torus(a, c, b, 5, 1); t(x, y, z) or t(y, x, z) or t(x, z, y)", 6.5),
    ];
    for (name, text, half) in texts {
        let field = Formula::parse(text).and_then(|f| f.compile(System::R0, &[], &[])).expect(name);
        for accuracy in [1e-2, 3e-3, 1e-3, 3e-4] {
            let start = Instant::now();
            let extraction = Extraction::new([-half; 3], [half; 3], accuracy * half);
            let found = extraction.run(&field).expect(name);
            println!(
                "extract {name} tolerance {accuracy} of half a side: {} triangles {} cells seconds {:.3}",
                found.mesh.triangles.len(),
                found.cells,
                start.elapsed().as_secs_f64()
            );
        }
    }
}

/// Uniform in the bounding box grown by a tenth of its size on every side.
fn random_points(mesh: &trisect::Mesh, count: usize) -> Vec<[f64; 3]> {
    use rand::{RngExt, SeedableRng};
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(1);
    let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
        mesh.positions.iter().map(|p| p[axis]).reduce(pick).unwrap_or(0.0)
    };
    let low: [f64; 3] = std::array::from_fn(|axis| bound(axis, f64::min));
    let high: [f64; 3] = std::array::from_fn(|axis| bound(axis, f64::max));
    (0..count)
        .map(|_| {
            std::array::from_fn(|axis| {
                low[axis] + (high[axis] - low[axis]) * (random.random::<f64>() * 1.2 - 0.1)
            })
        })
        .collect()
}

//! Signed distance over real models, timed: `cargo bench --bench field -- MODEL.off|MODEL.ply [POINTS.npy]`.
//!
//! Prints one line of `key value` pairs per measurement, for `benches/libigl_distance.py` to set beside libigl's.
#![allow(clippy::print_stdout, reason = "a benchmark reports on standard output")]

#[path = "../tests/common/files.rs"]
mod files;

use std::time::Instant;

use trisect::Control;
use trisect::field::{SignRule, SignedDistance};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let Some(model) = arguments.first() else {
        println!("no model named: nothing measured");
        return;
    };
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

//! How long the gate and the search for self-crossings of given models take: `cargo run --release --example check_times -- MODEL...`
//!
//! `ico:7` stands for a ball that is an icosahedron divided seven times. `RAYON_NUM_THREADS=1` before it measures one thread. One line of
//! JSON for each model; times are nanoseconds for each of its triangles, the least of nine runs. `benches/self_crossings.py` runs it beside
//! other libraries.

use std::time::Instant;

use trisect::{Control, Mesh, Solid, primitives};

const RUNS: usize = 9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for model in std::env::args().skip(1) {
        let mesh = match model.strip_prefix("ico:") {
            Some(levels) => primitives::icosphere(1.0, levels.parse()?)?,
            None => Mesh::load(&model)?,
        };
        let triangles = mesh.triangles.len();
        let (mut gate, mut check, mut crossings) = (f64::INFINITY, f64::INFINITY, 0);
        for _ in 0..RUNS {
            let mesh = mesh.clone();
            let start = Instant::now();
            let solid = Solid::try_from(mesh)?;
            gate = gate.min(start.elapsed().as_secs_f64());
            let start = Instant::now();
            crossings = solid.self_crossings(&Control::new())?.count;
            check = check.min(start.elapsed().as_secs_f64());
        }
        let [gate, check] = [gate, check].map(|seconds| seconds * 1e9 / triangles as f64);
        println!(
            "{{\"model\": {model:?}, \"triangles\": {triangles}, \"gate\": {gate:.1}, \"check\": {check:.1}, \"crossings\": {crossings}}}"
        );
    }
    Ok(())
}

//! Very big meshes, and how cost grows.
//!
//!     scale run 10e6 [spheres|bumpy] [FOLDER]   two bodies of that many triangles together; time and memory of every stage
//!     scale triangles [RUNS]                     a body that grows, the cut always through equally many triangles
//!     scale curve [RUNS]                         one size of mesh, a cut that grows
//!
//! One JSON object a line; `plot.py` draws the last two. Threads as RAYON_NUM_THREADS says for `run`, one for the others.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Instant;

use serde_json::json;
use trisect::io::{ReadOptions, WriteOptions};
use trisect::{BooleanOptions, Mesh, Operation, Outcome, Solid, primitives};

type Fallible<T> = Result<T, Box<dyn Error>>;

fn main() -> Fallible<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let runs = || arguments.get(1).map_or(Ok(5), |text| text.parse::<usize>());
    match arguments.first().map(String::as_str) {
        Some("run") => {
            let total: f64 = arguments.get(1).ok_or("how many triangles?")?.parse()?;
            let bumpy = arguments.get(2).is_some_and(|shape| shape == "bumpy");
            big_run(total, bumpy, arguments.get(3).map(Path::new))
        }
        Some("triangles") => growing_body(runs()?),
        Some("curve") => growing_curve(runs()?),
        _ => Err("scale run|triangles|curve; see the head of the source".into()),
    }
}

/// A geodesic sphere has 20 f^2 triangles.
fn frequency_of(triangles: f64) -> u32 {
    (triangles / 20.0).sqrt().round() as u32
}

fn sphere(frequency: u32) -> Fallible<Mesh> {
    Ok(primitives::geodesic_sphere(1.0, frequency)?.rotated([3.0, -1.0, 2.0], 99.239)?)
}

/// A sphere with waves.
fn bumpy(frequency: u32, waves: f64, phases: [f64; 3]) -> Fallible<Mesh> {
    let mut mesh = primitives::geodesic_sphere(1.0, frequency)?;
    for position in &mut mesh.positions {
        let height: f64 = (0..3).map(|k| (waves * position[k] + phases[k]).sin()).product();
        *position = position.map(|x| x * (1.0 + 0.02 * height));
    }
    Ok(mesh)
}

fn big_run(total: f64, with_waves: bool, folder: Option<&Path>) -> Fallible<()> {
    let frequency = frequency_of(0.5 * total);
    let meshes = stage("make", || {
        Ok(if with_waves {
            let second = bumpy(frequency, 40.0, [1.3, 2.1, 0.4])?.rotated([1.0, 2.0, 3.0], 24.308)?;
            [bumpy(frequency, 40.0, [0.1, 0.7, 1.9])?, second]
        } else {
            let second =
                sphere(frequency)?.rotated([1.0, 2.0, 3.0], 81.028)?.translated([0.5, 0.013, -0.007]);
            [sphere(frequency)?, second]
        })
    })?;
    let meshes = match folder {
        None => meshes,
        Some(folder) => {
            let paths = ["first.ply", "second.ply"].map(|name| folder.join(name));
            stage("write operands", || {
                for (mesh, path) in meshes.iter().zip(&paths) {
                    trisect::io::save(mesh, path, &WriteOptions::new())?;
                }
                Ok(())
            })?;
            drop(meshes);
            let [first, second] = &paths;
            stage("read operands", || {
                let read = |path| trisect::io::load(path, &ReadOptions::new()).map(|loaded| loaded.mesh);
                Ok([read(first)?, read(second)?])
            })?
        }
    };
    let triangles_in: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let [first, second] = stage("gate", || {
        let [first, second] = meshes;
        Ok([Solid::try_from(first)?, Solid::try_from(second)?])
    })?;
    let made = stage("union", || Ok(BooleanOptions::new().run(Operation::Union, [&first, &second])?))?;
    let triangles_out = made.solid().mesh().triangles.len();
    drop((first, second));
    stage("certificate", || {
        let certificate = made.certificate();
        assert!(certificate.closed, "a result is closed");
        Ok(certificate.volume)
    })?;
    if let Some(folder) = folder {
        stage("write result", || {
            Ok(trisect::io::save(made.solid().mesh(), folder.join("result.ply"), &WriteOptions::new())?)
        })?;
    }
    println!(
        "{}",
        json!({ "triangles_in": triangles_in, "triangles_out": triangles_out, "new_vertices": new_vertices(&made) })
    );
    Ok(())
}

/// Runs a stage and prints its time, the most memory in use during it, and what is in use after it.
fn stage<T>(name: &str, run: impl FnOnce() -> Fallible<T>) -> Fallible<T> {
    // Sets the peak back to what is in use now.
    fs::write("/proc/self/clear_refs", "5")?;
    let start = Instant::now();
    let value = run()?;
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{}",
        json!({ "stage": name, "seconds": seconds, "peak_gb": memory("VmHWM")?, "after_gb": memory("VmRSS")? })
    );
    Ok(value)
}

/// A field of this process's status, in units of 10^9 bytes.
fn memory(field: &str) -> Fallible<f64> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find(|line| line.starts_with(field)).ok_or("no such field")?;
    let kilobytes: f64 = line.split_whitespace().nth(1).ok_or("no value")?.parse()?;
    Ok(kilobytes * 1024e-9)
}

/// The number of vertices on the curves.
fn new_vertices(made: &Outcome) -> usize {
    made.curves().iter().map(|curve| curve.len() - 1).sum()
}

/// The tool shrinks as the body's triangles do: it always cuts about equally many.
fn growing_body(runs: usize) -> Fallible<()> {
    for frequency in [16, 32, 64, 128, 256, 512, 1000] {
        let body = Solid::try_from(sphere(frequency)?)?;
        let tool = primitives::icosphere(12.8 / f64::from(frequency), 4)?.rotated([1.0, 2.0, 3.0], 81.028)?;
        let tool = Solid::try_from(tool.translated([1.0, 0.013, -0.007]))?;
        measure("triangles", body.mesh().triangles.len(), Operation::Difference, [&body, &tool], runs)?;
    }
    Ok(())
}

/// The waves become shorter, and the curve longer with them.
fn growing_curve(runs: usize) -> Fallible<()> {
    for waves in [2.5, 5.0, 10.0, 20.0, 40.0, 80.0] {
        let first = Solid::try_from(bumpy(128, waves, [0.1, 0.7, 1.9])?)?;
        let second = bumpy(128, waves, [1.3, 2.1, 0.4])?.rotated([1.0, 2.0, 3.0], 24.308)?;
        let second = Solid::try_from(second)?;
        measure("curve", first.mesh().triangles.len(), Operation::Union, [&first, &second], runs)?;
    }
    Ok(())
}

fn measure(
    series: &str,
    triangles: usize,
    operation: Operation,
    operands: [&Solid; 2],
    runs: usize,
) -> Fallible<()> {
    let options = BooleanOptions::new().threads(1);
    let made = options.run(operation, operands)?;
    let mut times = Vec::new();
    for _ in 0..runs.max(1) {
        let start = Instant::now();
        let made = options.run(operation, operands)?;
        times.push(start.elapsed().as_secs_f64());
        drop(made);
    }
    times.sort_by(f64::total_cmp);
    println!(
        "{}",
        json!({
            "series": series,
            "triangles": triangles,
            "curve_vertices": new_vertices(&made),
            "median": times[times.len() / 2],
            "least": times[0],
        })
    );
    Ok(())
}

//! What the calls that `benches/python.py` makes from Python take from Rust: the same data, the same options, the same build.
//!
//!     cargo run --release --features extension-module --example rust_call
//!
//! Prints JSON: seconds of the processor, the least of several rounds, on one thread; the gate and the operation from meshes that are there, whose memory
//! the solids take over.

use std::hint::black_box;

use rustix::time::{ClockId, clock_gettime};
use trisect::{BooleanOptions, Mesh, Operation, Solid, primitives};

/// A cube pair is timed in rounds of so many calls, of which one alone would be within the clock's noise.
const CALLS: usize = 500;
const ROUNDS: usize = 15;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(measured)?;
    Ok(())
}

/// Seconds that this thread has had of a processor.
fn spent() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn measured() -> Result<(), trisect::Error> {
    // 1. Two cubes.
    let cubes = [primitives::cuboid([0.0; 3], [1.0; 3])?, primitives::cuboid([0.5; 3], [1.5; 3])?];
    let default = BooleanOptions::new();
    let mut small = f64::INFINITY;
    for _ in 0..ROUNDS {
        let copies: Vec<[Mesh; 2]> = (0..CALLS).map(|_| cubes.clone()).collect();
        let start = spent();
        for pair in copies {
            black_box(united(&default, pair)?);
        }
        small = small.min((spent() - start) / CALLS as f64);
    }
    // 2. Two balls of 327,680 triangles, taken to be clean, and looked through.
    let ball = primitives::icosphere(1.0, 7)?;
    let other = ball.clone().rotated([1.0, 2.0, 3.0], 40.0)?.translated([0.5, 0.013, -0.007]);
    let clean = BooleanOptions::new().assume_clean(true);
    let mut large = [f64::INFINITY; 2];
    for (options, least) in [&clean, &default].into_iter().zip(&mut large) {
        for _ in 0..ROUNDS {
            let pair = [ball.clone(), other.clone()];
            let start = spent();
            black_box(united(options, pair)?);
            *least = least.min(spent() - start);
        }
    }
    println!("{{\"cubes\": {small:e}, \"balls_clean\": {:e}, \"balls\": {:e}}}", large[0], large[1]);
    Ok(())
}

/// The union of two meshes.
fn united(options: &BooleanOptions, [a, b]: [Mesh; 2]) -> Result<trisect::Outcome, trisect::Error> {
    let (a, b) = (Solid::try_from(a)?, Solid::try_from(b)?);
    options.run(Operation::Union, [&a, &b])
}

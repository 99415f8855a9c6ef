//! The union of many solids, with progress, a deadline, a ceiling on memory, and a switch to cancel it.
//!
//!     cargo run --release --example unite_many -- [SIDE]
//!
//! Unites SIDE^3 overlapping spheres on a grid.

use std::time::{Duration, Instant};

use trisect::{BooleanOptions, CancelToken, Control, Error, Operation, Solid, primitives};

fn main() -> Result<(), Error> {
    let side: u32 = match std::env::args().nth(1) {
        None => 6,
        Some(text) => text.parse().map_err(|_| Error::InvalidArgument(format!("{text} is no number")))?,
    };
    let sphere = primitives::geodesic_sphere(0.65, 12)?;
    let at = |i: u32| [i % side, i / side % side, i / side / side].map(f64::from);
    let spheres: Vec<Solid> = (0..side.pow(3))
        .map(|i| Solid::try_from(sphere.clone().translated(at(i))))
        .collect::<Result<_, Error>>()?;

    // Another thread, a signal handler or a button may hold a clone of the token and call `cancel`.
    let token = CancelToken::new();
    let control = Control::new()
        .cancel(&token)
        .deadline(Instant::now() + Duration::from_secs(60))
        .memory_limit(4 << 30)
        .progress(|stage, fraction| println!("{stage}: {:3.0} %", 100.0 * fraction));

    match BooleanOptions::new().control(control.clone()).run(Operation::Union, &spheres) {
        Ok(united) => println!("{} spheres: {}", spheres.len(), united.certificate()),
        Err(Error::DeadlineExceeded) => println!("no time left"),
        Err(other) => return Err(other),
    }

    // A cancelled operation stops within milliseconds, with an error of its own; nothing is left behind.
    token.cancel();
    match BooleanOptions::new().control(control).run(Operation::Union, &spheres) {
        Err(Error::Cancelled) => println!("cancelled"),
        other => println!("not cancelled: {other:?}"),
    }
    Ok(())
}

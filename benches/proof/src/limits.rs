//! How soon a running boolean stops, and how honest its account of memory is. Measured, not asserted.

#[path = "../../../tests/common/counting.rs"]
mod counting;

use std::time::{Duration, Instant};

use trisect::{BooleanOptions, CancelToken, Control, Error, Operation, Solid, primitives};

fn pair(frequency: u32) -> [Solid; 2] {
    let ball = primitives::geodesic_sphere(1.0, frequency).expect("a ball");
    let turned = ball.clone().rotated([1.0, 2.0, 3.0], 7.0).expect("an axis");
    [ball, turned].map(|mesh| Solid::try_from(mesh).expect("closed"))
}

fn union(operands: &[Solid; 2], control: Control, threads: usize) -> Result<Solid, Error> {
    let outcome = BooleanOptions::new()
        .control(control)
        .threads(threads)
        .run(Operation::Union, [&operands[0], &operands[1]])?;
    Ok(outcome.into_solid())
}

/// Prints how long after a token is cancelled, or a deadline passes, the operation returns.
pub(crate) fn measure() {
    for frequency in [100, 220] {
        let operands = pair(frequency);
        let triangles: usize = operands.iter().map(|solid| solid.mesh().triangles.len()).sum();
        for threads in [1, 2] {
            let begun = Instant::now();
            let whole = union(&operands, Control::new(), threads).expect("no limits");
            let took = begun.elapsed();
            println!(
                "{triangles} triangles in, {} out, {threads} threads: whole operation {took:.1?}",
                whole.mesh().triangles.len()
            );
            drop(whole);
            summary("cancelled", took, |after| stopped(&operands, threads, after));
            summary("deadline", took, |after| {
                let deadline = Instant::now() + after;
                let result = union(&operands, Control::new().deadline(deadline), threads);
                result.is_err().then(|| deadline.elapsed())
            });
        }
        memory(&operands);
    }
}

fn summary(what: &str, took: Duration, run: impl Fn(Duration) -> Option<Duration>) {
    let mut late: Vec<Duration> = (1..40).filter_map(|part| run(took * part / 40)).collect();
    late.sort();
    if let (Some(median), Some(most)) = (late.get(late.len() / 2), late.last()) {
        println!(
            "  {what} at {} moments: returns after {median:.1?} (median), {most:.1?} (most)",
            late.len()
        );
    }
}

fn stopped(operands: &[Solid; 2], threads: usize, after: Duration) -> Option<Duration> {
    let token = CancelToken::new();
    let control = Control::new().cancel(&token);
    std::thread::scope(|scope| {
        let canceller = scope.spawn(move || {
            std::thread::sleep(after);
            let at = Instant::now();
            token.cancel();
            at
        });
        let result = union(operands, control, threads);
        let returned = Instant::now();
        let at = canceller.join().expect("no panic");
        result.is_err().then(|| returned - at)
    })
}

/// The smallest limit with which the operation ends, and the bytes it has in use at most.
fn memory(operands: &[Solid; 2]) {
    let peak = counting::peak_of(|| union(operands, Control::new(), 1));
    let (mut low, mut high) = (0, 1 << 40);
    while high - low > 1 << 16 {
        let middle = low + (high - low) / 2;
        let enough = union(operands, Control::new().memory_limit(middle), 1).is_ok();
        (low, high) = if enough { (low, middle) } else { (middle, high) };
    }
    println!(
        "  smallest memory limit {:.1} MB, in use at most {:.1} MB",
        high as f64 / 1e6,
        peak as f64 / 1e6
    );
}

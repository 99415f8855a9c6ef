//! Limits inside one running operation: each stops it with its own error, and what it leaves is as before.

mod common;
#[cfg(feature = "cli")]
#[path = "common/program.rs"]
mod program;

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use common::solid;
use trisect::{BooleanOptions, CancelToken, Control, Error, Failure, Operation, Outcome, Solid, primitives};

/// Balls that cross almost everywhere: the operation takes far longer than a message between threads.
fn heavy() -> [Solid; 2] {
    let ball = primitives::geodesic_sphere(1.0, 70).expect("a ball");
    [solid(ball.clone()), solid(ball.rotated([1.0, 2.0, 3.0], 1.0).expect("an axis"))]
}

fn light() -> [Solid; 2] {
    let ball = primitives::geodesic_sphere(1.0, 12).expect("a ball");
    [solid(ball.clone()), solid(ball.translated([0.1, 0.2, 0.3]))]
}

fn run(operands: &[Solid; 2], control: Control, threads: usize) -> Result<Outcome, Error> {
    BooleanOptions::new()
        .threads(threads)
        .control(control)
        .run(Operation::Union, [&operands[0], &operands[1]])
}

#[test]
fn a_token_stops_a_running_operation() {
    let operands = heavy();
    for threads in [1, 2] {
        let token = CancelToken::new();
        let (running, is_running) = mpsc::channel();
        // The operation reports that it has begun; then it is cancelled from another thread.
        let control = Control::new().cancel(&token).progress(move |_, _| running.send(()).unwrap_or(()));
        let canceller = std::thread::spawn(move || {
            is_running.recv().expect("it begins");
            std::thread::sleep(Duration::from_millis(5));
            token.cancel();
        });
        let error = run(&operands, control, threads).expect_err("it was cancelled");
        canceller.join().expect("no panic");
        assert!(matches!(error, Error::Cancelled), "{error}");
        assert_eq!(error.failure(), Failure::Limit);
    }
    // The operands are as good as before.
    let control = Control::new();
    let [a, b] = &operands;
    assert!(BooleanOptions::new().control(control).run(Operation::Intersection, [a, b]).is_ok());
}

#[test]
fn a_token_cancelled_at_any_report_of_many_operands() {
    let balls: Vec<Solid> = (0..24)
        .map(|i| {
            let at = [f64::from(i % 5), f64::from(i / 5), 0.1 * f64::from(i % 3)];
            solid(primitives::geodesic_sphere(0.7, 6).expect("a ball").translated(at))
        })
        .collect();
    let reports_of = |cancel_at: usize| {
        let token = CancelToken::new();
        let count = Arc::new(AtomicUsize::new(0));
        let (counted, switch) = (Arc::clone(&count), token.clone());
        let control = Control::new().cancel(&token).progress(move |_, _| {
            if counted.fetch_add(1, Relaxed) == cancel_at {
                switch.cancel();
            }
        });
        let result = BooleanOptions::new().control(control).run(Operation::Union, &balls);
        (result.map(Outcome::into_solid), count.load(Relaxed))
    };
    let (whole, reports) = reports_of(usize::MAX);
    assert!(whole.is_ok() && reports > 3, "{reports}");
    for cancel_at in 0..reports {
        let (result, seen) = reports_of(cancel_at);
        assert!(matches!(result, Err(Error::Cancelled)), "cancelled at report {cancel_at} of {reports}");
        assert_eq!(seen, cancel_at + 1, "it went on after it was cancelled");
    }
}

#[test]
fn a_deadline_stops_a_running_operation() {
    let operands = heavy();
    for threads in [1, 2] {
        let control = Control::new().deadline(Instant::now() + Duration::from_millis(5));
        let error = run(&operands, control, threads).expect_err("it takes longer");
        assert!(matches!(error, Error::DeadlineExceeded), "{error}");
        assert_eq!(error.failure(), Failure::Limit);
    }
    let passed = Control::new().deadline(Instant::now());
    assert!(matches!(run(&light(), passed, 1), Err(Error::DeadlineExceeded)));
}

#[test]
fn a_deadline_at_any_time_gives_the_error_or_the_result() {
    let operands = light();
    let begun = Instant::now();
    let whole = run(&operands, Control::new(), 1).expect("no limits").into_solid();
    let took = begun.elapsed();
    for part in 0..60 {
        let control = Control::new().deadline(Instant::now() + took * part / 40);
        match run(&operands, control, 1) {
            Ok(outcome) => assert_eq!(outcome.solid().mesh(), whole.mesh()),
            Err(error) => assert!(matches!(error, Error::DeadlineExceeded), "{error}"),
        }
    }
}

#[test]
fn a_memory_ceiling_stops_an_operation_before_it_is_exceeded() {
    let operands = light();
    let whole = run(&operands, Control::new(), 1).expect("no limits").into_solid();
    let run_within = |limit: u64| run(&operands, Control::new().memory_limit(limit), 1);
    // From a byte upwards: refused, with what was needed, and at some limit done.
    let (mut refused, mut done) = (0, 0);
    for step in 0..60u32 {
        let limit = (1.4f64.powi(step as i32)) as u64;
        match run_within(limit) {
            Ok(outcome) => {
                assert_eq!(outcome.solid().mesh(), whole.mesh());
                done += 1;
            }
            Err(Error::MemoryLimit { needed, limit: stated }) => {
                assert!(needed > limit && stated == limit, "{needed} {stated} {limit}");
                assert_eq!(done, 0, "more memory is not less");
                refused += 1;
            }
            Err(error) => panic!("{error}"),
        }
    }
    assert!(refused > 10 && done > 10, "{refused} {done}");
}

#[test]
fn what_was_reserved_is_given_back() {
    // One account for several operations in a row: stopped or not, they leave nothing on it.
    let operands = light();
    let limit = 50_000_000;
    let control = Control::new().memory_limit(limit);
    for round in 0..40 {
        let result = if round % 2 == 0 {
            run(&operands, control.clone(), 2)
        } else {
            run(&operands, control.clone().deadline(Instant::now() + Duration::from_micros(100 * round)), 2)
        };
        drop(result);
        drop(control.reserve(limit).expect("nothing is left on the account"));
    }
}

/// The program: exit code 4, and nothing on disk.
#[cfg(feature = "cli")]
mod program_limits {
    use super::program::{self, Folder, sphere};

    #[test]
    fn every_time_limit_gives_the_result_or_leaves_nothing() {
        let folder = Folder::new();
        folder.write("a.off", sphere(60, 1.0, [0.0; 3]));
        folder.write("b.off", sphere(60, 1.0, [0.01, 0.02, 0.03]));
        let inputs = folder.names();
        folder.run("difference a.off b.off -o c.ply -o d.obj").exits(0);
        let whole = (program::bytes(&folder.path("c.ply")), program::bytes(&folder.path("d.obj")));
        for name in ["c.ply", "d.obj"] {
            std::fs::remove_file(folder.path(name)).expect("it was written");
        }
        let mut stopped = 0;
        for step in 0..40 {
            // From a tenth of a millisecond up to about twenty seconds.
            let seconds = 1e-4 * 1.37f64.powi(step);
            let ran = folder.run(&format!("difference a.off b.off -o c.ply -o d.obj --timeout {seconds}"));
            if ran.code == 4 {
                stopped += 1;
                // Files are put in place one by one at the end; a limit between two may leave the first, whole.
                for name in folder.names().iter().filter(|name| !inputs.contains(name)) {
                    let expected = if name == "c.ply" { &whole.0 } else { &whole.1 };
                    assert_eq!(&program::bytes(&folder.path(name)), expected, "{name} after {seconds} s");
                }
            } else {
                let ran = ran.exits(0);
                assert!(ran.err.contains("result: "), "{ran:?}");
                assert_eq!(program::bytes(&folder.path("c.ply")), whole.0);
                assert_eq!(program::bytes(&folder.path("d.obj")), whole.1);
                break;
            }
        }
        assert!(stopped > 3, "only {stopped} were stopped");
    }

    #[test]
    fn every_memory_limit_gives_the_result_or_leaves_nothing() {
        let folder = Folder::new();
        folder.write("a.off", sphere(40, 1.0, [0.0; 3]));
        folder.write("b.off", sphere(40, 1.0, [0.01, 0.02, 0.03]));
        let inputs = folder.names();
        let (mut stopped, mut done) = (0, 0);
        for megabytes in [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 256] {
            let ran = folder.run(&format!("union a.off b.off -o c.ply --memory {megabytes}M"));
            if ran.code == 4 {
                stopped += 1;
                assert_eq!(folder.names(), inputs, "with {megabytes} MB");
                assert_eq!(done, 0, "more memory is not less");
            } else {
                ran.exits(0);
                done += 1;
                std::fs::remove_file(folder.path("c.ply")).expect("it was written");
            }
        }
        assert!(stopped > 0 && done > 0, "{stopped} {done}");
    }
}

//! `batch`: many jobs from one file, each in a process of its own, each reported once.
//!
//! A job is a run of this program: one that crashes or takes too much memory takes nothing with it, and what it took is the system's
//! again. Jobs are read one by one as workers become free, and reports written as jobs end, so that memory does not grow with their
//! number; what is kept of each is a number that tells whether it was reported before.
//!
//! - `job`: a line of the file, and the command line that it means;
//! - `pool`: workers, each with one process at a time;
//! - `reports`: the file of reports, and what is in it when a run goes on.

mod job;
mod pool;
mod reports;

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use serde_json::{Value, json};
use trisect::{Error, FileAction};

use super::fault::{Exit, Fault};
use super::session::Session;
use super::stream::STANDARD;
use super::values;
use job::{Jobs, Limits};
use pool::Pool;
use reports::Reports;

/// How often a worker's process is tried that ends without a word.
const ATTEMPTS: u32 = 2;

/// Failures named in the report of the whole run; all of them are in the file of reports.
const NAMED: usize = 20;

/// Many jobs.
#[derive(Debug, Args)]
pub(crate) struct Batch {
    /// Jobs, one JSON object a line: verb, inputs, output, options, and an id
    #[arg(value_name = "JOBS")]
    jobs: PathBuf,
    /// The file of reports, one JSON object a line for each job, in the order in which they end; `-` is standard output. Jobs that it
    /// has a report of are not run again
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Run so many jobs at the same time, each on one thread unless its options say otherwise [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_hyphen_values = true)]
    workers: Option<u16>,
    /// Run jobs again whose report says that they failed; the later report counts
    #[arg(long)]
    retry_failed: bool,
    /// Begin anew: throw away the reports that are there
    #[arg(long, conflicts_with = "retry_failed")]
    anew: bool,
    /// Give up each job after this time, unless its options say otherwise
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds, allow_hyphen_values = true)]
    job_timeout: Option<Duration>,
    /// Give up each job before its tables exceed this size, unless its options say otherwise
    #[arg(long, value_name = "SIZE", value_parser = values::bytes, allow_hyphen_values = true)]
    job_memory: Option<u64>,
}

/// How far a run is.
#[derive(Debug, Default)]
struct Tally {
    done: u64,
    failed: u64,
    skipped: u64,
    /// The first failures: ids and messages.
    failures: Vec<Value>,
}

impl Tally {
    fn add(&mut self, report: &Value) {
        if report["status"] == "done" {
            self.done += 1;
            return;
        }
        self.failed += 1;
        if self.failures.len() < NAMED {
            self.failures.push(json!({ "id": report["id"], "message": report["error"]["message"] }));
        }
    }
}

/// Runs all jobs that have no report yet.
pub(crate) fn run(arguments: &Batch, session: &mut Session<'_>) -> Result<Exit, Fault> {
    if arguments.output == Path::new(STANDARD) && session.common.json {
        return Err(Fault::usage("reports and --json cannot both go to standard output: give -o a file"));
    }
    // 1. What there is to do, and what is done.
    let total = count(&arguments.jobs)?;
    let mut reports = Reports::open(&arguments.output, arguments.anew, arguments.retry_failed)?;
    let jobs = Jobs::open(&arguments.jobs, reports.take_known())?;
    let folder = arguments.jobs.parent().filter(|folder| !folder.as_os_str().is_empty());
    let limits = Limits { timeout: arguments.job_timeout, memory: arguments.job_memory };
    // 2. Workers.
    let workers = arguments.workers.map_or_else(
        || std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get),
        usize::from,
    );
    let pool = Pool::start(jobs, folder.unwrap_or(Path::new(".")), &limits, workers)?;
    // 3. Reports as they come.
    let (mut tally, start, control) = (Tally::default(), Instant::now(), session.control());
    loop {
        if let Err(limit) = control.check() {
            session.note("batch", summary(&tally, pool.skipped(), total));
            return Err(Error::from(limit).into());
        }
        tally.skipped = pool.skipped();
        session.console.stage(&words(&tally, total, start), fraction(&tally, total));
        match pool.next() {
            pool::Next::Report(report) => {
                reports.write(&report)?;
                tally.add(&report);
            }
            pool::Next::Nothing => {}
            pool::Next::End(Ok(())) => break,
            pool::Next::End(Err(fault)) => return Err(fault),
        }
    }
    // 4. All together.
    tally.skipped = pool.skipped();
    session.console.say(&format!(
        "{} done, {} failed, {} reported before -> {}",
        tally.done,
        tally.failed,
        tally.skipped,
        arguments.output.display()
    ));
    for failure in &tally.failures {
        let text = |key: &str| failure[key].as_str().unwrap_or_default().to_owned();
        session.console.detail(&format!("failed: {}: {}", text("id"), text("message")));
    }
    session.note("batch", summary(&tally, tally.skipped, total));
    Ok(if tally.failed == 0 { Exit::Fine } else { Exit::Unusable })
}

fn summary(tally: &Tally, skipped: u64, total: u64) -> Value {
    json!({
        "jobs": total,
        "done": tally.done,
        "failed": tally.failed,
        "skipped": skipped,
        "failures": tally.failures,
    })
}

/// How many lines are jobs.
fn count(path: &Path) -> Result<u64, Fault> {
    let fail = |source| Error::File { action: FileAction::Read, path: path.to_path_buf(), source };
    let file = std::fs::File::open(path).map_err(fail)?;
    let (mut lines, mut line) = (0, Vec::new());
    let mut reader = BufReader::new(file);
    loop {
        line.clear();
        if reader.read_until(b'\n', &mut line).map_err(fail)? == 0 {
            return Ok(lines);
        }
        lines += u64::from(!line.trim_ascii().is_empty());
    }
}

fn fraction(tally: &Tally, total: u64) -> f64 {
    (tally.done + tally.failed + tally.skipped) as f64 / total.max(1) as f64
}

/// What the bar says: how many jobs of how many, and the time that is left if the others take as long.
fn words(tally: &Tally, total: u64, start: Instant) -> String {
    let ended = tally.done + tally.failed;
    let mut words = format!("{} of {total}", ended + tally.skipped);
    if tally.failed > 0 {
        words.push_str(&format!(", {} failed", tally.failed));
    }
    if ended > 0 {
        let left = total.saturating_sub(ended + tally.skipped);
        let seconds = start.elapsed().as_secs_f64() / ended as f64 * left as f64;
        words.push_str(&format!(", {seconds:.0} s left"));
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_are_counted_and_the_first_named() {
        let mut tally = Tally::default();
        for i in 0..NAMED + 5 {
            tally.add(&json!({ "id": i.to_string(), "status": "failed", "error": { "message": "no" } }));
        }
        tally.add(&json!({ "id": "x", "status": "done" }));
        assert_eq!((tally.done, tally.failed, tally.failures.len()), (1, NAMED as u64 + 5, NAMED));
        assert!(words(&tally, 50, Instant::now()).starts_with("26 of 50, 25 failed, "));
        assert!(fraction(&tally, 52) == 0.5 && fraction(&Tally::default(), 0) == 0.0);
    }
}

//! Workers: threads that run one job after the other, each in a process of its own.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use super::ATTEMPTS;
use super::job::{Job, Jobs, Limits};
use crate::cli::fault::Fault;

/// How long one look for a report waits: how soon Ctrl-C is heard.
const LOOK: Duration = Duration::from_millis(100);

/// What workers share.
#[derive(Debug)]
struct Shared {
    jobs: Mutex<Jobs>,
    skipped: AtomicU64,
    stopped: AtomicBool,
    /// The process of each worker, while there is one.
    processes: Vec<Mutex<Option<Child>>>,
    program: PathBuf,
    folder: PathBuf,
    limits: Limits,
}

/// The workers of a run.
pub(super) struct Pool {
    shared: Arc<Shared>,
    ended: Receiver<Result<Value, Fault>>,
}

/// What a look for a report finds.
pub(super) enum Next {
    /// A job has ended.
    Report(Value),
    /// None has ended yet.
    Nothing,
    /// There are no more jobs, or jobs cannot be read any more.
    End(Result<(), Fault>),
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Pool {
    /// Starts workers. Paths in jobs start at `folder`.
    pub(super) fn start(jobs: Jobs, folder: &Path, limits: &Limits, workers: usize) -> Result<Self, Fault> {
        let program = std::env::current_exe()
            .map_err(|error| Fault::internal(format!("cannot find this program to run it: {error}")))?;
        let shared = Arc::new(Shared {
            jobs: Mutex::new(jobs),
            skipped: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
            processes: (0..workers).map(|_| Mutex::new(None)).collect(),
            program,
            folder: folder.to_path_buf(),
            limits: *limits,
        });
        // As many reports as workers wait at most: who writes them is no slower than who makes them.
        let (sender, ended) = sync_channel(workers);
        for place in 0..workers {
            let (shared, sender) = (Arc::clone(&shared), sender.clone());
            thread::Builder::new()
                .spawn(move || serve(&shared, place, &sender))
                .map_err(|error| Fault::internal(format!("cannot start a worker: {error}")))?;
        }
        Ok(Self { shared, ended })
    }

    /// Waits a little for the next report.
    pub(super) fn next(&self) -> Next {
        match self.ended.recv_timeout(LOOK) {
            Ok(Ok(report)) => Next::Report(report),
            Ok(Err(fault)) => Next::End(Err(fault)),
            Err(RecvTimeoutError::Timeout) => Next::Nothing,
            Err(RecvTimeoutError::Disconnected) => Next::End(Ok(())),
        }
    }

    /// Jobs passed over because they were reported before.
    pub(super) fn skipped(&self) -> u64 {
        self.shared.skipped.load(Ordering::Relaxed)
    }
}

/// Ends all processes, however the run ends; what they were at is not reported.
impl Drop for Pool {
    fn drop(&mut self) {
        self.shared.stopped.store(true, Ordering::SeqCst);
        for process in &self.shared.processes {
            if let Some(child) = locked(process).as_mut() {
                // It may have ended by itself.
                let _ = child.kill();
                let _ = child.wait();
            }
        }
    }
}

/// Runs jobs until there are none.
fn serve(shared: &Shared, place: usize, sender: &SyncSender<Result<Value, Fault>>) {
    loop {
        let job = {
            let mut jobs = locked(&shared.jobs);
            let job = jobs.next();
            shared.skipped.store(jobs.skipped, Ordering::Relaxed);
            job
        };
        if shared.stopped.load(Ordering::SeqCst) {
            return;
        }
        let ended = match job {
            Ok(Some(job)) => Ok(shared.run(&job, place)),
            Ok(None) => return,
            Err(fault) => Err(fault),
        };
        let is_end = ended.is_err();
        if shared.stopped.load(Ordering::SeqCst) || sender.send(ended).is_err() || is_end {
            return;
        }
    }
}

impl Shared {
    /// The report of a job.
    fn run(&self, job: &Job, place: usize) -> Value {
        let start = Instant::now();
        let mut report = Map::new();
        report.insert("id".into(), job.id.as_str().into());
        let said = self.said(job, place);
        let is_done = said
            .as_ref()
            .is_ok_and(|said| matches!(said.get("exit_code").and_then(Value::as_u64), Some(0 | 5)));
        report.insert("status".into(), if is_done { "done" } else { "failed" }.into());
        match said {
            // What the program says of itself is the same for all jobs.
            Ok(said) => {
                report.extend(said.into_iter().filter(|(key, _)| key != "program" && key != "schema"));
            }
            Err((kind, message)) => {
                report.insert("error".into(), json!({ "kind": kind, "message": message }));
                report.insert("seconds".into(), json!({ "total": start.elapsed().as_secs_f64() }));
            }
        }
        report.into()
    }

    /// What the program says of a job; the kind of what is wrong, and what.
    fn said(&self, job: &Job, place: usize) -> Result<Map<String, Value>, (&'static str, String)> {
        let line = job.arguments(&self.limits).map_err(|message| ("usage", message))?;
        if let Some(folder) = job.output().ok().flatten().and_then(|output| Path::new(output).parent()) {
            let folder = self.folder.join(folder);
            std::fs::create_dir_all(&folder)
                .map_err(|error| ("unreadable", format!("cannot create {}: {error}", folder.display())))?;
        }
        let mut ended = String::new();
        for _ in 0..ATTEMPTS {
            let mut command = Command::new(&self.program);
            command.args(&line).current_dir(&self.folder);
            let (text, status) =
                self.ended(command, place).map_err(|error| ("internal", error.to_string()))?;
            if let Ok(Value::Object(said)) = serde_json::from_slice(&text) {
                return Ok(said);
            }
            ended = status.map_or_else(|| "it was stopped".into(), |status| status.to_string());
            if self.stopped.load(Ordering::SeqCst) {
                break;
            }
        }
        Err((
            "lost",
            format!(
                "the process of this job ended without a word ({ended}), {ATTEMPTS} times; signals 6 and 9 are usually memory: set \
                 --job-memory, or fewer --workers"
            ),
        ))
    }

    /// Runs a process to its end: what it printed, and how it ended.
    fn ended(&self, mut command: Command, place: usize) -> std::io::Result<(Vec<u8>, Option<ExitStatus>)> {
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn()?;
        let printed = child.stdout.take();
        let mut process = locked(&self.processes[place]);
        let running = process.insert(child);
        if self.stopped.load(Ordering::SeqCst) {
            // Who stopped us has looked at this place before there was a process.
            running.kill()?;
        }
        drop(process);
        let mut text = Vec::new();
        if let Some(mut printed) = printed {
            // (Without the lock, so that the process can be ended meanwhile.)
            printed.read_to_end(&mut text)?;
        }
        let status = locked(&self.processes[place]).take().map(|mut child| child.wait()).transpose()?;
        Ok((text, status))
    }
}

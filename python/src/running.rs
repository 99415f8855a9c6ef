//! Long calls: Python's lock is let go of, Ctrl-C and limits stop them, progress is told, and forked processes are safe.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use trisect::control::most_threads;
use trisect::{CancelToken, Control, Error};

use crate::failures;

/// Below so many triangles a call takes some milliseconds at most and is not watched: starting a thread to be able to stop it
/// would take a good part of the time of small ones.
pub(crate) const WATCHED_FROM: usize = 20_000;

/// How often a watched call is looked at: soon at first, since most end soon, then so that nobody feels a delay.
const LOOKS: [Duration; 2] = [Duration::from_millis(5), Duration::from_millis(40)];

/// The stack of the thread that does the work: that of a program's first thread.
const STACK: usize = 8 << 20;

/// What stops a call, and who hears of its progress.
#[derive(Default)]
pub(crate) struct Limits {
    pub(crate) deadline: Option<f64>,
    pub(crate) memory: Option<u64>,
    pub(crate) threads: Option<usize>,
    pub(crate) progress: Option<Py<PyAny>>,
}

impl Limits {
    /// Whether somebody has to look while the call runs.
    fn are_watched(&self, size: usize) -> bool {
        size >= WATCHED_FROM || self.progress.is_some()
    }

    /// Calls `work` with these limits; `size` is how many triangles it has to do with.
    pub(crate) fn run<T: Send>(
        &self,
        py: Python<'_>,
        size: usize,
        work: impl FnOnce(&Control) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        py.check_signals()?;
        let token = CancelToken::new();
        let told: Arc<Mutex<Option<(String, f64)>>> = Arc::default();
        let control = self.control(&token, &told)?;
        let pool = pool(self.threads)?;
        let guarded = move || {
            catch_unwind(AssertUnwindSafe(|| match &pool {
                Some(pool) => pool.install(|| work(&control)),
                None => work(&control),
            }))
        };
        let ended = if self.are_watched(size) {
            let progress = self.progress.as_ref();
            py.detach(|| watched(guarded, &token, &told, progress))?
        } else {
            py.detach(guarded)
        };
        match ended {
            Ok(result) => result.map_err(|error| failures::exception(&error)),
            Err(payload) => Err(failures::panic(&*payload)),
        }
    }

    fn control(&self, token: &CancelToken, told: &Arc<Mutex<Option<(String, f64)>>>) -> PyResult<Control> {
        let mut control = Control::new().cancel(token);
        if let Some(seconds) = self.deadline {
            let wait = Duration::try_from_secs_f64(seconds).ok();
            let end = wait.and_then(|wait| Instant::now().checked_add(wait));
            let wrong = || failures::argument(&format!("the deadline is a number of seconds, not {seconds}"));
            control = control.deadline(end.ok_or_else(wrong)?);
        }
        if let Some(bytes) = self.memory {
            control = control.memory_limit(bytes);
        }
        if self.progress.is_some() {
            let told = Arc::clone(told);
            control = control.progress(move |stage, fraction| {
                *told.lock().unwrap_or_else(PoisonError::into_inner) = Some((stage.to_owned(), fraction));
            });
        }
        Ok(control)
    }
}

/// Runs `work` in a thread of its own, and looks meanwhile for signals and progress. (Only Python's main thread gets signals, and
/// only while it asks for them.)
fn watched<T: Send>(
    work: impl FnOnce() -> T + Send,
    token: &CancelToken,
    told: &Mutex<Option<(String, f64)>>,
    progress: Option<&Py<PyAny>>,
) -> PyResult<T> {
    let (done, wait) = channel::<()>();
    thread::scope(|scope| {
        let run = move || {
            let result = work();
            drop(done);
            result
        };
        let worker = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, run);
        let worker =
            worker.map_err(|error| failures::argument(&format!("cannot start a thread: {error}")))?;
        let mut interruption = None;
        let mut looks = 0;
        while let Err(RecvTimeoutError::Timeout) = wait.recv_timeout(LOOKS[usize::from(looks > 0)]) {
            looks += 1;
            if interruption.is_none()
                && let Err(error) = Python::attach(|py| look(py, told, progress))
            {
                token.cancel();
                interruption = Some(error);
            }
        }
        let result = worker.join().unwrap_or_else(|payload| resume_unwind(payload));
        match interruption {
            Some(error) => Err(error),
            // What was told last, the end among it.
            None => Python::attach(|py| tell(py, told, progress)).map(|()| result),
        }
    })
}

/// Looks for Ctrl-C and tells how far the call is.
fn look(py: Python<'_>, told: &Mutex<Option<(String, f64)>>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    py.check_signals()?;
    tell(py, told, progress)
}

fn tell(py: Python<'_>, told: &Mutex<Option<(String, f64)>>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    let news = told.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let (Some((stage, fraction)), Some(progress)) = (news, progress) {
        progress.call1(py, (stage, fraction))?;
    }
    Ok(())
}

/// Threads of pools made so far: the process that made them, how many they are, and they.
static POOLS: Mutex<Vec<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// The process in which the package was first used: rayon's own threads are there, and in no process forked from it.
fn first_process() -> u32 {
    static FIRST: OnceLock<u32> = OnceLock::new();
    *FIRST.get_or_init(process::id)
}

/// The pool to work in. `None`: rayon's own, which lives in the process that first used the package. Work handed to its threads
/// from a process forked later would wait for ever, since threads are not forked.
fn pool(threads: Option<usize>) -> PyResult<Option<Arc<ThreadPool>>> {
    let here = process::id();
    if threads.is_none() && here == first_process() {
        return Ok(None);
    }
    let cores = || thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    let threads = threads.unwrap_or_else(cores).clamp(1, most_threads());
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    // Threads of another process are not here: there is nothing to end, and waiting for it would not end.
    for (_, _, lost) in pools.extract_if(.., |(process, ..)| *process != here) {
        std::mem::forget(lost);
    }
    if let Some((.., pool)) = pools.iter().find(|(_, count, _)| *count == threads) {
        return Ok(Some(Arc::clone(pool)));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
    let pool = Arc::new(
        pool.map_err(|error| failures::argument(&format!("cannot make {threads} threads: {error}")))?,
    );
    pools.push((here, threads, Arc::clone(&pool)));
    Ok(Some(pool))
}

/// Notes the process that imports the package.
pub(crate) fn note_process() {
    let _ = first_process();
}

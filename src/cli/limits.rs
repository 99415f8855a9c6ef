//! What ends a run early: Ctrl-C, the deadline, the memory ceiling.

use std::io::Write as _;
use std::path::PathBuf;
use std::process;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use trisect::{CancelToken, Control, Error};

use super::argument_groups::Common;
use super::color::PREFIX;
use super::fault::Fault;

/// How long after the deadline a run that does not notice it is ended by force.
const GRACE: Duration = Duration::from_secs(5);

/// The limits of a run. The first Ctrl-C (or termination signal) asks the run to stop, the second ends it at once;
/// either way nothing unfinished stays on disk.
#[derive(Debug)]
pub(crate) struct Limits {
    token: CancelToken,
    deadline: Option<Instant>,
    memory: Option<u64>,
    shared: Arc<Shared>,
}

/// What the signal handler and the watchdog need to know.
#[derive(Debug, Default)]
struct Shared {
    json: bool,
    interrupts: AtomicUsize,
    /// How many threads wait for a pipe and cannot notice anything; nothing has been written yet.
    waiting: AtomicUsize,
    /// Folders of unfinished outputs. Locked while outputs are put in place.
    unfinished: Mutex<Vec<PathBuf>>,
}

impl Limits {
    /// Starts to listen for signals, and the clock of `--timeout`.
    pub(crate) fn install(common: &Common) -> Result<Self, Fault> {
        let shared = Arc::new(Shared { json: common.json, ..Shared::default() });
        let token = CancelToken::new();
        let (cancel, handler) = (token.clone(), Arc::clone(&shared));
        ctrlc::set_handler(move || {
            cancel.cancel();
            let again = handler.interrupts.fetch_add(1, Ordering::SeqCst) > 0;
            if again || handler.waiting.load(Ordering::SeqCst) > 0 {
                handler.end(Error::Limit(trisect::Limit::Cancelled));
            }
        })
        .map_err(|error| Fault::internal(format!("cannot listen for signals: {error}")))?;

        let deadline = common.timeout.and_then(|time| Instant::now().checked_add(time));
        if let (Some(time), Some(_)) = (common.timeout, deadline) {
            let watched = Arc::clone(&shared);
            thread::spawn(move || {
                thread::sleep(time);
                if watched.waiting.load(Ordering::SeqCst) == 0 {
                    thread::sleep(GRACE);
                }
                watched.end(Error::Limit(trisect::Limit::DeadlineExceeded));
            });
        }
        Ok(Self { token, deadline, memory: common.memory, shared })
    }

    /// A control with these limits, without progress.
    pub(crate) fn control(&self) -> Control {
        let mut control = Control::new().cancel(&self.token);
        if let Some(deadline) = self.deadline {
            control = control.deadline(deadline);
        }
        if let Some(memory) = self.memory {
            control = control.memory_limit(memory);
        }
        control
    }

    /// Runs `read`, which may block without end; meanwhile a signal or the deadline ends the program at once.
    pub(crate) fn while_waiting<T>(&self, read: impl FnOnce() -> T) -> T {
        self.shared.waiting.fetch_add(1, Ordering::SeqCst);
        // A signal that came just before would otherwise be noticed only after the read.
        if self.token.is_cancelled() {
            self.shared.end(Error::Limit(trisect::Limit::Cancelled));
        }
        let result = read();
        self.shared.waiting.fetch_sub(1, Ordering::SeqCst);
        result
    }

    /// The folders to remove if the program is ended by force. While the guard is held, it is not ended.
    pub(crate) fn unfinished(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        self.shared.unfinished.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shared {
    /// Removes what is unfinished and ends the program.
    fn end(&self, reason: Error) -> ! {
        let fault = Fault::from(reason);
        // Held until the end: no output is put in place any more.
        let unfinished = self.unfinished.lock().unwrap_or_else(PoisonError::into_inner);
        for folder in unfinished.iter() {
            let _ = std::fs::remove_dir_all(folder);
        }
        let _ = writeln!(std::io::stderr(), "{PREFIX} {}", fault.message);
        if self.json {
            let _ = writeln!(std::io::stdout(), "{}", fault.to_object());
        }
        process::exit(i32::from(fault.exit.code()))
    }
}

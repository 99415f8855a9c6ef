//! Limits and progress of a running operation: cancellation, a deadline, a ceiling on memory, a progress
//! callback. One [`Control`] value is handed down through every stage; the stages ask it between small pieces
//! of work, so that a running operation stops promptly with an error of its own.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// A limit that stopped an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Limit {
    /// The caller cancelled the operation.
    #[error("cancelled")]
    Cancelled,
    /// The deadline passed.
    #[error("the time limit was reached before the operation was done")]
    DeadlineExceeded,
    /// The memory ceiling would have been exceeded.
    #[error("the operation needs {needed} bytes for its tables, more than the limit of {limit}")]
    Memory {
        /// Bytes the operation would hold.
        needed: u64,
        /// The limit set.
        limit: u64,
    },
}

/// A switch shared between the caller and a running operation. Cloning shares the switch.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// A token that is not cancelled.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks every operation that holds this token to stop. May be called from any thread, and more than once.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) has been called.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Threads that may be asked for on any machine. Tests compare the bits of up to 8 threads, also on machines with fewer
/// cores; twice that costs no time there (two cubes: 0.04 s with 64 threads on two cores, but 10 s with 1024).
const THREADS_ANYWHERE: usize = 16;

/// Threads that may be asked for, for each core. More than one lets the system balance uneven work; beyond four the
/// threads only wait for each other.
const THREADS_PER_CORE: usize = 4;

/// The most threads an operation runs on, however many are asked for: four for each core the process may use, or 16 if
/// that is more.
#[must_use]
pub fn most_threads() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    THREADS_ANYWHERE.max(THREADS_PER_CORE.saturating_mul(cores))
}

/// What a progress callback is told: the stage's name and the fraction done of the whole, in 0..=1.
pub type Progress = dyn Fn(&str, f64) + Send + Sync;

/// Limits and progress for one operation (or several in a row). The default has no limits.
///
/// Cloning shares the token, the callback and the memory account.
#[derive(Clone, Default)]
pub struct Control {
    cancel: Option<CancelToken>,
    deadline: Option<Instant>,
    memory_limit: Option<u64>,
    memory_used: Arc<AtomicU64>,
    progress: Option<Arc<Progress>>,
}

impl Control {
    /// No limits, no callback.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Stops with [`Limit::Cancelled`] soon after `token` is cancelled.
    #[must_use]
    pub fn cancel(mut self, token: &CancelToken) -> Self {
        self.cancel = Some(token.clone());
        self
    }

    /// Stops with [`Limit::DeadlineExceeded`] soon after `deadline` has passed.
    #[must_use]
    pub fn deadline(mut self, deadline: Instant) -> Self {
        self.deadline = Some(deadline);
        self
    }

    /// Stops with [`Limit::Memory`] before the operation's own tables would exceed `bytes`.
    #[must_use]
    pub fn memory_limit(mut self, bytes: u64) -> Self {
        self.memory_limit = Some(bytes);
        self
    }

    /// Calls `callback` with the stage and the fraction done, at most once per stage and piece of work.
    #[must_use]
    pub fn progress(mut self, callback: impl Fn(&str, f64) + Send + Sync + 'static) -> Self {
        self.progress = Some(Arc::new(callback));
        self
    }

    /// Whether the operation may go on. Cheap enough to ask once per thousand triangles.
    ///
    /// # Errors
    /// [`Limit::Cancelled`] or [`Limit::DeadlineExceeded`].
    pub fn check(&self) -> Result<(), Limit> {
        if self.cancel.as_ref().is_some_and(CancelToken::is_cancelled) {
            return Err(Limit::Cancelled);
        }
        if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return Err(Limit::DeadlineExceeded);
        }
        Ok(())
    }

    /// Reports progress to the callback, if there is one, and checks the limits.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn report(&self, stage: &str, fraction: f64) -> Result<(), Limit> {
        if let Some(progress) = &self.progress {
            progress(stage, fraction.clamp(0.0, 1.0));
        }
        self.check()
    }

    /// Accounts for `bytes` about to be allocated; the account is given back when the returned value drops.
    ///
    /// # Errors
    /// [`Limit::Memory`] if the operation would hold more than its limit.
    pub fn reserve(&self, bytes: u64) -> Result<Reservation, Limit> {
        let used = self.memory_used.fetch_add(bytes, Ordering::Relaxed) + bytes;
        let reservation = Reservation { account: Arc::clone(&self.memory_used), bytes };
        match self.memory_limit {
            Some(limit) if used > limit => Err(Limit::Memory { needed: used, limit }),
            _ => Ok(reservation),
        }
    }
}

impl fmt::Debug for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("cancel", &self.cancel)
            .field("deadline", &self.deadline)
            .field("memory_limit", &self.memory_limit)
            .finish_non_exhaustive()
    }
}

/// Bytes accounted for by [`Control::reserve`]; dropping it gives them back.
#[derive(Debug)]
#[must_use]
pub struct Reservation {
    account: Arc<AtomicU64>,
    bytes: u64,
}

impl Drop for Reservation {
    fn drop(&mut self) {
        self.account.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

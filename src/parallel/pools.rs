//! Pools of threads, kept from call to call.

use std::sync::{Arc, Mutex, PoisonError};

/// How many pools are kept, of different sizes. Programs use one or two; the tests three.
const POOLS: usize = 4;

/// Pools made so far, the last used at the end. Their threads sleep while nobody uses them.
static KEPT_POOLS: Mutex<Vec<Arc<rayon::ThreadPool>>> = Mutex::new(Vec::new());

/// Runs `work` in a pool of `threads` threads, [`most_threads`](crate::control::most_threads) at most. Pools are kept
/// for the next call, and callers at the same time share one.
///
/// # Errors
/// What the system says if it makes no further threads.
pub(crate) fn run_in_pool<R: Send>(
    threads: usize,
    work: impl FnOnce() -> R + Send,
) -> Result<R, rayon::ThreadPoolBuildError> {
    let threads = threads.clamp(1, crate::control::most_threads());
    Ok(pool(threads)?.install(work))
}

fn pool(threads: usize) -> Result<Arc<rayon::ThreadPool>, rayon::ThreadPoolBuildError> {
    let mut kept = KEPT_POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let pool = match kept.iter().position(|pool| pool.current_num_threads() == threads) {
        Some(place) => kept.remove(place),
        None => Arc::new(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?),
    };
    if kept.len() == POOLS {
        // Its threads end when the last who uses it is done.
        drop(kept.remove(0));
    }
    kept.push(Arc::clone(&pool));
    Ok(pool)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pools_have_the_threads_asked_for_and_are_kept() {
        for _ in 0..2 {
            for threads in [8, 2, 3, 5, 7] {
                assert_eq!(run_in_pool(threads, rayon::current_num_threads).unwrap(), threads);
            }
        }
        let most = crate::control::most_threads();
        assert!(most >= 16);
        assert_eq!(run_in_pool(100_000, rayon::current_num_threads).unwrap(), most);
        assert!(KEPT_POOLS.lock().unwrap().len() <= POOLS);
    }
}

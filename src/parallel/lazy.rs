//! What is computed when first asked for.

use std::sync::OnceLock;

/// What a cell holds, computed if it holds nothing. Where several threads ask at once, several compute, and what the first one has stays.
///
/// `OnceLock::get_or_init` lets the others wait. But a thread that computes on all threads takes up other work while it waits for
/// a part of it, perhaps a question for the same: then it would wait for itself, for ever.
pub(crate) fn get_or_compute<T>(cell: &OnceLock<T>, compute: impl FnOnce() -> T) -> &T {
    match cell.get() {
        Some(known) => known,
        None => {
            let value = compute();
            cell.get_or_init(|| value)
        }
    }
}

#[cfg(all(test, feature = "parallel"))]
mod tests {
    use std::thread::sleep;
    use std::time::Duration;

    use rayon::join;

    use super::*;

    #[test]
    fn threads_that_compute_may_be_asked_again() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let pause = |milliseconds| sleep(Duration::from_millis(milliseconds));
        for round in 0..12 {
            let cell = OnceLock::new();
            let ask = || *get_or_compute(&cell, || join(|| pause(10), || pause(40)) == ((), ()));
            // One thread computes, and the third has a part of that, if it has not taken what the second has left: to ask, and it asks already.
            let (a, (b, c)) = pool.install(|| {
                join(ask, || {
                    join(
                        || {
                            pause(5);
                            ask()
                        },
                        ask,
                    )
                })
            });
            assert!(a && b && c, "{round}");
        }
    }
}

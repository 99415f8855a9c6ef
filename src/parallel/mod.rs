//! Loops on rayon's threads where that pays and is allowed. Results come back in order, so nothing depends on the number
//! of threads, or on the feature `parallel`.
//!
//! A [`Runner`] also carries limits, for loops that may be long; the functions are for loops that are never.
//!
//! All of them reach rayon through three doors, `for_each_number`, `run_both` and [`Runner::sort`]. The first two are not
//! generic: rayon's machinery is compiled once for each of its callers, and was a sixth of the crate's code while every loop
//! was one. What hands items out and puts results together is compiled for the types of both, not for every loop (which
//! was another fourteenth): a loop comes to it as `&dyn Fn`. A call through a pointer for each piece of thousands of
//! items costs nothing.

mod lazy;
mod loops;
#[cfg(feature = "parallel")]
mod pools;
mod read_ahead;
mod runner;

pub(crate) use lazy::get_or_compute;
pub(crate) use loops::{all, append, build, join, map, map_chunks, parts, piece_count, ranges, try_map};
#[cfg(feature = "parallel")]
pub(crate) use pools::run_in_pool;
pub(crate) use read_ahead::read_ahead;
pub(crate) use runner::Runner;

//! The command-line program.

#[path = "cli/eval.rs"]
#[allow(dead_code, reason = "called by the verbs of the program")]
mod eval;
#[path = "cli/slice.rs"]
#[allow(dead_code, reason = "called by the verbs of the program")]
mod slice;

fn main() {}

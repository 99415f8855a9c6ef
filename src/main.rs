//! The command-line program. `trisect --help` tells what it does; `docs/program.md` tells it in full.

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod cli;

/// Stages take lists of megabytes and give them back. The system's allocator gives most of them back to the kernel, which clears every page again:
/// a sixth of the time of a union of balls of 328 k triangles, a fifth on two threads (benches/README.md).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    cli::run()
}

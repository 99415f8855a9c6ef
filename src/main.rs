//! The command-line program. `trisect --help` tells what it does; `docs/program.md` tells it in full.

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}

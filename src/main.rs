//! The command-line program. `trisect --help` tells what it does; `docs/program.md` tells it in full.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}

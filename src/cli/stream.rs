//! Standard output, and files that are devices: what is written to at once, without a stage.

use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

use super::fault::Fault;

/// The name that stands for standard input and output.
pub(crate) const STANDARD: &str = "-";

/// An existing thing that is not a file: writing beside it and renaming would destroy it.
pub(crate) fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|what| !what.is_file() && !what.is_dir())
}

/// Prints text on standard output; a reader that went away is no failure.
pub(crate) fn print(text: &str) -> Result<(), Fault> {
    print_bytes(text.as_bytes())
}

/// Writes bytes to standard output; a reader that went away is no failure.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Fault> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Fault::output("standard output", error))
        }
        _ => Ok(()),
    }
}

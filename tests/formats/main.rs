//! Reading and writing files of every format.

mod common;
mod files;
mod fixtures;
mod hostile;
mod oracle;
mod round_trip;
mod written;

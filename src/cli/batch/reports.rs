//! The file of reports: one line a job. When a run goes on, what it has already is known.

use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead as _, BufReader, Seek as _, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;
use trisect::{Error, FileAction};

use super::job::number_of;
use crate::cli::fault::Fault;
use crate::cli::stream::STANDARD;

/// Where reports go.
pub(super) struct Reports {
    path: PathBuf,
    out: Box<dyn Write>,
    known: HashSet<u64>,
}

impl Reports {
    /// Opens the file, and reads what it has: a line that was cut off when a run was stopped is taken away. With `anew` it begins
    /// empty; with `retry_failed` jobs that failed are not known.
    pub(super) fn open(path: &Path, anew: bool, retry_failed: bool) -> Result<Self, Fault> {
        let mut known = HashSet::new();
        if path == Path::new(STANDARD) {
            return Ok(Self { path: "standard output".into(), out: Box::new(io::stdout()), known });
        }
        let fail = |action| move |source| Error::File { action, path: path.to_path_buf(), source };
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(anew);
        let mut file = options.open(path).map_err(fail(FileAction::Create))?;
        let whole = read(&file, retry_failed, &mut known).map_err(fail(FileAction::Read))?;
        file.set_len(whole).map_err(fail(FileAction::Write))?;
        file.seek(SeekFrom::Start(whole)).map_err(fail(FileAction::Write))?;
        Ok(Self { path: path.to_path_buf(), out: Box::new(file), known })
    }

    /// The jobs that have a report.
    pub(super) fn take_known(&mut self) -> HashSet<u64> {
        std::mem::take(&mut self.known)
    }

    /// Adds a report, in one piece.
    pub(super) fn write(&mut self, report: &Value) -> Result<(), Fault> {
        let line = format!("{report}\n");
        let written = self.out.write_all(line.as_bytes()).and_then(|()| self.out.flush());
        written.map_err(|source| Fault::output(&self.path, source))
    }
}

/// Notes the jobs that are reported; how long the whole lines are together.
fn read(file: &File, retry_failed: bool, known: &mut HashSet<u64>) -> io::Result<u64> {
    let mut reader = BufReader::new(file);
    let (mut whole, mut line) = (0, Vec::new());
    loop {
        line.clear();
        let length = reader.read_until(b'\n', &mut line)?;
        if length == 0 || !line.ends_with(b"\n") {
            return Ok(whole);
        }
        whole += length as u64;
        let report: Value = serde_json::from_slice(&line).map_err(|error| {
            io::Error::new(io::ErrorKind::InvalidData, format!("it is no file of reports: {error}"))
        })?;
        let number = number_of(report["id"].as_str().unwrap_or_default());
        if retry_failed && report["status"] != "done" {
            known.remove(&number);
        } else {
            known.insert(number);
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_run_goes_on_where_it_was_stopped() {
        let path = std::env::temp_dir().join(format!("trisect-reports-{}", std::process::id()));
        let text = "{\"id\": \"a\", \"status\": \"done\"}\n{\"id\": \"b\", \"status\": \"failed\"}\n{\"id\": \"c\", \"sta";
        let known = |retry: bool| {
            std::fs::write(&path, text).unwrap();
            let mut reports = Reports::open(&path, false, retry).unwrap();
            reports.write(&json!({ "id": "c", "status": "done" })).unwrap();
            let known = reports.take_known();
            ["a", "b", "c"].map(|id| known.contains(&number_of(id)))
        };
        assert_eq!(known(true), [true, false, false]);
        assert_eq!(known(false), [true, true, false]);
        let lines = std::fs::read_to_string(&path).unwrap();
        assert_eq!(lines.lines().count(), 3);
        assert!(lines.lines().all(|line| serde_json::from_str::<Value>(line).is_ok()));
        assert!(Reports::open(&path, true, false).unwrap().take_known().is_empty());
        std::fs::write(&path, "no reports\n").unwrap();
        assert!(Reports::open(&path, false, false).is_err());
        std::fs::remove_file(path).unwrap();
    }
}

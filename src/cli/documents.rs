//! Outputs that are bytes already: text, SVG, pictures of sections, grids.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::argument_groups::Common;
use super::fault::Fault;
use super::limits::Limits;
use super::stage::{self, Stage};
use super::stream;
use super::stream::STANDARD;

/// A file to be written, or standard output.
pub(crate) struct Document {
    pub(crate) path: PathBuf,
    /// In lower case, as in JSON.
    pub(crate) format: &'static str,
    pub(crate) bytes: Vec<u8>,
}

/// Refuses places where documents cannot go, before they are made: folders, the same place twice, and what cannot be
/// written.
pub(crate) fn check<'p>(
    paths: impl IntoIterator<Item = &'p Path>,
    common: &Common,
    limits: &Limits,
) -> Result<(), Fault> {
    let mut earlier: Vec<&Path> = common.report.as_deref().into_iter().collect();
    for path in paths {
        if earlier.contains(&path) {
            return Err(Fault::usage(format!("{} is named as an output twice", path.display())));
        }
        earlier.push(path);
        if path == Path::new(STANDARD) {
            if common.json {
                return Err(Fault::usage("--json and -o - both want standard output; use --report FILE"));
            }
        } else if path.is_dir() {
            return Err(Fault::usage(format!("{} is a folder; name a file in it", path.display())));
        } else if !stream::is_device(path) {
            Stage::new(path, limits).map_err(|error| Fault::output(path, error))?;
        }
    }
    Ok(())
}

/// Refuses a file whose name says another format than the one it would get; streams and devices may have any name.
pub(crate) fn check_ending(path: &Path, endings: &[&str], advice: &str) -> Result<(), Fault> {
    let ending = path.extension().and_then(std::ffi::OsStr::to_str).unwrap_or_default();
    let known = endings.iter().any(|known| ending.eq_ignore_ascii_case(known));
    if known || path == Path::new(STANDARD) || stream::is_device(path) {
        return Ok(());
    }
    Err(Fault::usage(format!("{advice}, not {}", path.display())))
}

/// Writes a document in its hidden folder, or to its stream.
pub(crate) fn staged<'l>(document: &Document, limits: &'l Limits) -> Result<Option<Stage<'l>>, Fault> {
    let failed = |error| Fault::output(&document.path, error);
    if document.path == Path::new(STANDARD) {
        stream::print_bytes(&document.bytes)?;
        return Ok(None);
    }
    if stream::is_device(&document.path) {
        let mut out = fs::File::options().write(true).open(&document.path).map_err(failed)?;
        out.write_all(&document.bytes).map_err(failed)?;
        return Ok(None);
    }
    let stage = Stage::new(&document.path, limits).map_err(failed)?;
    fs::write(stage.path(), &document.bytes).map_err(failed)?;
    Ok(Some(stage))
}

/// What the report says of a document.
pub(crate) fn described(document: &Document) -> Value {
    json!({
        "file": document.path.display().to_string(),
        "format": document.format,
        "bytes": document.bytes.len(),
    })
}

/// Writes all documents. No file changes before all of them are written in full.
pub(crate) fn write(documents: &[Document], limits: &Limits) -> Result<Vec<Value>, Fault> {
    let mut stages = Vec::new();
    for document in documents {
        stages.extend(staged(document, limits)?);
    }
    stage::commit(&stages, limits)?;
    Ok(documents.iter().map(described).collect())
}

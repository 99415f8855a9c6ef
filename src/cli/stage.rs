//! Outputs that appear complete or not at all: written in a hidden folder beside their place, then renamed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process;

use trisect::Error;

use super::limits::Limits;

/// A hidden folder beside an output, removed with everything in it when dropped.
pub(crate) struct Stage<'a> {
    folder: PathBuf,
    /// Where the output goes, links followed.
    place: PathBuf,
    limits: &'a Limits,
}

impl<'a> Stage<'a> {
    /// Makes the folder for an output at `path`. Fails where the output could not be put in place later: no such
    /// folder, or one that must not be written to.
    pub(crate) fn new(path: &Path, limits: &'a Limits) -> io::Result<Self> {
        // A link keeps pointing where it did: the file behind it is replaced.
        let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if fs::metadata(&place).is_ok_and(|old| old.permissions().readonly()) {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        let beside = folder_of(&place);
        let mut unfinished = limits.unfinished();
        for attempt in 0_u32.. {
            let folder = beside.join(format!(".trisect-{}-{attempt}", process::id()));
            match fs::create_dir(&folder) {
                Ok(()) => {
                    unfinished.push(folder.clone());
                    drop(unfinished);
                    return Ok(Self { folder, place, limits });
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempt < 1000 => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// Where to write the output for now: under its own name, so that files that belong to it (a material library,
    /// a buffer) get theirs.
    pub(crate) fn path(&self) -> PathBuf {
        self.folder.join(self.place.file_name().unwrap_or_default())
    }

    /// Puts everything in the folder in place; the output itself last, after what it refers to. Returns the bytes
    /// written.
    fn commit(&self) -> Result<u64, Error> {
        let failed = |path: &Path, source| Error::File {
            action: trisect::FileAction::Replace,
            path: path.to_path_buf(),
            source,
        };
        let entries = fs::read_dir(&self.folder).map_err(|error| failed(&self.place, error))?;
        let mut names: Vec<_> = entries.flatten().map(|entry| entry.file_name()).collect();
        names.sort_by_key(|name| (Some(name.as_os_str()) == self.place.file_name(), name.clone()));
        let mut bytes = 0;
        for name in names {
            let (from, to) = (self.folder.join(&name), folder_of(&self.place).join(&name));
            if let Ok(old) = fs::metadata(&to) {
                // A file that was private stays private. If that cannot be done, it is none of the run's failures.
                let _ = fs::set_permissions(&from, old.permissions());
            }
            bytes += fs::metadata(&from).map_or(0, |file| file.len());
            fs::rename(&from, &to).map_err(|error| failed(&to, error))?;
        }
        Ok(bytes)
    }
}

impl Drop for Stage<'_> {
    fn drop(&mut self) {
        // What cannot be removed now will not be removable later either.
        let _ = fs::remove_dir_all(&self.folder);
        self.limits.unfinished().retain(|folder| *folder != self.folder);
    }
}

/// Puts all outputs in place and returns their sizes. Until here, none of them has changed anything outside its
/// hidden folder.
pub(crate) fn commit(stages: &[Stage<'_>], limits: &Limits) -> Result<Vec<u64>, Error> {
    limits.control().check()?;
    // Held: a second Ctrl-C waits until all are in place.
    let guard = limits.unfinished();
    let sizes = stages.iter().map(Stage::commit).collect();
    drop(guard);
    sizes
}

/// Puts one output in place whatever happened to the run: the report of a cancelled run is a report.
pub(crate) fn replace(stage: &Stage<'_>, limits: &Limits) -> Result<(), Error> {
    let _guard = limits.unfinished();
    stage.commit().map(|_| ())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

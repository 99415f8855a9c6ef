//! The models that cuts are tried on.

use std::path::{Path, PathBuf};

use trisect::{Mesh, Solid};

/// All files in a folder and those inside it, by name.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths.into_iter().flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// Every model that is a solid: those of the fixtures, or of the folder that `TRISECT_MODELS` names.
pub(crate) fn solids() -> Vec<(String, Solid)> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let paths = match std::env::var_os("TRISECT_MODELS") {
        Some(folder) => files(Path::new(&folder)),
        None => files(&fixtures.join("models")),
    };
    let solid = |path: &PathBuf| {
        let solid = Solid::try_from(Mesh::load(path).ok()?).ok().filter(|solid| solid.volume() > 0.0)?;
        Some((path.file_name()?.to_string_lossy().into_owned(), solid))
    };
    paths.iter().filter_map(solid).collect()
}

//! Names of inputs that mean a part of a file.

use std::path::{Path, PathBuf};

use trisect::Mesh;
use trisect::io::{Contents, Format};

use super::stream::STANDARD;

/// A part of a file, read.
#[derive(Debug, PartialEq)]
pub(crate) struct Chosen {
    /// Its name; nothing where it is the whole file.
    pub(crate) name: Option<String>,
    pub(crate) mesh: Mesh,
    pub(crate) format: Format,
    pub(crate) warnings: Vec<String>,
    /// What the file holds besides the mesh.
    pub(crate) contents: Contents,
}

/// The file that a name on the command line means, and the name of a part if it has one after `#`. A file that exists under
/// the whole name is that file; else the longest beginning counts that is a file, or all before the last `#`.
pub(crate) fn split(path: PathBuf) -> (PathBuf, Option<String>) {
    let Some(text) = path.to_str().filter(|text| text.contains('#') && !path.exists()) else {
        return (path, None);
    };
    let exists = |at: &usize| text[..*at] == *STANDARD || Path::new(&text[..*at]).exists();
    let mut places = text.rmatch_indices('#').map(|(at, _)| at).filter(|&at| at > 0);
    let last = places.clone().next();
    match places.find(exists).or(last) {
        Some(at) => (text[..at].into(), Some(text[at + 1..].into())),
        None => (path, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_after_the_file_is_a_part() {
        let folder = std::env::temp_dir().join(format!("trisect-parts-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        for name in ["a.obj", "b#1.obj"] {
            std::fs::write(folder.join(name), "").expect("written");
        }
        let parts = |name: &str| {
            let (path, part) = split(folder.join(name));
            (path.file_name().unwrap_or_default().to_string_lossy().into_owned(), part)
        };
        let named = |file: &str, part: &str| (file.to_owned(), Some(part.to_owned()));
        assert_eq!(parts("a.obj#base"), named("a.obj", "base"));
        assert_eq!(parts("a.obj#x#y"), named("a.obj", "x#y"));
        assert_eq!(parts("b#1.obj"), ("b#1.obj".to_owned(), None));
        assert_eq!(parts("b#1.obj#top"), named("b#1.obj", "top"));
        assert_eq!(parts("missing.glb#top"), named("missing.glb", "top"));
        assert_eq!(split("-#top".into()), ("-".into(), Some("top".to_owned())));
        assert_eq!(split("#top".into()), ("#top".into(), None));
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}

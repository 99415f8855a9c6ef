//! Files named in files: buffers of glTF, material libraries of OBJ.

use std::fs::{self, File};
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

/// The path of a file named in a file, which must lie in `folder` or below.
pub(super) fn beside(folder: &Path, name: &str) -> Result<PathBuf, String> {
    // Windows programs write backslashes.
    let relative = PathBuf::from(name.replace('\\', "/"));
    let inside = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    if name.is_empty() || name.contains('\0') {
        return Err("the name is empty or holds a zero byte".to_string());
    }
    if name.contains(':') || !relative.components().all(inside) {
        return Err(
            "only files in the file's own folder and below are opened; copy it there and give its relative path"
                .to_string(),
        );
    }
    Ok(folder.join(relative))
}

/// Reads a regular file named in a file, if it lies in `folder` or below and has at most `limit` bytes.
pub(super) fn read_beside(folder: &Path, name: &str, limit: u64) -> Result<Vec<u8>, String> {
    let path = beside(folder, name)?;
    let metadata = fs::metadata(&path).map_err(|error| error.to_string())?;
    if !metadata.is_file() {
        return Err("it is not a regular file".to_string());
    }
    if metadata.len() > limit {
        return Err(format!("it has {} bytes, more than the {limit} allowed", metadata.len()));
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    let file = File::open(&path).map_err(|error| error.to_string())?;
    file.take(limit).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_below_the_folder_are_opened() {
        let folder = Path::new("models");
        for name in [
            "../a.bin",
            "/etc/passwd",
            "a/../../b",
            "file:///a",
            "C:\\a.bin",
            "http://a/b",
            "",
            "a\0b",
            "\\a",
        ] {
            assert!(beside(folder, name).is_err(), "{name}");
        }
        assert_eq!(beside(folder, "textures\\a b.mtl").unwrap(), Path::new("models/textures/a b.mtl"));
        assert_eq!(beside(folder, "./a.bin").unwrap(), Path::new("models/./a.bin"));
    }
}

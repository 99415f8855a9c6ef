//! Inputs that are parts of files: `scene.glb#base`, `scene.glb#cut_*`.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use trisect::io::{self, Format, PartName, Parts};
use trisect::{Control, Error, Mesh};

use super::limits::Limits;
use super::operands;
use super::requests::{Request, STANDARD};

/// A part of a file, read.
#[derive(Debug, PartialEq)]
pub(crate) struct Chosen {
    /// Its name; nothing where it is the whole file.
    pub(crate) name: Option<String>,
    pub(crate) mesh: Mesh,
    pub(crate) format: Format,
    pub(crate) warnings: Vec<String>,
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

/// The inputs with every part that is asked for read: each part a pattern means is an input of its own.
pub(crate) fn each(
    requests: Vec<Request>,
    limits: &Limits,
    control: &Control,
) -> Result<Vec<Request>, Error> {
    let mut files: HashMap<(PathBuf, Option<Format>), Parts> = HashMap::new();
    let mut expanded = Vec::with_capacity(requests.len());
    for (index, request) in requests.into_iter().enumerate() {
        let Some(pattern) = request.part.clone().filter(|_| request.chosen.is_none()) else {
            expanded.push(request);
            continue;
        };
        let fail = |error: Error| error.of_operand(index, request.name());
        let key = (request.path.clone(), request.format);
        if !files.contains_key(&key) {
            files.insert(key.clone(), read(&request, limits, control).map_err(fail)?);
        }
        let Some(file) = files.get(&key) else { continue };
        let parts = file.select(&pattern).map_err(fail)?;
        for (number, part) in parts.into_iter().enumerate() {
            // What is to be said of the file is said once.
            let warnings = if number == 0 { file.whole.warnings.clone() } else { Vec::new() };
            let chosen =
                Chosen { name: Some(part.name), mesh: part.mesh, format: file.whole.format, warnings };
            expanded.push(Request { chosen: Some(Arc::new(chosen)), ..request.clone() });
        }
    }
    Ok(expanded)
}

/// The input with all parts that it asks for as one mesh.
pub(crate) fn together(request: Request, limits: &Limits, control: &Control) -> Result<Request, Error> {
    let Some(pattern) = request.part.clone() else { return Ok(request) };
    let file = read(&request, limits, control)?;
    let parts = file.select(&pattern)?;
    let mesh = Mesh::merged(parts.iter().map(|part| &part.mesh))?;
    let chosen =
        Chosen { name: Some(pattern), mesh, format: file.whole.format, warnings: file.whole.warnings };
    Ok(Request { chosen: Some(Arc::new(chosen)), ..request })
}

/// The input, read, and the names of the parts of its file.
pub(crate) fn whole(
    request: Request,
    limits: &Limits,
    control: &Control,
) -> Result<(Request, Vec<PartName>), Error> {
    if request.chosen.is_some() {
        return Ok((request, Vec::new()));
    }
    let file = read(&request, limits, control)?;
    let names = file.names();
    let io::Loaded { mesh, format, warnings, .. } = file.whole;
    let chosen = Chosen { name: None, mesh, format, warnings };
    Ok((Request { chosen: Some(Arc::new(chosen)), ..request }, names))
}

fn read(request: &Request, limits: &Limits, control: &Control) -> Result<Parts, Error> {
    let options = operands::options(request, control);
    match request.format {
        Some(format) => {
            let (bytes, options) = operands::bytes(request, options, limits)?;
            io::read_parts(&bytes, format, &options)
        }
        None => io::load_parts(&request.path, &options),
    }
    .map_err(operands::name_option)
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

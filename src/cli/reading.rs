//! Inputs read and moved to their place.

use std::io::Read as _;
use std::path::Path;

use trisect::control::Reservation;
use trisect::io::{self, Contents, Format};
use trisect::{Control, Error, Mesh};

use super::limits::Limits;
use super::requests::Request;
use super::stream::STANDARD;
use super::transforms::Transform;

/// A file that was read and moved.
pub(crate) struct Input {
    pub(crate) mesh: Mesh,
    pub(crate) format: Format,
    pub(crate) warnings: Vec<String>,
    /// What the file holds besides the mesh.
    pub(crate) contents: Contents,
    /// The mesh's share of the memory ceiling.
    pub(crate) reserved: Reservation,
}

/// Reads one input and moves it to its place.
pub(crate) fn read(request: &Request, limits: &Limits, control: &Control) -> Result<Input, Error> {
    #[cfg(feature = "subdivision")]
    if let Some(input) = super::cages::input(request, limits, control)? {
        return Ok(input);
    }
    let (mut mesh, format, warnings, contents) = match &request.chosen {
        Some(chosen) => {
            (chosen.mesh.clone(), chosen.format, chosen.warnings.clone(), chosen.contents.clone())
        }
        None => {
            let options = options(request, control);
            let loaded = match request.format {
                Some(format) => {
                    let (bytes, options) = bytes(request, options, limits)?;
                    io::read(&bytes, format, &options)
                }
                None => io::load(&request.path, &options),
            };
            let io::Loaded { mesh, format, warnings, contents, .. } = loaded.map_err(name_option)?;
            (mesh, format, warnings, contents)
        }
    };
    control.check()?;
    mesh = moved(mesh, &request.transforms, control)?;
    let bytes = size_of_val(&*mesh.positions) + size_of_val(&*mesh.triangles);
    let reserved = control.reserve(bytes as u64)?;
    Ok(Input { mesh, format, warnings, contents, reserved })
}

/// A mesh after all transforms.
pub(crate) fn moved(mut mesh: Mesh, transforms: &[Transform], control: &Control) -> Result<Mesh, Error> {
    for transform in transforms {
        mesh = transform.apply(mesh, control)?;
    }
    if !transforms.is_empty() && mesh.positions.as_flattened().iter().any(|value| !value.is_finite()) {
        return Err(Error::InvalidArgument(
            "its transforms move vertices out of the range of numbers".into(),
        ));
    }
    Ok(mesh)
}

/// How an input is read.
pub(crate) fn options(request: &Request, control: &Control) -> io::ReadOptions {
    let options = io::ReadOptions::new().control(control.clone());
    match request.expansion {
        Some(times) => options.expansion(times),
        None => options,
    }
}

/// The bytes of an input of a given format, and where files named in it are looked for.
pub(crate) fn bytes(
    request: &Request,
    options: io::ReadOptions,
    limits: &Limits,
) -> Result<(Vec<u8>, io::ReadOptions), Error> {
    if request.is_standard() {
        return Ok((limits.while_waiting(standard_input)?, options));
    }
    let folder = request.path.parent().unwrap_or(Path::new(""));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    Ok((file(&request.path, limits)?, options.folder(folder)))
}

/// The error of a glTF scene that takes too much, with the option that allows more.
pub(crate) fn name_option(error: Error) -> Error {
    match error {
        Error::TooLarge { what } if what.starts_with("the flattened scene") => {
            Error::TooLarge { what: format!("{what} (--expansion TIMES allows more)") }
        }
        other => other,
    }
}

/// The bytes of a file, or of standard input.
pub(crate) fn file(path: &Path, limits: &Limits) -> Result<Vec<u8>, Error> {
    let endless = std::fs::metadata(path).is_ok_and(|file| !file.is_file());
    let bytes = if endless { limits.while_waiting(|| std::fs::read(path)) } else { std::fs::read(path) };
    bytes.map_err(|source| Error::File {
        action: trisect::FileAction::Read,
        path: path.to_path_buf(),
        source,
    })
}

/// A text file, or standard input.
pub(crate) fn text(path: &Path, limits: &Limits) -> Result<String, Error> {
    let standard = path == Path::new(STANDARD);
    let bytes = if standard { limits.while_waiting(standard_input)? } else { file(path, limits)? };
    String::from_utf8(bytes).map_err(|_| Error::File {
        action: trisect::FileAction::Read,
        path: if standard { "standard input".into() } else { path.to_path_buf() },
        source: std::io::Error::new(std::io::ErrorKind::InvalidData, "it is not text (UTF-8)"),
    })
}

fn standard_input() -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    match std::io::stdin().lock().read_to_end(&mut bytes) {
        Ok(_) => Ok(bytes),
        Err(source) => {
            Err(Error::File { action: trisect::FileAction::Read, path: "standard input".into(), source })
        }
    }
}

//! Inputs that are parts of files: `scene.glb#base`, `scene.glb#cut_*`.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use trisect::io::{self, Format, FormatError, KeptScene, PartName, Parts};
use trisect::{Control, Error, Mesh};

use super::chosen::Chosen;
use super::limits::Limits;
use super::reading;
use super::requests::Request;

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
        let parts = selected(file, &pattern, &request).map_err(fail)?;
        for (number, (name, mesh)) in parts.into_iter().enumerate() {
            // What is to be said of the file is said once.
            let warnings = if number == 0 { file.whole.warnings.clone() } else { Vec::new() };
            let mut contents =
                if number == 0 { file.whole.contents.clone() } else { io::Contents::default() };
            contents.skinned = usize::from(is_skinned(&mesh));
            let chosen = Chosen { name: Some(name), mesh, format: file.whole.format, warnings, contents };
            expanded.push(Request { chosen: Some(Arc::new(chosen)), ..request.clone() });
        }
    }
    Ok(expanded)
}

/// The inputs, each with all parts that it asks for as one mesh: as many as before.
pub(crate) fn joined(
    requests: Vec<Request>,
    limits: &Limits,
    control: &Control,
) -> Result<Vec<Request>, Error> {
    let one = |(index, request): (usize, Request)| {
        let name = request.name();
        together(request, limits, control).map_err(|error| error.of_operand(index, name))
    };
    requests.into_iter().enumerate().map(one).collect()
}

/// The input with all parts that it asks for as one mesh.
pub(crate) fn together(request: Request, limits: &Limits, control: &Control) -> Result<Request, Error> {
    let Some(pattern) = request.part.clone() else { return Ok(request) };
    let file = read(&request, limits, control)?;
    let parts = selected(&file, &pattern, &request)?;
    let mesh = Mesh::merged(parts.iter().map(|(_, mesh)| mesh))?;
    let chosen = Chosen {
        name: Some(pattern),
        mesh,
        format: file.whole.format,
        warnings: file.whole.warnings,
        contents: file.whole.contents,
    };
    Ok(Request { chosen: Some(Arc::new(chosen)), ..request })
}

/// The parts that a pattern means, with their names. A node whose scene stays may have no mesh yet.
fn selected(file: &Parts, pattern: &str, request: &Request) -> Result<Vec<(String, Mesh)>, Error> {
    match file.select(pattern) {
        Ok(parts) => Ok(parts.into_iter().map(|part| (part.name, part.mesh)).collect()),
        Err(error) => {
            let is_unknown = matches!(error, Error::Format(FormatError::NoSuchPart { .. }));
            if is_unknown && request.is_place && KeptScene::load(&request.path, pattern)?.has_node()? {
                return Ok(vec![(pattern.to_owned(), Mesh::default())]);
            }
            Err(error)
        }
    }
}

/// The input, read, and the names of the parts of its file.
pub(crate) fn whole(
    request: Request,
    limits: &Limits,
    control: &Control,
) -> Result<(Request, Vec<PartName>), Error> {
    if request.chosen.is_some() || request.is_cage() {
        return Ok((request, Vec::new()));
    }
    let file = read(&request, limits, control)?;
    let names = file.names();
    let io::Loaded { mesh, format, warnings, contents, .. } = file.whole;
    let chosen = Chosen { name: None, mesh, format, warnings, contents };
    Ok((Request { chosen: Some(Arc::new(chosen)), ..request }, names))
}

fn read(request: &Request, limits: &Limits, control: &Control) -> Result<Parts, Error> {
    let options = reading::options(request, control);
    match request.format {
        Some(format) => {
            let (bytes, options) = reading::bytes(request, options, limits)?;
            io::read_parts(&bytes, format, &options)
        }
        None => io::load_parts(&request.path, &options),
    }
    .map_err(reading::name_option)
}

/// Whether the corners of a mesh have joints.
fn is_skinned(mesh: &Mesh) -> bool {
    mesh.attributes.iter().any(|attribute| attribute.name.starts_with("JOINTS_"))
}

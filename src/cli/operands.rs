//! Inputs made operands: reading, moving to their place, and the checks.

use std::io::Read as _;
use std::path::Path;
use std::time::Instant;

#[cfg(feature = "parallel")]
use rayon::prelude::*;
use serde_json::Value;
use trisect::control::Reservation;
use trisect::io::Format;
use trisect::mesh::{Gate, Mending, SelfCrossings, Welding};
use trisect::{Control, Error, Mesh, MeshError, Solid};

use super::fault::Fault;
use super::json::json_of;
use super::limits::Limits;
use super::progress::Console;
use super::repairs::{self, Remedy, Repairs};
use super::report::{counted, short};
use super::requests::Request;
use trisect::io;

/// A file that was read and moved.
pub(crate) struct Input {
    pub(crate) mesh: Mesh,
    pub(crate) format: Format,
    pub(crate) warnings: Vec<String>,
    /// The mesh's share of the memory ceiling.
    pub(crate) reserved: Reservation,
}

/// An input that can take part in a boolean.
pub(crate) struct Operand {
    pub(crate) request: Request,
    pub(crate) solid: Solid,
    pub(crate) format: Format,
    pub(crate) warnings: Vec<String>,
    pub(crate) crossings: Option<Crossings>,
    pub(crate) seconds: f64,
    _reserved: Reservation,
}

/// Reads one input and moves it to its place.
pub(crate) fn read(request: &Request, limits: &Limits, control: &Control) -> Result<Input, Error> {
    let (mut mesh, format, warnings) = match &request.chosen {
        Some(chosen) => (chosen.mesh.clone(), chosen.format, chosen.warnings.clone()),
        None => {
            let options = options(request, control);
            let loaded = match request.format {
                Some(format) => {
                    let (bytes, options) = bytes(request, options, limits)?;
                    io::read(&bytes, format, &options)
                }
                None => io::load(&request.path, &options),
            };
            let io::Loaded { mesh, format, warnings, .. } = loaded.map_err(name_option)?;
            (mesh, format, warnings)
        }
    };
    control.check()?;
    for transform in &request.transforms {
        mesh = transform.apply(mesh)?;
    }
    if !request.transforms.is_empty() && mesh.positions.as_flattened().iter().any(|value| !value.is_finite())
    {
        return Err(Error::InvalidArgument(
            "its transforms move vertices out of the range of numbers".into(),
        ));
    }
    let bytes = size_of_val(&*mesh.positions) + size_of_val(&*mesh.triangles);
    let reserved = control.reserve(bytes as u64)?;
    Ok(Input { mesh, format, warnings, reserved })
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

fn file(path: &Path, limits: &Limits) -> Result<Vec<u8>, Error> {
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
    let standard = path == Path::new(super::requests::STANDARD);
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

/// A solid that can be an operand, and what its checks found.
pub(crate) struct Usable {
    pub(crate) solid: Solid,
    /// The answer of the self-crossing check; `None` under `--assume-clean`.
    pub(crate) crossings: Option<Crossings>,
}

/// Self-crossings of an operand.
pub(crate) struct Crossings {
    /// How many pairs of triangles cross each other.
    pub(crate) count: usize,
    /// How many are no deeper than rounding.
    pub(crate) tolerated: usize,
    /// How many pairs lie on each other in one plane.
    pub(crate) touching: usize,
    /// All that is known about them.
    pub(crate) object: Value,
    /// The same, with the triangles' numbers in the file.
    pub(crate) found: SelfCrossings,
}

/// Why a mesh cannot be an operand.
pub(crate) struct Unusable {
    pub(crate) error: Error,
    /// Options that would make it one.
    pub(crate) remedy: Option<Remedy>,
}

/// Makes a mesh an operand, or says why it cannot be one and what would make it one, with the triangles' numbers in the
/// file.
pub(crate) fn usable(
    mesh: Mesh,
    repairs: Repairs,
    assume_clean: bool,
    control: &Control,
) -> Result<Usable, Box<Unusable>> {
    tried(mesh, repairs, assume_clean, control).map_err(|failed| {
        let (error, mesh) = *failed;
        let remedy = mesh.and_then(|mesh| repairs::remedy(&mesh, &error, repairs, assume_clean, control));
        Box::new(Unusable { error, remedy })
    })
}

/// The same without a look for what would make it one. With the error comes the mesh, if anything might.
pub(crate) fn tried(
    mesh: Mesh,
    repairs: Repairs,
    assume_clean: bool,
    control: &Control,
) -> Result<Usable, Box<(Error, Option<Mesh>)>> {
    let solid = match repairs.gate().solid(mesh) {
        Ok(solid) => solid,
        Err(refusal) => return Err(Box::new((refusal.error.into(), Some(refusal.mesh)))),
    };
    if assume_clean {
        return Ok(Usable { solid, crossings: None });
    }
    let mut found = match solid.self_crossings(control) {
        Ok(found) => found.clone(),
        Err(error) => return Err(Box::new((error, None))),
    };
    for place in &mut found.places {
        place.triangles = place.triangles.map(|triangle| solid.source_triangle(triangle));
    }
    // What a surface that crosses itself is inside and outside of, winding numbers tell.
    if found.is_clean() {
        let mut misplaced = solid.inside_out_shells();
        for place in &mut misplaced.places {
            for triangle in &mut place.triangles {
                *triangle = solid.source_triangle(*triangle);
            }
            // Vertices may have been joined since the file was read: their numbers are no longer its own.
            place.vertices.clear();
        }
        if !misplaced.is_none() {
            let error = MeshError::InsideOutShells(Box::new(misplaced)).into();
            return Err(Box::new((error, Some(solid.into_mesh()))));
        }
    }
    let crossings = Crossings {
        count: found.count,
        tolerated: found.tolerated,
        touching: found.touching,
        object: json_of(&found),
        found,
    };
    Ok(Usable { solid, crossings: Some(crossings) })
}

/// Warnings of what mending left out: pieces of surface that the file has and the operand has not. (What was joined, split
/// or stored twice is no warning: the surface is the file's but for rounding.)
pub(crate) fn left_out(mending: &Mending) -> Vec<String> {
    let mut warnings = Vec::new();
    for (one, several, fault) in mending.left_out() {
        let mut text = fault.text(one, several, 2);
        if one.contains("open part") {
            text.push_str(&format!(" ({}, area {})", parts(mending), short(mending.open_area)));
        }
        warnings.push(text);
    }
    warnings
}

fn parts(mending: &Mending) -> String {
    counted(mending.open_part_count, "part")
}

/// What mending does, in a few words.
pub(crate) fn effect(mending: &Mending) -> String {
    let mut text = mending.to_string();
    if let Some(distance) = mending.distance {
        text.push_str(&format!(", by a distance of {distance:.3e}"));
    }
    if mending.open_part_count > 0 {
        text.push_str(&format!(", {} of area {}", parts(mending), short(mending.open_area)));
    }
    text
}

/// A warning if a mesh had triangles, but none that enclose anything.
pub(crate) fn nothing_left(solid: &Solid) -> Option<String> {
    let cleaning = solid.cleaning();
    let left_out = cleaning.repeated_corners + 2 * cleaning.opposite_pairs;
    (solid.is_empty() && left_out > 0).then(|| {
        format!(
            "it is empty: each of its {left_out} triangles has an opposite copy or a repeated corner, so they enclose \
             nothing (a sheet with two sides is not a body: give it a thickness)"
        )
    })
}

/// The mesh mended by joining vertices as asked for, and how many were joined. Where that does not close it, they are joined
/// all the same, if a distance is given.
pub(crate) fn welded(mesh: Mesh, weld: Welding) -> Result<(Mesh, usize), Error> {
    if weld == Welding::Rounding {
        return Ok((mesh, 0));
    }
    let refusal = match Gate::new().weld(weld).solid(mesh) {
        Ok(solid) => {
            let joined = solid.mending().seams.count;
            return Ok((solid.into_mesh(), joined));
        }
        Err(refusal) => refusal,
    };
    let (Welding::Within(distance), MeshError::NotClosed(_) | MeshError::InsideOut { .. }) =
        (weld, &refusal.error)
    else {
        return if matches!(refusal.error, MeshError::NotClosed(_) | MeshError::InsideOut { .. }) {
            Ok((refusal.mesh, 0))
        } else {
            Err(refusal.error.into())
        };
    };
    let before = refusal.mesh.positions.len();
    let mesh = refusal.mesh.welded(distance)?;
    let removed = before - mesh.positions.len();
    Ok((mesh, removed))
}

/// The mesh with its faces outwards, and whether that changed it.
pub(crate) fn oriented(mesh: Mesh) -> (Mesh, bool) {
    let before = mesh.triangles.clone();
    let mesh = mesh.oriented();
    let turned = mesh.triangles != before;
    (mesh, turned)
}

/// Reads all inputs and makes them operands; the first fault in the order of the command line counts.
pub(crate) fn operands(
    requests: Vec<Request>,
    assume_clean: bool,
    limits: &Limits,
    control: &Control,
    console: &Console,
) -> Result<Vec<Operand>, Fault> {
    let one = |(index, request): (usize, Request)| {
        console.stage(&format!("reading {}", request.name()), 0.0);
        let name = request.name();
        operand(request, assume_clean, limits, control).map_err(|unusable| {
            let Unusable { error, remedy } = *unusable;
            Fault::of_unusable(error.of_operand(index, name), remedy)
        })
    };
    #[cfg(feature = "parallel")]
    let operands: Vec<Result<Operand, Fault>> = requests.into_par_iter().enumerate().map(one).collect();
    #[cfg(not(feature = "parallel"))]
    let operands: Vec<Result<Operand, Fault>> = requests.into_iter().enumerate().map(one).collect();
    operands.into_iter().collect()
}

fn operand(
    request: Request,
    assume_clean: bool,
    limits: &Limits,
    control: &Control,
) -> Result<Operand, Box<Unusable>> {
    let start = Instant::now();
    let Input { mesh, format, mut warnings, reserved } =
        read(&request, limits, control).map_err(|error| Box::new(Unusable { error, remedy: None }))?;
    let Usable { solid, crossings } = usable(mesh, request.repairs, assume_clean, control)?;
    warnings.extend(left_out(solid.mending()));
    warnings.extend(nothing_left(&solid));
    // What touches itself in single vertices would do so in the result as well.
    let solid = if solid.is_manifold() { solid } else { solid.separated().0 };
    let seconds = start.elapsed().as_secs_f64();
    Ok(Operand { request, solid, format, warnings, crossings, seconds, _reserved: reserved })
}

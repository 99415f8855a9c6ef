//! Reading and writing mesh files: OBJ, glTF and GLB, STL, PLY, OFF, 3MF.
//!
//! [`Mesh::load`](crate::Mesh::load) and [`Mesh::save`](crate::Mesh::save) are the short way; [`load`] and [`save`]
//! take options and return warnings; [`read`] and [`write()`] work on bytes and streams.
//!
//! ```
//! use trisect::Mesh;
//! use trisect::io::{self, Format, ReadOptions, WriteOptions};
//!
//! let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
//! let loaded = io::read(text, Format::Obj, &ReadOptions::new())?;
//! assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
//!
//! let mut ply = Vec::new();
//! io::write(&loaded.mesh, Format::Ply, &mut ply, &WriteOptions::new())?;
//! assert_eq!(io::read(&ply, Format::Ply, &ReadOptions::new())?.mesh, loaded.mesh);
//! # Ok::<(), trisect::Error>(())
//! ```
//!
//! What each format keeps and loses, the memory a reader may take and the wording of errors are described in
//! `docs/formats.md`. In short: coordinates stay `f64` from file to file wherever the format has room for them;
//! vertices stay as they are in the file (STL, which has none, is welded where coordinates are bit-equal); polygons
//! are triangulated completely, concave ones included; every count in a file is checked against the bytes that are
//! there before memory is taken for it.

mod beside;
mod color;
mod contents;
mod detect;
pub mod drawing;
mod error;
mod faces;
mod file;
mod finish;
mod format;
mod gltf;
mod labels;
mod mirror;
mod mtl;
mod notes;
mod obj;
mod off;
mod options;
mod outline;
mod parts;
mod pictures;
mod pieces;
mod ply;
mod rounding;
mod scan;
mod stl;
mod text;
#[cfg(feature = "threemf")]
mod threemf;
mod weld;

use std::io::Write;

use crate::{Error, FileAction, Mesh};

pub use contents::Contents;
pub use detect::Detected;
pub use error::FormatError;
pub use file::{load, save, save_report};
pub use format::Format;
pub use gltf::KeptScene;
pub use options::{Encoding, Precision, ReadOptions, WriteOptions};
pub use parts::{Part, PartName, Parts, load_parts, read_parts};
pub use rounding::{Rounding, Written};

/// A mesh read from a file, with what its reader had to say.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// The mesh. Every index is in range, every coordinate finite, no triangle names a vertex twice.
    pub mesh: Mesh,
    /// The format the file was read as.
    pub format: Format,
    /// What was ignored, repaired or missing, one sentence each; empty for most files.
    pub warnings: Vec<String>,
    /// What the file holds besides the mesh.
    pub contents: Contents,
}

/// Reads a mesh from the bytes of a file of the given format.
///
/// # Errors
/// [`FormatError::Malformed`] with the place, [`FormatError::Unsupported`] with the way out, [`Error::TooLarge`], and the limits
/// of the options' [`Control`](crate::Control).
pub fn read(bytes: &[u8], format: Format, options: &ReadOptions) -> Result<Loaded, Error> {
    if bytes.is_empty() {
        return Err(malformed(format, "byte 0", "the file is empty"));
    }
    // What usual files take while they are read; what hostile ones may take is bounded reader by reader.
    let _reservation = options.control.reserve(2 * bytes.len() as u64)?;
    let mut contents = Contents::default();
    let (mesh, warnings) = match format {
        Format::Obj => obj::read(bytes, options)?,
        Format::Gltf | Format::Glb => {
            let scene = gltf::read(bytes, format, options, false)?;
            contents = scene.contents;
            (scene.mesh, scene.warnings)
        }
        Format::Stl => stl::read(bytes, options)?,
        Format::Ply => ply::read(bytes, options)?,
        Format::Off => off::read(bytes, options)?,
        #[cfg(feature = "threemf")]
        Format::ThreeMf => {
            let (mesh, held, warnings) = threemf::read(bytes, options)?;
            contents = held;
            (mesh, warnings)
        }
    };
    Ok(finish_loading(mesh, format, warnings, contents))
}

/// What was read, with a warning if that is nothing.
fn finish_loading(mesh: Mesh, format: Format, mut warnings: Vec<String>, contents: Contents) -> Loaded {
    if mesh.is_empty() {
        warnings.push("the file has no triangles".to_string());
    }
    Loaded { mesh, format, warnings, contents }
}

/// Writes a mesh to a stream, and returns what the format could not keep, one sentence each.
///
/// The stream gets few large pieces; it needs no buffering.
///
/// # Errors
/// [`Error::Mesh`] when the mesh itself is at fault,
/// [`FormatError::Unsupported`] when the format cannot hold it, [`Error::File`] when the stream refuses the bytes, and the
/// limits of the options' [`Control`](crate::Control).
pub fn write(
    mesh: &Mesh,
    format: Format,
    output: &mut impl Write,
    options: &WriteOptions,
) -> Result<Vec<String>, Error> {
    write_to(mesh, format, output, options).map(|written| written.warnings)
}

/// Writes a mesh as [`write()`] does, and tells besides what the file holds where it is not the mesh: binary STL and glTF have
/// room for single precision only.
///
/// ```
/// use trisect::io::{self, Format, WriteOptions};
/// use trisect::primitives;
///
/// // A kilometre from the origin, in single precision: steps of 0.06 mm.
/// let cube = primitives::cuboid([1000.0; 3], [1000.01; 3])?;
/// let written = io::write_report(&cube, Format::Stl, &mut Vec::new(), &WriteOptions::new())?;
/// let rounding = written.rounding.expect("0.01 is no number of single precision");
/// assert_eq!(rounding.step, 2f64.powi(-14));
/// assert!(rounding.written_volume > rounding.volume && rounding.finer_at_origin);
/// assert!(written.warnings[0].contains("changes the volume"));
///
/// let (moved, _) = cube.recentered();
/// assert!(io::write_report(&moved, Format::Stl, &mut Vec::new(), &WriteOptions::new())?.warnings.is_empty());
/// # Ok::<(), trisect::Error>(())
/// ```
///
/// # Errors
/// Those of [`write()`].
pub fn write_report(
    mesh: &Mesh,
    format: Format,
    output: &mut impl Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    write_to(mesh, format, output, options)
}

/// [`write_report`] without the type parameter.
fn write_to(
    mesh: &Mesh,
    format: Format,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    finish::check_for_writing(mesh)?;
    let mut written = match format {
        Format::Obj => obj::write(mesh, output, options)?,
        Format::Gltf | Format::Glb => match &options.scene {
            Some(scene) => gltf::write_kept(mesh, scene, format, output, options)?,
            None => gltf::write(mesh, format, output, options, None)?,
        },
        Format::Stl => without_attributes(mesh, format, stl::write(mesh, output, options)?),
        Format::Ply => ply::write(mesh, output, options)?,
        Format::Off => without_attributes(mesh, format, off::write(mesh, output, options)?),
        #[cfg(feature = "threemf")]
        Format::ThreeMf => threemf::write(mesh, output, options)?,
    };
    if options.scene.is_some() && !matches!(format, Format::Gltf | Format::Glb) {
        written.warnings.insert(0, format!("{format} has no scenes: the mesh is written alone"));
    }
    Ok(written)
}

/// What is said of a format that has no attributes; STL's users look for neither materials nor pictures, and hear of them here.
fn without_attributes(mesh: &Mesh, format: Format, mut written: Written) -> Written {
    let names: Vec<&str> = mesh.attributes.iter().map(|attribute| &*attribute.name).collect();
    if !names.is_empty() {
        written.warnings.insert(0, format!("{format} has no place for {}: not written", names.join(", ")));
    }
    let textured = mesh.groups.list.iter().filter_map(|group| group.material.as_ref());
    if format == Format::Stl && textured.clone().any(|material| material.base_color_texture.is_some()) {
        written
            .warnings
            .insert(0, "STL is written without materials: colours and pictures are not kept".into());
    }
    written
}

/// The error for a damaged file.
fn malformed(format: Format, place: impl Into<String>, what: impl Into<String>) -> Error {
    FormatError::Malformed { format, place: place.into(), what: what.into() }.into()
}

/// The error for a sound file that needs something the reader or writer cannot do.
fn unsupported(format: Format, what: impl Into<String>) -> Error {
    FormatError::Unsupported { format, what: what.into() }.into()
}

/// The error for a stream that refuses bytes.
fn write_error(source: std::io::Error) -> Error {
    Error::File { action: FileAction::Write, path: "the output".into(), source }
}

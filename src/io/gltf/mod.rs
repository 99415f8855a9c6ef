//! glTF 2.0, as JSON with buffers (`.gltf`) and in one binary file (`.glb`).
//!
//! The scene is flattened: every mesh of every node, moved by the product of the node transforms in double precision,
//! its triangles reversed where that product mirrors. Coordinates are single precision by format; written files carry
//! the offset of the model in a node (double precision in JSON), so that large coordinates keep their digits.

mod accessor;
mod budget;
mod buffers;
mod container;
mod corners;
mod document;
#[cfg(feature = "draco")]
mod draco;
mod extensions;
mod joints;
mod json;
mod keep;
mod manifold;
mod materials;
mod morph;
mod place;
mod plain;
mod primitive;
mod scene;
mod triangles;
mod write;

pub use keep::KeptScene;
pub(super) use keep::write as write_kept;
pub(super) use write::{Aside, write};

use super::finish::check_finite;
use super::notes::Notes;
use super::outline::Outline;
use super::{Contents, Format, ReadOptions, malformed, unsupported};
use crate::{Error, Mesh};
use buffers::Buffers;
use document::{Document, Named};
use primitive::Builder;
use serde_json::value::RawValue;

/// A scene may take this many bytes of memory however small its file is.
const SMALLEST_LIMIT: u64 = 64 << 20;

/// A scene that was read.
pub(super) struct SceneRead {
    pub(super) mesh: Mesh,
    pub(super) warnings: Vec<String>,
    /// The names of nodes, if they were wanted.
    pub(super) outline: Outline,
    pub(super) contents: Contents,
}

/// Reads a scene; the outline is empty unless asked for, since it may be large for a small file.
pub(super) fn read(
    bytes: &[u8],
    format: Format,
    options: &ReadOptions,
    outlined: bool,
) -> Result<SceneRead, Error> {
    let mut notes = Notes::default();
    let container = container::open(bytes, format, &mut notes)?;
    let document: Document<'_> = serde_json::from_slice(container.json).map_err(|error| {
        let place = format!("JSON line {} column {}", error.line(), error.column());
        malformed(format, place, error.to_string())
    })?;
    let reader = Reader { document: &document, format };
    reader.check()?;

    let buffers = Buffers::new(&reader, container.binary, options);
    let mut builder = Builder::new(&reader, &buffers, bytes.len() as u64, options, &mut notes);
    builder.outline = outlined.then(Outline::default);
    scene::flatten(&reader, &mut builder)?;
    let mut contents = contents(&document);
    (contents.skinned, contents.morphed) = (builder.skinned, builder.morphed);
    let (mut mesh, outline) = builder.finish();
    check_finite(&mut mesh, format, &mut notes, |vertex| format!("vertex {vertex} of the scene"))?;
    let warnings = notes.into_warnings(|offset| format!("byte {offset}"));
    Ok(SceneRead { mesh, warnings, outline, contents })
}

/// What a document has besides meshes.
fn contents(document: &Document<'_>) -> Contents {
    /// Names of more animations are not kept.
    const MOST: usize = 1000;
    let name = |(index, text): (usize, &&RawValue)| {
        let named: Option<Named> = serde_json::from_str(text.get()).ok();
        named.and_then(|named| named.name).unwrap_or_else(|| index.to_string())
    };
    let extensions = document.extensions.as_ref();
    let lights = extensions.and_then(|extensions| extensions.lights.as_ref());
    let variants = extensions.and_then(|extensions| extensions.variants.as_ref());
    let of_nodes = document.nodes.iter().filter_map(|node| node.0.as_ref()?.extras.as_ref()).count();
    let of_scenes = document.scenes.iter().filter(|scene| scene.extras.is_some()).count();
    let of_meshes = document.meshes.iter().filter(|mesh| mesh.extras.is_some()).count();
    Contents {
        animations: document.animations.iter().enumerate().take(MOST).map(name).collect(),
        cameras: document.cameras.0,
        lights: lights.map_or(0, |lights| lights.lights.0),
        extras: of_nodes + of_scenes + of_meshes + usize::from(document.extras.is_some()),
        variants: variants.map_or(0, |variants| variants.variants.0),
        ..Contents::default()
    }
}

/// The document being read, and what to call it in errors.
struct Reader<'a> {
    document: &'a Document<'a>,
    format: Format,
}

impl<'a> Reader<'a> {
    /// The error for something wrong at a JSON pointer.
    fn error(&self, pointer: impl Into<String>, what: impl Into<String>) -> Error {
        malformed(self.format, pointer, what)
    }

    /// The item at an index found at `pointer`.
    fn get<T>(&self, list: &'a [T], name: &str, index: usize, pointer: &str) -> Result<&'a T, Error> {
        list.get(index).ok_or_else(|| {
            self.error(pointer, format!("names item {index} of {name:?}, which has {} items", list.len()))
        })
    }

    /// Makes sure that the document can be read: its version, the extensions that it requires, what it refers to.
    fn check(&self) -> Result<(), Error> {
        self.check_version()?;
        extensions::check(&self.document.extensions_required, self.format)?;
        self.check_references()
    }

    fn check_version(&self) -> Result<(), Error> {
        let asset = &self.document.asset;
        let least = asset.min_version.as_deref().unwrap_or("2.0");
        if asset.version.starts_with("2.") && least == "2.0" {
            return Ok(());
        }
        Err(unsupported(
            self.format,
            format!(
                "the file is of glTF version {}{}, this reader knows 2.0; files of version 1.0 can be converted with \
                 \"gltf-pipeline -i in.gltf -o out.gltf\"",
                asset.version,
                if least == "2.0" { String::new() } else { format!(" and needs {least}") }
            ),
        ))
    }

    /// Makes sure that accessors and buffer views refer to what exists, whether the scene uses them or not.
    fn check_references(&self) -> Result<(), Error> {
        let document = self.document;
        for (i, view) in document.buffer_views.iter().enumerate() {
            let pointer = format!("/bufferViews/{i}");
            let buffer = self.get(&document.buffers, "buffers", view.buffer as usize, &pointer)?;
            let (start, length) = (view.byte_offset, view.byte_length);
            let end = start.checked_add(length);
            if end.is_none_or(|end| end > buffer.byte_length) {
                return Err(self.error(
                    pointer,
                    format!(
                        "begins at byte {start} and has {length} bytes, but its buffer has {}",
                        buffer.byte_length
                    ),
                ));
            }
        }
        for (i, accessor) in document.accessors.iter().enumerate() {
            let sparse = accessor.sparse.as_ref();
            let sparse_views = sparse.map(|sparse| [sparse.indices.buffer_view, sparse.values.buffer_view]);
            for view in accessor.buffer_view.into_iter().chain(sparse_views.into_iter().flatten()) {
                self.get(&document.buffer_views, "bufferViews", view as usize, &format!("/accessors/{i}"))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod attribute_tests;
#[cfg(test)]
mod keep_tests;
#[cfg(test)]
mod tests;

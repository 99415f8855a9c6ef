//! Writing glTF and GLB.
//!
//! One buffer: the positions in single precision, shared by all primitives so that the surface stays closed across
//! groups, the attributes of the same vertices, the indices, group by group, and pictures. Each group name becomes a node with
//! a mesh, each group a primitive. Without attributes the vertices are those of the mesh; with them a vertex at a seam becomes
//! several at one place, which readers join, or `EXT_mesh_manifold` tells.

mod columns;
mod document;
mod frame;
mod layout;
mod materials;
mod mtl;
mod vertices;

use std::io::Write;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use serde_json::{Map, Value, json};

use super::super::pictures::PictureFile;
use super::super::rounding::{Measure, Written, examined};
use super::super::text::write_all;
use super::super::{Format, WriteOptions, write_error};
use super::json::percent_encode;
use crate::mesh::is_two_manifold;
use crate::{Error, Mesh};
pub(super) use document::Fragment;
pub(super) use materials::Known;

/// Where a `.gltf` file puts what is not its JSON.
pub(in crate::io) struct Aside<'a> {
    /// The name of the file of the buffer, and the file.
    pub(in crate::io) buffer: (String, &'a mut dyn Write),
    /// The files of pictures.
    pub(in crate::io) pictures: &'a [PictureFile],
}

/// Writes a `.gltf` file with its buffer inside or aside, or a `.glb` file.
pub(in crate::io) fn write(
    mesh: &Mesh,
    format: Format,
    output: &mut dyn Write,
    options: &WriteOptions,
    aside: Option<Aside<'_>>,
) -> Result<Written, Error> {
    if mesh.triangles.is_empty() {
        // Neither a buffer without bytes nor a mesh without triangles is allowed, and some readers want a node.
        let document = json!({
            "asset": document::asset(), "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{}]
        });
        match format {
            Format::Glb => write_glb_header(output, &document.to_string(), None)?,
            _ => write_all(output, document.to_string().as_bytes())?,
        }
        let lost = options.extra.as_ref();
        let lost = lost.map(|(key, _)| format!("there is no mesh that could have `{key}` beside it"));
        return Ok(Written { warnings: lost.into_iter().collect(), ..Written::default() });
    }
    // Seams of the mesh itself are joined first, where that is all that keeps the surface from being closed.
    let is_closed = options.manifold && is_two_manifold(mesh);
    let joined = (options.manifold && !is_closed).then(|| mesh.clone().welded(0.0)).transpose()?;
    let joined = joined.filter(is_two_manifold);
    let manifold = is_closed || joined.is_some();
    let mesh = joined.as_ref().unwrap_or(mesh);
    let mut warnings = Vec::new();
    if options.manifold && !manifold {
        warnings.push(document::NOT_MANIFOLD.to_string());
    }
    let pictures = aside.as_ref().map(|aside| aside.pictures);
    let (layout, mut document) = document::document(mesh, pictures, manifold, &mut warnings);
    if let Some((key, value)) = &options.extra {
        let meshes = document.get_mut("meshes").and_then(|meshes| meshes.get_mut(0));
        if let Some(mesh) = meshes.and_then(Value::as_object_mut) {
            mesh.insert("extras".to_string(), json!({ *key: value }));
        }
    }
    let bytes = layout.bytes();
    match aside {
        Some(Aside { buffer: (name, buffer), .. }) if format == Format::Gltf => {
            let uri = percent_encode(&name);
            document.insert("buffers".to_string(), json!([{"byteLength": bytes, "uri": uri}]));
            write_all(output, Value::Object(document).to_string().as_bytes())?;
            layout.write(buffer, options)?;
        }
        _ => write_container(document, bytes, format, output, |output| layout.write(output, options))?,
    }
    let frame = &layout.frame;
    let mut written = Written::default();
    if !frame.exact {
        written =
            examined(mesh, format, Measure { offset: frame.offset.to_array(), scale: frame.scale }, options)?;
    }
    written.warnings.splice(0..0, warnings);
    Ok(written)
}

/// Writes a document and its one buffer, of so many bytes, as a GLB, or as JSON with the buffer as base64 in it.
pub(super) fn write_container(
    mut document: Map<String, Value>,
    bytes: u64,
    format: Format,
    output: &mut dyn Write,
    buffer: impl FnOnce(&mut dyn Write) -> Result<(), Error>,
) -> Result<(), Error> {
    if format == Format::Glb {
        document.insert("buffers".to_string(), json!([{"byteLength": bytes}]));
        write_glb_header(output, &Value::Object(document).to_string(), Some(bytes))?;
        return buffer(output);
    }
    let rest = Value::Object(document).to_string();
    let start =
        format!("{{\"buffers\":[{{\"byteLength\":{bytes},\"uri\":\"data:application/octet-stream;base64,");
    write_all(output, start.as_bytes())?;
    let mut encoder = EncoderWriter::new(&mut *output, &STANDARD);
    buffer(&mut encoder)?;
    encoder.finish().map_err(write_error)?;
    drop(encoder);
    write_all(output, b"\"}],")?;
    write_all(output, &rest.as_bytes()[1..])
}

/// The header of a GLB file, its JSON chunk, and the header of a binary chunk.
fn write_glb_header(output: &mut dyn Write, document: &str, binary: Option<u64>) -> Result<(), Error> {
    let padded = document.len().next_multiple_of(4);
    let total = 20 + padded as u64 + binary.map_or(0, |bytes| 8 + bytes);
    let Ok(total) = u32::try_from(total) else {
        return Err(Error::TooLarge {
            what: format!("a GLB file of {total} bytes, where 4 GiB is the limit; write PLY"),
        });
    };
    let mut header = b"glTF\x02\0\0\0".to_vec();
    header.extend(total.to_le_bytes());
    header.extend((padded as u32).to_le_bytes());
    header.extend(b"JSON");
    header.extend(document.as_bytes());
    header.resize(20 + padded, b' ');
    if let Some(bytes) = binary {
        header.extend((bytes as u32).to_le_bytes());
        header.extend(b"BIN\0");
    }
    write_all(output, &header)
}

//! Writing 3MF: a package of three parts, with one model in millimetres.

mod objects;
mod palette;
mod text;

use std::io::{Cursor, Write};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::super::rounding::{self, Written};
use super::super::text::write_all;
use super::super::{Format, WriteOptions, write_error};
use crate::{Error, Mesh};
use objects::objects;
use palette::Palette;

/// What kinds of parts there are.
const CONTENT_TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n\
<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n\
<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n\
</Types>\n";

/// Which part is the model.
const RELATIONSHIPS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n\
<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n\
</Relationships>\n";

/// About how many bytes of a package a vertex and a triangle take, for the ceiling of memory; the package is made in memory.
const PACKED: [u64; 2] = [24, 8];

/// Writes the mesh as objects that are built, with colours of materials or of corners.
pub(in crate::io) fn write(
    mesh: &Mesh,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let mut written = rounding::of_precision(mesh, Format::ThreeMf, options)?;
    let size = PACKED[0] * mesh.positions.len() as u64 + PACKED[1] * mesh.triangles.len() as u64;
    let _reservation = options.control.reserve(size)?;
    let (objects, _room) = objects(mesh, options)?;
    let palette = Palette::of(mesh);
    let mut package = ZipWriter::new(Cursor::new(Vec::new()));
    // Without a time, so that the same mesh gives the same bytes.
    let deflated = SimpleFileOptions::DEFAULT
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::DEFAULT);
    for (name, content) in [("[Content_Types].xml", CONTENT_TYPES), ("_rels/.rels", RELATIONSHIPS)] {
        package.start_file(name, deflated).map_err(zip_error)?;
        write_all(&mut package, content.as_bytes())?;
    }
    package.start_file("3D/3dmodel.model", deflated.large_file(is_large(mesh))).map_err(zip_error)?;
    text::model(mesh, &objects, &palette, &mut package, options)?;
    let bytes = package.finish().map_err(zip_error)?.into_inner();
    write_all(output, &bytes)?;
    written.warnings.splice(0..0, palette::lost(mesh));
    Ok(written)
}

/// Whether the text of the model may be longer than 4 GiB, so that its length needs 64 bits; a line has at most some 100 bytes.
fn is_large(mesh: &Mesh) -> bool {
    (mesh.positions.len() + mesh.triangles.len()) as u64 * 100 > u64::from(u32::MAX)
}

fn zip_error(error: ZipError) -> Error {
    match error {
        ZipError::Io(source) => write_error(source),
        error => write_error(std::io::Error::other(error)),
    }
}

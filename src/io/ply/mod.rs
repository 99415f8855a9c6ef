//! PLY, ASCII and binary of either byte order: vertices, faces and triangle strips.
//!
//! Elements may come in any order, with any further properties, which become attributes, and further elements, which are skipped. Coordinates
//! may be of any number type, list counts and indices of any integer type.

mod binary;
mod body;
mod channels;
mod header;
mod properties;
mod usual;
mod write;

pub(super) use usual::Usual;
pub(super) use write::write;

use super::faces::{index_error, too_large};
use super::finish::check_finite;
use super::notes::Notes;
use super::scan::{line_place, quote};
use super::{Format, ReadOptions, malformed};
use crate::mesh::Polygons;
use crate::{Error, Mesh};
use body::{AsciiSource, Body};
use header::{Coding, Header, Property, Role};

/// The corners of attributes may take this many times the bytes of the file. Usual files take five times.
const ROOM: usize = 16;

/// Reads the mesh and the warnings.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    let header = Header::parse(bytes)?;
    let control = &options.control;
    let body = match header.coding {
        Coding::Ascii => Body::read(&header, &mut AsciiSource::new(bytes, header.end), control)?,
        Coding::LittleEndian => binary::read::<false>(bytes, &header, control)?,
        Coding::BigEndian => binary::read::<true>(bytes, &header, control)?,
    };
    let place = |offset| match header.coding {
        Coding::Ascii => line_place(bytes, offset),
        _ => format!("byte {offset}"),
    };
    finish_mesh(&header, body, bytes.len(), place, options)
}

/// The mesh and the warnings of a file with so many bytes.
fn finish_mesh(
    header: &Header,
    mut body: Body,
    length: usize,
    place: impl Fn(usize) -> String,
    options: &ReadOptions,
) -> Result<(Mesh, Vec<String>), Error> {
    let Some(positions) = body.positions.take() else {
        return Err(malformed(Format::Ply, "header", "there is no element \"vertex\""));
    };
    let mut notes = std::mem::take(&mut body.notes);
    let left_out = header.elements.iter().map(|element| element.left_out).sum();
    notes.add("property after the first 64 of vertices or faces not read", left_out);
    unread(header, &mut notes);
    let mesh = assemble(positions, body, ROOM.saturating_mul(length.max(1 << 12)), &mut notes, options)?;
    Ok((mesh, notes.into_warnings(place)))
}

/// Says which elements and lists a mesh has no place for.
fn unread(header: &Header, notes: &mut Notes) {
    for element in header.elements.iter().filter(|element| element.count > 0) {
        let name = quote(element.name.as_bytes());
        let known = match element.role {
            Role::Other => {
                notes.add(
                    format!("element {name} not read"),
                    usize::try_from(element.count).unwrap_or(usize::MAX),
                );
                continue;
            }
            Role::Vertices(_) => None,
            Role::Faces(indices) | Role::Strips(indices) => Some(indices),
        };
        let is_texture = |p: usize| element.further.iter().any(|(known, _)| *known == p);
        let lists = (0..element.properties.len()).filter(|&p| {
            matches!(element.properties[p], Property::List { .. }) && known != Some(p) && !is_texture(p)
        });
        notes.add(format!("list of the element {name} not read"), lists.count());
    }
}

fn assemble(
    positions: Vec<[f64; 3]>,
    mut body: Body,
    room: usize,
    notes: &mut Notes,
    options: &ReadOptions,
) -> Result<Mesh, Error> {
    let faces = std::mem::take(&mut body.faces);
    if faces.largest().is_some_and(|index| index as usize >= positions.len())
        && let Some((face, index)) = faces.first_beyond(positions.len())
    {
        let place =
            face.map_or("a face of fewer than three corners".to_string(), |face| format!("face {face}"));
        return Err(index_error(Format::Ply, place, u64::from(index), positions.len()));
    }
    let has_polygons = faces.has_polygons();
    let mut of = (has_polygons || !body.of_faces.is_empty() || !body.texture.is_empty()).then(Vec::new);
    let (triangles, _) = faces.into_triangles(&positions, &[], notes, &options.control, &mut of)?;
    if triangles.len() > u32::MAX as usize {
        return Err(too_large(Format::Ply, "triangles"));
    }
    let mut mesh = Mesh::new(positions, triangles);
    let faces = of.unwrap_or_default();
    if has_polygons {
        mesh.polygons = Polygons::of_faces(&faces);
    }
    mesh.attributes = properties::attributes(&mesh.triangles, &faces, body, room, notes);
    check_finite(&mut mesh, Format::Ply, notes, |vertex| format!("vertex {vertex}"))?;
    Ok(mesh)
}

#[cfg(test)]
mod tests;

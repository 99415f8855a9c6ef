//! STL, binary and ASCII.
//!
//! STL has no vertices, only the corners of triangles: corners with bit-equal coordinates become one vertex (negative
//! zero counts as zero). Binary STL holds single precision; ASCII STL is read and written with all digits.

mod ascii;
mod binary;
mod write;

pub(super) use ascii::looks_like_text;
pub(super) use binary::{HEADER, exact_length as binary_length};
pub(super) use write::write;

use super::finish::check_finite;
use super::notes::Notes;
use super::pieces::Blocks;
use super::scan::line_place;
use super::{Format, ReadOptions};
use crate::{Error, Mesh};

/// Reads the mesh and the warnings.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    let mut notes = Notes::default();
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    // Binary files may begin with the word "solid" too; their length gives them away.
    let binary = binary_length(bytes) == Some(bytes.len() as u64) || !looks_like_text(text);
    let mesh = if binary {
        binary::read(bytes, &mut notes, &options.control)?
    } else {
        ascii::read(bytes, &mut notes, &options.control)?
    };
    finish_mesh(mesh, notes, |offset| line_place(bytes, offset))
}

/// Reads a binary file of the length that it announces, its facets piece by piece: the mesh and the warnings.
pub(super) fn read_facets(
    blocks: &mut dyn Blocks,
    length: u64,
    options: &ReadOptions,
) -> Result<(Mesh, Vec<String>), Error> {
    let mut notes = Notes::default();
    let mesh = binary::read_facets(blocks, binary::facets_in(length), &mut notes, &options.control)?;
    finish_mesh(mesh, notes, |offset| format!("byte {offset}"))
}

fn finish_mesh(
    mut mesh: Mesh,
    mut notes: Notes,
    place: impl Fn(usize) -> String,
) -> Result<(Mesh, Vec<String>), Error> {
    check_finite(&mut mesh, Format::Stl, &mut notes, |vertex| format!("vertex {vertex}"))?;
    Ok((mesh, notes.into_warnings(place)))
}

#[cfg(test)]
mod tests;

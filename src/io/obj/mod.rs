//! Wavefront OBJ: positions, faces, groups and materials.
//!
//! Read by a parser of its own: the text is cut into pieces of whole lines, the pieces are parsed side by side, and
//! their vertices and faces put together in order. (The crate `tobj` splits a file into one vertex list per group,
//! fans concave polygons and reads about 75 MB/s; it serves as the oracle in the tests.)

mod groups;
mod library;
mod locate;
mod parse;
mod write;

pub(super) use write::{library, write};

use super::faces::{index_error, too_large};
use super::finish::check_finite;
use super::notes::Notes;
use super::scan::line_place;
use super::{Format, ReadOptions, malformed};
use crate::parallel;
use crate::{Error, Mesh};
use groups::Groups;
use parse::{Fault, Piece};

/// Pieces smaller than this are not worth a thread.
const SMALLEST_PIECE: usize = 1 << 20;

/// Reads the mesh and the warnings.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    read_in_pieces(bytes, parallel::piece_count(bytes.len(), SMALLEST_PIECE), options)
}

/// Reads the file cut into at most `count` pieces; the result is the same for any number.
fn read_in_pieces(bytes: &[u8], count: usize, options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    let mut pieces = parse_pieces(bytes, count, options)?;
    let mut notes = Notes::default();
    for piece in &mut pieces {
        notes.append(std::mem::take(&mut piece.notes));
    }
    let vertices: usize = pieces.iter().map(|piece| piece.positions.len()).sum();
    if vertices == 0 && pieces.iter().all(|piece| piece.faces.is_empty()) {
        if pieces.iter().any(|piece| piece.strange) {
            return Err(malformed(
                Format::Obj,
                "line 1",
                "no vertices and no faces, but lines that are not OBJ statements; is this another kind of file?",
            ));
        }
        return Ok((Mesh::default(), notes.into_warnings(|offset| line_place(bytes, offset))));
    }
    if vertices > u32::MAX as usize {
        return Err(too_large(Format::Obj, "vertices"));
    }
    if pieces.iter().filter_map(|piece| piece.faces.largest()).max().is_some_and(|i| i as usize >= vertices) {
        let (place, index) = locate::face_out_of_range(bytes, vertices);
        return Err(index_error(Format::Obj, place, index, vertices));
    }

    let positions = join(pieces.iter_mut().map(|piece| std::mem::take(&mut piece.positions)).collect());
    let resolved = parallel::map(pieces, |piece| -> Result<_, Error> {
        let mut notes = Notes::default();
        let places: Vec<_> = piece.changes.iter().map(|change| change.at).collect();
        let (triangles, offsets) =
            piece.faces.into_triangles(&positions, &places, &mut notes, &options.control)?;
        Ok((triangles, offsets, piece.changes, piece.libraries, notes))
    });

    let mut groups = Groups::default();
    let mut parts = Vec::with_capacity(resolved.len());
    let mut before = 0;
    for part in resolved {
        let (triangles, offsets, changes, libraries, part_notes) = part?;
        for (change, offset) in changes.iter().zip(offsets) {
            groups.change(change, before + offset);
        }
        for name in libraries {
            groups.add_library(name, options.folder.as_deref(), &mut notes);
        }
        before += triangles.len();
        if before > u32::MAX as usize {
            return Err(too_large(Format::Obj, "triangles"));
        }
        notes.append(part_notes);
        parts.push(triangles);
    }
    let groups = groups.finish(before, bytes.len().max(1 << 16), &mut notes)?;
    let mut mesh = Mesh::new(positions, join(parts));
    mesh.groups = groups;
    check_finite(&mut mesh, Format::Obj, &mut notes, |vertex| locate::vertex(bytes, vertex))?;
    Ok((mesh, notes.into_warnings(|offset| line_place(bytes, offset))))
}

/// The file in pieces, parsed.
fn parse_pieces<'a>(bytes: &'a [u8], count: usize, options: &ReadOptions) -> Result<Vec<Piece<'a>>, Error> {
    let mut ends: Vec<usize> =
        parallel::ranges(bytes.len(), count).iter().map(|range| end_of_line(bytes, range.end)).collect();
    ends.dedup();
    let starts = std::iter::once(0).chain(ends.iter().copied());
    let ranges: Vec<_> = starts.zip(ends.iter().copied()).map(|(start, end)| start..end).collect();
    let parsed: Result<Vec<_>, _> =
        parallel::map(ranges, |range| Piece::parse(bytes, range, &options.control)).into_iter().collect();
    match parsed {
        Ok(pieces) => Ok(pieces),
        Err(Fault::Error(error)) => Err(error),
        // Indices counted backwards need the number of vertices before the piece: one piece, then.
        Err(Fault::Relative) => match Piece::parse(bytes, 0..bytes.len(), &options.control) {
            Ok(piece) => Ok(vec![piece]),
            Err(Fault::Error(error)) => Err(error),
            // The first piece knows the vertices before it: none.
            Err(Fault::Relative) => Err(Error::InvalidArgument("an index relative to no vertex".into())),
        },
    }
}

/// The end of the statement at or after a byte: behind a line feed that no backslash takes back.
fn end_of_line(bytes: &[u8], near: usize) -> usize {
    let mut at = near;
    while let Some(length) = memchr::memchr(b'\n', &bytes[at..]) {
        at += length + 1;
        let line = bytes[..at - 1].strip_suffix(b"\r").unwrap_or(&bytes[..at - 1]);
        if !line.ends_with(b"\\") {
            return at;
        }
    }
    bytes.len()
}

/// Several lists as one; a single one is not copied.
fn join<T: Copy>(mut lists: Vec<Vec<T>>) -> Vec<T> {
    match lists.len() {
        1 => lists.pop().unwrap_or_default(),
        _ => {
            let mut joined = Vec::with_capacity(lists.iter().map(Vec::len).sum());
            for list in lists {
                joined.extend_from_slice(&list);
            }
            joined
        }
    }
}

#[cfg(test)]
mod tests;

//! Geomview OFF in text, with the variants that add normals, colours or texture coordinates, which are skipped with a warning.

use std::io::Write;

use super::faces::{FaceList, index_error, too_large};
use super::finish::check_finite;
use super::notes::Notes;
use super::rounding::{self, Written};
use super::scan::{Scanner, line_place, quote};
use super::text::{write_all, write_lines};
use super::{Format, ReadOptions, WriteOptions, malformed, unsupported};
use crate::mesh::{Faces, Polygons};
use crate::{Control, Error, Mesh};

/// Vertices or faces between two looks at the limits.
const CHECK_INTERVAL: usize = 1 << 12;

/// The first word of a file, "OFF" with prefixes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Header {
    texture: bool,
    colors: bool,
    normals: bool,
    homogeneous: bool,
    any_dimension: bool,
}

/// The header that a word is, if it is one: `[ST][C][N][4][n]OFF`.
pub(super) fn header(word: &[u8]) -> Option<Header> {
    let rest = word.strip_suffix(b"OFF")?;
    let (texture, rest) = rest.strip_prefix(b"ST").map_or((false, rest), |rest| (true, rest));
    let (colors, rest) = rest.strip_prefix(b"C").map_or((false, rest), |rest| (true, rest));
    let (normals, rest) = rest.strip_prefix(b"N").map_or((false, rest), |rest| (true, rest));
    let (homogeneous, rest) = rest.strip_prefix(b"4").map_or((false, rest), |rest| (true, rest));
    let (any_dimension, rest) = rest.strip_prefix(b"n").map_or((false, rest), |rest| (true, rest));
    rest.is_empty().then_some(Header { texture, colors, normals, homogeneous, any_dimension })
}

/// Reads the mesh and the warnings.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    let mut reader = Reader { bytes, scanner: Scanner::new(bytes, 0), notes: Notes::default() };
    if bytes.starts_with(b"\xef\xbb\xbf") {
        reader.scanner.advance(3);
    }
    let header = reader.header()?;
    let (vertices, faces) = reader.counts()?;
    let positions = reader.vertices(vertices, header, &options.control)?;
    let faces = reader.faces(faces, vertices, &options.control)?;
    let mut notes = reader.notes;
    let mut of = faces.has_polygons().then(Vec::new);
    let (triangles, _) = faces.into_triangles(&positions, &[], &mut notes, &options.control, &mut of)?;
    if triangles.len() > u32::MAX as usize {
        return Err(too_large(Format::Off, "triangles"));
    }
    let mut mesh = Mesh::new(positions, triangles);
    mesh.polygons = Polygons::of_faces(&of.unwrap_or_default());
    check_finite(&mut mesh, Format::Off, &mut notes, |vertex| format!("vertex {vertex}"))?;
    Ok((mesh, notes.into_warnings(|offset| line_place(bytes, offset))))
}

struct Reader<'a> {
    bytes: &'a [u8],
    scanner: Scanner<'a>,
    notes: Notes,
}

impl Reader<'_> {
    fn error(&self, what: &str) -> Error {
        malformed(Format::Off, line_place(self.bytes, self.scanner.offset()), what)
    }

    /// The first word, which may be missing.
    fn header(&mut self) -> Result<Header, Error> {
        self.scanner.skip_to_word();
        let word = self.scanner.peek_word();
        let Some(header) = header(word) else {
            return match word.first() {
                Some(b'0'..=b'9') => Ok(Header::default()),
                _ => Err(self.error(&format!("expected \"OFF\" at the beginning, found {}", quote(word)))),
            };
        };
        self.scanner.word();
        if header.homogeneous || header.any_dimension {
            return Err(unsupported(
                Format::Off,
                format!(
                    "{} has points of other than three dimensions; project them and write OFF",
                    quote(word)
                ),
            ));
        }
        self.scanner.skip_blanks();
        if self.scanner.peek_word() == b"BINARY" {
            return Err(unsupported(
                Format::Off,
                "binary OFF is not read; convert the file to text OFF or to PLY",
            ));
        }
        Ok(header)
    }

    /// How many vertices and faces there are; the number of edges that follows is optional and not used.
    fn counts(&mut self) -> Result<(usize, usize), Error> {
        self.scanner.skip_to_word();
        let vertices = self.count("the number of vertices")?;
        self.scanner.skip_to_word();
        let faces = self.count("the number of faces")?;
        self.scanner.skip_blanks();
        if self.scanner.at_line_end() {
            // The number of edges may stand alone on the next line; a vertex does not.
            let mut ahead = self.scanner;
            ahead.skip_to_word();
            let single = ahead.unsigned().is_ok();
            ahead.skip_blanks();
            if single && ahead.at_line_end() {
                self.scanner = ahead;
            }
        }
        self.scanner.skip_line();
        // The shortest vertex is "0 0 0" and its line end, the shortest face "0" and its line end.
        let room = self.scanner.rest().len() + 1;
        for (what, count, size) in [("vertices", vertices, 6), ("faces", faces, 2)] {
            if count > room as u64 / size {
                return Err(self.error(&format!(
                    "the file announces {count} {what}, but is too short for them; it is cut off or its counts are \
                     wrong"
                )));
            }
        }
        if vertices.max(faces) >= u64::from(u32::MAX) {
            return Err(too_large(Format::Off, "vertices or faces"));
        }
        Ok((vertices as usize, faces as usize))
    }

    /// Skips the rest of a line, and notes that there was one.
    fn skip_rest(&mut self, what: &'static str) {
        self.scanner.skip_blanks();
        if !self.scanner.at_line_end() && self.scanner.peek() != Some(b'#') {
            self.notes.at(what, self.scanner.offset());
        }
        self.scanner.skip_line();
    }

    fn count(&mut self, what: &str) -> Result<u64, Error> {
        self.scanner.unsigned().map_err(|_| self.scanner.expected(Format::Off, what))
    }

    /// The points. What the header announces with them is not read; where it announces nothing, as often with colours, it is
    /// further values.
    fn vertices(&mut self, count: usize, header: Header, control: &Control) -> Result<Vec<[f64; 3]>, Error> {
        let announced = [
            (header.normals, "normals of vertices are not read"),
            (header.colors, "colours of vertices are not read"),
            (header.texture, "texture coordinates of vertices are not read"),
        ];
        let is_plain = announced.iter().all(|(is_there, _)| !is_there);
        let mut positions = Vec::with_capacity(count);
        for i in 0..count {
            if i % CHECK_INTERVAL == 0 {
                control.check()?;
            }
            let mut position = [0.0; 3];
            for coordinate in &mut position {
                self.scanner.skip_to_word();
                *coordinate = self.scanner.float().map_err(|_| {
                    self.scanner.expected(Format::Off, &format!("a coordinate of vertex {i} of {count}"))
                })?;
            }
            positions.push(position);
            // A normal, a colour or texture coordinates may follow.
            if is_plain {
                self.skip_rest("further values of vertices are not read");
            } else {
                self.scanner.skip_line();
            }
        }
        for (_, what) in announced.iter().filter(|(is_there, _)| *is_there && count > 0) {
            self.notes.add(*what, count);
        }
        Ok(positions)
    }

    fn faces(&mut self, count: usize, vertices: usize, control: &Control) -> Result<FaceList, Error> {
        let mut faces = FaceList::with_capacity(count);
        let mut corners = Vec::new();
        for i in 0..count {
            if i % CHECK_INTERVAL == 0 {
                control.check()?;
            }
            self.scanner.skip_to_word();
            let start = self.scanner.offset();
            let length = self.scanner.unsigned().map_err(|_| {
                self.scanner.expected(Format::Off, &format!("the number of corners of face {i} of {count}"))
            })?;
            corners.clear();
            for _ in 0..length {
                self.scanner.skip_to_word();
                let index = self.scanner.unsigned().map_err(|_| {
                    self.scanner.expected(Format::Off, &format!("a corner of face {i} of {count}"))
                })?;
                if index >= vertices as u64 {
                    let place = line_place(self.bytes, start);
                    return Err(index_error(Format::Off, place, index, vertices));
                }
                corners.push(index as u32);
            }
            if !faces.push(&corners) {
                let what = match corners.len() {
                    0..3 => "face with fewer than three corners ignored",
                    _ => "face with fewer than three different corners dropped",
                };
                self.notes.at(what, start);
            } else if !faces.has_room() {
                return Err(too_large(Format::Off, "faces"));
            }
            // A colour may follow.
            self.skip_rest("colours of faces are not read");
        }
        Ok(faces)
    }
}

/// Writes vertices and triangles.
pub(super) fn write(mesh: &Mesh, output: &mut dyn Write, options: &WriteOptions) -> Result<Written, Error> {
    let mut written = rounding::of_precision(mesh, Format::Off, options)?;
    let faces = Faces::of(mesh, usize::MAX, |_, _| true);
    let header = format!("OFF\n{} {} 0\n", mesh.positions.len(), faces.len());
    write_all(output, header.as_bytes())?;
    write_lines(mesh, &faces, output, options)?;
    // Nobody looks for names in OFF; colours it could have.
    if mesh.groups.list.iter().any(|group| group.material.is_some()) {
        written.warnings.insert(0, "OFF is written without materials: names and colours are not kept".into());
    }
    Ok(written)
}

#[cfg(test)]
mod tests;

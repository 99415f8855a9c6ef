//! Wavefront OBJ: positions, faces, groups and materials.
//!
//! Read by a parser of its own: the text is cut into chunks of whole lines, the chunks are parsed side by side, and
//! their vertices and faces put together in order. (The crate `tobj` splits a file into one vertex list per group,
//! fans concave polygons and reads about 75 MB/s; it serves as the oracle in the tests.)

mod corners;
mod groups;
mod labels;
mod library;
mod locate;
mod mtl;
mod parse;
mod pictures;
mod smoothing;
mod unsaid;
mod write;

pub(super) use mtl::library;
pub(super) use write::write;

use super::faces::{index_error, too_large};
use super::finish::check_finite;
use super::labels::{ChunkCorners, NO_INDEX, of_triangles};
use super::notes::Notes;
use super::scan::line_place;
use super::{Format, ReadOptions, malformed};
use crate::mesh::Polygons;
use crate::parallel;
use crate::{Error, Mesh};
use groups::Groups;
use parse::{Change, Chunk, Fault};
use smoothing::Smoothing;

/// Chunks smaller than this are not worth a thread.
const SMALLEST_CHUNK: usize = 1 << 20;

/// Reads the mesh and the warnings.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    read_in_chunks(bytes, parallel::piece_count(bytes.len(), SMALLEST_CHUNK), options)
}

/// Reads the file cut into at most `count` chunks; the result is the same for any number.
fn read_in_chunks(bytes: &[u8], count: usize, options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    let mut chunks = parse_chunks(bytes, count, options)?;
    let mut notes = Notes::default();
    for chunk in &mut chunks {
        notes.append(std::mem::take(&mut chunk.notes));
    }
    let vertices: usize = chunks.iter().map(|chunk| chunk.positions.len()).sum();
    if vertices == 0 && chunks.iter().all(|chunk| chunk.faces.is_empty()) {
        if chunks.iter().any(|chunk| chunk.strange) {
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
    if chunks.iter().filter_map(|chunk| chunk.faces.largest()).max().is_some_and(|i| i as usize >= vertices) {
        let (place, index) = locate::face_out_of_range(bytes, vertices);
        return Err(index_error(Format::Obj, place, index, vertices));
    }

    let smoothing = smoothing(&chunks);
    let Lists { positions, colors, texture, normals } = Lists::taken(&mut chunks);
    let label_counts = [texture.len(), normals.len()];
    let resolved = parallel::map(chunks, |chunk| resolve(chunk, &positions, label_counts, options));

    let mut whole = Whole { parts: Vec::with_capacity(resolved.len()), ..Whole::default() };
    for part in resolved {
        whole.append(part?, options, &mut notes)?;
    }
    let Whole { groups, parts, count, of_texture, of_normals, polygons } = whole;
    let groups = groups.finish(count, options, bytes.len().max(1 << 16), &mut notes)?;
    let mut mesh = Mesh::new(positions, join(parts));
    mesh.groups = groups;
    mesh.polygons = polygons;
    let (texture, normals) = ((texture, of_texture), (normals, of_normals));
    mesh.attributes = corners::attributes(&mesh.triangles, texture, normals, &colors, &mut notes);
    if smoothing == Smoothing::Several && mesh.attributes.iter().all(|attribute| attribute.name != "NORMAL") {
        notes.say("smoothing groups are not kept");
    }
    check_finite(&mut mesh, Format::Obj, &mut notes, |vertex| locate::vertex(bytes, vertex))?;
    Ok((mesh, notes.into_warnings(|offset| line_place(bytes, offset))))
}

/// The lists of vertices and what faces name beside them, those of all chunks one after the other.
struct Lists {
    positions: Vec<[f64; 3]>,
    colors: Vec<[f64; 3]>,
    texture: Vec<[f64; 2]>,
    normals: Vec<[f64; 3]>,
}

impl Lists {
    fn taken(chunks: &mut [Chunk<'_>]) -> Self {
        let counts: Vec<usize> = chunks.iter().map(|chunk| chunk.positions.len()).collect();
        let colors = chunks.iter_mut().map(|chunk| std::mem::take(&mut chunk.colors));
        Self {
            colors: corners::join_colors(colors.zip(counts)),
            texture: join(chunks.iter_mut().map(|chunk| std::mem::take(&mut chunk.texture)).collect()),
            normals: join(chunks.iter_mut().map(|chunk| std::mem::take(&mut chunk.normals)).collect()),
            positions: join(chunks.iter_mut().map(|chunk| std::mem::take(&mut chunk.positions)).collect()),
        }
    }
}

/// The triangles of a chunk, with what belongs to them.
struct Resolved<'a> {
    triangles: Vec<[u32; 3]>,
    /// For each change of the group how many triangles come before it.
    offsets: Vec<usize>,
    changes: Vec<Change<'a>>,
    libraries: Vec<&'a [u8]>,
    notes: Notes,
    corners: ChunkCorners,
    polygons: Polygons,
}

/// What all chunks hold, as it grows chunk by chunk.
#[derive(Default)]
struct Whole<'a> {
    groups: Groups<'a>,
    /// The triangles of each chunk, and how many there are.
    parts: Vec<Vec<[u32; 3]>>,
    count: usize,
    of_texture: Vec<u32>,
    of_normals: Vec<u32>,
    polygons: Polygons,
}

impl<'a> Whole<'a> {
    /// Adds the next chunk.
    fn append(&mut self, part: Resolved<'a>, options: &ReadOptions, notes: &mut Notes) -> Result<(), Error> {
        let before = self.count;
        for (change, offset) in part.changes.iter().zip(part.offsets) {
            self.groups.change(change, before + offset);
        }
        for name in part.libraries {
            self.groups.add_library(name, options.folder.as_deref(), notes);
        }
        self.polygons.append(before, &part.polygons, part.triangles.len());
        self.count += part.triangles.len();
        if self.count > u32::MAX as usize {
            return Err(too_large(Format::Obj, "triangles"));
        }
        notes.append(part.notes);
        let ChunkCorners { texture, normals, .. } = part.corners;
        for (indices, of_chunk) in [(&mut self.of_texture, texture), (&mut self.of_normals, normals)] {
            if !of_chunk.is_empty() {
                indices.resize(3 * before, NO_INDEX);
                indices.extend(of_chunk);
            }
        }
        self.parts.push(part.triangles);
        Ok(())
    }
}

/// Makes triangles of the faces of a chunk.
fn resolve<'a>(
    chunk: Chunk<'a>,
    positions: &[[f64; 3]],
    label_counts: [usize; 2],
    options: &ReadOptions,
) -> Result<Resolved<'a>, Error> {
    let mut notes = Notes::default();
    let places: Vec<_> = chunk.changes.iter().map(|change| change.at).collect();
    let has_polygons = chunk.faces.has_polygons();
    let mut faces = (has_polygons || !chunk.labels.corners.is_empty()).then(Vec::new);
    let (triangles, offsets) =
        chunk.faces.into_triangles(positions, &places, &mut notes, &options.control, &mut faces)?;
    let faces = faces.unwrap_or_default();
    let corners = of_triangles(&triangles, &faces, &chunk.labels, label_counts);
    notes.add("texture coordinates or normal that a face names are not there", corners.beyond);
    let polygons = if has_polygons { Polygons::of_faces(&faces) } else { Polygons::default() };
    let (changes, libraries) = (chunk.changes, chunk.libraries);
    Ok(Resolved { triangles, offsets, changes, libraries, notes, corners, polygons })
}

/// The smoothing groups of all chunks.
fn smoothing<'a>(chunks: &[Chunk<'a>]) -> Smoothing<'a> {
    let mut all = Smoothing::None;
    for chunk in chunks {
        match chunk.smoothing {
            Smoothing::One(name) => all.add(name),
            Smoothing::Several => return Smoothing::Several,
            Smoothing::None => {}
        }
    }
    all
}

/// The file in chunks, parsed.
fn parse_chunks<'a>(bytes: &'a [u8], count: usize, options: &ReadOptions) -> Result<Vec<Chunk<'a>>, Error> {
    let mut ends: Vec<usize> =
        parallel::ranges(bytes.len(), count).iter().map(|range| end_of_line(bytes, range.end)).collect();
    ends.dedup();
    let starts = std::iter::once(0).chain(ends.iter().copied());
    let ranges: Vec<_> = starts.zip(ends.iter().copied()).map(|(start, end)| start..end).collect();
    let parsed: Result<Vec<_>, _> =
        parallel::map(ranges, |range| Chunk::parse(bytes, range, &options.control)).into_iter().collect();
    match parsed {
        Ok(chunks) => Ok(chunks),
        Err(Fault::Error(error)) => Err(error),
        // Indices counted backwards need the number of vertices before the chunk: one chunk, then.
        Err(Fault::Relative) => match Chunk::parse(bytes, 0..bytes.len(), &options.control) {
            Ok(chunk) => Ok(vec![chunk]),
            Err(Fault::Error(error)) => Err(error),
            // The first chunk knows the vertices before it: none.
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

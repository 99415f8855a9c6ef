//! Large binary files in the usual layout of their format, read piece by piece: their bytes never stand beside the mesh.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

use super::detect::other_name;
use super::{Contents, Format, Loaded, ReadOptions, finish_loading, ply, stl};
use crate::{Error, FileAction};

/// Files smaller than this are read as a whole: their bytes have room in the processor's nearer memory.
const LEAST: u64 = 1 << 20;
/// Bytes from the beginning that tell how to read the rest: headers of PLY have some hundreds.
const HEAD: usize = 1 << 12;

/// Bytes one after the other.
pub(super) trait Blocks {
    /// The next so many.
    ///
    /// # Errors
    /// [`Error::File`].
    fn next(&mut self, count: usize) -> Result<&[u8], Error>;
}

/// Those of a list, which has as many as are asked for.
impl Blocks for &[u8] {
    fn next(&mut self, count: usize) -> Result<&[u8], Error> {
        let (block, rest) = self.split_at(count);
        *self = rest;
        Ok(block)
    }
}

/// Those of a file.
struct FileBlocks<'a> {
    file: File,
    path: &'a Path,
    /// Those that were read last; used again and again, they stay in the processor's nearer memory if they are few.
    buffer: Vec<u8>,
}

impl FileBlocks<'_> {
    fn fail(&self, source: std::io::Error) -> Error {
        Error::File { action: FileAction::Read, path: self.path.to_path_buf(), source }
    }

    fn skip_to(&mut self, start: usize) -> Result<(), Error> {
        match self.file.seek(SeekFrom::Start(start as u64)) {
            Ok(_) => Ok(()),
            Err(source) => Err(self.fail(source)),
        }
    }
}

impl Blocks for FileBlocks<'_> {
    fn next(&mut self, count: usize) -> Result<&[u8], Error> {
        if self.buffer.len() < count {
            self.buffer.resize(count, 0);
        }
        match self.file.read_exact(&mut self.buffer[..count]) {
            Ok(()) => Ok(&self.buffer[..count]),
            Err(source) => Err(self.fail(source)),
        }
    }
}

/// Reads a large file that is binary STL of the length it announces, or binary PLY with vertices that are points alone and then triangles
/// alone; nothing of all others, without an error.
///
/// # Errors
/// [`Error::File`] if the file cannot be read, and those of [`read`](super::read).
pub(super) fn load(path: &Path, options: &ReadOptions) -> Result<Option<Loaded>, Error> {
    match read(path, options) {
        // (It has become shorter. Whoever reads it as a whole says where it is cut off.)
        Err(Error::File { source, .. }) if source.kind() == ErrorKind::UnexpectedEof => Ok(None),
        other => other,
    }
}

fn read(path: &Path, options: &ReadOptions) -> Result<Option<Loaded>, Error> {
    // (Some systems go on where the last reader of a stream has stopped.)
    if path.starts_with("/dev") {
        return Ok(None);
    }
    let fail = |source| Error::File { action: FileAction::Read, path: path.to_path_buf(), source };
    let (mut file, length) = match std::fs::metadata(path) {
        Ok(data) if data.is_file() && data.len() >= LEAST => (File::open(path).map_err(fail)?, data.len()),
        // (Whoever reads it as a whole says what is wrong with it.)
        _ => return Ok(None),
    };
    let mut head = vec![0; HEAD];
    file.read_exact(&mut head).map_err(fail)?;
    let mut blocks = FileBlocks { file, path, buffer: Vec::new() };
    let (format, read) = match Format::from_beginning(&head, length) {
        Some(format @ Format::Ply) => {
            let Some(usual) = ply::Usual::of(&head, length) else { return Ok(None) };
            let _reservation = options.control.reserve(2 * length)?;
            blocks.skip_to(usual.start())?;
            let Some(read) = usual.read(&mut blocks, length, options)? else { return Ok(None) };
            (format, read)
        }
        Some(format) => {
            let _reservation = options.control.reserve(2 * length)?;
            blocks.skip_to(stl::HEADER)?;
            (format, stl::read_facets(&mut blocks, length, options)?)
        }
        None => return Ok(None),
    };
    let (mesh, mut warnings) = read;
    warnings.splice(0..0, other_name(Format::from_path(path), format));
    Ok(Some(finish_loading(mesh, format, warnings, Contents::default())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{Encoding, Precision, WriteOptions, file, read, write};
    use crate::{CancelToken, Control, Limit, Mesh, primitives};

    /// Any mesh whose files are long enough.
    fn ball() -> Mesh {
        primitives::icosphere(1.0, 6).unwrap().rotated([1.0, 2.0, 3.0], 0.3).unwrap()
    }

    /// What is read of these bytes as a file, and whether piece by piece.
    fn of_file(name: &str, bytes: &[u8]) -> (Result<Loaded, Error>, bool) {
        let path = std::env::temp_dir().join(format!("trisect-pieces-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        let (loaded, in_pieces) = (file::load(&path, &ReadOptions::new()), load(&path, &ReadOptions::new()));
        std::fs::remove_file(&path).unwrap();
        (loaded, in_pieces.is_ok_and(|loaded| loaded.is_some()))
    }

    #[test]
    fn files_are_what_their_bytes_are() {
        let ball = ball();
        let options = [
            WriteOptions::new(),
            WriteOptions::new().precision(Precision::Single),
            WriteOptions::new().encoding(Encoding::Ascii),
        ];
        for (k, options) in options.iter().enumerate() {
            for format in [Format::Ply, Format::Stl] {
                let mut bytes = Vec::new();
                write(&ball, format, &mut bytes, options).unwrap();
                for name in ["a.ply", "a.stl"] {
                    let (loaded, in_pieces) = of_file(name, &bytes);
                    let (loaded, expected) =
                        (loaded.unwrap(), read(&bytes, format, &ReadOptions::new()).unwrap());
                    assert_eq!((&loaded.mesh, loaded.format), (&expected.mesh, format));
                    let is_named_so = Format::from_path(Path::new(name)) == Some(format);
                    assert_eq!(loaded.warnings.len(), usize::from(!is_named_so), "{:?}", loaded.warnings);
                    assert_eq!(in_pieces, k < 2, "{format} {k}");
                }
            }
        }
    }

    #[test]
    fn limits_hold_piece_by_piece() {
        let token = CancelToken::new();
        token.cancel();
        for format in [Format::Ply, Format::Stl] {
            let mut bytes = Vec::new();
            write(&ball(), format, &mut bytes, &WriteOptions::new()).unwrap();
            let path = std::env::temp_dir().join(format!(
                "trisect-limits-{}.{}",
                std::process::id(),
                format.extension()
            ));
            std::fs::write(&path, &bytes).unwrap();
            let with = |control: Control| load(&path, &ReadOptions::new().control(control));
            assert!(matches!(with(Control::new().cancel(&token)), Err(Error::Limit(Limit::Cancelled))));
            let length = bytes.len() as u64;
            assert!(with(Control::new().memory_limit(2 * length + 1024)).unwrap().is_some());
            assert!(matches!(with(Control::new().memory_limit(2 * length - 1)), Err(Error::Limit(_))));
            std::fs::remove_file(&path).unwrap();
        }
    }

    #[test]
    fn what_is_not_usual_is_read_as_a_whole() {
        let ball = ball();
        let mut ply = Vec::new();
        write(&ball, Format::Ply, &mut ply, &WriteOptions::new()).unwrap();
        let expected = read(&ply, Format::Ply, &ReadOptions::new()).unwrap();
        // 1. Bytes after the last face.
        let longer = [&*ply, b"more"].concat();
        let (loaded, in_pieces) = of_file("b.ply", &longer);
        assert!(!in_pieces && loaded.unwrap().warnings[0].contains("4 bytes after"));
        // 2. A face that is no triangle, which is found out at the last of them.
        let mut lying = ply.clone();
        let last = ply.len() - 13;
        lying[last] = 4;
        let (loaded, in_pieces) = of_file("c.ply", &lying);
        assert!(!in_pieces && loaded.unwrap_err().to_string().contains("cut off"));
        // 3. The same with numbers of the other order of bytes, and an index out of range in them.
        let header = ply.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        let text = String::from_utf8(ply[..header].to_vec()).unwrap().replace("little", "big");
        let mut big = text.into_bytes();
        let (vertices, faces) = ply[header..].split_at(24 * ball.positions.len());
        vertices.chunks(8).for_each(|number| big.extend(number.iter().rev()));
        for face in faces.chunks(13) {
            big.push(face[0]);
            face[1..].chunks(4).for_each(|number| big.extend(number.iter().rev()));
        }
        let (loaded, in_pieces) = of_file("d.ply", &big);
        assert!(in_pieces && loaded.unwrap().mesh == expected.mesh);
        let end = big.len();
        big[end - 4] = 1;
        let (loaded, _) = of_file("e.ply", &big);
        let (by_bytes, by_file) =
            (read(&big, Format::Ply, &ReadOptions::new()).unwrap_err(), loaded.unwrap_err());
        assert_eq!(by_bytes.to_string(), by_file.to_string());
        // 4. A header longer than what is looked at first, and files just long enough and just too short.
        let comments = "comment made by hand\n".repeat(300);
        let long = String::from_utf8(ply[..header].to_vec()).unwrap();
        let long = long.replacen("element", &format!("{comments}element"), 1);
        let (loaded, in_pieces) = of_file("h.ply", &[long.as_bytes(), &ply[header..]].concat());
        assert!(long.len() > HEAD && !in_pieces && loaded.unwrap().mesh == expected.mesh);
        let fewest = (LEAST as usize - stl::HEADER).div_ceil(50);
        for facets in [fewest - 1, fewest] {
            let mut bytes = vec![0; stl::HEADER + 50 * facets];
            bytes[80..84].copy_from_slice(&(facets as u32).to_le_bytes());
            let (loaded, in_pieces) = of_file("i.stl", &bytes);
            assert!(loaded.unwrap().mesh.is_empty() && in_pieces == (facets == fewest));
        }
        // 5. Coordinates that are no numbers, in both formats.
        let mut stl = Vec::new();
        write(&ball, Format::Stl, &mut stl, &WriteOptions::new()).unwrap();
        let facet = 84 + 50 * (ball.triangles.len() - 7);
        stl[facet + 12..facet + 16].copy_from_slice(&f32::NAN.to_le_bytes());
        let mut infinite = ply;
        infinite[header + 24 * 999..][..8].copy_from_slice(&f64::INFINITY.to_le_bytes());
        for (name, bytes, format) in [("f.stl", stl, Format::Stl), ("g.ply", infinite, Format::Ply)] {
            let by_file = of_file(name, &bytes).0.unwrap_err().to_string();
            let by_bytes = read(&bytes, format, &ReadOptions::new()).unwrap_err().to_string();
            assert_eq!(by_file, by_bytes);
            assert!(by_file.contains("not a finite"), "{by_file}");
        }
    }
}

//! Telling the format of a file from its name and from its content.

use std::path::Path;

use super::scan::Scanner;
use super::{Format, FormatError, malformed};
use crate::Error;

/// The format of a file, and a warning if its name says otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Detected {
    /// The format its content has, or if the content does not tell, the one its name stands for.
    pub format: Format,
    /// Set where name and content differ.
    pub warning: Option<String>,
}

impl Format {
    /// The format of a file from its name, if it has one, and its bytes. Content that can be no other format wins
    /// over the name.
    ///
    /// # Errors
    /// [`FormatError::Unknown`] if neither tells; [`FormatError::Malformed`] if the content is of a kind that is not read
    /// here, such as an archive.
    pub fn detect(path: Option<&Path>, bytes: &[u8]) -> Result<Detected, Error> {
        let named = path.and_then(Self::from_path);
        let display = || path.map_or_else(|| "the input".to_string(), |path| path.display().to_string());
        match (named, Self::from_content(bytes)) {
            (named, Some(format)) => Ok(Detected { format, warning: other_name(named, format) }),
            (named, None) => match (named, foreign(bytes)) {
                (Some(format), None) => Ok(Detected { format, warning: None }),
                (Some(format), Some(what)) => Err(malformed(format, "byte 0", format!("the file is {what}"))),
                (None, None) => Err(FormatError::Unknown { name: display() }.into()),
                (None, Some(what)) => {
                    Err(FormatError::Unknown { name: format!("{}, which is {what}", display()) }.into())
                }
            },
        }
    }

    /// The format that the content of a file can only be, if there is one.
    #[must_use]
    pub fn from_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"glTF") {
            return Some(Self::Glb);
        }
        #[cfg(feature = "threemf")]
        if bytes.starts_with(ZIP) {
            // Names of parts stand at the end of a package, in the clear.
            return memchr::memmem::rfind(bytes, b".model").map(|_| Self::ThreeMf);
        }
        if let Some(format) = Self::from_beginning(bytes, bytes.len() as u64) {
            return Some(format);
        }
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let start = text.trim_ascii_start();
        if start.starts_with(b"{") {
            // The order of keys is free, so the one key that every glTF has may come late.
            return memchr::memmem::find(start, b"\"asset\"").map(|_| Self::Gltf);
        }
        if super::stl::looks_like_text(start) {
            return Some(Self::Stl);
        }
        let mut scanner = Scanner::new(text, 0);
        scanner.skip_to_word();
        if super::off::header(scanner.peek_word()).is_some() {
            return Some(Self::Off);
        }
        looks_like_obj(scanner).then_some(Self::Obj)
    }

    /// PLY, or binary STL of the length it announces, if a file of that length that begins so can be nothing else.
    pub(super) fn from_beginning(bytes: &[u8], length: u64) -> Option<Self> {
        if bytes.starts_with(b"glTF") || cfg!(feature = "threemf") && bytes.starts_with(ZIP) {
            return None;
        }
        if matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r' | b' ' | b'\t', ..]) {
            return Some(Self::Ply);
        }
        (super::stl::binary_length(bytes) == Some(length)).then_some(Self::Stl)
    }
}

/// A warning where the name of a file stands for another format than that of its content.
pub(super) fn other_name(named: Option<Format>, found: Format) -> Option<String> {
    let named = named.filter(|named| *named != found)?;
    Some(format!("the name says {named}, but the content is {found}; read as {found}"))
}

/// What ZIP archives begin with.
const ZIP: &[u8] = b"PK\x03\x04";

/// Whether the first statements are those of an OBJ file, a vertex among them.
fn looks_like_obj(mut scanner: Scanner<'_>) -> bool {
    for _ in 0..64 {
        scanner.skip_to_word();
        match scanner.word() {
            b"v" => {
                return (0..3).all(|_| {
                    scanner.skip_blanks();
                    scanner.float().is_ok()
                });
            }
            b"o" | b"g" | b"s" | b"mtllib" | b"usemtl" | b"vt" | b"vn" => scanner.skip_line(),
            _ => return false,
        }
    }
    false
}

/// What a file is that is none of the formats read here, and what to do about it.
fn foreign(bytes: &[u8]) -> Option<&'static str> {
    let kinds: [(&[u8], &str); 16] = [
        (
            ZIP,
            if cfg!(feature = "threemf") {
                "a ZIP archive without a 3MF model; unpack it first"
            } else {
                "a ZIP archive (3MF files are such); unpack or convert it first"
            },
        ),
        (b"\x1f\x8b", "compressed with gzip; unpack it first"),
        (b"BZh", "compressed with bzip2; unpack it first"),
        (b"\xfd7zXZ", "compressed with xz; unpack it first"),
        (b"\x28\xb5\x2f\xfd", "compressed with zstd; unpack it first"),
        (
            b"version https://git-lfs",
            "a Git LFS pointer, not the model itself; fetch it with \"git lfs pull\"",
        ),
        (b"ISO-10303", "a STEP file; tessellate it in a CAD program and export STL or OBJ"),
        (b"Kaydara FBX", "an FBX file; convert it to glTF or OBJ"),
        (b"BLENDER", "a Blender scene; export it as glTF or OBJ"),
        (b"<?xml", "an XML file (COLLADA, AMF, X3D or another); convert it to glTF or OBJ"),
        (b"<!DOCTYPE", "a web page; was the download an error page?"),
        (b"<html", "a web page; was the download an error page?"),
        (b"# vtk", "a VTK file; convert it to PLY"),
        (b"%PDF", "a PDF document"),
        (b"\x89PNG", "a picture"),
        (b"\xff\xd8\xff", "a picture"),
    ];
    kinds.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, what)| what)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detect(name: &str, bytes: &[u8]) -> Result<Detected, Error> {
        Format::detect(Some(Path::new(name)), bytes)
    }

    #[test]
    fn content_wins_over_the_name_and_warns() {
        let obj = b"# made by hand\nmtllib a.mtl\no part\nv 0 0 0\n";
        let detected = detect("part.stl", obj).unwrap();
        assert_eq!(detected.format, Format::Obj);
        assert!(detected.warning.unwrap().contains("STL"));
        assert_eq!(detect("part.obj", obj).unwrap(), Detected { format: Format::Obj, warning: None });
        assert_eq!(detect("part", obj).unwrap().format, Format::Obj);
        assert_eq!(Format::detect(None, b"ply\nformat ascii 1.0\n").unwrap().format, Format::Ply);
        assert_eq!(detect("a.obj", b"solid x\n facet normal 0 0 1\n").unwrap().format, Format::Stl);
        assert_eq!(detect("a.ply", b"# c\nCOFF 3 1 0\n").unwrap().format, Format::Off);
        assert_eq!(detect("a.glb", b" {\"nodes\": [], \"asset\": {}}").unwrap().format, Format::Gltf);
        assert_eq!(detect("a.gltf", b"glTF\x02\0\0\0").unwrap().format, Format::Glb);
        let mut stl = b"solid binary".to_vec();
        stl.resize(80, 0);
        stl.extend([1, 0, 0, 0]);
        stl.resize(134, 0);
        assert_eq!(detect("a.obj", &stl).unwrap().format, Format::Stl);
    }

    #[test]
    fn the_name_decides_where_content_does_not() {
        assert_eq!(detect("a.obj", b"hello").unwrap().format, Format::Obj);
        assert_eq!(detect("a.off", b"3 1 0\n0 0 0").unwrap().format, Format::Off);
        assert!(matches!(detect("a.txt", b"hello"), Err(Error::Format(FormatError::Unknown { .. }))));
        assert!(matches!(Format::detect(None, b""), Err(Error::Format(FormatError::Unknown { .. }))));
    }

    #[test]
    fn other_kinds_of_files_are_named() {
        let error = detect("a.stl", b"PK\x03\x04 rest").unwrap_err().to_string();
        assert!(error.contains("ZIP"), "{error}");
        let error = detect("a.3mf", b"PK\x03\x04 rest").unwrap_err().to_string();
        assert!(error.contains("3MF"), "{error}");
        #[cfg(feature = "threemf")]
        assert_eq!(detect("a.3mf", b"PK\x03\x04 3D/a.model").unwrap().format, Format::ThreeMf);
    }
}

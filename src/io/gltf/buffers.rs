//! The bytes of buffers: the binary chunk, data in the JSON, or a file beside it. Each is fetched when first used.

use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;

use base64::Engine;
use base64::alphabet::{STANDARD, URL_SAFE};
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::super::ReadOptions;
use super::super::beside::{beside, read_beside};
use super::Reader;
use crate::Error;
use crate::control::Reservation;

/// The buffers of a document.
pub(super) struct Buffers<'a> {
    reader: &'a Reader<'a>,
    binary: Option<&'a [u8]>,
    options: &'a ReadOptions,
    fetched: RefCell<HashMap<Source, Rc<Vec<u8>>>>,
    external: Cell<u64>,
    /// The memory of files beside.
    reserved: RefCell<Vec<Reservation>>,
}

/// Where the bytes of a buffer come from; equal sources are fetched once.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Source {
    Data(usize),
    File(String),
}

/// The bytes of a buffer view.
pub(super) enum Bytes<'a> {
    Chunk(&'a [u8]),
    Shared { bytes: Rc<Vec<u8>>, start: usize, length: usize },
}

impl Bytes<'_> {
    pub(super) fn as_slice(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Shared { bytes, start, length } => &bytes[*start..*start + *length],
        }
    }
}

impl<'a> Buffers<'a> {
    pub(super) fn new(reader: &'a Reader<'a>, binary: Option<&'a [u8]>, options: &'a ReadOptions) -> Self {
        Self {
            reader,
            binary,
            options,
            fetched: RefCell::default(),
            external: Cell::new(0),
            reserved: RefCell::default(),
        }
    }

    /// How many bytes came from other files so far.
    pub(super) fn external_bytes(&self) -> u64 {
        self.external.get()
    }

    /// The bytes of a buffer view, which must exist.
    pub(super) fn view(&self, index: usize) -> Result<Bytes<'a>, Error> {
        let document = self.reader.document;
        let pointer = format!("/bufferViews/{index}");
        let view = self.reader.get(&document.buffer_views, "bufferViews", index, &pointer)?;
        self.part(view.buffer as usize, Some((view.byte_offset as usize, view.byte_length as usize)))
    }

    /// All bytes of a buffer.
    pub(super) fn whole(&self, index: usize) -> Result<Bytes<'a>, Error> {
        self.part(index, None)
    }

    /// The given bytes of a buffer, which lie within its announced length, or all.
    fn part(&self, index: usize, range: Option<(usize, usize)>) -> Result<Bytes<'a>, Error> {
        let document = self.reader.document;
        let pointer = format!("/buffers/{index}");
        let buffer = self.reader.get(&document.buffers, "buffers", index, &pointer)?;
        let (start, length) = range.unwrap_or((0, usize::try_from(buffer.byte_length).unwrap_or(usize::MAX)));
        let short = |available: usize| {
            self.reader.error(
                &*pointer,
                format!(
                    "announces {} bytes, but {available} are there; the file is cut off",
                    buffer.byte_length
                ),
            )
        };
        let Some(uri) = buffer.uri.as_deref() else {
            let chunk = self.binary.filter(|_| index == 0).ok_or_else(|| {
                self.reader.error(
                    &*pointer,
                    "has no data: neither a \"uri\" nor, as the first buffer of a GLB file, the binary chunk \
                     (with EXT_meshopt_compression the data are only in compressed form: decompress the file with \
                     \"gltf-transform copy in.glb out.glb\")",
                )
            })?;
            // The view lies within the buffer's announced length.
            let bytes = chunk.get(..buffer.byte_length as usize).ok_or_else(|| short(chunk.len()))?;
            return Ok(Bytes::Chunk(&bytes[start..start + length]));
        };
        let bytes = self.fetch(index, uri, &pointer)?;
        if (bytes.len() as u64) < buffer.byte_length {
            return Err(short(bytes.len()));
        }
        Ok(Bytes::Shared { bytes, start, length })
    }

    /// The bytes behind a URI.
    fn fetch(&self, buffer: usize, uri: &str, pointer: &str) -> Result<Rc<Vec<u8>>, Error> {
        let data = uri.strip_prefix("data:");
        let source = match data {
            Some(_) => Source::Data(buffer),
            None => Source::File(self.file_name(uri, pointer)?),
        };
        if let Some(bytes) = self.fetched.borrow().get(&source) {
            return Ok(Rc::clone(bytes));
        }
        let bytes: Rc<Vec<u8>> = match (&source, data) {
            (Source::File(name), _) => Rc::new(self.read_file(name, pointer)?),
            (Source::Data(_), data) => Rc::new(self.decode(data.unwrap_or_default(), pointer)?),
        };
        self.fetched.borrow_mut().insert(source, Rc::clone(&bytes));
        Ok(bytes)
    }

    /// The name of the file that a URI means; one with a scheme names none that is read, and stays as it is.
    pub(super) fn file_name(&self, uri: &str, pointer: &str) -> Result<String, Error> {
        if uri.contains("://") {
            return Ok(uri.to_string());
        }
        percent_decode(uri).map(|name| without_dots(&name)).ok_or_else(|| {
            self.reader.error(pointer, format!("the URI {:?} has a wrong percent escape", shorten(uri)))
        })
    }

    /// Reads a file beside the document.
    pub(super) fn read_file(&self, name: &str, pointer: &str) -> Result<Vec<u8>, Error> {
        let folder = self.options.folder.as_deref().ok_or_else(|| {
            self.reader.error(
                pointer,
                format!("is in the file {:?}, but the folder is not known; use a GLB file", shorten(name)),
            )
        })?;
        // A file that cannot be asked for its length cannot be read either.
        let length = beside(folder, name).ok().and_then(|path| std::fs::metadata(path).ok());
        let length = length.map_or(0, |metadata| metadata.len());
        self.reserved.borrow_mut().push(self.options.control.reserve(length)?);
        let bytes = read_beside(folder, name, u64::from(u32::MAX) * 8).map_err(|reason| {
            self.reader.error(pointer, format!("cannot read the file {:?}: {reason}", shorten(name)))
        })?;
        self.external.set(self.external.get() + bytes.len() as u64);
        Ok(bytes)
    }

    /// The bytes of a data URI, given what follows "data:".
    pub(super) fn decode(&self, data: &str, pointer: &str) -> Result<Vec<u8>, Error> {
        let Some((_, text)) = data.split_once(',').filter(|(kind, _)| kind.ends_with(";base64")) else {
            return Err(self.reader.error(pointer, "the data URI is not in base64"));
        };
        let text: Cow<'_, str> = if memchr::memchr(b'%', text.as_bytes()).is_some() {
            percent_decode(text).map_or(Cow::Borrowed(text), Cow::Owned)
        } else {
            Cow::Borrowed(text)
        };
        let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
        let url_safe = memchr::memchr2(b'-', b'_', text.as_bytes()).is_some();
        let engine = GeneralPurpose::new(if url_safe { &URL_SAFE } else { &STANDARD }, config);
        engine
            .decode(text.as_bytes())
            .map_err(|error| self.reader.error(pointer, format!("the data URI is not valid base64: {error}")))
    }
}

/// A relative path without the parts that stay in place, so that one file has one name.
fn without_dots(name: &str) -> String {
    let separator = |character| character == '/' || character == '\\';
    let parts: Vec<&str> = name.split(separator).filter(|part| !part.is_empty() && *part != ".").collect();
    // Absolute paths stay absolute, and are refused later.
    let root = if name.starts_with(separator) { "/" } else { "" };
    format!("{root}{}", parts.join("/"))
}

/// Replaces "%20" and the like; `None` if one is cut off, no number or not UTF-8.
fn percent_decode(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        if first == b'%' {
            let digit = |i: usize| char::from(*tail.get(i)?).to_digit(16);
            bytes.push((digit(0)? * 16 + digit(1)?) as u8);
            rest = &tail[2..];
        } else {
            bytes.push(first);
            rest = tail;
        }
    }
    String::from_utf8(bytes).ok()
}

fn shorten(text: &str) -> String {
    text.chars().take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_has_one_name() {
        for name in ["a/b.bin", "./a/b.bin", "a/./b.bin", "a//b.bin", "a\\b.bin", ".//a/b.bin"] {
            assert_eq!(without_dots(name), "a/b.bin", "{name}");
        }
        assert_eq!(without_dots("/etc/a.bin"), "/etc/a.bin");
        assert_eq!(without_dots("../a.bin"), "../a.bin");
    }

    #[test]
    fn percent_escapes() {
        assert_eq!(percent_decode("a%20b%C3%A9").as_deref(), Some("a b\u{e9}"));
        for wrong in ["%", "%2", "%zz", "%FF", "%+1"] {
            assert_eq!(percent_decode(wrong), None, "{wrong}");
        }
    }
}

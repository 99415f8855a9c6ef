//! The two parts of a glTF file: its JSON, and in a GLB file the binary chunk.

use super::super::notes::Notes;
use super::super::{Format, malformed, unsupported};
use crate::Error;

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BINARY: u32 = 0x004e_4942;

/// The parts of a file.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// Opens a file of either kind.
pub(super) fn open<'a>(bytes: &'a [u8], format: Format, notes: &mut Notes) -> Result<Container<'a>, Error> {
    if !bytes.starts_with(MAGIC) {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if format == Format::Glb && !text.trim_ascii_start().starts_with(b"{") {
            return Err(malformed(format, "byte 0", "a GLB file begins with \"glTF\""));
        }
        return Ok(Container { json: text, binary: None });
    }
    let file = File { bytes, format };
    let version = file.number(4)?;
    if version != 2 {
        return Err(unsupported(
            format,
            format!(
                "the GLB container is of version {version}, this reader knows 2; files of version 1 can be \
                     converted with \"gltf-pipeline -i in.glb -o out.glb\""
            ),
        ));
    }
    let length = file.number(8)? as usize;
    if length > bytes.len() {
        let what = format!("the header announces {length} bytes, the file has {}", bytes.len());
        return Err(file.cut_off(bytes.len(), &what));
    }
    if length < bytes.len() {
        notes.say(format!("{} bytes after the end of the GLB ignored", bytes.len() - length));
    }
    let mut container = file.chunks(length, notes)?;
    // Padding should be blanks; zeros are seen as well.
    let end = container.json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    container.json = &container.json[..end];
    if container.json.is_empty() {
        return Err(malformed(format, "byte 12", "the first chunk of a GLB file must be its JSON"));
    }
    Ok(container)
}

/// A GLB file.
struct File<'a> {
    bytes: &'a [u8],
    format: Format,
}

impl<'a> File<'a> {
    fn cut_off(&self, at: usize, what: &str) -> Error {
        malformed(self.format, format!("byte {at}"), format!("{what}; it is cut off"))
    }

    /// The 32-bit number at a byte.
    fn number(&self, at: usize) -> Result<u32, Error> {
        let word = self.bytes.get(at..at + 4).and_then(|word| word.first_chunk::<4>());
        word.map(|word| u32::from_le_bytes(*word))
            .ok_or_else(|| self.cut_off(at, "the file ends in a header"))
    }

    /// The JSON chunk and the first binary chunk of a file of `length` bytes.
    fn chunks(&self, length: usize, notes: &mut Notes) -> Result<Container<'a>, Error> {
        let mut container = Container { json: b"", binary: None };
        let mut at = 12;
        while at < length {
            let (size, kind) = (self.number(at)? as usize, self.number(at + 4)?);
            let start = at + 8;
            let chunk = self.bytes.get(start..).and_then(|rest| rest.get(..size)).ok_or_else(|| {
                let there = self.bytes.len();
                self.cut_off(start, &format!("a chunk of {size} bytes begins here, the file has {there}"))
            })?;
            match kind {
                JSON if at == 12 => container.json = chunk,
                BINARY if container.binary.is_none() => container.binary = Some(chunk),
                _ => {}
            }
            let end = start + size;
            at = end.next_multiple_of(4);
            // The length counts the padding by the standard. Some writers pad without counting, and some leave the
            // padding out: then the next chunk begins where this one ends.
            if at != end && end < length && !self.begins_chunk(at, length) && self.begins_chunk(end, length) {
                notes.at("chunk whose length is not a multiple of four", start);
                at = end;
            }
        }
        Ok(container)
    }

    /// Whether a chunk of a kind known here begins at a byte and ends within the file of `length` bytes.
    fn begins_chunk(&self, at: usize, length: usize) -> bool {
        let (Ok(size), Ok(kind)) = (self.number(at), self.number(at + 4)) else { return false };
        matches!(kind, JSON | BINARY) && at + 8 + size as usize <= length
    }
}

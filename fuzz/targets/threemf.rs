//! Packages of 3MF. Bytes that are no package are the text of a model: changes to packed text would only break its checksum.
#![no_main]
mod mesh_file;
use trisect::io::Format;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if bytes.starts_with(b"PK") {
        mesh_file::check(bytes, Format::ThreeMf);
    } else {
        mesh_file::check(&package(bytes), Format::ThreeMf);
    }
});

/// A package with that text as its only part, not packed.
fn package(text: &[u8]) -> Vec<u8> {
    const NAME: &[u8] = b"a.model";
    let checksum = !text.iter().fold(!0_u32, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 })
    });
    let length = (text.len() as u32).to_le_bytes();
    // What the local header and the directory both say: version, flags, method, time, checksum, sizes, lengths of name and extra.
    let mut fields = [[20, 0], [0; 2], [0; 2], [0; 2], [0x21, 0]].concat();
    fields.extend(checksum.to_le_bytes());
    fields.extend(length.iter().chain(&length));
    fields.extend([NAME.len() as u8, 0, 0, 0]);
    let mut bytes = [b"PK\x03\x04", &*fields, NAME, text].concat();
    let directory = bytes.len() as u32;
    bytes.extend([b"PK\x01\x02\x14\0", &*fields, &[0; 14], NAME].concat());
    let size = bytes.len() as u32 - directory;
    bytes.extend(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
    bytes.extend(size.to_le_bytes().iter().chain(&directory.to_le_bytes()));
    bytes.extend([0; 2]);
    bytes
}

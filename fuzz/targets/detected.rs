#![no_main]
mod mesh_file;
use trisect::io::Format;
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(detected) = Format::detect(None, bytes) {
        mesh_file::check(bytes, detected.format);
    }
});

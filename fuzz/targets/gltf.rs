#![no_main]
mod mesh_file;
use trisect::io::Format;
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let format = if bytes.starts_with(b"glTF") { Format::Glb } else { Format::Gltf };
    mesh_file::check(bytes, format);
});

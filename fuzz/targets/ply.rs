#![no_main]
mod mesh_file;
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| mesh_file::check(bytes, trisect::io::Format::Ply));

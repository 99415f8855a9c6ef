#![no_main]
//! Path data of SVG, and whole files.
use trisect::parametric::svg;
libfuzzer_sys::fuzz_target!(|text: &str| {
    let _ = svg::curves_of_path(text).is_ok();
    let _ = svg::read_paths(text).is_ok();
});

#![no_main]
//! Curves and patches in JSON.
use trisect::parametric::json;
libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok(value) = json::parse(text) {
        let _ = (json::curve(&value).is_ok(), json::named_patches(&value).is_ok());
    }
});

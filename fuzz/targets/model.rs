#![no_main]
//! Model files: parsing only, since a small file may ask for any amount of work.
use trisect::model::Model;
libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok(model) = Model::parse(text, std::path::Path::new("models")) {
        let _ = (model.names().count(), model.files().len());
    }
});

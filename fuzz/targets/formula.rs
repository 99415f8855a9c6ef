#![no_main]
//! The formula language, with what it compiles to.
use trisect::field::{Formula, System};
libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok(formula) = Formula::parse(text) {
        let names = formula.free_names();
        let _ = names.len();
        if let Ok(field) = formula.compile(System::R0, &[], &[]) {
            let _ = field.at([0.5, -0.25, 2.0]);
        }
    }
});

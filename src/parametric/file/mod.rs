//! Geometry in files: the JSON of the program, and SVG.

pub mod json;
pub mod svg;

//! SVG: paths into curves, curves into paths, pictures.
//!
//! SVG's y axis points down, this library's up: y is negated on the way in and out, so that pictures look the same and a
//! path written and read again is the same curve.

mod arc;
mod path;
mod picture;
mod read;
mod write;

pub use path::{PathContours, curves_of_path};
pub use picture::{Ink, Picture};
pub use read::{SvgPath, read_paths};
pub use write::path_data;

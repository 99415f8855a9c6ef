//! Crossings that rounding left in a written file.

use std::path::Path;

use trisect::io::{self, Rounding};
use trisect::{Error, Solid};

use super::limits::Limits;
use super::report::counted;

/// What is said of a file whose surface crosses itself, though what was written does not.
///
/// Crossings that rounding makes are no deeper than its step. Where all coordinates that a reader gets are numbers of single
/// precision, the check of operands tolerates that much; where the file has an offset they are not, and it does not. So such
/// a file is read back and checked, as its operands were: about a microsecond a triangle.
pub(crate) fn in_file(path: &Path, rounding: &Rounding, limits: &Limits) -> Result<Option<String>, Error> {
    if !rounding.closed || !rounding.has_offset {
        return Ok(None);
    }
    let control = limits.control();
    let loaded = io::load(path, &io::ReadOptions::new().control(control.clone()))?;
    let Ok(solid) = Solid::try_from(loaded.mesh) else { return Ok(None) };
    let found = solid.self_crossings(&control)?;
    let Some(deepest) = found.places.first() else { return Ok(None) };
    let [x, y, z] = deepest.place;
    Ok(Some(format!(
        "rounding to single precision makes {} of triangles cross, {:.1e} deep at ({x}, {y}, {z}): as an operand the file \
         would be refused; OBJ and PLY keep all digits, and crossings of a model moved to the origin are tolerated \
         (--recenter moves it)",
        counted(found.count, "pair"),
        deepest.depth,
    )))
}

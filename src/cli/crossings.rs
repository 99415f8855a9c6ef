//! Crossings that rounding left in a written file.

use std::path::Path;

use trisect::io::{self, Rounding};
use trisect::{Error, Solid};

use super::limits::Limits;
use super::words::counted;

/// What is said of a file whose surface crosses itself, though what was written does not.
///
/// Rounding moves no part of a surface by more than its step, and the check of operands tolerates crossings of a few steps
/// where all coordinates are numbers of single precision. Two kinds of files may be said to cross themselves all the same: those with an offset,
/// whose coordinates are none, and those where needles turned over, which may pass through others for more than a step. These
/// are read back and checked as operands are, in some tenths of a microsecond a triangle.
pub(crate) fn in_file(path: &Path, rounding: &Rounding, limits: &Limits) -> Result<Option<String>, Error> {
    let turned = rounding.turned_triangles + rounding.flat_triangles;
    if !rounding.closed || !(rounding.has_offset || turned > 0) {
        return Ok(None);
    }
    let control = limits.control();
    let loaded = io::load(path, &io::ReadOptions::new().control(control.clone()))?;
    let Ok(solid) = Solid::try_from(loaded.mesh) else { return Ok(None) };
    let found = solid.self_crossings(&control)?;
    let Some(deepest) = found.places.first() else { return Ok(None) };
    let [x, y, z] = deepest.place;
    Ok(Some(format!(
        "rounding to single precision makes {} of triangles cross, {:.1e} deep at ({x}, {y}, {z}), which the result \
         does not; OBJ and PLY keep all digits{}",
        counted(found.count, "pair"),
        deepest.depth,
        if rounding.has_offset {
            ", and at the origin (--recenter moves the model there) single precision is what is expected"
        } else {
            ""
        },
    )))
}

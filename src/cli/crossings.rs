//! Crossings that rounding left in a written file.

use std::path::Path;

use trisect::io::{self, Rounding};
use trisect::{Error, Mesh, Solid};

use super::limits::Limits;
use super::words::counted;

/// What is said of a file whose surface crosses itself, though what was written does not.
///
/// Rounding moves no part of a surface by more than its step, and the check of operands tolerates crossings of a few steps where all coordinates
/// are numbers of single precision. Needles that turned over may pass through others for more. In a file of single precision that holds
/// `solid`, if that is known, it is looked around them alone. Any other, and a file with an offset, whose coordinates are no
/// such numbers, is read back and checked as operands are, in some tenths of a microsecond a triangle.
pub(crate) fn in_file<'a>(
    path: &Path,
    solid: impl FnOnce() -> Option<(&'a Solid, &'a Mesh)>,
    rounding: &Rounding,
    limits: &Limits,
) -> Result<Option<String>, Error> {
    if !rounding.closed || !rounding.has_offset && rounding.overturned.is_empty() {
        return Ok(None);
    }
    let control = limits.control();
    let solid = if rounding.has_offset { None } else { solid() };
    let found = if let Some((solid, written)) = solid {
        let held = |position: &[f64; 3]| position.map(|x| f64::from(x as f32));
        let held = written.positions.iter().map(held).collect();
        solid.self_crossings_moved(held, &rounding.overturned, &control)?
    } else {
        let loaded = io::load(path, &io::ReadOptions::new().control(control.clone()))?;
        let Ok(solid) = Solid::try_from(loaded.mesh) else { return Ok(None) };
        solid.self_crossings(&control)?.clone()
    };
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

//! Crossings that rounding left in a written file.

use std::path::Path;

use trisect::io::{self, Rounding};
use trisect::{Error, Mesh, Solid};

use super::limits::Limits;
use super::words::counted;

/// What is said of a file that holds `mesh` as `rounding` says, if its surface crosses itself.
///
/// Rounding moves no part of a surface by more than its step, and the check of operands tolerates crossings of a few steps
/// where all coordinates are numbers of single precision. So two kinds of files alone may be said to cross themselves all the same. Needles that
/// turned over may pass through others for more than a step: it is looked around them. And a file with an offset has coordinates that
/// are no such numbers: it is read back and checked as operands are, in some tenths of a microsecond a triangle.
pub(crate) fn in_file(
    mesh: &Mesh,
    path: &Path,
    rounding: &Rounding,
    limits: &Limits,
) -> Result<Option<String>, Error> {
    if !rounding.closed || !(rounding.has_offset || !rounding.overturned.is_empty()) {
        return Ok(None);
    }
    let control = limits.control();
    let found = if rounding.has_offset {
        let loaded = io::load(path, &io::ReadOptions::new().control(control.clone()))?;
        let Ok(solid) = Solid::try_from(loaded.mesh) else { return Ok(None) };
        solid.self_crossings(&control)?.clone()
    } else {
        let held = mesh.positions.iter().map(|position| position.map(|x| f64::from(x as f32))).collect();
        Mesh::new(held, mesh.triangles.clone()).self_crossings_with(&rounding.overturned, &control)?
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

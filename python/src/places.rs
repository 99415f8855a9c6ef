//! Meshes moved to other places, by the names that transforms have in jobs and in the program.

use trisect::{Error, Mesh};

/// Moved: "translate" by three numbers, "scale" by three factors, "rotate" by degrees about x, then y, then z, "matrix" by
/// the rows of one of 3 x 4 or 4 x 4.
pub(crate) fn moved(mesh: Mesh, how: &str, numbers: &[f64]) -> Result<Mesh, Error> {
    let moved = match (how, numbers) {
        ("translate", &[x, y, z]) => mesh.translated([x, y, z]),
        ("scale", &[x, y, z]) => mesh.scaled([x, y, z])?,
        ("rotate", &[x, y, z]) => {
            mesh.rotated([1.0, 0.0, 0.0], x)?.rotated([0.0, 1.0, 0.0], y)?.rotated([0.0, 0.0, 1.0], z)?
        }
        ("matrix", rows) => mesh.transformed(rows)?,
        _ => {
            return Err(Error::InvalidArgument(format!(
                "there is no transform {how} of {} numbers",
                numbers.len()
            )));
        }
    };
    if moved.positions.as_flattened().iter().any(|x| !x.is_finite()) {
        return Err(Error::InvalidArgument(
            "its transforms move vertices out of the range of numbers".into(),
        ));
    }
    Ok(moved)
}

/// Whether a transform turns faces over, and whether it keeps all lengths.
pub(crate) fn kind(how: &str, numbers: &[f64]) -> (bool, bool) {
    match (how, numbers) {
        ("scale", factors) => (factors.iter().product::<f64>() < 0.0, false),
        ("matrix", &[a, b, c, _, d, e, f, _, g, h, i, ..]) => {
            (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0, false)
        }
        _ => (false, true),
    }
}

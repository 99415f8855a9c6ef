//! What rounding to single precision does to a mesh.

use super::{Format, unsupported};
use crate::{Error, Mesh};

/// Refuses a mesh whose coordinates are beyond single precision, and says how many triangles lose a corner when
/// coordinates are rounded: two of their corners, different before, are equal then.
pub(super) fn check_single(mesh: &Mesh, format: Format) -> Result<Option<String>, Error> {
    let largest = mesh.positions.as_flattened().iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    if !(largest as f32).is_finite() {
        return Err(unsupported(
            format,
            format!(
                "coordinate {largest:e} is beyond single precision; write OBJ, PLY or OFF in double precision"
            ),
        ));
    }
    let lost = collapsed(mesh, |point| point.map(|coordinate| coordinate as f32));
    Ok((lost > 0)
        .then(|| format!("rounding to single precision makes two corners of {lost} triangles equal")))
}

/// How many triangles lose a corner when coordinates are rounded by `round`.
pub(super) fn collapsed(mesh: &Mesh, round: impl Fn([f64; 3]) -> [f32; 3]) -> usize {
    let collapses = |triangle: &&[u32; 3]| {
        let exact = triangle.map(|corner| mesh.positions[corner as usize]);
        let rounded = exact.map(&round);
        [(0, 1), (1, 2), (2, 0)].into_iter().any(|(i, j)| rounded[i] == rounded[j] && exact[i] != exact[j])
    };
    mesh.triangles.iter().filter(collapses).count()
}

//! What rounding to single precision does to a mesh.

use super::{Format, unsupported};
use crate::parallel;
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
    let lost = collapsed(mesh, |[x, y, z]| [x as f32, y as f32, z as f32]);
    Ok((lost > 0)
        .then(|| format!("rounding to single precision makes two corners of {lost} triangles equal")))
}

/// How many triangles lose a corner when coordinates are rounded by `round`.
pub(super) fn collapsed(mesh: &Mesh, round: impl Fn([f64; 3]) -> [f32; 3] + Sync) -> usize {
    let collapses = |triangle: &&[u32; 3]| {
        let exact = |i: usize| mesh.positions[triangle[i] as usize];
        let (a, b, c) = (round(exact(0)), round(exact(1)), round(exact(2)));
        // Equal corners are rare, and only then it matters whether they were equal before.
        (a == b || b == c || c == a)
            && [(a == b, 0, 1), (b == c, 1, 2), (c == a, 2, 0)]
                .into_iter()
                .any(|(equal, i, j)| equal && exact(i) != exact(j))
    };
    let count = mesh.triangles.len();
    let ranges = parallel::ranges(count, parallel::piece_count(count, 1 << 16));
    parallel::map(ranges, |range| mesh.triangles[range].iter().filter(collapses).count()).into_iter().sum()
}

//! Faces of both operands that are in one plane but for rounding.
//!
//! Where such faces cross, the arrangement knows of it. Those that do not cross, as a unit in the last place is between them, leave a film or a
//! gap as thin as that, which nothing else would tell of.

use crate::Error;
use crate::boolean::candidates::Candidates;
use crate::boolean::complex::ids::FaceId;
use crate::boolean::complex::planes::are_nearly_flush;
use crate::boolean::complex::rounding::Rounding;
use crate::boolean::complex::{Complex, Operand};
use crate::parallel::Runner;

/// The pairs of such faces whose boxes meet, ascending. Some ten nanoseconds a candidate.
///
/// # Errors
/// Only limits.
pub(crate) fn find_nearly_flush(
    complex: &Complex<'_>,
    candidates: &Candidates,
    rounding: Rounding,
    runner: Runner<'_>,
) -> Result<Vec<[FaceId; 2]>, Error> {
    let mut pairs = candidates.visit(runner, |s, t, found| {
        let faces = [complex.face(0, s), complex.face(1, t)];
        let [a, b] = [(0, s), (1, t)].map(|(operand, triangle)| {
            let Operand { positions, triangles } = complex.operands[operand];
            triangles[triangle as usize].map(|v| positions[v as usize])
        });
        if are_nearly_flush(&a, &b, rounding) {
            found.push(faces);
        }
    })?;
    pairs.sort_unstable();
    pairs.dedup();
    Ok(pairs)
}

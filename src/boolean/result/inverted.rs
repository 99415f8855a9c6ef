//! Triangles that rounding turned over.

use super::origins::Origins;
use crate::boolean::complex::origin::Origin;
use crate::exact::{Projection, Sign, orient2d};
use crate::{Mesh, Solid};

/// Triangles of a result that look the other way than the faces they were cut from. O(n).
pub(crate) fn count_inverted(mesh: &Mesh, origins: &Origins, operands: &[&Solid]) -> u64 {
    let corners = |mesh: &Mesh, t: u32| mesh.triangles[t as usize].map(|v| mesh.positions[v as usize]);
    let is_inverted = |(t, origin): &(u32, Origin)| {
        let source = corners(operands[origin.operand as usize].mesh(), origin.triangle);
        let seen = Projection::of(&source);
        let seen = if origin.reversed { seen.reversed() } else { seen };
        let [a, b, c] = corners(mesh, *t).map(|p| seen.project(&p));
        orient2d(a, b, c) == Sign::Negative
    };
    (0..).zip(origins.iter()).filter(is_inverted).count() as u64
}

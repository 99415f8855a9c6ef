//! Surface patches and watertight meshes of them.

mod density;
mod deviation;
mod face_mesh;
mod flat_triangle;
mod joints;
mod mesh;
mod needles;
mod orientation;
mod pieces;
mod shapes;
mod surface;

pub use joints::Gap;
pub use mesh::{PatchMesh, PatchMeshing, PatchTriangle};
pub use surface::{Patch, PatchSide};

//! Plane regions: bounded by curves or by straight edges, combined and filled with triangles.

mod curved;
mod membership;
mod overlay;
pub(crate) mod polygons;
pub(crate) mod triangulate;

pub use curved::Region;
pub use membership::Membership;
pub use overlay::{FillRule, RegionOperation};
pub use polygons::Polygons;
pub use triangulate::PlaneMesh;

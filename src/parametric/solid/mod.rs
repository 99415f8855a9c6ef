//! Closed meshes from plane regions: extruded, revolved, swept.

mod extrude;
mod revolve;
mod sweep;

pub use extrude::Extrusion;
pub use revolve::Revolution;
pub use sweep::Sweep;

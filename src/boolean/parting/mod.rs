//! Solids parted: by planes, in one pass over the solid, and by surfaces, in the general arrangement.

mod plane;
mod surfaces;

pub use plane::{PlaneCut, Section, SectionSide, Sections};
pub use surfaces::{Cell, Imprinted};

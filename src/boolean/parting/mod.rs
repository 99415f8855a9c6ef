//! Solids parted: by planes, in one pass over the solid, and by surfaces, in the general arrangement; expressions with half-spaces.

mod half_spaces;
mod plane;
mod surfaces;

pub use half_spaces::Leaf;
pub use plane::{PlaneCut, Section, SectionSide, Sections};
pub use surfaces::{Cell, Imprinted};

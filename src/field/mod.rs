//! Solids given by functions: signed distance of meshes, R-functions, formulas, and the way back to a closed mesh.
//!
//! Everything here is **positive inside**, zero on the boundary and negative outside, as in Choporov 2017 and 2010.

mod contour_distance;
mod distance;
mod expression;
mod extract;
mod formula;
mod interval;
mod leaf;
mod number;
mod pseudonormal;
mod rfunction;
mod work;

pub use contour_distance::{ContourDistance, Contours};
pub use distance::{SignRule, SignedDistance, SignedDistanceAt};
pub use expression::{Expression, Graph, Leaf, NodeId};
pub use extract::{Extracted, Extraction};
pub use formula::{Formula, FormulaError};
pub use interval::Interval;
pub use rfunction::System;

//! Solids given by functions: signed distance of meshes, R-functions, formulas, and the way back to a closed mesh.
//!
//! Everything here is **positive inside**, zero on the boundary and negative outside, as in Choporov 2017 and 2010.

#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a NaN fails every comparison, and is meant to be refused"
)]

mod bounds;
mod contour_distance;
mod distance;
mod dual;
mod error;
mod expression;
mod extract;
mod extrude;
mod formula;
mod grid;
mod inside;
mod interval;
mod leaf;
mod number;
mod pseudonormal;
mod rfunction;
mod section;
#[cfg(feature = "render")]
mod section_picture;
mod work;

pub use contour_distance::{ContourDistance, Contours};
pub use distance::{SignRule, SignedDistance, SignedDistanceAt};
pub use error::FieldError;
pub use expression::{Expression, Graph, Leaf, NodeId};
pub use extract::{ContourExtraction, Extracted, Extraction};
pub use extrude::extrude;
pub(crate) use formula::named_system;
pub use formula::{Formula, FormulaError};
pub use grid::{Grid, GridFormat};
pub use interval::Interval;
pub use rfunction::System;
pub use section::Section;

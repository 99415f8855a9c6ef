//! Solids given by functions: signed distance of meshes, R-functions, formulas, and the way back to a closed mesh.
//!
//! Everything here is **positive inside**, zero on the boundary and negative outside, as in Choporov 2017 and 2010.

mod distance;
mod pseudonormal;
mod work;

pub use distance::{SignRule, SignedDistance, SignedDistanceAt};

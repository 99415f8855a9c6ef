//! Arithmetic that does not round, and the decisions built on it.
//!
//! Every decision of the engine is the sign of a polynomial in values of one determinant, [`orient3d`], of input
//! vertices. The signs are exact for every finite `f64`, and with the symbolic perturbation of [`orient3d_perturbed`] they are
//! never zero (Vyatkin 2019, step 1).
//!
//! Each sign is found in stages: plain `f64` with an error bound; where that is not enough, exact integers. A finite
//! `f64` is an integer multiple of a power of two, so a handful of coordinates always lies on a common `lattice` of
//! integers: where 40 bits suffice (models on a grid) the arithmetic is native 128-bit; else it is multi-word
//! (`Integer`), which has no range to leave, so that tiny, huge and mixed magnitudes need no special care. The filters
//! demand that a determinant exceed, besides the usual relative bound, an absolute floor far above anything that underflow
//! can have lost; on overflow they compare infinities or NaN and fail; either way the exact stage decides.

mod across;
pub(crate) mod at_hand;
pub(crate) mod barycentric;
mod double_double;
mod facing;
mod filter;
mod integer;
mod lattice;
mod near;
pub(crate) mod order;
mod orient;
pub(crate) mod perturbed;
mod plane;
pub(crate) mod planes;
pub(crate) mod position;
mod projection;
mod residue;
mod seen;
pub(crate) mod unrounded;
mod vector;

pub(crate) use across::unit_across;
pub(crate) use facing::facing;
pub(crate) use filter::{FILTER_RANGE, PlaneFilter, orient3d_filter};
pub use orient::{Sign, collinear, orient2d, orient3d};
pub use perturbed::orient3d_perturbed;
pub use plane::{Plane, PlaneFault};
pub(crate) use projection::Projection;
pub(crate) use seen::Seen;

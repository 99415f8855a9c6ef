//! Subdivision surfaces given by control meshes, which modellers call cages, and booleans of them that give cages again.
//!
//! [`Cage`] is what files have: triangles or polygons. [`PolygonCage`] is a Catmull-Clark surface, given by quads and other polygons.
//! [`ControlMesh`] is a piecewise-smooth Loop surface: faces, control points, creases and corners. It subdivides, tells its limit
//! surface at any place, and becomes triangles within a tolerance ([`ControlMesh::limit_mesh`]), which every other boolean
//! takes. [`FreeForm`] combines two cages: the result is a cage whose surface is the boolean of both surfaces within a measured
//! distance, whose intersection curve is a crease, and whose control points away from the curve are the old ones bit for bit.
//!
//! Vyatkin 2019, after Biermann, Kristjansson and Zorin, "Approximate Boolean operations on free-form solids", SIGGRAPH 2001;
//! rules after Loop 1987, Hoppe et al. 1994, Biermann, Levin and Zorin 2000, DeRose, Kass and Truong 1998. `docs/freeforms.md`
//! has the words, the weights and what was measured.

#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a NaN fails every comparison, and is meant to be refused"
)]

mod cage;
mod catmull_clark;
mod check;
mod control_mesh;
mod details;
mod error;
mod evaluate;
mod freeform;
#[cfg(feature = "formats")]
mod gltf;
mod halves;
#[cfg(feature = "formats")]
pub(crate) mod json;
mod level;
mod limit;
mod limit_mesh;
mod obj;
mod patch;
mod place;
mod polygons;
mod refine;
mod rules;
mod tags;

pub use cage::{Cage, Scheme};
pub use catmull_clark::{Converted, PolygonCage};
pub use control_mesh::{ControlMesh, Evaluator};
pub use details::{Details, DomainVertex};
pub use error::CageError;
pub use freeform::{Errors, FreeForm, FreeFormOutcome, FreeFormReport, VertexOrigin};
pub use limit_mesh::LimitMesh;
pub use place::{LimitPoint, Place};
pub use rules::Rules;
pub use tags::{Corner, Crease, INFINITE_SHARPNESS, Sector, Tags};

#[cfg(test)]
mod tests;

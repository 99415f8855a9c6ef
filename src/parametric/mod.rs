//! Parametric geometry: curves, plane regions, surface patches, and the solids made of them.
//!
//! After Choporov 2017 (adaptive meshes of curves and patches), Al-Athamneh 2016 (curves, contours, regions) and
//! Ganchuk 2024 (two Bezier curves joined into one); B-splines and NURBS after Piegl and Tiller, "The NURBS Book".
//!
//! - **Curves** of the plane and of space share the trait [`Curve`]: [`Segment`], [`EllipticArc`], [`Polyline`],
//!   [`HermiteSpline`], [`CubicSpline`], [`LagrangeCurve`], [`Bezier`], [`NurbsCurve`], [`Composite`], [`Reversed`].
//!   [`CurveMeshing`] makes polygons of them.
//! - **Regions**: [`Region`] is bounded by curves, [`Polygons`] by straight edges; the latter combine exactly
//!   ([`Polygons::union`] and so on) and are filled with triangles. [`Extrusion`], [`Revolution`] and [`Sweep`] make
//!   closed meshes of them.
//! - **Patches**: [`Patch`] is a Bezier, B-spline or NURBS surface; [`PatchMeshing`] makes one watertight mesh of many.
//! - **Conjugation**: [`CurveJoin`] replaces two curves by one.
//! - **Files**: [`json`] and [`svg`].
//!
//! # What is guaranteed
//!
//! Meshes deviate from their curve or patch by no more than the tolerance: that is decided by convex hulls of control
//! points, not by samples. Patches whose boundaries run along each other share vertices bit for bit, and the mesh of
//! patches without gaps is closed. Not guaranteed: that a mesh whose tolerance is as large as the solid's own features
//! (thin walls, narrow gaps) does not cross itself; [`Solid`](crate::Solid) and the check of the program tell.
//!
//! ```
//! use trisect::parametric::{Patch, PatchMeshing};
//!
//! let sphere = Patch::sphere([0.0; 3], 1.0)?;
//! let made = PatchMeshing::new(0.001).closed(&[sphere])?;
//! assert!(made.gaps.is_empty());
//! let solid = made.into_solid()?;
//! # let _ = solid;
//! # Ok::<(), trisect::Error>(())
//! ```

mod arc;
mod bernstein;
mod bezier;
mod composite;
mod conjugation;
mod conjugation_report;
mod constraints;
mod cubic_spline;
mod curve;
mod density;
mod deviation;
mod discretise;
mod error;
mod extrude;
mod face_mesh;
mod flat_triangle;
mod gauss;
mod hermite;
mod joints;
pub mod json;
mod knots;
mod lagrange;
mod line;
mod membership;
mod needles;
mod nurbs;
mod nurbs_tools;
mod orientation;
mod overlay;
mod parameters;
mod patch;
mod patch_mesh;
mod patch_pieces;
mod patch_shapes;
mod polygons;
mod polyline;
mod region;
mod revolve;
pub mod svg;
mod sweep;
mod triangulate;
mod vector;

pub use arc::EllipticArc;
pub use bezier::Bezier;
pub use composite::Composite;
pub use conjugation::{CurveJoin, JoinMetric, Joined, JoinedSpline, JointAt, Operand};
pub use conjugation_report::{ConstraintReport, JoinReport};
pub use cubic_spline::{CubicSpline, SplineEnds};
pub use curve::{Curve, Reversed, SharedCurve};
pub use discretise::{CurveMesh, CurveMeshing, Refinement};
pub use error::GeometryError;
pub use extrude::Extrusion;
pub use hermite::{HermiteSpline, TangentRule};
pub use joints::Gap;
pub use lagrange::LagrangeCurve;
pub use line::Segment;
pub use membership::Membership;
pub use nurbs::NurbsCurve;
pub use overlay::{FillRule, RegionOperation};
pub use parameters::Spacing;
pub use patch::{Patch, Side};
pub use patch_mesh::{PatchMesh, PatchMeshing, PatchTriangle};
pub use polygons::Polygons;
pub use polyline::Polyline;
pub use region::Region;
pub use revolve::Revolution;
pub use sweep::Sweep;
pub use triangulate::PlaneMesh;

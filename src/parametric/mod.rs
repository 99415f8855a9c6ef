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
//! (thin walls, narrow gaps) does not cross itself; [`Solid`](crate::Solid) and the program's `check` find that out.
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

mod curve;
mod error;
mod file;
mod join;
mod numeric;
mod patch;
mod region;
mod solid;

pub use curve::{
    Bezier, Composite, CubicSpline, Curve, CurveForm, CurveMesh, CurveMeshing, EllipticArc, HermiteSpline,
    LagrangeCurve, NurbsCurve, Polyline, Refinement, Reversed, Segment, SharedCurve, Spacing, SplineEnds,
    TangentRule,
};
pub use error::GeometryError;
pub use file::{json, svg};
pub use join::{
    ConstraintReport, CurveJoin, JoinInput, JoinMetric, JoinReport, Joined, JoinedSpline, JointAt,
};
pub use patch::{Gap, Patch, PatchMesh, PatchMeshing, PatchSide, PatchTriangle};
pub use region::{FillRule, Membership, PlaneMesh, Polygons, Region, RegionOperation};
pub use solid::{Extrusion, Revolution, Sweep};

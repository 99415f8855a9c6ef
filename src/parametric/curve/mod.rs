//! Curves of the plane and of space, and polygons of them.

pub(crate) mod arc;
pub(crate) mod bezier;
pub(crate) mod composite;
mod cubic_spline;
pub(crate) mod discretise;
mod hermite;
mod lagrange;
pub(crate) mod line;
pub(crate) mod nurbs;
mod nurbs_as_curve;
pub(crate) mod nurbs_tools;
pub(crate) mod param_curve;
mod parameters;
mod piecewise;
mod polyline;
mod reversed;

pub use arc::EllipticArc;
pub use bezier::Bezier;
pub use composite::Composite;
pub use cubic_spline::{CubicSpline, SplineEnds};
pub use discretise::{CurveMesh, CurveMeshing, Refinement};
pub use hermite::{HermiteSpline, TangentRule};
pub use lagrange::LagrangeCurve;
pub use line::Segment;
pub use nurbs::NurbsCurve;
pub use param_curve::{Curve, CurveForm, SharedCurve};
pub use parameters::Spacing;
pub use polyline::Polyline;
pub use reversed::Reversed;

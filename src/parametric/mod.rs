//! Parametric geometry: curves, plane regions, surface patches, and solids made of them.

mod arc;
mod bernstein;
mod bezier;
mod composite;
mod cubic_spline;
mod curve;
mod discretise;
mod error;
mod extrude;
mod gauss;
mod hermite;
mod knots;
mod lagrange;
mod line;
mod membership;
mod nurbs;
mod nurbs_tools;
mod overlay;
mod parameters;
mod polygons;
mod polyline;
mod region;
mod revolve;
mod sweep;
mod triangulate;
mod vector;

pub use arc::EllipticArc;
pub use bezier::Bezier;
pub use composite::Composite;
pub use cubic_spline::{CubicSpline, SplineEnds};
pub use curve::{Curve, Reversed, SharedCurve};
pub use discretise::{CurveMesh, CurveMeshing, Refinement};
pub use error::GeometryError;
pub use extrude::Extrusion;
pub use hermite::{HermiteSpline, TangentRule};
pub use lagrange::LagrangeCurve;
pub use line::Segment;
pub use membership::Membership;
pub use nurbs::NurbsCurve;
pub use overlay::{FillRule, RegionOperation};
pub use parameters::Spacing;
pub use polygons::Polygons;
pub use polyline::Polyline;
pub use region::Region;
pub use revolve::Revolution;
pub use sweep::Sweep;
pub use triangulate::PlaneMesh;

/// placeholder
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {}
impl std::fmt::Display for Gap {
    fn fmt(&self, _: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        Ok(())
    }
}

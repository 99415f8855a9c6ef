//! What the other rooms compute with: small vectors, Bernstein polynomials, knot vectors, quadrature.

pub(crate) mod bernstein;
pub(crate) mod domain;
pub(crate) mod gauss;
pub(crate) mod knots;
pub(crate) mod vector;

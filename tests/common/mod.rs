//! Helpers shared by the capability tests.
#![allow(dead_code, reason = "each test program uses some of these")]

pub(crate) mod meshes;
#[cfg(feature = "parametric")]
pub(crate) mod parametric;
pub(crate) mod planar;
#[cfg(feature = "cli")]
pub(crate) mod program;
pub(crate) mod same_bits;
pub(crate) mod shapes;
pub(crate) mod surface;
pub(crate) mod threejs;

use trisect::{Mesh, Operation, Outcome, Solid};

/// The solid of a mesh that must be one.
pub(crate) fn solid(mesh: Mesh) -> Solid {
    Solid::try_from(mesh).expect("a closed mesh")
}

/// A box between two corners.
pub(crate) fn cuboid(low: [f64; 3], high: [f64; 3]) -> Solid {
    solid(trisect::primitives::cuboid(low, high).expect("a box"))
}

/// A cube.
pub(crate) fn cube(low: [f64; 3], side: f64) -> Solid {
    cuboid(low, low.map(|x| x + side))
}

/// Runs an operation with default settings.
pub(crate) fn run(operation: Operation, operands: &[&Solid]) -> Outcome {
    same_bits::run(operation, operands)
}

/// Asserts what every result promises: closed, 2-manifold, no triangle without area, one origin per triangle.
pub(crate) fn assert_sound(outcome: &Outcome, context: &str) {
    let certificate = outcome.certificate();
    assert!(certificate.closed, "{context}: {certificate}");
    assert!(certificate.manifold, "{context}: {certificate}");
    assert_eq!(certificate.zero_area, 0, "{context}: {certificate}");
    assert_eq!(outcome.origins().len(), certificate.triangles, "{context}");
}

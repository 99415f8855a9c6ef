//! Basic shapes.

use pyo3::prelude::*;
use trisect::{Error, Solid, primitives};

use crate::running::{Limits, WATCHED_FROM};
use crate::solids::Core;

/// A shape by its kind, its lengths, and the numbers of its parts.
#[pyfunction]
pub(crate) fn shape(py: Python<'_>, kind: &str, lengths: Vec<f64>, counts: Vec<u32>) -> PyResult<Core> {
    let solid = Limits::default().run(py, WATCHED_FROM, |_| {
        let mesh = match (kind, &*lengths, &*counts) {
            ("cuboid", &[a, b, c, d, e, f], []) => primitives::cuboid([a, b, c], [d, e, f]),
            ("icosphere", &[radius], &[level]) => primitives::icosphere(radius, level),
            ("cylinder", &[radius, height], &[segments]) => primitives::cylinder(radius, height, segments),
            ("cone", &[radius, height], &[segments]) => primitives::cone(radius, height, segments),
            ("torus", &[radius, tube], &[around, across]) => primitives::torus(radius, tube, around, across),
            _ => Err(Error::InvalidArgument(format!("there is no shape {kind} of such numbers"))),
        };
        Ok(Solid::try_from(mesh?)?)
    })?;
    Ok(solid.into())
}

//! Shaded pictures.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use trisect::render::{self, View};
use trisect::{Error, FileAction};

use crate::failures;
use crate::solids::Core;

/// A solid as the bytes of a PNG file; with `by_operand`, in a colour for each operand of the result.
#[pyfunction]
#[pyo3(signature = (core, width, height, direction, by_operand=false, background=None))]
pub(crate) fn picture<'py>(
    py: Python<'py>,
    core: &Core,
    width: u32,
    height: u32,
    direction: [f64; 3],
    by_operand: bool,
    background: Option<[u8; 3]>,
) -> PyResult<Bound<'py, PyBytes>> {
    let made = Arc::clone(&core.made);
    let mut view = View::default();
    (view.width, view.height, view.direction) = (width, height, direction);
    if let Some(colour) = background {
        view.background = [colour; 2];
    }
    let colours = match (by_operand, &*made) {
        (true, crate::solids::Made::Outcome(outcome)) => {
            let colour = |origin: &trisect::Origin| render::palette(origin.operand as usize);
            Some(outcome.origins().iter().map(colour).collect::<Vec<[u8; 3]>>())
        }
        _ => None,
    };
    let drawn = py.detach(|| {
        let mut bytes = Vec::new();
        let picture = render::mesh(made.solid().mesh(), &view, colours.as_deref());
        picture.write_png(&mut bytes).map(|()| bytes)
    });
    let bytes = drawn.map_err(|source| {
        failures::exception(&Error::File { action: FileAction::Write, path: "the picture".into(), source })
    })?;
    Ok(PyBytes::new(py, &bytes))
}

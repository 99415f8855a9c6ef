//! Shaded pictures.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use trisect::render::{self, View};
use trisect::{Error, FileAction};

use crate::failures;
use crate::solids::{Core, Made};

/// The largest side of a picture, in pixels, as the program has it: the samples behind it take 32 bytes per pixel.
const MOST: u32 = 4096;

/// A solid as the bytes of a PNG file; with `by_operand`, in a colour for each operand of the result.
#[pyfunction]
#[pyo3(signature = (core, width, height, direction, by_operand=false))]
pub(crate) fn picture<'py>(
    py: Python<'py>,
    core: &Core,
    width: u32,
    height: u32,
    direction: [f64; 3],
    by_operand: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    if ![width, height].iter().all(|side| (1..=MOST).contains(side)) {
        let text = format!("a picture has sides of 1 to {MOST} pixels, not {width} x {height}");
        return Err(failures::argument(&text));
    }
    let made = Arc::clone(&core.made);
    let mut view = View::default();
    (view.width, view.height, view.direction) = (width, height, direction);
    let drawn = py.detach(|| {
        let colours = match (by_operand, &*made) {
            (true, Made::Outcome(outcome)) => {
                let colour = |origin: &trisect::Origin| render::palette(origin.operand as usize);
                Some(outcome.origins().iter().map(colour).collect::<Vec<[u8; 3]>>())
            }
            _ => None,
        };
        let mut bytes = Vec::new();
        let picture = render::mesh(made.solid().mesh(), &view, colours.as_deref());
        picture.write_png(&mut bytes).map(|()| bytes)
    });
    let bytes = drawn.map_err(|source| {
        failures::exception(&Error::File { action: FileAction::Write, path: "the picture".into(), source })
    })?;
    Ok(PyBytes::new(py, &bytes))
}

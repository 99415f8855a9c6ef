//! Files: meshes read and written, models evaluated.

use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use trisect::io::{self, Encoding, Precision, ReadOptions, WriteOptions};
use trisect::mesh::Gate;
use trisect::model::{Evaluation, Model};
use trisect::{Error, Mesh};

use crate::failures;
use crate::meshes::Surface;
use crate::running::WATCHED_FROM;
use crate::settings::limits;
use crate::solids::Core;

/// Reads a mesh file, or the parts of it that a name means; what its reader had to say; and the ending that its format has.
#[pyfunction]
#[pyo3(signature = (path, part=None, settings=None))]
pub(crate) fn load(
    py: Python<'_>,
    path: PathBuf,
    part: Option<String>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<(Surface, Vec<String>, &'static str)> {
    // (How large the mesh is is not known yet.)
    let (mesh, warnings, format) = limits(settings)?.run(py, WATCHED_FROM, |control| {
        let options = ReadOptions::new().control(control.clone());
        let Some(part) = part else {
            let loaded = io::load(&path, &options)?;
            return Ok((loaded.mesh, loaded.warnings, loaded.format));
        };
        let parts = io::load_parts(&path, &options)?;
        let chosen = parts.select(&part)?;
        let mesh = Mesh::merged(chosen.iter().map(|part| &part.mesh))?;
        Ok((mesh, parts.whole.warnings, parts.whole.format))
    })?;
    Ok((mesh.into(), warnings, format.extension()))
}

/// Options of a written file.
fn write_options(options: Option<&Bound<'_, PyDict>>) -> PyResult<WriteOptions> {
    let mut written = WriteOptions::new();
    let Some(options) = options else { return Ok(written) };
    for (key, value) in options.iter() {
        let key: String = key.extract()?;
        let wanted: bool = value.extract()?;
        written = match key.as_str() {
            "ascii" if wanted => written.encoding(Encoding::Ascii),
            "single" if wanted => written.precision(Precision::Single),
            "ascii" | "single" => written,
            "manifold" => written.manifold(wanted),
            "separate" => written.separate(wanted),
            _ => return Err(failures::argument(&format!("unknown option '{key}'"))),
        };
    }
    Ok(written)
}

fn save(
    py: Python<'_>,
    mesh: &Mesh,
    path: &PathBuf,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<String>> {
    let options = write_options(options)?;
    let saved = py.detach(|| io::save(mesh, path, &options));
    saved.map_err(|error| failures::exception(&error))
}

/// Writes a solid to a mesh file; what the format could not keep.
#[pyfunction]
#[pyo3(signature = (core, path, options=None))]
pub(crate) fn save_solid(
    py: Python<'_>,
    core: &Core,
    path: PathBuf,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<String>> {
    save(py, core.solid().mesh(), &path, options)
}

/// Writes a mesh to a mesh file; what the format could not keep.
#[pyfunction]
#[pyo3(signature = (surface, path, options=None))]
pub(crate) fn save_mesh(
    py: Python<'_>,
    surface: &Surface,
    path: PathBuf,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<String>> {
    save(py, &surface.mesh, &path, options)
}

/// A solid, or a surface that may be open.
#[derive(IntoPyObject)]
pub(crate) enum Evaluated {
    /// A solid.
    Solid(Core),
    /// What a trim leaves.
    Open(Surface),
}

/// Evaluates a model: the text of its file, and the folder where file names in it start.
#[pyfunction]
#[pyo3(signature = (text, folder, tolerance=None, settings=None))]
pub(crate) fn model(
    py: Python<'_>,
    text: &str,
    folder: PathBuf,
    tolerance: Option<f64>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<(Evaluated, Vec<String>)> {
    limits(settings)?.run(py, WATCHED_FROM, |control| {
        let model = Model::parse(text, &folder)?;
        let mut evaluation = Evaluation::new().control(control.clone());
        if let Some(tolerance) = tolerance {
            evaluation = evaluation.tolerance(tolerance);
        }
        let evaluated = evaluation.run(&model)?;
        if evaluated.is_open {
            return Ok((Evaluated::Open(evaluated.mesh.into()), evaluated.warnings));
        }
        let solid = Gate::new().solid(evaluated.mesh).map_err(Error::from)?;
        Ok((Evaluated::Solid(Core::extracted(solid, evaluated.extraction)), evaluated.warnings))
    })
}

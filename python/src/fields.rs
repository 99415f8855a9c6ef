//! Signed distances, winding numbers, formulas, models as fields, grids, and fields as solids.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use trisect::field::{Expression, Extracted, Extraction, Formula, Grid, SignedDistance, System};
use trisect::model::{Evaluation, ExtractionReport, Model};
use trisect::{Control, Error, Solid};

use crate::running::WATCHED_FROM;
use crate::settings::limits;
use crate::solids::Core;
use crate::{arrays, failures};

/// Points between two looks at the limits.
const POINTS: usize = 1 << 12;

/// From so many points on a call is watched.
fn size(points: usize) -> usize {
    points.saturating_mul(4)
}

/// What `work` finds at points.
fn asked<T: Send>(
    py: Python<'_>,
    points: &Bound<'_, PyAny>,
    settings: Option<&Bound<'_, PyDict>>,
    work: impl FnOnce(&[[f64; 3]], &Control) -> Result<Vec<T>, Error> + Send,
) -> PyResult<Vec<T>> {
    let points = arrays::positions(points)?;
    limits(settings)?.run(py, size(points.len()), |control| work(&points, control))
}

/// Distances, gradients, nearest points, and the triangles that these are in.
type Measured<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<i64>>,
);

/// The signed distance of a solid.
#[pyclass(frozen, module = "trisect._trisect")]
pub(crate) struct Distance {
    distance: Arc<SignedDistance>,
}

#[pymethods]
impl Distance {
    /// Of a solid.
    #[staticmethod]
    #[pyo3(signature = (core, settings=None))]
    fn of_solid(py: Python<'_>, core: &Core, settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let made = Arc::clone(&core.made);
        let count = made.solid().mesh().triangles.len();
        let distance = limits(settings)?.run(py, count, |control| {
            // So that Ctrl-C ends what takes longest of it.
            made.solid().self_crossings(control)?;
            Ok(SignedDistance::new(made.solid()))
        })?;
        Ok(Self { distance: Arc::new(distance) })
    }

    /// Distances at points, positive inside.
    #[pyo3(signature = (points, settings=None))]
    fn at<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let distances = asked(py, points, settings, |points, control| self.distance.at_all(points, control))?;
        Ok(PyArray1::from_vec(py, distances))
    }

    /// Distances, gradients, nearest points and their triangles, at points.
    #[pyo3(signature = (points, settings=None))]
    fn measure<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Measured<'py>> {
        let found =
            asked(py, points, settings, |points, control| self.distance.measure_all(points, control))?;
        let nothing = [f64::NAN; 3];
        let distances = found.iter().map(|at| at.map_or(f64::NAN, |at| at.distance)).collect();
        let gradients: Vec<[f64; 3]> = found.iter().map(|at| at.map_or(nothing, |at| at.gradient)).collect();
        let closest: Vec<[f64; 3]> =
            found.iter().map(|at| at.map_or(nothing, |at| at.closest.point)).collect();
        let triangles = found.iter().map(|at| at.map_or(-1, |at| i64::from(at.closest.triangle))).collect();
        Ok((
            PyArray1::from_vec(py, distances),
            arrays::table(py, &gradients)?,
            arrays::table(py, &closest)?,
            PyArray1::from_vec(py, triangles),
        ))
    }

    /// Winding numbers at points, exact.
    #[pyo3(signature = (points, settings=None))]
    fn winding<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray1<i32>>> {
        let numbers = asked(py, points, settings, |points, control| {
            let some = |some: &[[f64; 3]]| -> Result<Vec<i32>, Error> {
                control.check()?;
                Ok(some.iter().map(|&point| self.distance.tree().crossings(point).winding).collect())
            };
            let all: Vec<Vec<i32>> = points.par_chunks(POINTS).map(some).collect::<Result<_, _>>()?;
            Ok(all.concat())
        })?;
        Ok(PyArray1::from_vec(py, numbers))
    }

    /// Distances on a grid over a box, no larger than `band`; and its first point.
    #[pyo3(signature = (low, high, spacing, band=None, settings=None))]
    fn grid<'py>(
        &self,
        py: Python<'py>,
        low: [f64; 3],
        high: [f64; 3],
        spacing: f64,
        band: Option<f64>,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let grid = limits(settings)?.run(py, WATCHED_FROM, |control| {
            let grid = Grid::over(low, high, spacing)?;
            grid.banded(&self.distance, band.unwrap_or(f64::INFINITY), control)
        })?;
        shaped(py, grid)
    }
}

fn shaped(py: Python<'_>, grid: Grid) -> PyResult<Bound<'_, PyArray3<f32>>> {
    PyArray1::from_vec(py, grid.values).reshape(grid.shape)
}

/// A function of space, positive inside.
#[pyclass(frozen, module = "trisect._trisect")]
pub(crate) struct Field {
    expression: Arc<Expression>,
}

#[pymethods]
impl Field {
    /// Of a formula with parameters and other fields.
    #[staticmethod]
    fn of_formula(
        text: &str,
        parameters: Vec<(String, f64)>,
        fields: Vec<(String, PyRef<'_, Self>)>,
    ) -> PyResult<Self> {
        let fields: Vec<(String, Expression)> =
            fields.into_iter().map(|(name, field)| (name, (*field.expression).clone())).collect();
        let compiled = Formula::parse(text)
            .and_then(|formula| formula.compile(System::default(), &parameters, &fields))
            .map_err(|error| failures::exception(&Error::from(error)))?;
        Ok(Self { expression: Arc::new(compiled) })
    }

    /// Of a model: the text of its file, and the folder where file names in it start.
    #[staticmethod]
    #[pyo3(signature = (text, folder, settings=None))]
    fn of_model(
        py: Python<'_>,
        text: &str,
        folder: PathBuf,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let expression = limits(settings)?.run(py, WATCHED_FROM, |control| {
            Evaluation::new().control(control.clone()).field(&Model::parse(text, &folder)?)
        })?;
        Ok(Self { expression: Arc::new(expression) })
    }

    /// Values at points.
    #[pyo3(signature = (points, settings=None))]
    fn at<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = asked(py, points, settings, |points, control| self.expression.at_all(points, control))?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// Values on a grid over a box.
    #[pyo3(signature = (low, high, spacing, settings=None))]
    fn grid<'py>(
        &self,
        py: Python<'py>,
        low: [f64; 3],
        high: [f64; 3],
        spacing: f64,
        settings: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let grid = limits(settings)?.run(py, WATCHED_FROM, |control| {
            Grid::over(low, high, spacing)?.sample(&self.expression, control)
        })?;
        shaped(py, grid)
    }
}

/// The solid where a field is positive, with what its extraction reports.
#[pyfunction]
#[pyo3(signature = (field, low, high, tolerance, clip=false, resolution=None, settings=None))]
#[allow(clippy::too_many_arguments, reason = "they are Python's keywords")]
pub(crate) fn extract(
    py: Python<'_>,
    field: &Field,
    low: [f64; 3],
    high: [f64; 3],
    tolerance: f64,
    clip: bool,
    resolution: Option<f64>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Core> {
    let expression = Arc::clone(&field.expression);
    let (solid, report) = limits(settings)?.run(py, WATCHED_FROM, |control| {
        let mut extraction = Extraction::new(low, high, tolerance).clip(clip).control(control.clone());
        if let Some(resolution) = resolution {
            extraction = extraction.resolution(resolution);
        }
        let Extracted { mesh, cells, divided_cells, deviation, normal_deviation, .. } =
            extraction.run(&expression)?;
        let report = ExtractionReport { tolerance, deviation, normal_deviation, cells, divided_cells };
        Ok((Solid::try_from(mesh)?, report))
    })?;
    Ok(Core::extracted(solid, Some(report)))
}

//! Operations on solids.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use trisect::{Expression, Mesh, Operation, Solid, TrimSide};

use crate::failures;
use crate::meshes::Surface;
use crate::settings::{Settings, limits};
use crate::solids::{Core, Made};

/// Shares of operands: they stay alive while Python's lock is let go of.
fn shares(operands: &[PyRef<'_, Core>]) -> Vec<Arc<Made>> {
    operands.iter().map(|core| Arc::clone(&core.made)).collect()
}

fn size(operands: &[Arc<Made>]) -> usize {
    operands.iter().map(|made| made.solid().mesh().triangles.len()).sum()
}

fn solids(operands: &[Arc<Made>]) -> Vec<&Solid> {
    operands.iter().map(|made| made.solid()).collect()
}

/// One operation on any number of solids.
#[pyfunction]
#[pyo3(signature = (operation, operands, settings=None))]
pub(crate) fn combine(
    py: Python<'_>,
    operation: &str,
    operands: Vec<PyRef<'_, Core>>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Core> {
    let operation: Operation = operation.parse().map_err(|error| failures::argument(&format!("{error}")))?;
    let (limits, settings, operands) = (limits(settings)?, Settings::read(settings)?, shares(&operands));
    let outcome = limits
        .run(py, size(&operands), |control| settings.options(control).run(operation, solids(&operands)))?;
    Ok(outcome.into())
}

/// Expressions of the same solids, in one arrangement. A solid that crosses itself is resolved by its own name as expression.
#[pyfunction]
#[pyo3(signature = (expressions, names, operands, settings=None))]
pub(crate) fn evaluate(
    py: Python<'_>,
    expressions: Vec<String>,
    names: Vec<String>,
    operands: Vec<PyRef<'_, Core>>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<Core>> {
    let read = |text: &String| {
        Expression::parse(text, &names).map_err(|error| failures::argument(&error.to_string()))
    };
    let expressions: Vec<Expression> = expressions.iter().map(read).collect::<PyResult<_>>()?;
    let (limits, settings, operands) = (limits(settings)?, Settings::read(settings)?, shares(&operands));
    let outcomes = limits.run(py, size(&operands), |control| {
        let options = settings.options(control);
        match &*expressions {
            [only] if !matches!(only, Expression::Operand(_)) => {
                options.evaluate(only, solids(&operands)).map(|outcome| vec![outcome])
            }
            all => options.evaluate_all(all, solids(&operands)),
        }
    })?;
    Ok(outcomes.into_iter().map(Core::from).collect())
}

/// What of an open surface lies inside a solid or outside it.
#[pyfunction]
#[pyo3(signature = (surface, by, inside, settings=None))]
pub(crate) fn trim(
    py: Python<'_>,
    surface: &Surface,
    by: &Core,
    inside: bool,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Surface> {
    let (limits, settings) = (limits(settings)?, Settings::read(settings)?);
    let (sheet, by) = (Arc::clone(&surface.mesh), Arc::clone(&by.made));
    let side = if inside { TrimSide::Inside } else { TrimSide::Outside };
    let size = sheet.triangles.len() + by.solid().mesh().triangles.len();
    let trimmed = limits.run(py, size, |control| settings.options(control).trim(&sheet, by.solid(), side))?;
    Ok(trimmed.mesh.into())
}

/// The cells into which surfaces, which may be open, part a solid: what of it can be reached without passing through one.
#[pyfunction]
#[pyo3(signature = (core, surfaces, settings=None))]
pub(crate) fn part(
    py: Python<'_>,
    core: &Core,
    surfaces: Vec<PyRef<'_, Surface>>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Vec<Core>> {
    let (limits, settings) = (limits(settings)?, Settings::read(settings)?);
    let made = Arc::clone(&core.made);
    let sheets: Vec<Arc<Mesh>> = surfaces.iter().map(|surface| Arc::clone(&surface.mesh)).collect();
    let size =
        made.solid().mesh().triangles.len() + sheets.iter().map(|sheet| sheet.triangles.len()).sum::<usize>();
    let cells = limits.run(py, size, |control| {
        let listed: Vec<&Mesh> = sheets.iter().map(|sheet| &**sheet).collect();
        settings.options(control).split(made.solid(), &listed)
    })?;
    Ok(cells.into_iter().map(|cell| Core::from(cell.solid)).collect())
}

//! Solids against planes.

use std::sync::Arc;

use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trisect::exact::{Plane, PlaneFault};
use trisect::io::drawing::{Layer, dxf, json, svg};
use trisect::{Error, FaceGroup, PlaneCut, SectionSide, Sections};

use crate::settings::{Settings, limits};
use crate::solids::Core;
use crate::{arrays, failures};

/// A plane as it is given: by its coefficients, `normal . x = offset`, or by three points, which run counter-clockwise seen from
/// above.
#[derive(FromPyObject)]
pub(crate) enum Given {
    /// Normal and offset.
    Coefficients(([f64; 3], f64)),
    /// Points.
    Points([[f64; 3]; 3]),
}

fn plane(given: Given) -> PyResult<Plane> {
    let made = match given {
        Given::Coefficients(([1.0, 0.0, 0.0], offset)) => Plane::across(0, offset),
        Given::Coefficients(([0.0, 1.0, 0.0], offset)) => Plane::across(1, offset),
        Given::Coefficients(([0.0, 0.0, 1.0], offset)) => Plane::across(2, offset),
        Given::Coefficients((normal, offset)) => Plane::new(normal, offset),
        Given::Points([a, b, c]) => Plane::through(a, b, c),
    };
    made.map_err(|fault: PlaneFault| failures::exception(&Error::from(fault)))
}

/// Normal, offset; name and height.
type Level = ([f64; 3], f64, Option<(String, f64)>);

/// What a plane is: a normal of about unit length unless it was given by one, the offset that belongs to it; and, of a plane
/// across an axis, its name and its height.
#[pyfunction]
pub(crate) fn level(at: Given) -> PyResult<Level> {
    let given = if let Given::Coefficients(coefficients) = &at { Some(*coefficients) } else { None };
    let plane = plane(at)?;
    let (normal, offset) = given.unwrap_or_else(|| {
        let (normal, point) = (plane.normal(), plane.point());
        (normal, (0..3).map(|k| normal[k] * point[k]).sum())
    });
    let named = plane.as_level().map(|(axis, at)| (format!("{}={at}", ["x", "y", "z"][axis]), at));
    Ok((normal, offset, named))
}

/// What is above a plane and what is below it.
#[pyfunction]
#[pyo3(signature = (core, at, cap=None, settings=None))]
pub(crate) fn cut(
    py: Python<'_>,
    core: &Core,
    at: Given,
    cap: Option<String>,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<(Core, Core)> {
    let (limits, settings, plane) = (limits(settings)?, Settings::read(settings)?, plane(at)?);
    let made = Arc::clone(&core.made);
    let size = made.solid().mesh().triangles.len();
    let (above, below) = limits.run(py, size, |control| {
        let mut cut = PlaneCut::new(plane).options(settings.options(control));
        if let Some(name) = cap {
            cut = cut.cap(FaceGroup { name, material: None });
        }
        cut.halves(made.solid())
    })?;
    Ok((above.into(), below.into()))
}

/// A section: area, perimeter, and its shapes, each an outline and its holes; the same rings in space.
type Flat<'py> = (f64, f64, Vec<Vec<Bound<'py, PyArray2<f64>>>>, Vec<Vec<Bound<'py, PyArray2<f64>>>>);

/// Sections at planes.
#[pyfunction]
#[pyo3(signature = (core, at, side="inside", settings=None))]
pub(crate) fn sections<'py>(
    py: Python<'py>,
    core: &Core,
    at: Vec<Given>,
    side: &str,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<Vec<Flat<'py>>> {
    let side = match side {
        "inside" => SectionSide::Inside,
        "above" => SectionSide::Above,
        "below" => SectionSide::Below,
        other => {
            return Err(failures::argument(&format!(
                "unknown side '{other}': known are inside, above, below"
            )));
        }
    };
    let planes: Vec<Plane> = at.into_iter().map(plane).collect::<PyResult<_>>()?;
    let (limits, settings) = (limits(settings)?, Settings::read(settings)?);
    let made = Arc::clone(&core.made);
    let size = made.solid().mesh().triangles.len();
    let found = limits.run(py, size, |control| {
        Sections::new().side(side).options(settings.options(control)).at(made.solid(), &planes)
    })?;
    let mut listed = Vec::with_capacity(found.len());
    for section in &found {
        let flat = |ring: &Vec<[f64; 2]>| arrays::table(py, ring);
        let placed = |ring: &Vec<[f64; 2]>| {
            let places: Vec<[f64; 3]> = ring.iter().map(|&point| section.place(point)).collect();
            arrays::table(py, &places)
        };
        listed.push((
            section.area(),
            section.perimeter(),
            rings(section.shapes(), flat)?,
            rings(section.shapes(), placed)?,
        ));
    }
    Ok(listed)
}

/// What `array` makes of every ring of some polygons.
fn rings<T>(
    shapes: &[Vec<Vec<[f64; 2]>>],
    array: impl Fn(&Vec<[f64; 2]>) -> PyResult<T>,
) -> PyResult<Vec<Vec<T>>> {
    shapes.iter().map(|shape| shape.iter().map(&array).collect()).collect()
}

/// Polygons with holes.
type Shapes = Vec<Vec<Vec<[f64; 2]>>>;

/// Sections as the text of a drawing: "svg", "dxf" or "json".
#[pyfunction]
pub(crate) fn drawing(kind: &str, layers: Vec<(String, f64, Shapes)>) -> PyResult<String> {
    let listed: Vec<Layer<'_>> = layers
        .iter()
        .map(|(name, height, shapes)| Layer { name: name.clone(), height: *height, shapes })
        .collect();
    match kind {
        "svg" => Ok(svg(&listed)),
        "dxf" => Ok(dxf(&listed)),
        "json" => Ok(json(&listed)),
        other => Err(failures::argument(&format!("unknown drawing '{other}': known are svg, dxf, json"))),
    }
}

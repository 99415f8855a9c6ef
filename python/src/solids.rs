//! Solids: closed surfaces, and results with what is known of them.

use std::hash::Hasher as _;
use std::sync::{Arc, OnceLock};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rustc_hash::FxHasher;
use trisect::mesh::Gate;
use trisect::model::ExtractionReport;
use trisect::{Certificate, Error, Mesh, MeshError, Outcome, Solid};

use crate::failures;
use crate::meshes::{Parts, Surface, read_mesh, welding};
use crate::settings::limits;
use crate::views::{Owner, View};

/// A solid, or the result that it is of.
pub(crate) enum Made {
    /// A solid by itself.
    Solid(Box<Solid>),
    /// The result of an operation.
    Outcome(Box<Outcome>),
}

impl Made {
    pub(crate) fn solid(&self) -> &Solid {
        match self {
            Self::Solid(solid) => solid,
            Self::Outcome(outcome) => outcome.solid(),
        }
    }

    fn outcome(&self) -> Option<&Outcome> {
        match self {
            Self::Solid(_) => None,
            Self::Outcome(outcome) => Some(outcome),
        }
    }
}

/// What stands behind a `trisect.Solid`.
#[pyclass(frozen, module = "trisect._trisect")]
pub(crate) struct Core {
    pub(crate) made: Arc<Made>,
    /// Of a surface extracted from a field.
    extraction: Option<ExtractionReport>,
    hash: OnceLock<u64>,
}

/// Operands, triangles, and whether they are reversed.
type OriginTables<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<bool>>);

impl From<Solid> for Core {
    fn from(solid: Solid) -> Self {
        Self::extracted(solid, None)
    }
}

impl From<Outcome> for Core {
    fn from(outcome: Outcome) -> Self {
        Self { made: Arc::new(Made::Outcome(Box::new(outcome))), extraction: None, hash: OnceLock::new() }
    }
}

impl Core {
    /// A solid with what its extraction reports, if it comes from one.
    pub(crate) fn extracted(solid: Solid, extraction: Option<ExtractionReport>) -> Self {
        Self { made: Arc::new(Made::Solid(Box::new(solid))), extraction, hash: OnceLock::new() }
    }

    pub(crate) fn solid(&self) -> &Solid {
        self.made.solid()
    }

    /// The solid of what `change` makes of a copy of the mesh.
    fn changed(
        &self,
        py: Python<'_>,
        change: impl FnOnce(Mesh) -> Result<Mesh, Error> + Send,
    ) -> PyResult<Self> {
        let limits = crate::running::Limits::default();
        let count = self.solid().mesh().triangles.len();
        let made = Arc::clone(&self.made);
        let changed =
            limits.run(py, count, move |_| passed(Gate::new(), change(made.solid().mesh().clone())?))?;
        Ok(changed.into())
    }

    /// The result, for which one that is an operand by itself has no answer.
    fn outcome(&self) -> PyResult<&Outcome> {
        let none =
            "this solid is no result of an operation: it has neither origins nor curves nor a certificate";
        self.made.outcome().ok_or_else(|| failures::argument(none))
    }
}

/// What a mesh is taken through to become a solid.
fn gate(options: Option<&Bound<'_, PyDict>>) -> PyResult<Gate> {
    let mut gate = Gate::new();
    let Some(options) = options else { return Ok(gate) };
    for (key, value) in options.iter() {
        let key: String = key.extract()?;
        gate = match key.as_str() {
            "weld" => gate.weld(welding(&value)),
            "orient" => gate.orient(value.extract()?),
            "closed_parts" => gate.closed_parts(value.extract()?),
            "fill_holes" => gate.fill_holes(value.extract()?),
            "refine_holes" => gate.refine_holes(value.extract()?),
            "proven_clean" => gate.proven_clean(value.extract()?),
            "single_shells" => gate.single_shells(value.extract()?),
            "as_is" => gate.as_is(value.extract()?),
            _ => return Err(failures::argument(&format!("unknown option '{key}'"))),
        };
    }
    Ok(gate)
}

/// The solid of a mesh.
fn passed(gate: Gate, mesh: Mesh) -> Result<Solid, Error> {
    gate.solid(mesh).map_err(Error::from)
}

#[pymethods]
impl Core {
    /// A solid from arrays.
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, sizes=None, options=None, settings=None))]
    fn of_arrays(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        sizes: Option<Vec<u32>>,
        options: Option<&Bound<'_, PyDict>>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (gate, limits) = (gate(options)?, limits(settings)?);
        let mesh = read_mesh(vertices, faces, sizes)?;
        let solid = limits.run(py, mesh.triangles.len(), |control| {
            control.check()?;
            passed(gate, mesh)
        })?;
        Ok(solid.into())
    }

    /// A solid of a mesh.
    #[staticmethod]
    #[pyo3(signature = (surface, options=None, settings=None))]
    fn of_mesh(
        py: Python<'_>,
        surface: &Surface,
        options: Option<&Bound<'_, PyDict>>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (gate, limits) = (gate(options)?, limits(settings)?);
        let mesh = Arc::clone(&surface.mesh);
        let solid = limits.run(py, mesh.triangles.len(), |control| {
            control.check()?;
            passed(gate, (*mesh).clone())
        })?;
        Ok(solid.into())
    }

    /// A copy as a mesh without promises.
    fn surface(&self) -> Surface {
        self.solid().mesh().clone().into()
    }

    /// A table of the mesh, for `numpy.asarray`.
    #[pyo3(signature = (name, attribute=0))]
    fn view(&self, name: &str, attribute: usize) -> PyResult<View> {
        View::new(Owner::Solid(Arc::clone(&self.made)), name, attribute)
    }

    /// The names of the attributes, in order.
    fn attributes(&self) -> Vec<String> {
        self.solid().mesh().attributes.iter().map(|attribute| attribute.name.clone()).collect()
    }

    /// The groups as JSON.
    fn groups(&self) -> String {
        serde_json::to_string(&self.solid().mesh().groups.list).unwrap_or_default()
    }

    /// Counts and measures: vertices, triangles.
    fn counts(&self) -> (usize, usize) {
        let mesh = self.solid().mesh();
        (mesh.positions.len(), mesh.triangles.len())
    }

    /// The enclosed volume.
    fn volume(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.solid().volume())
    }

    /// The area of the surface.
    fn area(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.solid().area())
    }

    /// Low and high corner of the smallest box.
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.solid().bounds().map(|bounds| [bounds.low, bounds.high])
    }

    /// The centre of mass.
    fn centroid(&self, py: Python<'_>) -> Option<[f64; 3]> {
        py.detach(|| self.solid().mesh().centroid())
    }

    /// Whether it is a 2-manifold, pieces of the surface, V - E + F, the genus.
    fn topology(&self, py: Python<'_>) -> (bool, usize, i64, Option<usize>) {
        py.detach(|| {
            let solid = self.solid();
            (solid.is_manifold(), solid.components(), solid.euler_characteristic(), solid.genus())
        })
    }

    /// Whether it is the result of an operation.
    fn is_result(&self) -> bool {
        self.made.outcome().is_some()
    }

    /// The certificate of a result as JSON.
    fn certificate(&self, py: Python<'_>) -> PyResult<String> {
        let outcome = self.outcome()?;
        py.detach(|| text(outcome.certificate()))
    }

    /// Operand, triangle and whether it is reversed, for every triangle of a result.
    fn origins<'py>(&self, py: Python<'py>) -> PyResult<OriginTables<'py>> {
        let outcome = self.outcome()?;
        let origins = py.detach(|| outcome.origins());
        let operands: Vec<u32> = origins.iter().map(|origin| origin.operand).collect();
        let triangles: Vec<u32> = origins.iter().map(|origin| origin.triangle).collect();
        let reversed: Vec<bool> = origins.iter().map(|origin| origin.reversed).collect();
        Ok((
            PyArray1::from_vec(py, operands),
            PyArray1::from_vec(py, triangles),
            PyArray1::from_vec(py, reversed),
        ))
    }

    /// The curves of a result, as chains of vertices.
    fn curves<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray1<u32>>>> {
        let outcome = self.outcome()?;
        let curves = py.detach(|| outcome.curves());
        Ok(curves.into_iter().map(|curve| PyArray1::from_vec(py, curve)).collect())
    }

    /// For every triangle the one it had in the mesh this was made of.
    fn sources<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let count = self.solid().mesh().triangles.len() as u32;
        let sources = (0..count).map(|triangle| self.solid().source_triangle(triangle)).collect();
        PyArray1::from_vec(py, sources)
    }

    /// What was left out, joined and mended when this was made, as JSON; and the same of mending in words.
    fn mending(&self) -> (String, String, String) {
        let (cleaning, mending) = (self.solid().cleaning(), self.solid().mending());
        let of = |value: Result<String, serde_json::Error>| value.unwrap_or_default();
        (of(serde_json::to_string(&cleaning)), of(serde_json::to_string(mending)), mending.to_string())
    }

    /// What the extraction reports as JSON, if the surface is one of a field.
    fn extraction(&self) -> Option<String> {
        let ExtractionReport { tolerance, deviation, normal_deviation, cells, divided_cells } =
            self.extraction?;
        let report = serde_json::json!({
            "tolerance": tolerance,
            "deviation": deviation,
            "normal_deviation": normal_deviation,
            "cells": cells,
            "divided_cells": divided_cells,
        });
        Some(report.to_string())
    }

    /// Where the surface crosses itself, as JSON.
    #[pyo3(signature = (settings=None))]
    fn self_crossings(&self, py: Python<'_>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<String> {
        let count = self.solid().mesh().triangles.len();
        limits(settings)?.run(py, count, |control| {
            let found = self.solid().self_crossings(control)?;
            Ok(serde_json::to_string(found).unwrap_or_default())
        })
    }

    /// As the program has an operand: looked through, refused if shells face the wrong way, and apart where it touches itself in
    /// single vertices, as its result would.
    #[pyo3(signature = (assume_clean=false, settings=None))]
    fn operand(
        &self,
        py: Python<'_>,
        assume_clean: bool,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let count = self.solid().mesh().triangles.len();
        let separated = limits(settings)?.run(py, count, |control| {
            let solid = self.solid();
            if !assume_clean && solid.self_crossings(control)?.is_clean() {
                let misplaced = solid.inside_out_shells();
                if !misplaced.is_none() {
                    return Err(MeshError::InsideOutShells(Box::new(misplaced)).into());
                }
            }
            Ok((!solid.is_manifold()).then(|| solid.separated().0))
        })?;
        Ok(match separated {
            Some(solid) => solid.into(),
            None => Self { made: Arc::clone(&self.made), extraction: self.extraction, hash: OnceLock::new() },
        })
    }

    /// Whether it has neither attributes nor groups nor polygons.
    fn is_plain(&self) -> bool {
        let mesh = self.solid().mesh();
        mesh.attributes.is_empty() && mesh.groups.is_empty() && mesh.polygons.is_empty()
    }

    /// Whether it is known, without a look, that operations may take it as it is.
    fn is_proven_clean(&self) -> bool {
        self.solid().is_proven_clean()
    }

    /// The bodies as solids of their own.
    fn bodies(&self, py: Python<'_>) -> Vec<Self> {
        py.detach(|| self.solid().bodies()).into_iter().map(Self::from).collect()
    }

    /// Turned around an axis through the origin; by quarter turns exactly.
    fn rotated(&self, py: Python<'_>, axis: [f64; 3], degrees: f64) -> PyResult<Self> {
        self.changed(py, |mesh| mesh.rotated(axis, degrees).map_err(Error::from))
    }

    /// Scaled along the axes.
    fn scaled(&self, py: Python<'_>, factors: [f64; 3]) -> PyResult<Self> {
        self.changed(py, |mesh| mesh.scaled(factors).map_err(Error::from))
    }

    /// Moved by an offset.
    fn translated(&self, py: Python<'_>, offset: [f64; 3]) -> PyResult<Self> {
        self.changed(py, |mesh| Ok(mesh.translated(offset)))
    }

    /// Moved by the rows of a 3 x 4 or 4 x 4 matrix.
    fn transformed(&self, py: Python<'_>, matrix: Vec<f64>) -> PyResult<Self> {
        self.changed(py, |mesh| mesh.transformed(&matrix).map_err(Error::from))
    }

    /// Whether two solids have the same vertices, triangles, attributes and groups, to the bit.
    fn equals(&self, py: Python<'_>, other: &Self) -> bool {
        let (one, two) = (self.solid(), other.solid());
        Arc::ptr_eq(&self.made, &other.made) || py.detach(|| one.mesh() == two.mesh())
    }

    /// A number that equal solids have in common.
    fn hash(&self, py: Python<'_>) -> u64 {
        *self.hash.get_or_init(|| py.detach(|| hash_of(self.solid().mesh())))
    }

    /// All that the mesh holds, for `Surface.of_parts`.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        crate::meshes::parts(py, self.solid().mesh())
    }
}

fn text(certificate: &Certificate) -> PyResult<String> {
    serde_json::to_string(certificate).map_err(|error| failures::argument(&error.to_string()))
}

fn hash_of(mesh: &Mesh) -> u64 {
    let mut hasher = FxHasher::default();
    for x in mesh.positions.as_flattened() {
        // Zeros compare as equal.
        hasher.write_u64((x + 0.0).to_bits());
    }
    for corners in mesh.triangles.as_flattened() {
        hasher.write_u32(*corners);
    }
    hasher.finish()
}

//! Cages of subdivision surfaces: made, read, refined, and combined to cages.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trisect::io::WriteOptions;
use trisect::subdivision::{
    Cage as AnyCage, ControlMesh, Corner, Crease, FreeForm, Rules, Scheme, Sector, Tags, VertexOrigin,
};
use trisect::{Error, Mesh, Operation};

use crate::meshes::Surface;
use crate::running::WATCHED_FROM;
use crate::settings::limits;
use crate::solids::Core;
use crate::{arrays, failures, places};

/// What stands behind a `trisect.Cage`.
#[pyclass(frozen, module = "trisect._trisect")]
pub(crate) struct Cage {
    cage: Arc<AnyCage>,
}

impl From<AnyCage> for Cage {
    fn from(cage: AnyCage) -> Self {
        Self { cage: Arc::new(cage) }
    }
}

/// Edges with their sharpness, vertices with theirs, and sectors: vertex, first neighbour, angle, flatness.
type TagLists = (Vec<(u32, u32, f64)>, Vec<(u32, f64)>, Vec<(u32, u32, f64, f64)>);

fn tags((creases, corners, sectors): TagLists) -> Tags {
    Tags {
        creases: creases.into_iter().map(|(a, b, sharpness)| Crease { edge: [a, b], sharpness }).collect(),
        corners: corners.into_iter().map(|(vertex, sharpness)| Corner { vertex, sharpness }).collect(),
        sectors: sectors
            .into_iter()
            .map(|(vertex, first, angle, flatness)| Sector { vertex, first, angle, flatness })
            .collect(),
    }
}

fn rules(name: &str) -> PyResult<Rules> {
    let known = || Rules::ALL.map(Rules::name).join(", ");
    Rules::named(name)
        .ok_or_else(|| failures::argument(&format!("unknown rules '{name}': known are {}", known())))
}

fn scheme(name: Option<&str>) -> PyResult<Option<Scheme>> {
    let known = || Scheme::ALL.map(Scheme::name).join(", ");
    let one = |name: &str| {
        Scheme::named(name)
            .ok_or_else(|| failures::argument(&format!("unknown scheme '{name}': known are {}", known())))
    };
    name.map(one).transpose()
}

#[pymethods]
impl Cage {
    /// A cage of points, faces and tags; and what became of faces that the scheme does not have.
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, tagged, weights="loop", named=None))]
    fn of_arrays(
        vertices: &Bound<'_, PyAny>,
        faces: Vec<Vec<u32>>,
        tagged: TagLists,
        weights: &str,
        named: Option<&str>,
    ) -> PyResult<(Self, Vec<String>)> {
        let positions = arrays::positions(vertices)?;
        let made = AnyCage::new(positions, &faces, tags(tagged), rules(weights)?, scheme(named)?);
        let (cage, warnings) = made.map_err(|error| failures::exception(&error))?;
        Ok((cage.into(), warnings))
    }

    /// A cage of the bytes of a file ("obj", "json", "glb" or "gltf"), and what was left out of it.
    #[staticmethod]
    #[pyo3(signature = (kind, bytes, weights="loop", named=None))]
    fn of_bytes(
        kind: &str,
        bytes: &[u8],
        weights: &str,
        named: Option<&str>,
    ) -> PyResult<(Self, Vec<String>)> {
        let read = match kind {
            "obj" => AnyCage::from_obj(bytes, rules(weights)?, scheme(named)?),
            "json" => AnyCage::from_json(bytes).map(|cage| (cage, Vec::new())),
            "glb" | "gltf" => AnyCage::from_gltf(bytes).map(|cage| (cage, Vec::new())),
            other => {
                return Err(failures::argument(&format!(
                    "a cage is no *.{other}: read *.obj, *.json or *.glb"
                )));
            }
        };
        let (cage, warnings) = read.map_err(|error| failures::exception(&error))?;
        Ok((cage.into(), warnings))
    }

    /// The text of a file: "obj" or "json".
    fn text(&self, kind: &str) -> PyResult<String> {
        match kind {
            "json" => Ok(self.cage.to_json() + "\n"),
            "obj" if self.levels() > 0 => Err(failures::argument(&format!(
                "OBJ has no details, and this cage has {} levels of them: write *.json, or what refine(0) makes of it",
                self.levels()
            ))),
            "obj" => Ok(self.cage.to_obj()),
            other => {
                Err(failures::argument(&format!("a cage is no *.{other}: write *.obj, *.json or *.glb")))
            }
        }
    }

    /// Writes a glTF file that shows `surface` and has the cage beside it; what the format could not keep.
    fn save_beside(&self, py: Python<'_>, surface: &Surface, path: PathBuf) -> PyResult<Vec<String>> {
        let options = self.cage.beside(WriteOptions::new());
        let saved = py.detach(|| trisect::io::save(&surface.mesh, &path, &options));
        saved.map_err(|error| failures::exception(&error))
    }

    /// The control points.
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::table(py, self.cage.positions())
    }

    /// The vertices of all faces.
    fn faces(&self) -> Vec<Vec<u32>> {
        self.cage.faces()
    }

    /// Creases, corners, sectors.
    fn tags(&self) -> TagLists {
        let tags = self.cage.tags();
        (
            tags.creases.iter().map(|crease| (crease.edge[0], crease.edge[1], crease.sharpness)).collect(),
            tags.corners.iter().map(|corner| (corner.vertex, corner.sharpness)).collect(),
            tags.sectors.iter().map(|s| (s.vertex, s.first, s.angle, s.flatness)).collect(),
        )
    }

    /// The names of the scheme and, under Loop's, of its rules.
    fn scheme(&self) -> (&'static str, Option<&'static str>) {
        let rules = match &*self.cage {
            AnyCage::Loop(cage) => Some(cage.rules().name()),
            _ => None,
        };
        (self.cage.scheme().name(), rules)
    }

    /// Control points, faces, whether there is no border.
    fn counts(&self) -> (usize, usize, bool) {
        let closed = match &*self.cage {
            AnyCage::Loop(cage) => cage.is_closed(),
            AnyCage::CatmullClark(cage) => cage.is_closed(),
            _ => false,
        };
        (self.cage.positions().len(), self.cage.face_count(), closed)
    }

    /// How many levels of details it has.
    fn levels(&self) -> usize {
        match &*self.cage {
            AnyCage::Loop(cage) => cage.details().len(),
            _ => 0,
        }
    }

    /// After so many subdivisions.
    #[pyo3(signature = (steps, settings=None))]
    fn refined(&self, py: Python<'_>, steps: usize, settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let cage = Arc::clone(&self.cage);
        let refined = limits(settings)?.run(py, WATCHED_FROM, move |control| {
            control.check()?;
            cage.subdivided(steps)
        })?;
        Ok(refined.into())
    }

    /// The limit surface within a tolerance, or over every face split so many times.
    #[pyo3(signature = (tolerance, steps=None, settings=None))]
    fn limit_mesh(
        &self,
        py: Python<'_>,
        tolerance: f64,
        steps: Option<usize>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Surface> {
        let cage = Arc::clone(&self.cage);
        let mesh = limits(settings)?.run(py, WATCHED_FROM, move |control| {
            control.check()?;
            match steps {
                Some(steps) => cage.limit_mesh_of_steps(steps),
                None => cage.limit_mesh(tolerance),
            }
        })?;
        Ok(mesh.into())
    }

    /// The cage itself as a mesh of triangles.
    fn mesh(&self) -> PyResult<Surface> {
        Ok(self.cage.mesh().map_err(|error| failures::exception(&error))?.into())
    }

    /// With creases where faces meet at more than so many degrees.
    fn creased(&self, degrees: f64) -> PyResult<Self> {
        let creased = self.cage.with_creases_from_angle(degrees);
        Ok(creased.map_err(|error| failures::exception(&error))?.into())
    }

    /// At another place, as [`places::moved`] moves meshes.
    fn moved(&self, how: &str, numbers: Vec<f64>) -> PyResult<Self> {
        let (reflects, rigid) = places::kind(how, &numbers);
        let points = |positions: &[[f64; 3]]| {
            Ok(places::moved(Mesh::new(positions.to_vec(), Vec::new()), how, &numbers)?.positions)
        };
        let moved = self.cage.moved(points, reflects, rigid);
        Ok(moved.map_err(|error| failures::exception(&error))?.into())
    }

    /// All that the cage is, as text, for pickles.
    fn json(&self) -> String {
        self.cage.to_json()
    }
}

/// Operands, vertices and whether they moved, for every control point of a result; operand -1 for new ones.
type PointOrigins<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

/// A result: cage, exact boolean, report as JSON, origins, and how far each operand was fitted.
type Combined<'py> = (Cage, Core, String, PointOrigins<'py>, Vec<f64>);

/// The setting called `key`, if it is given.
fn setting<'py, T: for<'a> FromPyObject<'a, 'py>>(
    options: Option<&Bound<'py, PyDict>>,
    key: &str,
) -> PyResult<Option<T>> {
    let Some(value) = options.map(|options| options.get_item(key)).transpose()?.flatten() else {
        return Ok(None);
    };
    value
        .extract::<T>()
        .map(Some)
        .map_err(|_| failures::argument(&format!("{key} has no such value: {value}")))
}

fn read(options: Option<&Bound<'_, PyDict>>) -> PyResult<FreeForm> {
    let mut form = FreeForm::new();
    if let Some(tolerance) = setting(options, "tolerance")? {
        form = form.tolerance(tolerance);
    }
    let details: usize = setting(options, "details")?.unwrap_or(0);
    // (Where details are added, halving is not the first thing tried; as in the program.)
    let attempts = setting(options, "attempts")?.unwrap_or(if details > 0 { 0 } else { 2 });
    Ok(form
        .details(details)
        .attempts(attempts)
        .refine(setting(options, "refine")?.unwrap_or(0))
        .rings(setting(options, "rings")?.unwrap_or(2))
        .allow_tangent(setting(options, "allow_tangent")?.unwrap_or(false)))
}

/// Combines cages. Those of polygons are fitted by cages of triangles first, within half of the tolerance.
#[pyfunction]
#[pyo3(signature = (operation, operands, options=None, settings=None))]
pub(crate) fn combine_cages<'py>(
    py: Python<'py>,
    operation: &str,
    operands: Vec<PyRef<'py, Cage>>,
    options: Option<&Bound<'py, PyDict>>,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<Combined<'py>> {
    let operation: Operation = operation.parse().map_err(|error| failures::argument(&format!("{error}")))?;
    let (form, tolerance) = (read(options)?, setting::<f64>(options, "tolerance")?);
    let cages: Vec<Arc<AnyCage>> = operands.iter().map(|cage| Arc::clone(&cage.cage)).collect();
    let (outcome, distances) = limits(settings)?.run(py, WATCHED_FROM, move |control| {
        let mut fitted = Vec::with_capacity(cages.len());
        for (number, cage) in cages.iter().enumerate() {
            control.check()?;
            let allowed = 0.5 * tolerance.unwrap_or_else(|| 1e-3 * diagonal(cage));
            let found = cage.to_loop(allowed);
            fitted.push(found.map_err(|error| error.of_operand(number, format!("cage {}", number + 1)))?);
        }
        let distances = fitted.iter().map(|(_, distance)| *distance).collect::<Vec<f64>>();
        let surfaces: Vec<&ControlMesh> = fitted.iter().map(|(cage, _)| cage).collect();
        let outcome = form.control(control.clone()).run_all(operation, &surfaces)?;
        Ok::<_, Error>((outcome, distances))
    })?;
    let mut table = (Vec::new(), Vec::new(), Vec::new());
    for origin in outcome.origins() {
        let (operand, vertex, moved) = match *origin {
            VertexOrigin::Kept { operand, vertex } => (operand as i64, i64::from(vertex), false),
            VertexOrigin::Fitted { operand, vertex } => (operand as i64, i64::from(vertex), true),
            _ => (-1, -1, true),
        };
        table.0.push(operand);
        table.1.push(vertex);
        table.2.push(moved);
    }
    let origins =
        (PyArray1::from_vec(py, table.0), PyArray1::from_vec(py, table.1), PyArray1::from_vec(py, table.2));
    let report = serde_json::to_string(outcome.report()).unwrap_or_default();
    let exact = Core::from(outcome.exact().clone());
    Ok((AnyCage::from(outcome.into_surface()).into(), exact, report, origins, distances))
}

/// The length of the diagonal of a cage's bounds; 1 of a cage that is a point.
fn diagonal(cage: &AnyCage) -> f64 {
    let bounds = Mesh::new(cage.positions().to_vec(), Vec::new()).bounds();
    let length = bounds
        .map_or(0.0, |bounds| (0..3).map(|k| (bounds.high[k] - bounds.low[k]).powi(2)).sum::<f64>().sqrt());
    if length > 0.0 { length } else { 1.0 }
}

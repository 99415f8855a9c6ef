//! Meshes without promises: open surfaces, files as they are, what has to be looked at before it is a solid.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use trisect::mesh::{Attribute, Gate, Welding, diagnose};
use trisect::{Error, Mesh, MeshError};

use crate::settings::limits;
use crate::views::{Owner, View};
use crate::{arrays, failures, places};

/// What stands behind a `trisect.Mesh`.
#[pyclass(frozen, module = "trisect._trisect")]
pub(crate) struct Surface {
    pub(crate) mesh: Arc<Mesh>,
}

impl From<Mesh> for Surface {
    fn from(mesh: Mesh) -> Self {
        Self { mesh: Arc::new(mesh) }
    }
}

/// The name of an attribute, its values, and the value of every corner.
type Table<'py> = (String, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// What a mesh holds beside positions and triangles: attributes; and groups and polygons as JSON.
pub(crate) type Parts<'py> = (Vec<Table<'py>>, String, String);

/// A mesh from arrays; with `sizes`, of polygons whose corners are listed one after the other.
pub(crate) fn read_mesh(
    vertices: &Bound<'_, PyAny>,
    faces: &Bound<'_, PyAny>,
    sizes: Option<Vec<u32>>,
) -> PyResult<Mesh> {
    let positions = arrays::positions(vertices)?;
    let polygons = |positions: Vec<[f64; 3]>, corners: &[u32], sizes: &[u32]| {
        Mesh::from_polygons(positions, corners, sizes)
            .map_err(|error| failures::exception(&Error::from(error)))
    };
    if let Some(sizes) = sizes {
        let corners = faces.cast::<PyArray1<i64>>()?;
        let corners = arrays::ragged(corners, &sizes, positions.len())?;
        return polygons(positions, &corners, &sizes);
    }
    if let Some(triangles) = arrays::triangles(faces, positions.len())? {
        return Ok(Mesh::new(positions, triangles));
    }
    let (corners, columns) = arrays::faces(faces, positions.len())?;
    match columns {
        3 => Ok(Mesh::new(positions, corners.as_chunks::<3>().0.to_vec())),
        0..3 => Err(failures::shape("faces", &[corners.len() / columns.max(1), columns])),
        _ => {
            let sizes = vec![columns as u32; corners.len() / columns];
            polygons(positions, &corners, &sizes)
        }
    }
}

/// What [`Surface::of_parts`] makes a mesh of.
pub(crate) fn parts<'py>(py: Python<'py>, mesh: &Mesh) -> PyResult<Parts<'py>> {
    let table = |attribute: &Attribute| -> PyResult<Table<'py>> {
        let values = PyArray1::from_slice(py, &attribute.values);
        let corners = PyArray1::from_slice(py, &attribute.of_corner);
        Ok((
            attribute.name.clone(),
            values.reshape([attribute.len(), attribute.components])?,
            corners.reshape([attribute.of_corner.len() / 3, 3])?,
        ))
    };
    let json = |value: Result<String, serde_json::Error>| value.unwrap_or_default();
    Ok((
        mesh.attributes.iter().map(table).collect::<PyResult<_>>()?,
        json(serde_json::to_string(&mesh.groups)),
        json(serde_json::to_string(&mesh.polygons)),
    ))
}

#[pymethods]
impl Surface {
    /// A mesh from arrays.
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, sizes=None))]
    fn of_arrays(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        sizes: Option<Vec<u32>>,
    ) -> PyResult<Self> {
        Ok(read_mesh(vertices, faces, sizes)?.into())
    }

    /// A mesh from all that it holds.
    #[staticmethod]
    fn of_parts(
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyArray2<u32>>,
        parts: Parts<'_>,
    ) -> PyResult<Self> {
        let (tables, groups, polygons) = parts;
        let mut mesh = Mesh::new(
            arrays::positions(positions)?,
            triangles.try_readonly()?.to_vec()?.as_chunks::<3>().0.to_vec(),
        );
        for (name, values, corners) in tables {
            mesh.attributes.push(attribute(name, &values, &corners)?);
        }
        let wrong = |error: serde_json::Error| failures::argument(&format!("a damaged pickle: {error}"));
        mesh.groups = serde_json::from_str(&groups).map_err(wrong)?;
        mesh.polygons = serde_json::from_str(&polygons).map_err(wrong)?;
        Ok(mesh.into())
    }

    /// The same with an attribute more, or with another one in place of that of its name.
    fn with_attribute(
        &self,
        name: String,
        values: &Bound<'_, PyArray2<f64>>,
        corners: &Bound<'_, PyArray2<u32>>,
    ) -> PyResult<Self> {
        let mut mesh = (*self.mesh).clone();
        mesh.set_attribute(attribute(name, values, corners)?);
        Ok(mesh.into())
    }

    /// The same with groups of triangles: their names, and for every triangle the number of one.
    fn with_groups(&self, names: Vec<String>, of_triangle: Vec<u32>) -> Self {
        let mut mesh = (*self.mesh).clone();
        let group = |name| trisect::FaceGroup { name, material: None };
        mesh.groups.list = names.into_iter().map(group).collect();
        mesh.groups.of_triangle = of_triangle;
        mesh.into()
    }

    /// A table of the mesh, for `numpy.asarray`.
    #[pyo3(signature = (name, attribute=0))]
    fn view(&self, name: &str, attribute: usize) -> PyResult<View> {
        View::new(Owner::from(self), name, attribute)
    }

    /// The names of the attributes, in order.
    fn attributes(&self) -> Vec<String> {
        self.mesh.attributes.iter().map(|attribute| attribute.name.clone()).collect()
    }

    /// The groups as JSON.
    fn groups(&self) -> String {
        serde_json::to_string(&self.mesh.groups.list).unwrap_or_default()
    }

    /// Vertices, triangles.
    fn counts(&self) -> (usize, usize) {
        (self.mesh.positions.len(), self.mesh.triangles.len())
    }

    /// The area of the surface.
    fn area(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.mesh.area())
    }

    /// What is wrong with it, as JSON, and in words.
    #[pyo3(signature = (settings=None))]
    fn diagnosis(&self, py: Python<'_>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<(String, String)> {
        limits(settings)?.run(py, self.mesh.triangles.len(), |control| {
            control.check()?;
            let found = diagnose(&self.mesh);
            control.check()?;
            Ok((serde_json::to_string(&found).unwrap_or_default(), found.to_string()))
        })
    }

    /// Moved to another place; see [`places::moved`].
    fn moved(&self, py: Python<'_>, how: &str, numbers: Vec<f64>) -> PyResult<Self> {
        let mesh = Arc::clone(&self.mesh);
        let moved = py.detach(|| places::moved((*mesh).clone(), how, &numbers));
        Ok(moved.map_err(|error| failures::exception(&error))?.into())
    }

    /// With vertices of open edges joined, also where that does not close it, and with faces turned outwards.
    #[pyo3(signature = (weld=None, orient=false))]
    fn joined(&self, py: Python<'_>, weld: Option<&Bound<'_, PyAny>>, orient: bool) -> PyResult<Self> {
        let weld = weld.map(welding);
        let mesh = (*self.mesh).clone();
        let joined = py.detach(|| {
            let mesh = weld.map_or(Ok(mesh.clone()), |weld| welded(mesh, weld))?;
            Ok(if orient { mesh.oriented() } else { mesh })
        });
        Ok(joined.map_err(|error: Error| failures::exception(&error))?.into())
    }

    /// The surface of each group that has triangles, with its number; the whole if there are no groups.
    fn by_group(&self, py: Python<'_>) -> Vec<(u32, Self)> {
        let groups = py.detach(|| self.mesh.by_group());
        groups.into_iter().map(|(group, mesh)| (group, mesh.into())).collect()
    }

    /// All that the mesh holds.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        parts(py, &self.mesh)
    }
}

/// What `weld` means: a distance, or "auto".
pub(crate) fn welding(value: &Bound<'_, PyAny>) -> Welding {
    value.extract::<f64>().map_or(Welding::Closing, Welding::Within)
}

/// As the program joins the vertices of surfaces that may stay open: so that they close it; if nothing does, by the distance
/// all the same.
fn welded(mesh: Mesh, weld: Welding) -> Result<Mesh, Error> {
    let refusal = match Gate::new().weld(weld).solid(mesh) {
        Ok(solid) => return Ok(solid.into_mesh()),
        Err(refusal) => refusal,
    };
    match (weld, &refusal.error) {
        (Welding::Within(distance), MeshError::NotClosed(_) | MeshError::InsideOut { .. }) => {
            Ok(refusal.mesh.welded(distance)?)
        }
        (_, MeshError::NotClosed(_) | MeshError::InsideOut { .. }) => Ok(refusal.mesh),
        _ => Err(refusal.error.into()),
    }
}

fn attribute(
    name: String,
    values: &Bound<'_, PyArray2<f64>>,
    corners: &Bound<'_, PyArray2<u32>>,
) -> PyResult<Attribute> {
    let values = values.try_readonly()?;
    let mut attribute = Attribute::new(name, values.as_array().ncols());
    attribute.values = values.as_array().iter().copied().collect();
    attribute.of_corner = corners.try_readonly()?.as_array().iter().copied().collect();
    Ok(attribute)
}

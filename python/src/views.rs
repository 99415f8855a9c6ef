//! Arrays that leave: read-only views of memory that a solid owns, without a copy.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::meshes::Surface;
use crate::solids::Made;
use trisect::Mesh;

/// Who owns the memory.
#[derive(Clone)]
pub(crate) enum Owner {
    /// A solid.
    Solid(Arc<Made>),
    /// A mesh.
    Mesh(Arc<Mesh>),
}

impl Owner {
    fn mesh(&self) -> &Mesh {
        match self {
            Self::Solid(made) => made.solid().mesh(),
            Self::Mesh(mesh) => mesh,
        }
    }
}

/// What of the mesh is shown.
#[derive(Clone, Copy)]
enum Table {
    Positions,
    Triangles,
    Values(usize),
    Corners(usize),
    Groups,
}

/// A table of a mesh, for NumPy: `numpy.asarray(view)` shows its memory, keeps the view alive and cannot write to it.
#[pyclass(frozen, module = "trisect._trisect")]
pub(crate) struct View {
    owner: Owner,
    table: Table,
}

impl View {
    /// The view called so, of the attribute of that number where it is one of an attribute.
    pub(crate) fn new(owner: Owner, name: &str, attribute: usize) -> PyResult<Self> {
        let mesh = owner.mesh();
        let known = attribute < mesh.attributes.len();
        let table = match name {
            "vertices" => Table::Positions,
            "faces" => Table::Triangles,
            "groups" => Table::Groups,
            "values" if known => Table::Values(attribute),
            "corners" if known => Table::Corners(attribute),
            _ => return Err(pyo3::exceptions::PyKeyError::new_err(name.to_owned())),
        };
        Ok(Self { owner, table })
    }

    /// Where the table is, what its numbers are, and its shape.
    fn place(&self) -> (usize, &'static str, [usize; 2]) {
        // (Its address is what NumPy's array interface wants; a table is never changed while a view of it is there, since a
        // view owns a share of it and what it owns is never written to.)
        let mesh = self.owner.mesh();
        match self.table {
            Table::Positions => (mesh.positions.as_ptr().addr(), "<f8", [mesh.positions.len(), 3]),
            Table::Triangles => (mesh.triangles.as_ptr().addr(), "<u4", [mesh.triangles.len(), 3]),
            Table::Groups => {
                (mesh.groups.of_triangle.as_ptr().addr(), "<u4", [mesh.groups.of_triangle.len(), 1])
            }
            Table::Values(number) => {
                let attribute = &mesh.attributes[number];
                let shape = [attribute.len(), attribute.components];
                (attribute.values.as_ptr().addr(), "<f8", shape)
            }
            Table::Corners(number) => {
                let corners = &mesh.attributes[number].of_corner;
                (corners.as_ptr().addr(), "<u4", [corners.len() / 3, 3])
            }
        }
    }
}

#[pymethods]
impl View {
    /// What NumPy asks for.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (address, numbers, shape) = self.place();
        let dict = PyDict::new(py);
        dict.set_item("version", 3)?;
        dict.set_item("shape", (shape[0], shape[1]))?;
        dict.set_item("typestr", numbers)?;
        dict.set_item("data", (address, true))?;
        Ok(dict)
    }
}

impl From<&Surface> for Owner {
    fn from(surface: &Surface) -> Self {
        Self::Mesh(Arc::clone(&surface.mesh))
    }
}

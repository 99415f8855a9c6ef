//! Cages as leaves of model files: solids within a tolerance of their limit surface.

use std::path::Path;

use glam::{DAffine3, DVec3};
use serde_json::{Map, Value};

use super::fault;
use crate::subdivision::{ControlMesh, Rules, json};
use crate::{Error, FileAction, Mesh};

/// Default tolerance, in units of the cage's diagonal.
const DEFAULT_TOLERANCE: f64 = 1e-3;

/// A cage in a model.
#[derive(Clone, Debug)]
pub(super) struct Cage(pub(super) ControlMesh);

impl Cage {
    /// From a node's keys: `file`, or those of a cage file itself.
    pub(super) fn of_node(mut object: Map<String, Value>, folder: &Path) -> Result<Self, Error> {
        let Some(file) = object.remove("file") else {
            return json::from_value(&Value::Object(object)).map(Self);
        };
        let file = file.as_str().ok_or_else(|| fault("`file` is the name of a cage: *.obj or *.json"))?;
        if let Some(key) = object.keys().next() {
            return Err(fault(format!("unknown key `{key}` beside `file` for the kind `freeform`")));
        }
        let path = folder.join(file);
        let bytes = std::fs::read(&path).map_err(|source| Error::File {
            action: FileAction::Read,
            path: path.clone(),
            source,
        })?;
        let is_json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        let cage = if is_json {
            ControlMesh::from_json(&bytes)
        } else {
            ControlMesh::from_obj(&bytes, Rules::default()).map(|(cage, _)| cage)
        };
        cage.map(Self).map_err(|error| fault(format!("{}: {error}", path.display())))
    }

    /// The limit surface's closed mesh within `tolerance`, or a thousandth of the cage's diagonal.
    pub(super) fn mesh(&self, tolerance: Option<f64>) -> Result<Mesh, Error> {
        let tolerance = tolerance.unwrap_or_else(|| DEFAULT_TOLERANCE * self.diagonal());
        let fine = self.0.limit_mesh(tolerance)?;
        Ok(fine.solid().mesh().clone())
    }

    fn diagonal(&self) -> f64 {
        self.0.mesh().bounds().map_or(1.0, |bounds| DVec3::from(bounds.low).distance(bounds.high.into()))
    }

    /// The cage, moved. A reflection turns its faces over.
    pub(super) fn moved(&self, transform: DAffine3) -> Result<Self, Error> {
        let positions =
            self.0.positions().iter().map(|&p| transform.transform_point3(p.into()).to_array()).collect();
        let mut faces = self.0.faces().to_vec();
        if transform.matrix3.determinant() < 0.0 {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        ControlMesh::new(positions, faces, self.0.tags().clone(), self.0.rules()).map(Self)
    }
}

//! Cages as leaves of model files: solids within a tolerance of their limit surface.

use std::path::Path;

use glam::{DAffine3, DVec3};
use serde_json::{Map, Value};

use super::fault;
use crate::subdivision::{self, ControlMesh, Rules, json};
use crate::{Error, FileAction, Mesh};

/// Default tolerance, in units of the cage's diagonal.
const DEFAULT_TOLERANCE: f64 = 1e-3;

/// A cage in a model.
#[derive(Clone, Debug)]
pub(super) struct Cage(pub(super) subdivision::Cage);

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
            subdivision::Cage::from_json(&bytes)
        } else {
            subdivision::Cage::from_obj(&bytes, Rules::default(), None).map(|(cage, _)| cage)
        };
        cage.map(Self).map_err(|error| fault(format!("{}: {error}", path.display())))
    }

    /// The limit surface's closed mesh within `tolerance`, or a thousandth of the cage's diagonal.
    pub(super) fn mesh(&self, tolerance: Option<f64>) -> Result<Mesh, Error> {
        self.0.limit_mesh(tolerance.unwrap_or_else(|| self.default_tolerance()))
    }

    /// The cage as one of triangles for operations that give cages; and what is to be said of it.
    pub(super) fn of_triangles(
        &self,
        tolerance: Option<f64>,
    ) -> Result<(ControlMesh, Option<String>), Error> {
        // Half of what the operation may be off by.
        let tolerance = 0.5 * tolerance.unwrap_or_else(|| self.default_tolerance());
        let (cage, distance) = self.0.to_loop(tolerance)?;
        let warning = (self.0.scheme() == subdivision::Scheme::CatmullClark).then(|| {
            format!(
                "a cage of polygons became one of {} triangles, whose surface is within {distance:.3e} of it",
                cage.faces().len()
            )
        });
        Ok((cage, warning))
    }

    fn default_tolerance(&self) -> f64 {
        let mut low = DVec3::INFINITY;
        let mut high = DVec3::NEG_INFINITY;
        for &p in self.0.positions() {
            (low, high) = (low.min(p.into()), high.max(p.into()));
        }
        let diagonal = low.distance(high);
        if diagonal.is_finite() { DEFAULT_TOLERANCE * diagonal } else { DEFAULT_TOLERANCE }
    }

    /// The cage, moved. A reflection turns its faces over.
    pub(super) fn moved(&self, transform: DAffine3) -> Result<Self, Error> {
        if transform == DAffine3::IDENTITY {
            return Ok(self.clone());
        }
        let points = |positions: &[[f64; 3]]| {
            Ok(positions.iter().map(|&p| transform.transform_point3(p.into()).to_array()).collect())
        };
        let turn = transform.matrix3;
        let is_rigid = (turn * turn.transpose()).abs_diff_eq(glam::DMat3::IDENTITY, 1e-14);
        let reflects = turn.determinant() < 0.0;
        self.0.moved(points, reflects, is_rigid && !reflects).map(Self)
    }
}

//! Nodes as meshes: leaves meshed, operations by the exact booleans, functions extracted.

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::ExtractionReport;
use super::state::State;
use crate::boolean::BooleanOptions;
use crate::field::{Extracted, Extraction, extrude};
use crate::io::ReadOptions;
use crate::model::{Kind, Mode};
use crate::{Error, Mesh, MeshError, Solid};

impl State<'_> {
    /// The node as a mesh: by the exact booleans where it is an operation.
    pub(super) fn exact(&mut self, node: usize) -> Result<Arc<Solid>, Error> {
        if let Some(solid) = self.solids.get(&node) {
            return Ok(Arc::clone(solid));
        }
        let solid = Arc::new(self.make_exact(node)?);
        self.solids.insert(node, Arc::clone(&solid));
        Ok(solid)
    }

    fn make_exact(&mut self, node: usize) -> Result<Solid, Error> {
        let control = &self.settings.control;
        control.check()?;
        let at = &self.model.nodes[node];
        let label = self.label(node);
        let mesh = if at.extrude.is_some() {
            let contours = self.region(node)?;
            let [low, high] = at.extrude.unwrap_or_default();
            extrude(&contours, low, high).map_err(|error| error.in_node(label))?
        } else {
            match &at.kind {
                #[cfg(feature = "subdivision")]
                Kind::Operation(..) if at.mode == Some(Mode::FreeForm) => self.free_form(node)?,
                Kind::Operation(operation, operands) => {
                    let solids = operands
                        .iter()
                        .map(|&operand| self.operand_solid(operand))
                        .collect::<Result<Vec<Arc<Solid>>, Error>>()?;
                    let options = BooleanOptions::new().control(control.clone());
                    let outcome = options.run(*operation, solids.iter().map(Arc::as_ref));
                    let outcome = outcome.map_err(|error| error.in_node(label))?;
                    outcome.into_solid().mesh().clone()
                }
                Kind::Complement(_) => {
                    let what = "a complement is unbounded and has no mesh: use `difference`, or evaluate it as a field";
                    return Err(Error::Model(what.into()).in_node(label));
                }
                Kind::Reference(_, target) => (*self.operand_solid(*target)?).mesh().clone(),
                Kind::Mesh(file) => {
                    self.loaded(&self.model.folder.join(file)).map_err(|error| error.in_node(label))?
                }
                Kind::Primitive(primitive) => {
                    let tolerance = self.tolerance(node, primitive.diagonal());
                    primitive.mesh(tolerance).map_err(|error| error.in_node(label))?
                }
                Kind::Formula { .. } | Kind::Contour(_) => {
                    // Transformed already.
                    return self.extracted(node);
                }
                Kind::Parametric(solid) => {
                    let mesh = solid.mesh(self.given_tolerance(node), control);
                    mesh.map_err(|error| error.in_node(label))?
                }
                #[cfg(feature = "subdivision")]
                Kind::Cage(cage) => self.limit_mesh(node, cage)?,
                #[cfg(not(feature = "subdivision"))]
                Kind::Cage(none) => match **none {},
                Kind::Custom { kind, value } => {
                    let Some(handler) = self.settings.kinds.get(kind) else {
                        let what = format!("nodes of the kind `{kind}` cannot be evaluated here");
                        return Err(Error::Model(what).in_node(label));
                    };
                    let tolerance = self.given_tolerance(node);
                    handler
                        .mesh(value, tolerance, &self.model.folder, control)
                        .map_err(|error| error.in_node(label))?
                }
            }
        };
        let solid = moved(mesh, at.transform).and_then(Solid::try_from);
        let solid = solid.map_err(|error| Error::from(error).in_node(label))?;
        for (one, several, fault) in solid.mending().left_out() {
            self.warnings.push(format!("{label}: {}", fault.text(one, several, 2)));
        }
        Ok(solid)
    }

    fn loaded(&mut self, path: &Path) -> Result<Mesh, Error> {
        if let Some(loader) = &self.settings.loader {
            return loader(path);
        }
        let options = ReadOptions::new().control(self.settings.control.clone());
        let loaded = crate::io::load(path, &options)?;
        let named = loaded.warnings.into_iter().map(|warning| format!("{}: {warning}", path.display()));
        self.warnings.extend(named);
        Ok(loaded.mesh)
    }

    /// The operand of an exact operation: exact itself, unless it says otherwise.
    fn operand_solid(&mut self, node: usize) -> Result<Arc<Solid>, Error> {
        match self.mode(node, Some(Mode::Exact)) {
            Mode::Exact | Mode::FreeForm => self.exact(node),
            Mode::Field => self.meshed(node),
        }
    }

    /// The node as a mesh, through its field (or its contours, if it is extruded).
    pub(super) fn meshed(&mut self, node: usize) -> Result<Arc<Solid>, Error> {
        if self.model.nodes[node].extrude.is_some() {
            return self.exact(node);
        }
        Ok(Arc::new(self.extracted(node)?))
    }

    fn extracted(&mut self, node: usize) -> Result<Solid, Error> {
        let label = self.label(node);
        let field = self.expression(node)?;
        let control = &self.settings.control;
        let given = self.model.nodes[node].bounds.or(self.model.defaults.bounds);
        let bounds = match given {
            Some(bounds) => Some(bounds),
            None => field.positive_bounds(None, control).map_err(|error| error.in_node(label))?,
        };
        let Some([low, high]) = bounds else { return Ok(Solid::empty()) };
        let diagonal = DVec3::from_array(low).distance(DVec3::from_array(high));
        let tolerance = self.tolerance(node, diagonal);
        let Extracted { mesh, cells, divided_cells, deviation, .. } = Extraction::new(low, high, tolerance)
            .clip(self.model.nodes[node].clip)
            .control(control.clone())
            .run(&field)
            .map_err(|error| error.in_node(label))?;
        self.last = Some(ExtractionReport { tolerance, deviation, cells, divided_cells });
        Solid::try_from(mesh).map_err(|error| Error::from(error).in_node(label))
    }
}

/// The mesh transformed, still facing outward.
fn moved(mesh: Mesh, transform: DAffine3) -> Result<Mesh, MeshError> {
    if transform == DAffine3::IDENTITY {
        return Ok(mesh);
    }
    let (map, shift) = (transform.matrix3, transform.translation);
    let rows: [[f64; 4]; 3] =
        std::array::from_fn(|k| [map.x_axis[k], map.y_axis[k], map.z_axis[k], shift[k]]);
    mesh.transformed(rows.as_flattened())
}

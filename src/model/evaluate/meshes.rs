//! Nodes as meshes: leaves meshed, operations by the exact booleans, functions extracted.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::ExtractionReport;
use super::state::State;
use crate::boolean::{Expression, Leaf, Operation};
use crate::exact::Plane;
use crate::field::{Extracted, Extraction, extrude};
use crate::io::ReadOptions;
use crate::model::made::Meshing;
use crate::model::{Kind, Made, Mode};
use crate::{Error, Mesh, MeshError, Solid};

/// A leaf of a tree of operations.
enum NodeLeaf {
    Solid(Arc<Solid>),
    Below(Plane),
}

impl NodeLeaf {
    fn leaf(&self) -> Leaf<'_> {
        match self {
            Self::Solid(solid) => Leaf::Solid(solid),
            Self::Below(plane) => Leaf::Below(*plane),
        }
    }
}

/// The leaves of a tree of operations, each once.
#[derive(Default)]
struct Leaves {
    list: Vec<NodeLeaf>,
    /// By node.
    places: BTreeMap<usize, usize>,
    /// Operations met so far.
    operations: usize,
}

/// Operations in one expression at most: a model that names a node again and again may stand for a tree that grows without
/// bound. What is left is evaluated by itself first.
const MOST_OPERATIONS: usize = 4096;

/// What to do with half-spaces, which have no end.
const INSTEAD_OF_HALF_SPACES: &str = "use it in an `intersection`, take it off in a `difference`";

/// The error of a node that has no end, and what to do with it instead.
fn unbounded(what: &str, instead: &str) -> Error {
    Error::Model(format!("{what} is unbounded and has no mesh: {instead}, or evaluate it as a field"))
}

/// The error of a kind of nodes that the program at hand does not know.
fn unknown(kind: &str) -> Error {
    Error::Model(format!("nodes of the kind `{kind}` cannot be evaluated here"))
}

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
        let within = |error: Error| error.in_node(label);
        let mesh = if let Some([low, high]) = at.extrude {
            let contours = self.region(node)?;
            extrude(&contours, low, high).map_err(within)?
        } else {
            match &at.kind {
                #[cfg(feature = "subdivision")]
                Kind::Operation(..) if at.mode == Some(Mode::FreeForm) => self.free_form(node)?,
                Kind::Operation(operation, operands) => {
                    let (operation, operands) = (*operation, operands.clone());
                    self.of_tree(operation, &operands, label)?
                }
                Kind::Complement(_) => {
                    return Err(unbounded("a complement", "use `difference`").in_node(label));
                }
                Kind::HalfSpace(_) => {
                    return Err(unbounded("a half-space", INSTEAD_OF_HALF_SPACES).in_node(label));
                }
                Kind::Reference(_, target) => (*self.operand_solid(*target)?).mesh().clone(),
                Kind::Mesh(file) => self.mesh_file(node, file)?,
                Kind::Primitive(primitive) => {
                    let tolerance = self.tolerance(node, primitive.diagonal());
                    primitive.mesh(tolerance).map_err(within)?
                }
                // (Transformed already.)
                Kind::Formula { .. } | Kind::Contour(_) => return self.extracted(node),
                Kind::Parametric(solid) => solid.mesh(self.given_tolerance(node), control).map_err(within)?,
                Kind::Made(made, operands) => self.made(node, made, operands)?,
                Kind::Cut(cut, operands) => self.cut(node, cut, operands)?,
                #[cfg(feature = "subdivision")]
                Kind::Cage(cage) => self.limit_mesh(node, cage)?,
                #[cfg(not(feature = "subdivision"))]
                Kind::Cage(none) => match **none {},
                Kind::Custom { kind, value } => {
                    let Some(handler) = self.settings.kinds.get(kind) else {
                        return Err(unknown(kind).in_node(label));
                    };
                    let tolerance = self.given_tolerance(node);
                    handler.mesh(value, tolerance, &self.model.folder, control).map_err(within)?
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

    /// A hull, a sum, a pattern or text, of nodes that are meshed first.
    fn made(&mut self, node: usize, made: &Made, operands: &[usize]) -> Result<Mesh, Error> {
        let solids: Vec<Arc<Solid>> =
            operands.iter().map(|&operand| self.solid_of(operand)).collect::<Result<_, Error>>()?;
        let solids: Vec<&Solid> = solids.iter().map(Arc::as_ref).collect();
        let (tolerance, smooth) = (self.given_tolerance(node), self.is_smooth(node));
        made.mesh(&solids, Meshing { tolerance, smooth }, &self.model.folder, &self.settings.control)
            .map_err(|error| error.in_node(self.label(node)))
    }

    /// An operand of something that is made of meshes.
    pub(super) fn solid_of(&mut self, operand: usize) -> Result<Arc<Solid>, Error> {
        match self.mode(operand, None) {
            Mode::Field => self.meshed(operand),
            Mode::Exact | Mode::FreeForm => self.exact(operand),
        }
    }

    /// What an exact operation gives.
    fn of_tree(&mut self, operation: Operation, operands: &[usize], label: &str) -> Result<Mesh, Error> {
        let mut leaves = Leaves::default();
        let expression = self.operation(operation, operands, &mut leaves)?;
        let options = self.boolean_options();
        let list: Vec<Leaf<'_>> = leaves.list.iter().map(NodeLeaf::leaf).collect();
        let outcome = options.evaluate_leaves(&expression, &list);
        Ok(outcome.map_err(|error| error.in_node(label))?.into_solid().into_mesh())
    }

    /// The plane of a node that is a half-space.
    fn half_space(&self, node: usize) -> Result<Option<Plane>, Error> {
        let mut at = &self.model.nodes[node];
        let mut is_moved = at.transform != DAffine3::IDENTITY;
        // (Names do not lead round in a circle: that is checked when a model is read.)
        while let Kind::Reference(_, target) = &at.kind {
            at = &self.model.nodes[*target];
            is_moved |= at.transform != DAffine3::IDENTITY;
        }
        match &at.kind {
            Kind::HalfSpace(_) if is_moved => {
                let what =
                    "a half-space is not moved, so that its plane stays exact: give the plane where it is";
                Err(Error::Model(what.into()).in_node(self.label(node)))
            }
            Kind::HalfSpace(half_space) => Ok(Some(half_space.plane)),
            _ => Ok(None),
        }
    }

    /// A whole tree of exact operations as one expression of its leaves: nothing is rounded in between.
    fn operation(
        &mut self,
        operation: Operation,
        operands: &[usize],
        leaves: &mut Leaves,
    ) -> Result<Expression, Error> {
        let sets = operands.iter().map(|&operand| self.set(operand, leaves));
        let sets = sets.collect::<Result<Vec<Expression>, Error>>()?;
        Ok(match operation {
            Operation::Union => Expression::Union(sets),
            Operation::Intersection => Expression::Intersection(sets),
            Operation::Difference => Expression::Difference(sets),
            Operation::SymmetricDifference => Expression::SymmetricDifference(sets),
        })
    }

    /// An operand of an operation: an operation of its own, unless it is moved or meshed first, else a leaf.
    fn set(&mut self, node: usize, leaves: &mut Leaves) -> Result<Expression, Error> {
        let plane = self.half_space(node)?;
        let at = &self.model.nodes[node];
        leaves.operations += 1;
        let is_plain = at.extrude.is_none()
            && at.transform == DAffine3::IDENTITY
            && leaves.operations <= MOST_OPERATIONS;
        if plane.is_none() && is_plain && self.mode(node, Some(Mode::Exact)) == Mode::Exact {
            match &at.kind {
                Kind::Operation(operation, operands) => {
                    let (operation, operands) = (*operation, operands.clone());
                    return self.operation(operation, &operands, leaves);
                }
                Kind::Reference(_, target) => {
                    let target = *target;
                    return self.set(target, leaves);
                }
                _ => {}
            }
        }
        if let Some(&place) = leaves.places.get(&node) {
            return Ok(Expression::Operand(place));
        }
        let leaf = match plane {
            Some(plane) => NodeLeaf::Below(plane),
            None => NodeLeaf::Solid(self.operand_solid(node)?),
        };
        leaves.list.push(leaf);
        leaves.places.insert(node, leaves.list.len() - 1);
        Ok(Expression::Operand(leaves.list.len() - 1))
    }

    pub(super) fn loaded(&mut self, path: &Path) -> Result<Mesh, Error> {
        if let Some(loader) = &self.settings.loader {
            return loader(path);
        }
        let options = ReadOptions::new().control(self.settings.control.clone());
        let loaded = crate::io::load(path, &options)?;
        let lost = loaded.contents.not_kept();
        let named =
            loaded.warnings.into_iter().chain(lost).map(|warning| format!("{}: {warning}", path.display()));
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
        let Extracted { mesh, cells, divided_cells, deviation, normal_deviation, .. } =
            Extraction::new(low, high, tolerance)
                .clip(self.model.nodes[node].clip)
                .smooth(self.is_smooth(node))
                .control(control.clone())
                .run(&field)
                .map_err(|error| error.in_node(label))?;
        self.last = Some(ExtractionReport { tolerance, deviation, normal_deviation, cells, divided_cells });
        Solid::try_from(mesh).map_err(|error| Error::from(error).in_node(label))
    }
}

/// The mesh transformed, still facing outward.
pub(super) fn moved(mesh: Mesh, transform: DAffine3) -> Result<Mesh, MeshError> {
    if transform == DAffine3::IDENTITY {
        return Ok(mesh);
    }
    let (map, shift) = (transform.matrix3, transform.translation);
    let rows: [[f64; 4]; 3] =
        std::array::from_fn(|k| [map.x_axis[k], map.y_axis[k], map.z_axis[k], shift[k]]);
    mesh.transformed(rows.as_flattened())
}

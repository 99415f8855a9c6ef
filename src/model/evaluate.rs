//! Evaluation of a model: exactly on meshes, or as functions with one extraction.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use rustc_hash::FxHashMap;

use super::{Kind, Mode, Model};
use crate::boolean::Operation;
use crate::field::{
    ContourDistance, ContourExtraction, Contours, Expression, Extracted, Extraction, Graph, NodeId,
    SignedDistance, System, extrude,
};
use crate::{Control, Error, Mesh, Solid};

/// Evaluates leaves of a kind that models may name but that is defined elsewhere, such as parametric patches.
pub trait LeafKind: Send + Sync {
    /// The closed mesh that the node's own keys (`value`, an object) describe, within `tolerance` of the true surface;
    /// file names in it start at `folder`.
    ///
    /// # Errors
    /// What is wrong with the description.
    fn mesh(&self, value: &serde_json::Value, tolerance: f64, folder: &Path) -> Result<Mesh, Error>;
}

/// Reads a mesh file.
type Loader = dyn Fn(&Path) -> Result<Mesh, Error> + Send + Sync;

/// Settings of an evaluation.
#[derive(Clone)]
pub struct Evaluation {
    tolerance: Option<f64>,
    control: Control,
    kinds: BTreeMap<String, Arc<dyn LeafKind>>,
    loader: Arc<Loader>,
}

impl Default for Evaluation {
    fn default() -> Self {
        Self::new()
    }
}

/// What a model evaluates to.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// The closed surface; empty if the solid is.
    pub mesh: Mesh,
    /// What the last extraction reports, if the result is one.
    pub extraction: Option<ExtractionReport>,
}

/// See [`Extracted`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtractionReport {
    /// The tolerance used.
    pub tolerance: f64,
    /// The largest deviation found.
    pub deviation: f64,
    /// Cubes that the surface was sought in.
    pub cells: usize,
    /// Cubes with several pieces of surface at the finest level.
    pub divided_cells: usize,
}

impl Evaluation {
    /// Default settings: the model's own tolerance, or a thousandth of the diagonal of what is meshed.
    #[must_use]
    pub fn new() -> Self {
        let loader = |path: &Path| super::load::mesh(path);
        Self {
            tolerance: None,
            control: Control::default(),
            kinds: BTreeMap::new(),
            loader: Arc::new(loader),
        }
    }

    /// Meshes within `tolerance`, whatever the model says.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = Some(tolerance);
        self
    }

    /// Limits and progress.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// Evaluates leaves of the kind `name` by `kind`.
    #[must_use]
    pub fn leaf_kind(mut self, name: &str, kind: Arc<dyn LeafKind>) -> Self {
        self.kinds.insert(name.to_owned(), kind);
        self
    }

    /// Reads mesh files by `loader` instead of by their format.
    #[must_use]
    pub fn loader(mut self, loader: impl Fn(&Path) -> Result<Mesh, Error> + Send + Sync + 'static) -> Self {
        self.loader = Arc::new(loader);
        self
    }

    /// The model's result as a closed mesh.
    ///
    /// # Errors
    /// What is wrong, in [`Error::InNode`] with the node at fault.
    pub fn run(&self, model: &Model) -> Result<Evaluated, Error> {
        let mut state = State::new(self, model);
        let mode = state.mode(model.result, None);
        if mode == Mode::Exact {
            let solid = state.exact(model.result)?;
            return Ok(Evaluated { mesh: solid.mesh().clone(), extraction: state.last });
        }
        let solid = state.meshed(model.result)?;
        Ok(Evaluated { mesh: solid.mesh().clone(), extraction: state.last })
    }

    /// The model's result as a function, positive inside.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn field(&self, model: &Model) -> Result<Expression, Error> {
        let mut state = State::new(self, model);
        let root = state.field(model.result)?;
        Ok(Expression::new(state.graph, root))
    }

    /// The boundary of the result in the plane z = `height`; for a model that is extruded as a whole, of the region
    /// that is.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn contours(&self, model: &Model, height: f64) -> Result<Contours, Error> {
        let mut state = State::new(self, model);
        if model.nodes[model.result].extrude.is_some() {
            return state.region(model.result);
        }
        let root = state.field(model.result)?;
        let field = Expression::new(state.graph.clone(), root);
        state.contours_of(model.result, &field, height)
    }

    /// A box round the model's result.
    ///
    /// # Errors
    /// As [`run`](Self::run), and [`Error::Field`] if the result is unbounded.
    pub fn bounds(&self, model: &Model) -> Result<Option<[[f64; 3]; 2]>, Error> {
        let given = model.nodes[model.result].bounds.or(model.defaults.bounds);
        match given {
            Some(bounds) => Ok(Some(bounds)),
            None => self.field(model)?.positive_bounds(None, &self.control),
        }
    }
}

/// An evaluation under way. Every node is evaluated at most once each way.
struct State<'a> {
    settings: &'a Evaluation,
    model: &'a Model,
    graph: Graph,
    fields: FxHashMap<usize, NodeId>,
    solids: FxHashMap<usize, Arc<Solid>>,
    last: Option<ExtractionReport>,
}

impl<'a> State<'a> {
    fn new(settings: &'a Evaluation, model: &'a Model) -> Self {
        Self {
            settings,
            model,
            graph: Graph::new(),
            fields: FxHashMap::default(),
            solids: FxHashMap::default(),
            last: None,
        }
    }

    fn label(&self, node: usize) -> &'a str {
        &self.model.nodes[node].label
    }

    /// How a node is evaluated: as it says, or as the operation it is part of, or exactly if it is made of nothing
    /// but meshes, primitives and extrusions.
    fn mode(&self, node: usize, parent: Option<Mode>) -> Mode {
        if let Some(mode) = self.model.nodes[node].mode.or(parent) {
            return mode;
        }
        let mut pending = vec![node];
        let mut seen = vec![false; self.model.nodes.len()];
        while let Some(node) = pending.pop() {
            if std::mem::replace(&mut seen[node], true) {
                continue;
            }
            let at = &self.model.nodes[node];
            match &at.kind {
                Kind::Formula { .. } | Kind::Complement(_) => return Mode::Field,
                Kind::Contour(_) if at.extrude.is_none() => return Mode::Field,
                _ => pending.extend(self.model.operands(node)),
            }
        }
        Mode::Exact
    }

    fn system(&self, node: usize) -> System {
        self.model.nodes[node].system.or(self.model.defaults.system).unwrap_or_default()
    }

    /// The tolerance that meshing a node of the given size keeps.
    fn tolerance(&self, node: usize, size: f64) -> f64 {
        self.given_tolerance(node).unwrap_or(size * 1e-3)
    }

    fn given_tolerance(&self, node: usize) -> Option<f64> {
        self.settings.tolerance.or(self.model.nodes[node].tolerance).or(self.model.defaults.tolerance)
    }

    /// The node as a mesh: by the exact booleans where it is an operation.
    fn exact(&mut self, node: usize) -> Result<Arc<Solid>, Error> {
        if let Some(solid) = self.solids.get(&node) {
            return Ok(Arc::clone(solid));
        }
        let solid = Arc::new(self.make_exact(node)?);
        self.solids.insert(node, Arc::clone(&solid));
        Ok(solid)
    }

    fn make_exact(&mut self, node: usize) -> Result<Solid, Error> {
        self.settings.control.check()?;
        let at = &self.model.nodes[node];
        let label = self.label(node);
        let mesh = if at.extrude.is_some() {
            let contours = self.region(node)?;
            let [low, high] = at.extrude.unwrap_or_default();
            extrude(&contours, low, high).map_err(|error| error.in_node(label))?
        } else {
            match &at.kind {
                Kind::Operation(operation, operands) => {
                    let solids = operands
                        .iter()
                        .map(|&operand| self.operand_solid(operand))
                        .collect::<Result<Vec<Arc<Solid>>, Error>>()?;
                    let solids: Vec<&Solid> = solids.iter().map(AsRef::as_ref).collect();
                    let options = crate::boolean::Options::new().control(self.settings.control.clone());
                    let outcome = options.run(*operation, &solids).map_err(|error| error.in_node(label))?;
                    outcome.into_solid().mesh().clone()
                }
                Kind::Complement(_) => {
                    let what = "a complement is unbounded and has no mesh: use `difference`, or evaluate it as a field";
                    return Err(Error::Model(what.into()).in_node(label));
                }
                Kind::Reference(_, target) => (*self.operand_solid(*target)?).mesh().clone(),
                Kind::Mesh(file) => (self.settings.loader)(&self.model.folder.join(file))
                    .map_err(|error| error.in_node(label))?,
                Kind::Primitive(primitive) => {
                    let rough = bounds_of(&primitive.mesh(f64::INFINITY));
                    primitive.mesh(self.tolerance(node, diagonal(rough)))
                }
                Kind::Formula { .. } | Kind::Contour(_) => {
                    // Transformed already.
                    return self.extracted(node);
                }
                Kind::Custom { kind, value } => {
                    let Some(handler) = self.settings.kinds.get(kind) else {
                        let what = format!("nodes of the kind `{kind}` cannot be evaluated here");
                        return Err(Error::Model(what).in_node(label));
                    };
                    let tolerance =
                        at.tolerance.or(self.settings.tolerance).or(self.model.defaults.tolerance);
                    handler
                        .mesh(value, tolerance.unwrap_or(1e-3), &self.model.folder)
                        .map_err(|error| error.in_node(label))?
                }
            }
        };
        Solid::try_from(moved(mesh, at.transform)).map_err(|error| error.in_node(label))
    }

    /// The operand of an exact operation: exact itself, unless it says otherwise.
    fn operand_solid(&mut self, node: usize) -> Result<Arc<Solid>, Error> {
        match self.mode(node, Some(Mode::Exact)) {
            Mode::Exact => self.exact(node),
            Mode::Field => self.meshed(node),
        }
    }

    /// The node as a mesh, through its field (or its contours, if it is extruded).
    fn meshed(&mut self, node: usize) -> Result<Arc<Solid>, Error> {
        if self.model.nodes[node].extrude.is_some() {
            return self.exact(node);
        }
        Ok(Arc::new(self.extracted(node)?))
    }

    fn extracted(&mut self, node: usize) -> Result<Solid, Error> {
        let label = self.label(node);
        let root = self.field(node)?;
        let field = Expression::new(self.graph.clone(), root);
        let control = &self.settings.control;
        let given = self.model.nodes[node].bounds.or(self.model.defaults.bounds);
        let bounds = match given {
            Some(bounds) => Some(bounds),
            None => field.positive_bounds(None, control).map_err(|error| error.in_node(label))?,
        };
        let Some([low, high]) = bounds else { return Solid::try_from(Mesh::default()) };
        let tolerance = self.tolerance(node, diagonal([low, high]));
        let Extracted { mesh, cells, divided_cells, deviation, .. } = Extraction::new(low, high, tolerance)
            .clip(self.model.nodes[node].clip)
            .control(control.clone())
            .run(&field)
            .map_err(|error| error.in_node(label))?;
        self.last = Some(ExtractionReport { tolerance, deviation, cells, divided_cells });
        Solid::try_from(mesh).map_err(|error| error.in_node(label))
    }

    /// The plane region that an extruded node extrudes.
    fn region(&mut self, node: usize) -> Result<Contours, Error> {
        let at = &self.model.nodes[node];
        if let Kind::Contour(contours) = &at.kind {
            return Ok(contours.clone());
        }
        let root = self.plain_field(node)?;
        let field = Expression::new(self.graph.clone(), root);
        self.contours_of(node, &field, 0.0)
    }

    fn contours_of(&mut self, node: usize, field: &Expression, height: f64) -> Result<Contours, Error> {
        let label = self.label(node);
        let control = &self.settings.control;
        let given = self.model.nodes[node].bounds.or(self.model.defaults.bounds);
        let bounds = match given {
            Some(bounds) => Some(bounds),
            None => field.positive_bounds(Some(height), control).map_err(|error| error.in_node(label))?,
        };
        let Some([[x0, y0, _], [x1, y1, _]]) = bounds else { return Ok(Contours::default()) };
        let tolerance = self.tolerance(node, (x1 - x0).hypot(y1 - y0));
        ContourExtraction::new([x0, y0], [x1, y1], tolerance)
            .height(height)
            .control(control.clone())
            .run(field)
            .map_err(|error| error.in_node(label))
    }

    /// The node as a function.
    fn field(&mut self, node: usize) -> Result<NodeId, Error> {
        if let Some(&known) = self.fields.get(&node) {
            return Ok(known);
        }
        self.settings.control.check()?;
        let at = &self.model.nodes[node];
        let plain = self.plain_field(node)?;
        let mut root = plain;
        if let Some([low, high]) = at.extrude {
            let [_, _, z] = self.graph.axes();
            let (low, high) = (self.graph.constant(low), self.graph.constant(high));
            let (above, below) = (self.graph.sub(z, low), self.graph.sub(high, z));
            let slab = self.graph.and(System::R1, above, below);
            let system = self.system(node);
            root = self.graph.and(system, root, slab);
        }
        // Solids made exactly are in place already.
        if at.transform != DAffine3::IDENTITY && !self.is_exact_leaf(node) {
            let inverse = at.transform.inverse();
            let rows = inverse.matrix3.transpose().to_cols_array_2d();
            root = self.graph.affine(root, rows, inverse.translation.to_array());
            // A uniform scaling keeps distances distances.
            let scale = at.transform.matrix3.determinant().abs().cbrt();
            if (scale - 1.0).abs() > 1e-15 {
                let factor = self.graph.constant(scale);
                root = self.graph.mul(root, factor);
            }
        }
        self.fields.insert(node, root);
        Ok(root)
    }

    /// Whether the node's field is the distance of its mesh, transform and extrusion included.
    fn is_exact_leaf(&self, node: usize) -> bool {
        let at = &self.model.nodes[node];
        match at.kind {
            Kind::Mesh(_) | Kind::Custom { .. } => at.extrude.is_none(),
            Kind::Operation(..) => at.mode == Some(Mode::Exact) && at.extrude.is_none(),
            _ => false,
        }
    }

    /// The node's field before extrusion and transform.
    fn plain_field(&mut self, node: usize) -> Result<NodeId, Error> {
        let label = self.label(node);
        let system = self.system(node);
        let at = &self.model.nodes[node];
        if self.is_exact_leaf(node) {
            let solid = self.exact(node)?;
            return Ok(self.graph.leaf(Arc::new(SignedDistance::new(&solid))));
        }
        match &at.kind {
            Kind::Operation(operation, operands) => {
                let fields = operands
                    .iter()
                    .map(|&operand| self.field(operand))
                    .collect::<Result<Vec<NodeId>, Error>>()?;
                Ok(self.combined(*operation, system, &fields))
            }
            Kind::Complement(operand) => {
                let field = self.field(*operand)?;
                Ok(self.graph.neg(field))
            }
            Kind::Reference(_, target) => self.field(*target),
            Kind::Primitive(primitive) => Ok(primitive.field(&mut self.graph)),
            Kind::Formula { formula, parameters, uses } => {
                let mut named = Vec::new();
                for (name, used) in uses {
                    let root = self.field(*used)?;
                    named.push((name.clone(), Expression::new(self.graph.clone(), root)));
                }
                // The node's own parameters hide the model's.
                let parameters: Vec<(String, f64)> =
                    self.model.defaults.parameters.iter().chain(parameters).cloned().collect();
                let field = formula
                    .compile(system, &parameters, &named)
                    .map_err(|error| Error::from(error).in_node(label))?;
                let (graph, root) = field.graph();
                Ok(self.graph.import(graph, root))
            }
            Kind::Contour(contours) => {
                let distance = ContourDistance::new(contours).map_err(|error| error.in_node(label))?;
                Ok(self.graph.leaf(Arc::new(distance)))
            }
            Kind::Mesh(_) | Kind::Custom { .. } => {
                // Only when extruded: a mesh has no plane region.
                let what = "only formulas, contours and combinations of them can be extruded";
                Err(Error::Model(what.into()).in_node(label))
            }
        }
    }

    fn combined(&mut self, operation: Operation, system: System, fields: &[NodeId]) -> NodeId {
        let graph = &mut self.graph;
        let mut all = fields[0];
        for &field in &fields[1..] {
            all = match operation {
                Operation::Union => graph.or(system, all, field),
                Operation::Intersection => graph.and(system, all, field),
                Operation::Difference => {
                    let not = graph.neg(field);
                    graph.and(system, all, not)
                }
                Operation::SymmetricDifference => {
                    let (not_all, not_field) = (graph.neg(all), graph.neg(field));
                    let (one, other) = (graph.and(system, all, not_field), graph.and(system, field, not_all));
                    graph.or(system, one, other)
                }
            };
        }
        all
    }
}

fn bounds_of(mesh: &Mesh) -> [[f64; 3]; 2] {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &position in &mesh.positions {
        low = low.min(DVec3::from_array(position));
        high = high.max(DVec3::from_array(position));
    }
    [low.to_array(), high.to_array()]
}

fn diagonal([low, high]: [[f64; 3]; 2]) -> f64 {
    DVec3::from_array(low).distance(DVec3::from_array(high))
}

/// The mesh transformed, still facing outward.
fn moved(mut mesh: Mesh, transform: DAffine3) -> Mesh {
    if transform == DAffine3::IDENTITY {
        return mesh;
    }
    for position in &mut mesh.positions {
        *position = transform.transform_point3(DVec3::from_array(*position)).to_array();
    }
    if transform.matrix3.determinant() < 0.0 {
        for triangle in &mut mesh.triangles {
            triangle.swap(1, 2);
        }
    }
    mesh
}

//! An evaluation under way: what is known of the nodes, and nodes as functions.

use std::sync::Arc;

use glam::DAffine3;
use rustc_hash::FxHashMap;

use super::{Evaluation, ExtractionReport};
use crate::boolean::Operation;
use crate::field::{
    ContourDistance, ContourExtraction, Contours, Expression, Graph, NodeId, SignedDistance, System,
};
use crate::model::{Kind, Mode, Model};
use crate::{Error, Solid};

/// Every node is evaluated at most once each way.
pub(super) struct State<'a> {
    pub(super) settings: &'a Evaluation,
    pub(super) model: &'a Model,
    graph: Graph,
    fields: FxHashMap<usize, NodeId>,
    pub(super) solids: FxHashMap<usize, Arc<Solid>>,
    /// What the last extraction reported.
    pub(super) last: Option<ExtractionReport>,
    pub(super) warnings: Vec<String>,
}

impl<'a> State<'a> {
    pub(super) fn new(settings: &'a Evaluation, model: &'a Model) -> Self {
        Self {
            settings,
            model,
            graph: Graph::new(),
            fields: FxHashMap::default(),
            solids: FxHashMap::default(),
            last: None,
            warnings: Vec::new(),
        }
    }

    pub(super) fn label(&self, node: usize) -> &'a str {
        &self.model.nodes[node].label
    }

    /// How a node is evaluated: as it says, or as the operation it is part of, or exactly if it is made of nothing
    /// but meshes, primitives, parametric solids and extrusions.
    pub(super) fn mode(&self, node: usize, parent: Option<Mode>) -> Mode {
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
                // Meshes, whatever they are made of.
                Kind::Made(..) | Kind::Cut(..) => {}
                _ => pending.extend(self.model.operands(node)),
            }
        }
        Mode::Exact
    }

    fn system(&self, node: usize) -> System {
        self.model.nodes[node].system.or(self.model.defaults.system).unwrap_or_default()
    }

    /// The tolerance that meshing a node of the given size keeps.
    pub(super) fn tolerance(&self, node: usize, size: f64) -> f64 {
        self.given_tolerance(node).unwrap_or(size * 1e-3)
    }

    pub(super) fn given_tolerance(&self, node: usize) -> Option<f64> {
        self.settings.tolerance.or(self.model.nodes[node].tolerance).or(self.model.defaults.tolerance)
    }

    /// Whether the surface of a node that is extracted is made smooth.
    pub(super) fn is_smooth(&self, node: usize) -> bool {
        let of_model = self.model.nodes[node].smooth.or(self.model.defaults.smooth);
        self.settings.smooth.or(of_model).unwrap_or(true)
    }

    /// The plane region that an extruded node extrudes.
    pub(super) fn region(&mut self, node: usize) -> Result<Contours, Error> {
        if let Kind::Contour(outline) = &self.model.nodes[node].kind {
            let contours = outline.contours(self.given_tolerance(node));
            return contours.map_err(|error| error.in_node(self.label(node)));
        }
        let root = self.plain_field(node)?;
        let field = Expression::new(self.graph.clone(), root);
        self.contours_of(node, &field, 0.0)
    }

    /// The boundary of a node's field in a plane.
    pub(super) fn contours_of(
        &mut self,
        node: usize,
        field: &Expression,
        height: f64,
    ) -> Result<Contours, Error> {
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

    /// The node as an expression of its own.
    pub(super) fn expression(&mut self, node: usize) -> Result<Expression, Error> {
        let root = self.field(node)?;
        Ok(Expression::new(self.graph.clone(), root))
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
            Kind::Mesh(_)
            | Kind::Parametric(_)
            | Kind::Cage(_)
            | Kind::Made(..)
            | Kind::Cut(..)
            | Kind::Custom { .. } => at.extrude.is_none(),
            Kind::Operation(..) => {
                matches!(at.mode, Some(Mode::Exact | Mode::FreeForm)) && at.extrude.is_none()
            }
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
                    named.push((name.clone(), self.expression(*used)?));
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
            Kind::HalfSpace(half_space) => {
                let formula = half_space.formula().map_err(|error| Error::from(error).in_node(label))?;
                let field =
                    formula.compile(system, &[], &[]).map_err(|error| Error::from(error).in_node(label))?;
                let (graph, root) = field.graph();
                Ok(self.graph.import(graph, root))
            }
            Kind::Contour(_) => {
                let contours = self.region(node)?;
                let distance = ContourDistance::new(&contours).map_err(|error| error.in_node(label))?;
                Ok(self.graph.leaf(Arc::new(distance)))
            }
            Kind::Mesh(_)
            | Kind::Parametric(_)
            | Kind::Cage(_)
            | Kind::Made(..)
            | Kind::Cut(..)
            | Kind::Custom { .. } => {
                // Only when extruded: a mesh has no plane region.
                let what = "only formulas, contours, regions and combinations of them can be extruded";
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

//! Nodes of cages: their limit surfaces as meshes, and operations that give cages.

use crate::model::cage::Cage;
use crate::model::{Kind, Mode};
use crate::subdivision::{ControlMesh, FreeForm};
use crate::{Error, Mesh};

use super::state::State;

impl State<'_> {
    /// The mesh of an operation over cages.
    pub(super) fn free_form(&mut self, node: usize) -> Result<Mesh, Error> {
        let cage = self.operation_cage(node)?;
        self.limit_mesh(node, &cage)
    }

    /// The mesh of a cage within the node's tolerance.
    pub(super) fn limit_mesh(&self, node: usize, cage: &Cage) -> Result<Mesh, Error> {
        cage.mesh(self.given_tolerance(node)).map_err(|error| error.in_node(self.label(node)))
    }

    /// The cage of a node, at its place.
    fn cage(&mut self, node: usize) -> Result<Cage, Error> {
        let at = &self.model.nodes[node];
        let cage = match &at.kind {
            Kind::Cage(cage) => Cage::clone(cage),
            Kind::Reference(_, target) => self.cage(*target)?,
            Kind::Operation(..) if at.mode.is_none_or(|mode| mode == Mode::FreeForm) => {
                self.operation_cage(node)?
            }
            _ => {
                let what = "it is no cage: an operation with `\"evaluate\": \"freeform\"` takes nodes of the kind `freeform` and \
                            operations over them; make a cage of it, or evaluate the operation exactly";
                return Err(Error::Model(what.into()).in_node(self.label(node)));
            }
        };
        cage.moved(at.transform).map_err(|error| error.in_node(self.label(node)))
    }

    /// The cage of an operation, before its own transform.
    fn operation_cage(&mut self, node: usize) -> Result<Cage, Error> {
        let model = self.model;
        let Kind::Operation(operation, operands) = &model.nodes[node].kind else {
            return Err(Error::Model("it is no operation".into()).in_node(self.label(node)));
        };
        let mut settings = FreeForm::new().control(self.settings.control.clone());
        if let Some(tolerance) = self.given_tolerance(node) {
            settings = settings.tolerance(tolerance);
        }
        let mut cages: Vec<ControlMesh> = Vec::with_capacity(operands.len());
        for &operand in operands {
            let cage = self.cage(operand)?;
            let within = |error: Error| error.in_node(self.label(operand));
            let (cage, warning) = cage.of_triangles(self.given_tolerance(node)).map_err(within)?;
            if let Some(warning) = warning {
                self.warnings.push(format!("node {}: {warning}", self.label(operand)));
            }
            cages.push(cage);
        }
        let cages: Vec<&ControlMesh> = cages.iter().collect();
        let outcome =
            settings.run_all(*operation, &cages).map_err(|error| error.in_node(self.label(node)))?;
        for warning in &outcome.report().warnings {
            self.warnings.push(format!("node {}: {warning}", self.label(node)));
        }
        Ok(Cage(outcome.into_surface().into()))
    }
}

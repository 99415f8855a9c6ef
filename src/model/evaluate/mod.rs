//! Evaluation of a model: exactly on meshes, or as functions with one extraction.

#[cfg(feature = "subdivision")]
mod cages;
mod cuts;
mod meshes;
mod state;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use super::{Mode, Model};
use crate::field::{Contours, Expression};
use crate::{Control, Error, Mesh};
use state::State;

/// Evaluates leaves of a kind of the caller's own: one whose name begins with `x-`.
pub trait LeafKind: Send + Sync {
    /// The closed mesh that the node's own keys (`value`, an object) describe, within `tolerance` of the true surface
    /// (nothing if neither the model nor the caller says); file names in it start at `folder`.
    ///
    /// # Errors
    /// What is wrong with the description.
    fn mesh(
        &self,
        value: &serde_json::Value,
        tolerance: Option<f64>,
        folder: &Path,
        control: &Control,
    ) -> Result<Mesh, Error>;
}

/// Reads a mesh file.
type Loader = dyn Fn(&Path) -> Result<Mesh, Error> + Send + Sync;

/// Settings of an evaluation.
#[derive(Clone)]
pub struct Evaluation {
    tolerance: Option<f64>,
    smooth: Option<bool>,
    control: Control,
    kinds: BTreeMap<String, Arc<dyn LeafKind>>,
    loader: Option<Arc<Loader>>,
}

impl Default for Evaluation {
    fn default() -> Self {
        Self::new()
    }
}

/// What a model evaluates to.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// The closed surface; empty if the solid is. Open where the result is a `trim`.
    pub mesh: Mesh,
    /// Whether it is a trimmed surface, and no solid.
    pub is_open: bool,
    /// What the last extraction reports, if the result is one.
    pub extraction: Option<ExtractionReport>,
    /// What the readers of mesh files had to say, each with the file's name.
    pub warnings: Vec<String>,
}

/// What an extraction reports: see [`Extracted`](crate::field::Extracted).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtractionReport {
    /// The tolerance used.
    pub tolerance: f64,
    /// The largest deviation found.
    pub deviation: f64,
    /// Degrees that the normals of 95 of a hundred triangles are within of the gradient.
    pub normal_deviation: f64,
    /// Cubes that the surface was sought in.
    pub cells: usize,
    /// Cubes with several pieces of surface at the finest level.
    pub divided_cells: usize,
}

impl Evaluation {
    /// Default settings: the model's own tolerance, or a thousandth of the diagonal of what is meshed.
    #[must_use]
    pub fn new() -> Self {
        Self {
            tolerance: None,
            smooth: None,
            control: Control::default(),
            kinds: BTreeMap::new(),
            loader: None,
        }
    }

    /// Meshes within `tolerance`, whatever the model says.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = Some(tolerance);
        self
    }

    /// Whether surfaces extracted from fields are made smooth, whatever the model says: see
    /// [`Extraction::smooth`](crate::field::Extraction::smooth).
    #[must_use]
    pub fn smooth(mut self, smooth: bool) -> Self {
        self.smooth = Some(smooth);
        self
    }

    /// Limits and progress.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// Evaluates leaves of the kind `name`, which begins with `x-`, by `kind`.
    #[must_use]
    pub fn leaf_kind(mut self, name: &str, kind: Arc<dyn LeafKind>) -> Self {
        self.kinds.insert(name.to_owned(), kind);
        self
    }

    /// Reads mesh files by `loader` instead of by their format.
    #[must_use]
    pub fn loader(mut self, loader: impl Fn(&Path) -> Result<Mesh, Error> + Send + Sync + 'static) -> Self {
        self.loader = Some(Arc::new(loader));
        self
    }

    /// The model's result as a closed mesh, or, of a `trim`, as one that may be open.
    ///
    /// # Errors
    /// What is wrong, in [`Error::InNode`] with the node at fault.
    pub fn run(&self, model: &Model) -> Result<Evaluated, Error> {
        let mut state = State::new(self, model);
        if let Some(mesh) = state.trimmed()? {
            return Ok(Evaluated { mesh, is_open: true, extraction: None, warnings: state.warnings });
        }
        let solid = match state.mode(model.result, None) {
            Mode::Exact | Mode::FreeForm => state.exact(model.result)?,
            Mode::Field => state.meshed(model.result)?,
        };
        let mesh = solid.mesh().clone();
        Ok(Evaluated { mesh, is_open: false, extraction: state.last, warnings: state.warnings })
    }

    /// The model's result as a function, positive inside.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn field(&self, model: &Model) -> Result<Expression, Error> {
        let mut state = State::new(self, model);
        state.expression(model.result)
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
        let field = state.expression(model.result)?;
        state.contours_of(model.result, &field, height)
    }

    /// A box around the model's result.
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

//! Booleans of free forms: cages in, a cage out (Vyatkin 2019, after Biermann, Kristjansson, Zorin 2001).
//!
//! 1. Both limit surfaces as triangles, and their exact boolean ([`operand`]).
//! 2. The intersection curve, its points moved onto both surfaces ([`curve`]).
//! 3. A working mesh: control faces that the exact result kept whole, and fine triangles where it cut ([`start`]); those are
//!    coarsened to the size of the control faces beside them ([`sizes`], [`coarsen`]). Every step keeps the mesh a closed
//!    surface, so the cage has the topology of the exact result without a decision of its own.
//! 4. Vertices beside the curve move along their surfaces to better shapes ([`relax`]); the cage is put together
//!    ([`assemble`]).
//! 5. Control points within two rings of what changed are fitted by least squares ([`fit`], [`solve`]); all others keep their
//!    bits.
//! 6. The distance of both surfaces is measured ([`measure`]). While it is larger than asked for, 3 to 6 are done again with
//!    faces of half the size beside the curve; the best is returned.

mod assemble;
mod attempt;
mod build;
mod coarsen;
mod curve;
mod details;
mod fan;
mod fit;
#[cfg(test)]
mod many_tests;
mod measure;
mod meetings;
mod operand;
mod relax;
mod report;
mod run;
mod sizes;
pub(crate) mod solve;
mod start;
#[cfg(test)]
mod tests;
mod work;

use super::control_mesh::ControlMesh;
use crate::{Control, Error, Operation, Outcome};
pub use measure::Errors;
pub use report::FreeFormReport;
use run::{Run, diagonal};

/// Where a control point of a result comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VertexOrigin {
    /// An operand's control point, bit for bit.
    Kept {
        /// The operand, from 0.
        operand: usize,
        /// Its vertex.
        vertex: u32,
    },
    /// An operand's control point that moved.
    Fitted {
        /// The operand, from 0.
        operand: usize,
        /// Its vertex.
        vertex: u32,
    },
    /// A new one.
    New,
}

/// Settings of a boolean of cages.
///
/// ```
/// use trisect::Operation;
/// use trisect::subdivision::{ControlMesh, FreeForm, Rules, Tags};
///
/// let ball = trisect::primitives::icosphere(1.0, 1)?;
/// let other = ball.clone().translated([0.9, 0.1, 0.2]);
/// let a = ControlMesh::new(ball.positions, ball.triangles, Tags::default(), Rules::Loop)?;
/// let b = ControlMesh::new(other.positions, other.triangles, Tags::default(), Rules::Loop)?;
/// let both = FreeForm::new().tolerance(0.05).run(Operation::Union, &a, &b)?;
/// assert!(both.report().reached);
/// assert!(!both.surface().tags().creases.is_empty());
/// # Ok::<(), trisect::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FreeForm {
    tolerance: Option<f64>,
    refine: u32,
    attempts: u32,
    rings: usize,
    details: usize,
    allow_tangent: bool,
    control: Control,
}

impl Default for FreeForm {
    fn default() -> Self {
        Self {
            tolerance: None,
            refine: 0,
            attempts: 2,
            rings: 2,
            details: 0,
            allow_tangent: false,
            control: Control::new(),
        }
    }
}

/// A result: the cage, the exact boolean it stands for, and what is known of both.
#[derive(Clone, Debug)]
pub struct FreeFormOutcome {
    surface: ControlMesh,
    exact: Outcome,
    origins: Vec<VertexOrigin>,
    report: FreeFormReport,
}

impl FreeFormOutcome {
    /// The cage of the result.
    #[must_use]
    pub fn surface(&self) -> &ControlMesh {
        &self.surface
    }

    /// The cage, by value.
    #[must_use]
    pub fn into_surface(self) -> ControlMesh {
        self.surface
    }

    /// The exact boolean of the limit surfaces as triangles.
    #[must_use]
    pub fn exact(&self) -> &Outcome {
        &self.exact
    }

    /// Where each control point comes from.
    #[must_use]
    pub fn origins(&self) -> &[VertexOrigin] {
        &self.origins
    }

    /// What was asked for and what came of it.
    #[must_use]
    pub fn report(&self) -> &FreeFormReport {
        &self.report
    }
}

/// Tolerance without one given, over the diagonal of the operands.
const USUAL_TOLERANCE: f64 = 1e-3;

impl FreeForm {
    /// Default settings: a thousandth of the operands' diagonal as tolerance, faces beside the curve halved at most twice.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// How far the cage's surface may be from the exact result, in units of the coordinates.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = Some(tolerance);
        self
    }

    /// Begins with faces beside the curve halved so many times.
    #[must_use]
    pub fn refine(mut self, times: u32) -> Self {
        self.refine = times;
        self
    }

    /// How many times more they are halved at most while the tolerance is not reached. Default 2.
    #[must_use]
    pub fn attempts(mut self, attempts: u32) -> Self {
        self.attempts = attempts;
        self
    }

    /// How many rings of control points around what changed may move. Default 2; at least 1.
    #[must_use]
    pub fn rings(mut self, rings: usize) -> Self {
        self.rings = rings.max(1);
        self
    }

    /// Up to how many levels of details are added while the tolerance is not reached: displacements after one, two, ...
    /// subdivisions, which make every level three to five times as near. Default 0: a plain cage, which every program reads. At
    /// most 4.
    #[must_use]
    pub fn details(mut self, levels: usize) -> Self {
        self.details = levels.min(4);
        self
    }

    /// Whether surfaces that nearly touch along their curve are taken.
    #[must_use]
    pub fn allow_tangent(mut self, allow: bool) -> Self {
        self.allow_tangent = allow;
        self
    }

    /// Limits and progress.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// Combines two cages. An empty result is a success.
    ///
    /// # Errors
    /// [`Error::Operand`] with the reason for a cage that is not closed or whose surface is no solid;
    /// [`Error::InvalidArgument`] for a tolerance that is not positive, and operations other than union, intersection and
    /// difference; [`Error::Cage`] where the surfaces are nearly tangential; limits.
    pub fn run(
        &self,
        operation: Operation,
        a: &ControlMesh,
        b: &ControlMesh,
    ) -> Result<FreeFormOutcome, Error> {
        self.run_all(operation, &[a, b])
    }

    /// Combines any number of cages at once: of a difference, what is taken from the first. The exact result is one of all limit
    /// surfaces, where three meet is a corner of the cage, and the distance is that of one step. One cage alone, in a union, becomes
    /// one that does not cross itself.
    ///
    /// ```
    /// use trisect::Operation;
    /// use trisect::subdivision::{ControlMesh, FreeForm, Rules, Tags};
    ///
    /// let ball = |at| {
    ///     let ball = trisect::primitives::icosphere(1.0, 1)?.translated(at);
    ///     ControlMesh::new(ball.positions, ball.triangles, Tags::default(), Rules::Loop)
    /// };
    /// let balls = [ball([0.0; 3])?, ball([0.9, 0.1, 0.2])?, ball([0.4, 0.8, 0.1])?];
    /// let all = FreeForm::new().tolerance(0.05).run_all(Operation::Union, &balls.each_ref())?;
    /// assert_eq!(all.report().junctions, 2);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`run`](Self::run); [`Error::InvalidArgument`] for no cages, and more than 65,535.
    pub fn run_all(&self, operation: Operation, cages: &[&ControlMesh]) -> Result<FreeFormOutcome, Error> {
        if cages.is_empty() || cages.len() > usize::from(u16::MAX) {
            return Err(Error::InvalidArgument(format!("1 to {} cages, not {}", u16::MAX, cages.len())));
        }
        if !matches!(operation, Operation::Union | Operation::Intersection | Operation::Difference) {
            return Err(Error::InvalidArgument(format!(
                "{} of cages is not offered: its result touches itself along the curve; take two differences",
                operation.name()
            )));
        }
        let tolerance = self.tolerance.unwrap_or_else(|| USUAL_TOLERANCE * diagonal(cages));
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::InvalidArgument(format!("a tolerance must be positive, not {tolerance}")));
        }
        Run::new(self, tolerance).all(operation, cages)
    }
}

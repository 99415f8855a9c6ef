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
mod coarsen;
mod curve;
mod details;
mod fit;
mod measure;
mod operand;
mod relax;
mod report;
mod sizes;
mod solve;
mod start;
#[cfg(test)]
mod tests;
mod work;

use std::time::Instant;

use glam::DVec3;

use super::control_mesh::ControlMesh;
use super::error::CageError;
use super::tags::Tags;
use crate::{BooleanOptions, Control, Error, Operation, Outcome};
use assemble::{Draft, assemble};
use curve::Chain;
use fit::Fit;
pub use measure::Errors;
use measure::{Measure, Region};
use operand::Operand;
pub use report::FreeFormReport;
use sizes::Sizes;
use start::Start;

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

/// The limit surfaces are triangulated within this share of the tolerance.
const FINENESS: f64 = 0.5;
/// ... but not into more triangles than this for one operand, since the working mesh begins with some of them.
const MOST_TRIANGLES: usize = 150_000;
/// ... and no face more often than this.
const MOST_STEPS: u32 = 5;
/// The cage's surface is measured at the vertices of 4^3 triangles a face.
const MEASURED_STEPS: u32 = 3;
/// Tolerance without one given, over the diagonal of the operands.
const USUAL_TOLERANCE: f64 = 1e-3;
/// Surfaces that cross at less than this angle, in degrees, are refused: their curve is not known.
const LEAST_CROSSING: f64 = 5.0;

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
        if !matches!(operation, Operation::Union | Operation::Intersection | Operation::Difference) {
            return Err(Error::InvalidArgument(format!(
                "{} of cages is not offered: its result touches itself along the curve; take two differences",
                operation.name()
            )));
        }
        let tolerance = self.tolerance.unwrap_or_else(|| USUAL_TOLERANCE * diagonal(&[a, b]));
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::InvalidArgument(format!("a tolerance must be positive, not {tolerance}")));
        }
        let mut run =
            Run { settings: self, tolerance, report: FreeFormReport::default(), start: Instant::now() };
        run.report.asked = tolerance;
        run.all(operation, a, b)
    }
}

fn diagonal(cages: &[&ControlMesh]) -> f64 {
    let points = cages.iter().flat_map(|cage| cage.positions()).map(|&p| DVec3::from(p));
    let (low, high) =
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    (high - low).length()
}

/// One run: settings, and the report that grows.
struct Run<'s> {
    settings: &'s FreeForm,
    tolerance: f64,
    report: FreeFormReport,
    start: Instant,
}

/// What one size of faces gave.
struct Attempt {
    draft: Draft,
    errors: Errors,
    /// The largest distance over each face.
    of_face: Vec<f64>,
    region: Region,
    refined: u32,
    left_over: usize,
}

impl Run<'_> {
    fn took(&mut self, step: &'static str) {
        let seconds = self.start.elapsed().as_secs_f64();
        self.start = Instant::now();
        match self.report.seconds.iter_mut().find(|known| known.0 == step) {
            Some(known) => known.1 += seconds,
            None => self.report.seconds.push((step, seconds)),
        }
    }

    fn operand(&self, index: usize, cage: &ControlMesh) -> Result<Operand, Error> {
        let faces = cage.faces().len().max(1);
        let mut most = MOST_STEPS;
        while most > 2 && faces.saturating_mul(1 << (2 * most)) > MOST_TRIANGLES {
            most -= 1;
        }
        let most = most.max(2 + self.settings.refine.min(2));
        Operand::new(cage, self.tolerance * FINENESS, most)
            .map_err(|error| error.of_operand(index, format!("operand {}", index + 1)))
    }

    fn all(
        &mut self,
        operation: Operation,
        a: &ControlMesh,
        b: &ControlMesh,
    ) -> Result<FreeFormOutcome, Error> {
        let control = &self.settings.control;
        // 1. Limit surfaces as triangles, and their exact boolean.
        control.report("limit surfaces", 0.0)?;
        let operands = [self.operand(0, a)?, self.operand(1, b)?];
        let operands = [&operands[0], &operands[1]];
        for (index, cage) in [a, b].into_iter().enumerate() {
            if operands[index].cage.faces().len() != cage.faces().len() {
                self.report.warnings.push(format!(
                    "operand {} is subdivided first, since it has details or creases that are sharp for a while only: the same \
                     surface, with more control points",
                    index + 1
                ));
            }
        }
        self.took("limit");
        let exact = BooleanOptions::new()
            .control(control.clone())
            .remove_vertices(false)
            .run(operation, [operands[0].solid(), operands[1].solid()])?;
        self.took("boolean");
        self.report.exact_triangles = exact.solid().mesh().triangles.len();
        if exact.solid().is_empty() {
            let surface = ControlMesh::new(Vec::new(), Vec::new(), Tags::default(), a.rules())?;
            self.report.reached = true;
            return Ok(FreeFormOutcome {
                surface,
                exact,
                origins: Vec::new(),
                report: std::mem::take(&mut self.report),
            });
        }
        if !exact.solid().is_manifold() {
            return Err(CageError::Operation(
                "the exact result touches itself in an edge or a vertex, which no cage can do; move an operand a little".into(),
            )
            .into());
        }
        // 2. The curve.
        let start = Start::new(operands, &exact);
        let chains = start.chains(self.tolerance);
        self.check_chains(&chains)?;
        self.took("curve");
        // 3. Cages with faces of smaller and smaller size beside the curve.
        let mut best: Option<Attempt> = None;
        let last = self.settings.refine + if chains.is_empty() { 0 } else { self.settings.attempts };
        for refined in self.settings.refine..=last {
            control.report(
                "cage",
                f64::from(refined - self.settings.refine) / f64::from(last - self.settings.refine + 1),
            )?;
            let attempt = self.attempt(operands, &start, &chains, &exact, refined)?;
            if best.as_ref().is_none_or(|best| attempt.errors.largest() < best.errors.largest()) {
                best = Some(attempt);
            }
            if best.as_ref().is_some_and(|best| best.errors.largest() <= self.tolerance) {
                break;
            }
        }
        let Some(mut best) = best else { return Err(CageError::Operation("no cage was made".into()).into()) };
        if self.settings.details > 0 && best.errors.largest() > self.tolerance {
            let measure = Measure {
                operands,
                start: &start,
                exact: &exact,
                chains: &chains,
                fineness: self.tolerance * FINENESS,
            };
            let levels =
                details::add(&mut best, &measure, start.reversed, self.settings.details, self.tolerance)?;
            self.report.levels = levels.len();
            self.report.details = levels.iter().map(|level| level.at.len()).sum();
            best.draft.cage = best.draft.cage.with_details(levels)?;
            self.took("details");
        }
        self.describe(&best, operands);
        Ok(FreeFormOutcome {
            surface: best.draft.cage,
            exact,
            origins: best.draft.origins,
            report: std::mem::take(&mut self.report),
        })
    }

    fn check_chains(&mut self, chains: &[Chain]) -> Result<(), Error> {
        let sine = chains.iter().map(|chain| chain.crossing).fold(1.0, f64::min);
        self.report.crossing = sine.clamp(0.0, 1.0).asin().to_degrees();
        self.report.chains = chains.len();
        self.report.features = chains.iter().map(|chain| chain.features.len()).sum();
        if self.report.crossing < LEAST_CROSSING {
            let text = format!(
                "the surfaces meet at {:.1} degrees somewhere along their curve: where it runs is not well known",
                self.report.crossing
            );
            if !self.settings.allow_tangent {
                return Err(CageError::Operation(format!(
                    "{text}; move an operand, take the exact boolean of the limit meshes, or allow it (--allow-tangent)"
                ))
                .into());
            }
            self.report.warnings.push(text);
        }
        Ok(())
    }

    fn attempt(
        &mut self,
        operands: [&Operand; 2],
        start: &Start<'_>,
        chains: &[Chain],
        exact: &Outcome,
        refined: u32,
    ) -> Result<Attempt, Error> {
        // 1. The cage's faces.
        let sizes = Sizes::new(chains, start.curve_sizes(chains, refined));
        let steps = start.steps(&sizes);
        let mut work = start.work(chains, &sizes, &steps)?;
        let left_over = coarsen::coarsen(&mut work);
        relax::polish(&mut work, chains);
        relax::relax(&mut work, chains, operands, start.reversed);
        coarsen::turn_edges(&mut work);
        let mut draft = assemble(&work, operands, start.reversed)?;
        self.took("cage");
        // 2. Its control points.
        let mut fit = Fit::new(&draft, operands, start.reversed, chains, self.settings.rings, 2);
        let mut positions = draft.cage.points();
        if !fit.unknown.is_empty() {
            fit.run(&mut positions, 0.01 * self.tolerance);
            for &v in &fit.unknown {
                if let VertexOrigin::Kept { operand, vertex } = draft.origins[v as usize] {
                    draft.origins[v as usize] = VertexOrigin::Fitted { operand, vertex };
                }
            }
        }
        draft.cage = draft.cage.with_points(&positions);
        self.took("fit");
        // 3. The distance.
        let fineness = self.tolerance * FINENESS;
        let measure = Measure { operands, start, exact, chains, fineness };
        let region = measure.region(&draft, &fit.unknown);
        let (errors, of_face) = measure.errors(&draft, &region, MEASURED_STEPS);
        self.took("measure");
        Ok(Attempt { draft, errors, of_face, region, refined, left_over })
    }

    fn describe(&mut self, best: &Attempt, operands: [&Operand; 2]) {
        let report = &mut self.report;
        let level = best.draft.cage.level();
        report.errors = best.errors;
        report.reached = best.errors.largest() <= self.tolerance;
        report.vertices = best.draft.origins.len();
        report.faces = level.faces.len();
        report.refined = best.refined;
        report.left_over = best.left_over;
        for (v, origin) in best.draft.origins.iter().enumerate() {
            let count = level.ring(v as u32).face_count();
            match *origin {
                VertexOrigin::Kept { .. } => report.unchanged += 1,
                VertexOrigin::Fitted { .. } => report.fitted += 1,
                VertexOrigin::New => report.added += 1,
            }
            let before = match *origin {
                VertexOrigin::Kept { operand, vertex } | VertexOrigin::Fitted { operand, vertex } => {
                    operands[operand].surface.level.ring(vertex).face_count()
                }
                VertexOrigin::New => 0,
            };
            if count != before {
                report.valence = report.valence.max(count);
            }
        }
        if !report.reached {
            let errors = best.errors;
            let place = if errors.band >= errors.outside { "beside the curve" } else { "in faces around it" };
            report.warnings.push(format!(
                "the cage is within {:.3e} of the exact result, not {:.3e}; the largest distance is {place}: refine the cages there \
                 (`subdivide --levels 1`), or allow more",
                errors.largest(),
                self.tolerance
            ));
        }
    }
}

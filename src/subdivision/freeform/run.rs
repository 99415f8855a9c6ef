//! One boolean of two cages, step by step.

use std::time::Instant;

use glam::DVec3;

use super::assemble::{Draft, assemble};
use super::attempt::Attempt;
use super::curve::Chain;
use super::fit::Fit;
use super::measure::Measure;
use super::meetings::meetings;
use super::operand::Operand;
use super::report::FreeFormReport;
use super::sizes::Sizes;
use super::start::Start;
use super::{FreeForm, FreeFormOutcome, VertexOrigin, build, coarsen, details, relax};
use crate::subdivision::control_mesh::ControlMesh;
use crate::subdivision::error::CageError;
use crate::subdivision::tags::Tags;
use crate::{BooleanOptions, Error, Operation};

/// The limit surfaces are triangulated within this share of the tolerance.
const FINENESS: f64 = 0.5;
/// ... but not into more triangles than this for one operand, since the working mesh begins with some of them.
const MOST_TRIANGLES: usize = 150_000;
/// ... and no face more often than this.
const MOST_STEPS: u32 = 5;
/// The cage's surface is measured at the vertices of 4^3 triangles a face.
const MEASURED_STEPS: u32 = 3;
/// Surfaces that cross at less than this angle, in degrees, are refused: their curve is not known.
const LEAST_CROSSING: f64 = 5.0;

/// The diagonal of all control points.
pub(super) fn diagonal(cages: &[&ControlMesh]) -> f64 {
    let points = cages.iter().flat_map(|cage| cage.positions()).map(|&p| DVec3::from(p));
    let (low, high) =
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    (high - low).length()
}

/// One run: settings, and the report that grows.
pub(super) struct Run<'s> {
    settings: &'s FreeForm,
    tolerance: f64,
    report: FreeFormReport,
    start: Instant,
}

impl<'s> Run<'s> {
    pub(super) fn new(settings: &'s FreeForm, tolerance: f64) -> Self {
        let report = FreeFormReport { asked: tolerance, ..FreeFormReport::default() };
        Self { settings, tolerance, report, start: Instant::now() }
    }

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

    /// All steps, one after the other.
    pub(super) fn all(
        mut self,
        operation: Operation,
        cages: &[&ControlMesh],
    ) -> Result<FreeFormOutcome, Error> {
        // 1. Limit surfaces as triangles, and their exact boolean.
        let control = &self.settings.control;
        control.report("limit surfaces", 0.0)?;
        let operands = cages.iter().enumerate().map(|(index, cage)| self.operand(index, cage));
        let mut operands: Vec<Operand> = operands.collect::<Result<_, Error>>()?;
        self.warn_of_subdivision(&operands, cages);
        self.took("limit");
        let exact = BooleanOptions::new()
            .control(control.clone())
            .remove_vertices(false)
            .run(operation, operands.iter().map(Operand::solid))?;
        self.took("boolean");
        self.report.exact_triangles = exact.solid().mesh().triangles.len();
        if exact.solid().is_empty() {
            let rules = cages.first().map(|cage| cage.rules()).unwrap_or_default();
            let surface = ControlMesh::new(Vec::new(), Vec::new(), Tags::default(), rules)?;
            self.report.reached = true;
            return Ok(FreeFormOutcome { surface, exact, origins: Vec::new(), report: self.report });
        }
        if !exact.solid().is_manifold() {
            let what = "the exact result touches itself in an edge or a vertex, which no cage can do; move an operand a little";
            return Err(CageError::Operation(what.into()).into());
        }
        // 2. The curve.
        let meetings = meetings(&operands, &exact);
        for [a, b] in meetings.iter().flat_map(|meeting| &meeting.layers) {
            operands[usize::from(a.operand)].crosses_itself |= a.operand == b.operand;
        }
        let operands: &[Operand] = &operands;
        let start = Start::new(operands, &exact);
        let chains = start.chains(meetings, self.tolerance);
        self.check_chains(&chains)?;
        self.took("curve");
        // 3. Cages with faces of smaller and smaller size beside the curve, and details of the best.
        let fineness = self.tolerance * FINENESS;
        let measure = Measure { operands, start: &start, exact: &exact, chains: &chains, fineness };
        let mut best = self.best(&measure)?;
        self.add_details(&mut best, &measure)?;
        self.describe(&best, operands);
        let Draft { cage, origins, .. } = best.draft;
        Ok(FreeFormOutcome { surface: cage, exact, origins, report: self.report })
    }

    /// An operand that is sharp for a while only, or has details, has more control points than its cage.
    fn warn_of_subdivision(&mut self, operands: &[Operand], cages: &[&ControlMesh]) {
        for (index, cage) in cages.iter().enumerate() {
            if operands[index].cage.faces().len() != cage.faces().len() {
                self.report.warnings.push(format!(
                    "operand {} is subdivided first, since it has details or creases that are sharp for a while only: the same \
                     surface, with more control points",
                    index + 1
                ));
            }
        }
    }

    /// The best of all sizes until the tolerance is reached.
    fn best(&mut self, measure: &Measure<'_>) -> Result<Attempt, Error> {
        let first = self.settings.refine;
        let last = first + if measure.chains.is_empty() { 0 } else { self.settings.attempts };
        let mut best = self.attempt(measure, first)?;
        for refined in first + 1..=last {
            if best.errors.largest() <= self.tolerance {
                break;
            }
            self.settings.control.report("cage", f64::from(refined - first) / f64::from(last - first + 1))?;
            let attempt = self.attempt(measure, refined)?;
            if attempt.errors.largest() < best.errors.largest() {
                best = attempt;
            }
        }
        Ok(best)
    }

    /// Adds details where they are asked for and needed.
    fn add_details(&mut self, best: &mut Attempt, measure: &Measure<'_>) -> Result<(), Error> {
        if self.settings.details == 0 || best.errors.largest() <= self.tolerance {
            return Ok(());
        }
        let levels = details::add(best, measure, self.settings.details, self.tolerance)?;
        self.report.levels = levels.len();
        self.report.details = levels.iter().map(|level| level.at.len()).sum();
        best.draft.cage = best.draft.cage.clone().with_details(levels)?;
        self.took("details");
        Ok(())
    }

    fn check_chains(&mut self, chains: &[Chain]) -> Result<(), Error> {
        let sine = chains.iter().map(|chain| chain.crossing).fold(1.0, f64::min);
        self.report.crossing = sine.clamp(0.0, 1.0).asin().to_degrees();
        self.report.chains = chains.len();
        self.report.features = chains.iter().map(|chain| chain.features.len()).sum();
        let open = chains.iter().filter(|chain| !chain.closed);
        let mut ends: Vec<u32> = open
            .filter_map(|chain| Some([*chain.vertices.first()?, *chain.vertices.last()?]))
            .flatten()
            .collect();
        ends.sort_unstable();
        self.report.junctions = ends.chunk_by(|a, b| a == b).filter(|same| same.len() > 2).count();
        if self.report.crossing < LEAST_CROSSING {
            let text = format!(
                "the surfaces meet at {:.1} degrees somewhere along their curve: where it runs is not well known",
                self.report.crossing
            );
            if !self.settings.allow_tangent {
                return Err(CageError::Operation(format!(
                    "{text}; move an operand, take the exact boolean of the limit meshes, or allow tangential curves"
                ))
                .into());
            }
            self.report.warnings.push(text);
        }
        Ok(())
    }

    /// A cage with faces beside the curve halved `refined` times.
    fn attempt(&mut self, measure: &Measure<'_>, refined: u32) -> Result<Attempt, Error> {
        let Measure { operands, start, chains, .. } = *measure;
        // 1. The cage's faces.
        let sizes = Sizes::new(chains, start.curve_sizes(chains, refined));
        let steps = start.steps(&sizes);
        let mut work = build::work(start, chains, &sizes, &steps)?;
        let left_over = coarsen::coarsen(&mut work);
        relax::polish(&mut work, chains);
        relax::relax(&mut work, chains, operands, &start.reversed);
        coarsen::turn_edges(&mut work);
        let mut draft = assemble(&work, operands, &start.reversed)?;
        self.took("cage");
        // 2. Its control points.
        let mut fit = Fit::new(&draft, operands, &start.reversed, chains, self.settings.rings, 2);
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
        let region = measure.region(&draft, &fit.unknown);
        let (errors, of_face) = measure.errors(&draft, &region, MEASURED_STEPS);
        self.took("measure");
        Ok(Attempt { draft, errors, of_face, region, refined, left_over })
    }

    fn describe(&mut self, best: &Attempt, operands: &[Operand]) {
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
                "the cage is within {:.3e} of the exact result, not {:.3e}; the largest distance is {place}: refine the cages there, or allow more",
                errors.largest(),
                self.tolerance
            ));
        }
    }
}

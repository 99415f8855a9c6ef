//! Functions of space as `slice` and `grid` take them: of a model, of a mesh, of a formula.

use std::sync::Arc;

use clap::ArgMatches;
use trisect::field::{Expression, Formula, Graph, SignRule, SignedDistance, System};
use trisect::mesh::Gate;
use trisect::model::{Evaluation, Model};
use trisect::{Control, Solid};

use super::fault::Fault;
use super::field_arguments::{self, Rule, Source};
use super::reading;
use super::requests;
use super::selection;
use super::session::Session;

/// A function of space and where to look at it.
pub(crate) struct Field {
    pub(crate) expression: Expression,
    /// The distance itself, if the function is a mesh's.
    pub(crate) distance: Option<Arc<SignedDistance>>,
    pub(crate) bounds: [[f64; 3]; 2],
    /// What it is the function of, for messages.
    pub(crate) name: String,
}

impl Field {
    /// The rule by which a mesh's inside was told.
    pub(crate) fn sign(&self) -> Option<&'static str> {
        self.distance.as_ref().map(|distance| field_arguments::rule_name(distance.decided_by()))
    }
}

/// Reads what the command line names.
pub(crate) fn field(
    source: &Source,
    matches: &ArgMatches,
    session: &mut Session<'_>,
    control: &Control,
) -> Result<Field, Fault> {
    let mut distance = None;
    let requests = requests::placed_requests(matches)?;
    let is_cage = requests.iter().any(requests::Request::is_cage);
    let (expression, own, name) = if let Some(text) = &source.formula {
        let formula = Formula::parse(text).map_err(trisect::Error::from)?;
        let expression = formula.compile(System::default(), &[], &[]).map_err(trisect::Error::from)?;
        (expression, None, "the formula".to_owned())
    } else if let Some(path) = source.files.iter().find(|path| is_json(path) && !is_cage) {
        if requests.iter().any(|request| !request.transforms.is_empty()) || source.reading.format.is_some() {
            return Err(Fault::usage("a model file takes neither transforms nor --format"));
        }
        let model = Model::load(path)?;
        let evaluation = Evaluation::new().control(control.clone());
        let expression = evaluation.field(&model)?;
        let own = if source.bounds.is_some() { None } else { evaluation.bounds(&model)? };
        (expression, own, path.display().to_string())
    } else {
        let mut requests = requests::requests(matches, source.reading.format)?;
        let request = requests.pop().ok_or_else(|| Fault::usage("a file or --formula is needed"))?;
        let of_input = |error: trisect::Error| error.of_operand(0, request.name());
        let request = selection::together(request.clone(), &session.limits, control).map_err(of_input)?;
        let input = reading::read(&request, &session.limits, control)
            .map_err(|error| error.of_operand(0, request.name()))?;
        for warning in &input.warnings {
            session.warn(format!("{}: {warning}", request.name()));
        }
        // Seams and the like are mended as for an operand; what cannot be one is taken as it is.
        let mended = Gate::new().solid(input.mesh).map_or_else(|refusal| refusal.mesh, Solid::into_mesh);
        let found = Arc::new(SignedDistance::of_mesh_within(&mended, source.sign.rule(), control));
        control.check().map_err(trisect::Error::from)?;
        if source.sign == Rule::Automatic && found.decided_by() == SignRule::FastWinding {
            session.warn(open_surface(&request.name()));
        }
        let mut graph = Graph::new();
        let root = graph.leaf(Arc::<SignedDistance>::clone(&found));
        let own = found.tree().bounds();
        distance = Some(found);
        (Expression::new(graph, root), own, request.name())
    };
    let bounds = match (source.bounds, own) {
        (Some(bounds), _) => bounds,
        (None, Some(own)) => widened(own),
        (None, None) => {
            let found = expression.positive_bounds(None, control)?;
            widened(found.ok_or_else(|| {
                Fault::unusable(format!("{name} is positive nowhere: say by --bounds where to look"))
            })?)
        }
    };
    Ok(Field { expression, distance, bounds, name })
}

/// What is said of a mesh that encloses nothing for certain.
fn open_surface(name: &str) -> String {
    format!(
        "{name}: it is not closed (`trisect check` says where), so its inside is a guess: where the generalised winding \
         number is above one half (--sign fast-winding asks for that)"
    )
}

fn is_json(path: &std::path::Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

fn widened([low, high]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let room = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max) * 0.1;
    [low.map(|x| x - room), high.map(|x| x + room)]
}

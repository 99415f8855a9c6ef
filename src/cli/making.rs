//! `hull`, `text`, `minkowski`, `offset` and `hollow`.

use std::path::PathBuf;
use std::time::Instant;

use clap::ArgMatches;
use serde_json::{Value, json};
use trisect::making::{self as library, OffsetOptions};
use trisect::{Control, Error, Mesh, Solid};

use super::argument_groups::{Inputs, Results, Smoothness};
use super::combine;
use super::fault::{Exit, Fault};
use super::made;
use super::making_arguments::{Hollow, Hull, Minkowski, Offset, Text};
use super::reading;
use super::requests;
use super::selection;
use super::session::Session;
use super::words;

/// Makes the convex hull of all inputs.
pub(crate) fn run(arguments: &Hull, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let control = session.control();
    let requests = requests::requests(matches, arguments.from.reading.format)?;
    let requests = selection::each(requests, &session.limits, &control)?;
    let targets = made::targets(&arguments.results, session)?;
    let start = Instant::now();
    let (mut points, mut format, mut described) = (Vec::new(), None, Vec::<Value>::new());
    for (index, request) in requests.into_iter().enumerate() {
        let name = request.name();
        session.console.stage(&format!("reading {name}"), 0.0);
        let input = reading::read(&request, &session.limits, &control)
            .map_err(|error| error.of_operand(index, name.clone()))?;
        for warning in input.warnings {
            session.warn(format!("{name}: {warning}"));
        }
        warn_of_lost(&input.mesh, &name, "hull", session);
        // Vertices that no triangle uses are no part of the surface.
        let mut used: Vec<u32> = input.mesh.triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let corners = used.iter().filter_map(|&vertex| input.mesh.positions.get(vertex as usize));
        points.extend(corners);
        format.get_or_insert(input.format);
        let triangles = input.mesh.triangles.len();
        session.console.say(&format!("{name}: {}", words::counted(triangles, "triangle")));
        described.push(
            json!({ "operand": index + 1, "file": name, "triangles": triangles, "points": used.len() }),
        );
    }
    session.took("read", start);
    session.note("operands", described);

    let start = Instant::now();
    let hull = library::convex_hull(&points).map_err(unusable)?;
    let solid = Solid::try_from(hull).map_err(Error::from)?;
    let seconds = session.took("run", start);
    made::deliver(&solid, &arguments.results, &targets, format, seconds, session)?;
    Ok(Exit::Fine)
}

/// Sets text.
pub(crate) fn run_text(
    arguments: &Text,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let control = session.control();
    let start = Instant::now();
    let named = |text: PathBuf| format!("text:{}", text.display()).into();
    let mut requests = requests::placed_inputs(matches, named)?;
    let Some(request) = requests.pop() else { return Err(Fault::usage("a text is needed")) };
    let targets = made::targets(&arguments.results, session)?;
    let mesh = reading::read(&request, &session.limits, &control)?.mesh;
    let solid = Solid::try_from(mesh).map_err(Error::from)?;
    let seconds = session.took("run", start);
    made::deliver(&solid, &arguments.results, &targets, None, seconds, session)?;
    Ok(Exit::Fine)
}

/// Makes the Minkowski sum of two inputs.
pub(crate) fn run_minkowski(
    arguments: &Minkowski,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let control = session.control();
    let requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    let requests = selection::joined(requests, &session.limits, &control)?;
    if requests.len() != 2 {
        return Err(Fault::usage(format!(
            "minkowski takes two inputs, the solid and the convex tool, not {}: minkowski BODY TOOL -o OUTPUT",
            requests.len()
        )));
    }
    let targets = made::targets(&arguments.results, session)?;
    let assume_clean = arguments.inputs.using.assume_clean;
    let writing = Some(&arguments.results.writing);
    let operands = combine::read(requests, assume_clean, writing, &control, session)?;
    let [body, tool] = &*operands else { return Err(Fault::internal("two operands")) };
    if !tool.solid.is_convex() {
        return Err(Fault::unusable(format!(
            "operand 2 ({}): the tool of a Minkowski sum must be convex, and this is not; `trisect hull {} -o hull.stl` makes its \
             hull",
            tool.request.name(),
            tool.request.name()
        )));
    }
    for operand in &operands {
        warn_of_lost(operand.solid.mesh(), &operand.request.name(), "sum", session);
    }
    let start = Instant::now();
    session.console.stage("summing up", 0.0);
    let solid = library::minkowski_sum(&body.solid, &tool.solid, &control)?;
    let seconds = session.took("run", start);
    made::deliver(&solid, &arguments.results, &targets, Some(body.format), seconds, session)?;
    Ok(Exit::Fine)
}

/// Grows or shrinks one input.
pub(crate) fn run_offset(
    arguments: &Offset,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let options = offsetting(arguments.tolerance, arguments.smoothness);
    let of = |solid: &Solid, control: &Control| {
        options.clone().control(control.clone()).offset(solid, arguments.distance)
    };
    let verb = Verb { name: "offset", is_new: true };
    from_distance(verb, &arguments.inputs, &arguments.results, matches, session, of)
}

/// Hollows one input.
pub(crate) fn run_hollow(
    arguments: &Hollow,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let options = offsetting(arguments.tolerance, arguments.smoothness);
    let of = |solid: &Solid, control: &Control| {
        options.clone().control(control.clone()).hollow(solid, arguments.wall, &arguments.drain)
    };
    let verb = Verb { name: "hollow", is_new: false };
    from_distance(verb, &arguments.inputs, &arguments.results, matches, session, of)
}

fn offsetting(tolerance: Option<f64>, smoothness: Smoothness) -> OffsetOptions {
    let options = OffsetOptions::new().smooth(!smoothness.no_smooth);
    match tolerance {
        Some(tolerance) => options.tolerance(tolerance),
        None => options,
    }
}

/// A verb that makes something of a distance field.
struct Verb {
    name: &'static str,
    /// Whether nothing of the input's own surface is left.
    is_new: bool,
}

/// Makes something of the distance field of one input.
fn from_distance(
    Verb { name: verb, is_new }: Verb,
    inputs: &Inputs,
    results: &Results,
    matches: &ArgMatches,
    session: &mut Session<'_>,
    make: impl Fn(&Solid, &Control) -> Result<library::Offset, Error>,
) -> Result<Exit, Fault> {
    let control = session.control();
    let requests = requests::requests(matches, inputs.from.reading.format)?;
    let requests = selection::joined(requests, &session.limits, &control)?;
    if requests.len() != 1 {
        return Err(Fault::usage(format!("{verb} takes one input, not {}", requests.len())));
    }
    let targets = made::targets(results, session)?;
    let assume_clean = inputs.using.assume_clean;
    let operands = combine::read(requests, assume_clean, Some(&results.writing), &control, session)?;
    let [operand] = &*operands else { return Err(Fault::internal("one operand")) };
    if is_new {
        warn_of_lost(operand.solid.mesh(), &operand.request.name(), verb, session);
    }
    let start = Instant::now();
    session.console.stage(verb, 0.0);
    let made = make(&operand.solid, &control).map_err(unusable)?;
    let seconds = session.took("run", start);
    session.note("tolerance", made.tolerance);
    session.note("deviation", made.deviation);
    session.note("normal_deviation", made.normal_deviation);
    made::deliver(&made.solid, results, &targets, Some(operand.format), seconds, session)?;
    let (deviation, tolerance) = (words::short(made.deviation), words::short(made.tolerance));
    session.console.say(&format!("within {deviation} of the true {verb} (tolerance {tolerance})"));
    Ok(Exit::Fine)
}

/// Says what a surface that is made anew has no place for.
fn warn_of_lost(mesh: &Mesh, name: &str, made: &str, session: &mut Session<'_>) {
    let groups = (!mesh.groups.list.is_empty()).then(|| "groups and materials".to_owned());
    let attributes = mesh.attributes.iter().map(|attribute| attribute.name.clone());
    let lost: Vec<String> = groups.into_iter().chain(attributes).collect();
    if !lost.is_empty() {
        session.warn(format!("{name}: {} not kept: the {made} is a new surface", lost.join(", ")));
    }
}

/// Points without a hull are no fault of the command line.
fn unusable(error: Error) -> Fault {
    match error {
        Error::InvalidArgument(what) => Fault::unusable(what),
        other => other.into(),
    }
}

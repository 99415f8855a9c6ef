//! `split`: bodies, face groups, and the cells that one solid makes of another, as files of their own.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::Value;
use trisect::io::Format;
use trisect::mesh::Gate;
use trisect::{BooleanOptions, Expression, Mesh, Outcome, Solid};

use super::argument_groups::{Colours, Results};
use super::chosen;
use super::combine;
use super::cut_arguments::Split;
use super::fault::{Exit, Fault};
use super::operands::{self, Operand};
use super::output::{self, Product, Target};
use super::report::Measures;
use super::requests::{self, Request};
use super::selection;
use super::session::Session;
use super::words;

/// A part that is written to files of its own.
struct Part {
    /// What its files' names end with.
    suffix: String,
    mesh: Mesh,
    solid: Option<Solid>,
    /// The operand that each triangle came from.
    operands: Vec<usize>,
}

impl Part {
    fn of_solid(suffix: String, solid: Solid) -> Self {
        let (mesh, operands) = (solid.mesh().clone(), vec![0; solid.mesh().triangles.len()]);
        Self { suffix, mesh, solid: Some(solid), operands }
    }

    fn of_outcome(suffix: String, outcome: Outcome) -> Self {
        let operands = outcome.origins().iter().map(|origin| origin.operand as usize).collect();
        Self { operands, ..Self::of_solid(suffix, outcome.into_solid()) }
    }
}

/// Splits an input.
pub(crate) fn run(arguments: &Split, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let mut requests = requests::requests(matches, arguments.inputs.reading.format)?;
    if requests.len() > 1 {
        return Err(Fault::usage("split takes one input; --by FILE names the solid that it is cut by"));
    }
    if let Some(by) = &arguments.by {
        let (path, part) = chosen::split(by.clone());
        let of_input = requests.first().cloned().ok_or_else(|| Fault::usage("an input is needed"))?;
        requests.push(Request { path, part, format: None, transforms: Vec::new(), ..of_input });
    }
    let targets = output::targets(&arguments.results.writing, &arguments.results.drawing, session.common)?;
    if targets.is_empty() && !session.common.json && session.common.report.is_none() {
        return Err(Fault::usage(
            "nowhere to put the parts: add -o FILE, whose name gets a number for each part, or --json",
        ));
    }
    let control = session.control();
    for (index, request) in requests.iter_mut().enumerate() {
        let name = request.name();
        *request = selection::together(request.clone(), &session.limits, &control)
            .map_err(|error| Fault::from(error.of_operand(index, name)))?;
    }

    let start = Instant::now();
    let assume_clean = arguments.inputs.using.assume_clean;
    let operands = operands::operands(requests, assume_clean, &session.limits, &control, &session.console)?;
    session.took("read", start);
    combine::describe(&operands, Some(&arguments.results.writing), session);
    let start = Instant::now();
    let options = BooleanOptions::new()
        .rules(operands.iter().map(|operand| operand.request.rule))
        .assume_clean(assume_clean)
        .control(control);
    let parts = parts(arguments, &operands, &options)?;
    let seconds = session.took("run", start);
    let format = operands.first().map(|operand| operand.format);
    write(&arguments.results, &targets, &parts, format, seconds, session)
}

fn parts(arguments: &Split, operands: &[Operand], options: &BooleanOptions) -> Result<Vec<Part>, Fault> {
    let [input, tools @ ..] = operands else { return Err(Fault::usage("an input is needed")) };
    if arguments.groups {
        let mesh = input.solid.mesh();
        let groups = mesh.by_group();
        let part = |(group, mesh): (u32, Mesh)| {
            let name =
                input.solid.mesh().groups.list.get(group as usize).map_or("", |group| group.name.as_str());
            let operands = vec![group as usize; mesh.triangles.len()];
            Part { suffix: format!("-{}", file_name(name, group)), solid: closed(&mesh), mesh, operands }
        };
        return Ok(groups.into_iter().map(part).collect());
    }
    let Some(tool) = tools.first() else {
        return Ok(numbered("", input_bodies(input, options)?));
    };
    let both = || vec![Expression::Operand(0), Expression::Operand(1)];
    let cells = [
        Expression::Difference(both()),
        Expression::Intersection(both()),
        Expression::Difference(vec![Expression::Operand(1), Expression::Operand(0)]),
    ];
    let outcomes = options.evaluate_all(&cells, [&input.solid, &tool.solid])?;
    let named = outcomes.into_iter().zip(["-difference", "-intersection", "-reverse"]);
    let parts = named.filter(|(outcome, _)| !outcome.solid().is_empty()).flat_map(|(outcome, name)| {
        if arguments.explode {
            numbered(name, outcome.solid().bodies())
        } else {
            vec![Part::of_outcome(name.to_owned(), outcome)]
        }
    });
    Ok(parts.collect())
}

/// A group that is closed by itself, as a solid.
fn closed(mesh: &Mesh) -> Option<Solid> {
    Gate::new().as_is(true).solid(mesh.clone()).ok()
}

/// The bodies of an input, which is resolved where it crosses itself.
fn input_bodies(input: &Operand, options: &BooleanOptions) -> Result<Vec<Solid>, Fault> {
    let crosses = input.crossings.as_ref().is_some_and(|crossings| crossings.count + crossings.touching > 0);
    if crosses {
        return Ok(options.resolve(&input.solid)?.solid().bodies());
    }
    Ok(input.solid.bodies())
}

/// Bodies by size, the largest first, with numbers of as many digits as the last one has.
fn numbered(name: &str, mut bodies: Vec<Solid>) -> Vec<Part> {
    bodies.sort_by(|x, y| y.volume().total_cmp(&x.volume()));
    let digits = bodies.len().to_string().len();
    let part = |(index, body): (usize, Solid)| Part::of_solid(format!("{name}-{:0digits$}", index + 1), body);
    bodies.into_iter().enumerate().map(part).collect()
}

/// A group's name as a part of a file's name, with its number, since groups may have the same name.
fn file_name(name: &str, group: u32) -> String {
    let kept: String = name
        .chars()
        .map(|c| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '_' })
        .collect();
    if kept.is_empty() { format!("{}", group + 1) } else { format!("{}-{kept}", group + 1) }
}

/// Writes all parts and says what they are.
fn write(
    results: &Results,
    targets: &[Target],
    parts: &[Part],
    format: Option<Format>,
    seconds: f64,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let (mut described, mut outputs): (Vec<Value>, Vec<Value>) = (Vec::new(), Vec::new());
    for part in parts {
        let targets: Vec<Target> =
            targets.iter().map(|target| target.with_suffix(&part.suffix)).collect::<Result<_, _>>()?;
        let picture = || {
            let operands = part.operands.iter().copied();
            let colours = output::colours(results.drawing.png_color.unwrap_or(Colours::Operand), operands);
            trisect::render::mesh(&part.mesh, &output::view(&results.drawing, format), colours.as_deref())
        };
        let options = output::write_options(&results.writing, &session.limits);
        let product = Product { mesh: &part.mesh, options, picture: &picture, documents: &[] };
        let (written, warnings) = output::write_all(&targets, &product, &session.limits)?;
        warnings.into_iter().for_each(|warning| session.warn(warning));
        outputs.extend(written);
        let measures = part.solid.as_ref().map_or_else(|| Measures::of_mesh(&part.mesh), Measures::of_solid);
        let mut object = measures.to_json();
        let name = part.suffix.trim_start_matches('-').to_owned();
        object.insert("part".into(), name.clone().into());
        described.push(object.into());
        let names: Vec<String> = targets.iter().map(Target::name).collect();
        let arrow = if names.is_empty() { String::new() } else { format!(" -> {}", names.join(", ")) };
        session.console.say(&format!("{name}: {}{arrow}", measures.line()));
    }
    session.took("write", start);
    session.note("results", described);
    session.note("outputs", outputs);
    session.console.say(&format!("{} ({})", words::counted(parts.len(), "part"), words::time(seconds)));
    Ok(Exit::Fine)
}

//! `split`: bodies, face groups, and the cells that one solid makes of another, as files of their own.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::Value;
use trisect::mesh::Gate;
use trisect::{BooleanOptions, Cell, Expression, Mesh, Outcome, Solid};

use super::argument_groups::{Colours, Results};
use super::chosen;
use super::combine;
use super::cut_arguments::Split;
use super::fault::{Exit, Fault};
use super::operands::{self, Operand};
use super::output::{self, Target};
use super::report::{self, Measures};
use super::requests::{self, Request};
use super::scenes;
use super::selection;
use super::session::Session;
use super::trim::{self, Sheet};
use super::words;
use super::written::Written;

/// A part that is written to files of its own.
struct Part {
    /// What its files' names end with.
    suffix: String,
    mesh: Mesh,
    measures: Measures,
    /// The operand that each triangle came from.
    operands: Vec<usize>,
}

impl Part {
    fn of_solid(suffix: String, solid: Solid) -> Self {
        let measures = Measures::of_solid(&solid);
        let mesh = solid.into_mesh();
        let operands = vec![0; mesh.triangles.len()];
        Self { suffix, mesh, measures, operands }
    }

    fn of_outcome(suffix: String, outcome: Outcome) -> Self {
        let operands = outcome.origins().iter().map(|origin| origin.operand as usize).collect();
        Self { operands, ..Self::of_solid(suffix, outcome.into_solid()) }
    }
}

/// Splits an input.
pub(crate) fn run(arguments: &Split, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let mut requests = requests(arguments, matches)?;
    let writing = &arguments.results.writing;
    scenes::name_node(&mut requests, writing)?;
    let targets = output::targets(writing, &arguments.results.drawing, session.common)?;
    if targets.is_empty() && !session.is_reported() {
        return Err(Fault::usage(
            "nowhere to put the parts: add -o FILE, whose name gets a number for each part, or --json",
        ));
    }
    let control = session.control();
    let mut requests = selection::joined(requests, &session.limits, &control)?;
    let sheet_requests = requests.split_off(requests.len() - arguments.sheet.len());
    let write_options =
        scenes::kept(output::write_options(writing, &session.limits), writing, requests.first())?;
    // (Their names get ends, which the folder does not mind.)
    output::probe(&targets, &session.limits)?;

    let start = Instant::now();
    let assume_clean = arguments.inputs.using.assume_clean;
    let operands = operands::operands(requests, assume_clean, &session.limits, &control, &session.console)?;
    session.took("read", start);
    combine::describe(&operands, Some(writing), session);
    let mut sheets: Vec<Sheet> = Vec::new();
    for (number, request) in sheet_requests.iter().enumerate() {
        sheets.push(trim::sheet(request, number + 1, writing, &control, session)?);
    }
    let start = Instant::now();
    let options = session
        .boolean_options(control)
        .rules(operands.iter().map(|operand| operand.request.rule))
        .assume_clean(assume_clean);
    let parts = if sheets.is_empty() {
        parts(arguments, &operands, &options, session)?
    } else {
        between(&operands, &sheets, &options)?
    };
    let seconds = session.took("run", start);
    let format = operands.first().map(|operand| operand.format);
    let style = combine::Style { format, options: write_options };
    write(&arguments.results, &targets, &parts, &style, seconds, session)
}

/// The input, the solid that it is cut by if there is one, and the surfaces that it is parted by; those are mended as the input is.
fn requests(arguments: &Split, matches: &ArgMatches) -> Result<Vec<Request>, Fault> {
    let mut requests = requests::placed_requests(matches)?;
    if requests.len() > 1 {
        return Err(Fault::usage("split takes one input; --by FILE names the solid that it is cut by"));
    }
    let input = requests.first().cloned().ok_or_else(|| Fault::usage("an input is needed"))?;
    requests.extend(arguments.by.iter().chain(&arguments.sheet).map(|path| {
        let (path, part) = chosen::split(path.clone());
        Request { path, part, chosen: None, transforms: Vec::new(), ..input.clone() }
    }));
    requests::name_formats(&mut requests, arguments.inputs.from.reading.format)?;
    Ok(requests)
}

/// The cells between surfaces, the largest first.
fn between(operands: &[Operand], sheets: &[Sheet], options: &BooleanOptions) -> Result<Vec<Part>, Fault> {
    let [input, ..] = operands else { return Err(Fault::usage("an input is needed")) };
    let surfaces: Vec<&Mesh> = sheets.iter().map(|sheet| &sheet.mesh).collect();
    let mut cells = options.split(&input.solid, &surfaces)?;
    cells.sort_by(|x, y| y.solid.volume().total_cmp(&x.solid.volume()));
    let digits = cells.len().to_string().len();
    let part = |(index, cell): (usize, Cell)| {
        let operands = cell.origins.iter().map(|origin| origin.operand as usize).collect();
        Part { operands, ..Part::of_solid(format!("-{:0digits$}", index + 1), cell.solid) }
    };
    Ok(cells.into_iter().enumerate().map(part).collect())
}

fn parts(
    arguments: &Split,
    operands: &[Operand],
    options: &BooleanOptions,
    session: &mut Session<'_>,
) -> Result<Vec<Part>, Fault> {
    let [input, tools @ ..] = operands else { return Err(Fault::usage("an input is needed")) };
    if arguments.groups {
        let mesh = input.solid.mesh();
        let groups = mesh.by_group();
        let part = |(group, surface): (u32, Mesh)| {
            let name = mesh.groups.list.get(group as usize).map_or("", |group| group.name.as_str());
            let operands = vec![group as usize; surface.triangles.len()];
            let suffix = format!("-{}", file_name(name, group));
            Part { suffix, measures: measures_of_group(&surface), mesh: surface, operands }
        };
        return Ok(groups.into_iter().map(part).collect());
    }
    let Some(tool) = tools.first() else {
        return Ok(numbered("", input_bodies(operands, input, options, session)?));
    };
    let both = || vec![Expression::Operand(0), Expression::Operand(1)];
    let cells = [
        Expression::Difference(both()),
        Expression::Intersection(both()),
        Expression::Difference(vec![Expression::Operand(1), Expression::Operand(0)]),
    ];
    let outcomes = options.evaluate_all(&cells, [&input.solid, &tool.solid])?;
    if let Some(outcome) = outcomes.first() {
        combine::warn_of_inward(outcome, operands, session);
        if let Some(warning) = report::nearly_flush(outcome.nearly_flush()) {
            session.warn(warning);
        }
    }
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

/// The measures of a group, those of a solid if it is closed by itself.
fn measures_of_group(mesh: &Mesh) -> Measures {
    let solid = Gate::new().as_is(true).solid(mesh.clone());
    solid.map_or_else(|_| Measures::of_mesh(mesh), |solid| Measures::of_solid(&solid))
}

/// The bodies of an input, which is resolved where it crosses itself.
fn input_bodies(
    operands: &[Operand],
    input: &Operand,
    options: &BooleanOptions,
    session: &mut Session<'_>,
) -> Result<Vec<Solid>, Fault> {
    let crosses = input.crossings.as_ref().is_some_and(|crossings| crossings.count + crossings.touching > 0);
    if crosses {
        let outcome = options.resolve(&input.solid)?;
        combine::warn_of_inward(&outcome, operands, session);
        return Ok(outcome.solid().bodies());
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
    style: &combine::Style,
    seconds: f64,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let (mut described, mut outputs): (Vec<Value>, Vec<Value>) = (Vec::new(), Vec::new());
    for part in parts {
        let targets: Vec<Target> =
            targets.iter().map(|target| target.with_suffix(&part.suffix)).collect::<Result<_, _>>()?;
        let written = Written {
            usual: Colours::Operand,
            operand: &|triangle| part.operands[triangle],
            ..Written::new(&part.mesh, style.options.clone(), style.format)
        };
        outputs.extend(written.to(&targets, &results.writing, &results.drawing, session)?);
        let mut object = part.measures.to_json();
        let name = part.suffix.trim_start_matches('-').to_owned();
        object.insert("part".into(), name.clone().into());
        described.push(object.into());
        let arrow = output::arrow(&targets);
        session.console.say(&format!("{name}: {}{arrow}", part.measures.line()));
    }
    session.took("write", start);
    session.note("results", described);
    session.note("outputs", outputs);
    session.console.say(&format!("{} ({})", words::counted(parts.len(), "part"), words::time(seconds)));
    Ok(Exit::Fine)
}

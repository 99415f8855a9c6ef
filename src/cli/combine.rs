//! `union`, `difference`, `intersection`, `xor`, `combine`, `resolve`.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::Value;
use trisect::io::{Format, WriteOptions};
use trisect::{
    BooleanOptions, Control, Embed, FaceGroup, Grid, OperandState, Operation, Outcome, Rule, Solid,
};

use super::argument_groups::{Colours, Results, Writing};
use super::arguments::{Combination, Combine};
use super::fault::{Exit, Fault};
use super::mended;
use super::operands::{self, Operand};
use super::output::{self, Target};
use super::report::{self, Measures};
use super::requests::{self, Request};
use super::scenes;
use super::selection;
use super::session::Session;
use super::surface;
use super::task::Task;
use super::values;
use super::words;
use super::written::Written;

/// Runs a boolean of the inputs.
pub(crate) fn run(
    operation: Operation,
    arguments: &Combine,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    run_task(&Task::Operation(operation), requests, arguments, session)
}

/// Evaluates expressions of the inputs.
pub(crate) fn run_combination(
    arguments: &Combination,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let combine = &arguments.combine;
    let mut requests = requests::requests(matches, combine.inputs.from.reading.format)?;
    let task = Task::of(arguments, &mut requests)?;
    run_task(&task, requests, combine, session)
}

/// Resolves one input.
pub(crate) fn run_resolve(
    arguments: &Combine,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    if requests.len() > 1 {
        return Err(Fault::usage("resolve takes one input; union unites several, each resolved first"));
    }
    run_task(&Task::Resolve, requests, arguments, session)
}

fn run_task(
    task: &Task,
    requests: Vec<Request>,
    arguments: &Combine,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let targets = output::targets(&arguments.results.writing, &arguments.results.drawing, session.common)?;
    refuse_pointless(arguments, &targets, session)?;
    let mut requests = requests;
    scenes::name_node(&mut requests, &arguments.results.writing)?;
    let requests = parts(task, requests, session)?;
    let writing = &arguments.results.writing;
    let write_options =
        scenes::kept(output::write_options(writing, &session.limits), writing, requests.first())?;
    if requests.len() < task.least_inputs() {
        return Err(Fault::usage("at least two inputs are needed: FILE1 FILE2 ... -o OUTPUT"));
    }
    let suffixes = task.suffixes();
    let targets: Vec<Vec<Target>> = suffixes
        .iter()
        .map(|suffix| targets.iter().map(|target| target.with_suffix(suffix)).collect())
        .collect::<Result<_, _>>()?;
    if !arguments.dry_run {
        targets.iter().try_for_each(|targets| output::probe(targets, &session.limits))?;
    }

    let control = session.control();
    let assume_clean = arguments.inputs.using.assume_clean;
    let operands = read(requests, assume_clean, Some(&arguments.results.writing), &control, session)?;
    let operands = if arguments.color_by.is_some() { grouped(operands) } else { operands };
    if arguments.dry_run {
        announce(task, &operands, &targets.concat(), session);
        return Ok(Exit::Fine);
    }

    let start = Instant::now();
    let options = options(arguments, &operands, &targets.concat(), session, control);
    let solids: Vec<&Solid> = operands.iter().map(|operand| &operand.solid).collect();
    let outcomes = task.run(&options, &solids)?;
    let seconds = session.took("run", start);

    if let Some(outcome) = outcomes.first() {
        warn_of_inward(outcome, &operands, session);
    }
    let first = operands.first();
    let style = Style { format: first.map(|operand| operand.format), options: write_options };
    finish(arguments, &outcomes, &targets, &suffixes, &style, seconds, session)?;
    Ok(Exit::Fine)
}

/// How results are written: the format of the first operand, which tells what is up, and the options.
pub(super) struct Style {
    pub(super) format: Option<Format>,
    pub(super) options: WriteOptions,
}

/// Writes all results and says what they are.
fn finish(
    arguments: &Combine,
    outcomes: &[Outcome],
    targets: &[Vec<Target>],
    suffixes: &[&'static str],
    style: &Style,
    seconds: f64,
    session: &mut Session<'_>,
) -> Result<(), Fault> {
    let mut results = Vec::new();
    let mut outputs = Vec::new();
    for ((outcome, targets), suffix) in outcomes.iter().zip(targets).zip(suffixes) {
        let name = suffix.strip_prefix('-').unwrap_or("result");
        let is_reported = session.is_reported();
        let write = || write(&arguments.results, targets, outcome, style, session);
        outputs.extend(while_looking_at(outcome, is_reported, write)?);
        results.push(tell(name, outcome, targets, seconds, session));
    }
    if let Some(first) = results.first() {
        session.note("result", first.clone());
    }
    if results.len() > 1 {
        session.note("results", results);
    }
    session.note("outputs", outputs);
    Ok(())
}

/// What `write` returns, which runs while another thread, if there is one, finds out what [`tell`] will ask of the result.
///
/// Neither waits for the other: what is found out is computed outside of locks, and what both ask for meanwhile is computed twice (by pages alone).
#[cfg(feature = "parallel")]
fn while_looking_at<T: Send>(outcome: &Outcome, is_reported: bool, write: impl FnOnce() -> T + Send) -> T {
    if rayon::current_num_threads() == 1 {
        return write();
    }
    let look = || {
        let _ = outcome.nearly_flush();
        let _ = Measures::for_line(outcome.solid());
        if is_reported {
            let _ = outcome.certificate();
        }
    };
    rayon::join(write, look).0
}

#[cfg(not(feature = "parallel"))]
fn while_looking_at<T>(_: &Outcome, _: bool, write: impl FnOnce() -> T) -> T {
    write()
}

/// How the operands are combined.
fn options(
    arguments: &Combine,
    operands: &[Operand],
    targets: &[Target],
    session: &Session<'_>,
    control: Control,
) -> BooleanOptions {
    let solids = operands.iter().map(|operand| &operand.solid);
    let cut_faces = surface::cut_faces(arguments.cut_material.as_deref(), arguments.cut_uv, solids);
    let options = session
        .boolean_options(control)
        .rules(operands.iter().map(|operand| operand.request.rule))
        .embed(embedding(arguments, targets))
        .cut_faces(cut_faces)
        .assume_clean(arguments.inputs.using.assume_clean);
    match arguments.snap {
        Some(distance) => options.snap(distance),
        None => options,
    }
}

/// Warns of inverted bodies of operands that the rule leaves out.
pub(super) fn warn_of_inward(outcome: &Outcome, operands: &[Operand], session: &mut Session<'_>) {
    for (index, (state, operand)) in outcome.operand_states().iter().zip(operands).enumerate() {
        if let OperandState::Resolved { inward_volume, .. } = *state
            && inward_volume > 0.0
            && operand.request.rule == Rule::Positive
        {
            session.warn(format!(
                "operand {} ({}): a volume of {} is wound around inwards, which is no material by the rule positive; --rule \
                 nonzero makes it some, and --orient turns shells that face inwards",
                index + 1,
                operand.request.name(),
                words::short(inward_volume),
            ));
        }
    }
}

/// Says what a result is, and returns it for the report.
pub(super) fn tell(
    name: &str,
    outcome: &Outcome,
    targets: &[Target],
    seconds: f64,
    session: &mut Session<'_>,
) -> Value {
    // What nobody is told is not computed.
    let measures = if session.is_reported() {
        Measures::of_solid(outcome.solid())
    } else {
        Measures::for_line(outcome.solid())
    };
    let mut result = measures.to_json();
    if session.is_reported() {
        result.insert("certificate".into(), report::certificate(outcome.certificate()));
    }
    if let Some(warning) = report::nearly_flush(outcome.nearly_flush()) {
        session.warn(warning);
    }
    if let Some(snapping) = outcome.snapping() {
        session.console.say(&format!("{name}: {}", report::snapping(snapping)));
        if snapping.unfinished {
            session.warn(format!("{name}: something nearer than the distance to snap by was left as it was"));
        }
        if snapping.vanished > 0 {
            let inputs = words::counted(snapping.vanished as usize, "input");
            session
                .warn(format!("{name}: nothing is left of {inputs}, no larger than the distance to snap by"));
        }
    }
    if let Some(left) = outcome.embedding().map(|done| done.left).filter(|&left| left > 0) {
        let triangles = words::counted(left, "triangle");
        session.warn(format!("{name}: {triangles} still cross others or lie on them after rounding"));
    }
    let arrow = output::arrow(targets);
    session.console.say(&format!("{name}: {} ({}){arrow}", measures.line(), words::time(seconds)));
    if session.common.verbose > 0 {
        session.console.detail(&outcome.certificate().to_string());
    }
    result.into()
}

/// The operands with all faces of each in a group of its name, in the colour that pictures give it.
fn grouped(operands: Vec<Operand>) -> Vec<Operand> {
    let mut names: Vec<String> = Vec::new();
    let mut one = |(index, mut operand): (usize, Operand)| {
        let name = operand.request.short_name();
        let count = names.iter().filter(|&other| *other == name).count();
        names.push(name.clone());
        let name = if count == 0 { name } else { format!("{name} {}", count + 1) };
        let material = Some(values::plain_material(&name, trisect::render::palette(index)));
        operand.solid = operand.solid.in_group(FaceGroup { name, material });
        operand
    };
    operands.into_iter().enumerate().map(&mut one).collect()
}

/// What becomes of crossings that rounding makes.
fn embedding(arguments: &Combine, targets: &[Target]) -> Embed {
    if arguments.exact_rounding {
        return Embed::Never;
    }
    if arguments.embed {
        let single = arguments.results.writing.single || targets.iter().any(Target::is_single);
        return Embed::OnGrid(if single { Grid::Single } else { Grid::Double });
    }
    // What writing in single precision loses is told when it is written, and embedding on that grid would lose it before.
    Embed::NearCut
}

/// The inputs, one for each part of a file that is asked for; in expressions, whose operands are numbered, one for all parts
/// that one input means.
fn parts(task: &Task, mut requests: Vec<Request>, session: &Session<'_>) -> Result<Vec<Request>, Fault> {
    if requests.iter().all(|request| request.part.is_none()) {
        return Ok(requests);
    }
    let control = session.control();
    if task.numbers_inputs() {
        return Ok(selection::joined(requests, &session.limits, &control)?);
    }
    if task.is_difference() && !requests.is_empty() {
        let others = requests.split_off(1);
        let name = requests.first().map(Request::name).unwrap_or_default();
        requests = selection::each(requests, &session.limits, &control)?;
        if requests.len() > 1 {
            let names: Vec<String> = requests.iter().take(4).map(Request::name).collect();
            return Err(Fault::unusable(format!(
                "operand 1 ({name}): that are {} parts ({}{}), and a difference takes all others from one; unite them first, \
                 or name the one",
                requests.len(),
                names.join(", "),
                if requests.len() > names.len() { ", ..." } else { "" },
            )));
        }
        requests.extend(others);
    }
    Ok(selection::each(requests, &session.limits, &control)?)
}

/// Command lines that are well formed but cannot be meant.
fn refuse_pointless(arguments: &Combine, targets: &[Target], session: &Session<'_>) -> Result<(), Fault> {
    if targets.is_empty() && !session.is_reported() && !arguments.dry_run {
        return Err(Fault::usage(
            "nowhere to put the result: add -o FILE (or -o - for standard output, --png FILE, --json, --report FILE, \
             --dry-run)",
        ));
    }
    Ok(())
}

/// The operands that requests ask for, read and told of.
pub(super) fn read(
    requests: Vec<Request>,
    assume_clean: bool,
    writing: Option<&Writing>,
    control: &Control,
    session: &mut Session<'_>,
) -> Result<Vec<Operand>, Fault> {
    let start = Instant::now();
    let operands = operands::operands(requests, assume_clean, &session.limits, control, &session.console)?;
    session.took("read", start);
    describe(&operands, writing, session);
    Ok(operands)
}

/// One line and one JSON object for every operand, and its warnings.
pub(super) fn describe(operands: &[Operand], writing: Option<&Writing>, session: &mut Session<'_>) {
    let mut described = Vec::new();
    for (index, operand) in operands.iter().enumerate() {
        let measures = if session.is_reported() {
            Measures::of_solid(&operand.solid)
        } else {
            Measures::for_line(&operand.solid)
        };
        session.console.say(&report::operand_line(operand, &measures));
        if let (Some(cleaning), _) = report::cleaning(&operand.solid) {
            session.console.detail(&format!("  {cleaning}"));
        }
        for line in mended::listed(operand.solid.mending()) {
            session.console.detail(&format!("  {line}"));
        }
        for transform in &operand.request.transforms {
            session.console.detail(&format!("  {transform}"));
        }
        let lost = writing.map(|writing| scenes::lost(&operand.contents, writing, index)).unwrap_or_default();
        for warning in lost.iter().chain(&operand.warnings) {
            session.warn(format!("operand {} ({}): {warning}", index + 1, operand.request.name()));
        }
        described.push(report::operand_json(operand, index, &measures));
    }
    session.note("operands", described);
}

/// Writes a result.
pub(super) fn write(
    results: &Results,
    targets: &[Target],
    outcome: &Outcome,
    style: &Style,
    session: &mut Session<'_>,
) -> Result<Vec<Value>, Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let operand = |triangle: usize| outcome.origins()[triangle].operand as usize;
    let written = Written {
        usual: Colours::Operand,
        operand: &operand,
        outcome: Some(outcome),
        ..Written::new(outcome.solid().mesh(), style.options.clone(), style.format)
    };
    let outputs = written.to(targets, &results.writing, &results.drawing, session)?;
    session.took("write", start);
    Ok(outputs)
}

/// What `--dry-run` says.
fn announce(task: &Task, operands: &[Operand], targets: &[Target], session: &mut Session<'_>) {
    let triangles = operands.iter().map(|operand| operand.solid.mesh().triangles.len()).sum();
    let names: Vec<String> =
        targets.iter().map(|target| format!("{} ({})", target.name(), target.format())).collect();
    let writing = if names.is_empty() { "nothing".into() } else { names.join(", ") };
    session.console.say(&format!(
        "dry run: would take {} of {} with {} and write {writing}",
        task.words(),
        words::counted(operands.len(), "operand"),
        words::counted(triangles, "triangle"),
    ));
    let outputs: Vec<Value> = targets
        .iter()
        .map(|target| serde_json::json!({ "file": target.path.display().to_string(), "format": target.format() }))
        .collect();
    session.note("outputs", outputs);
    session.note("dry_run", true);
}

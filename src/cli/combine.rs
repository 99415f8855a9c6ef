//! `union`, `difference`, `intersection`, `xor`.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::Value;
use trisect::io::Format;
use trisect::{BooleanOptions, Operation, Outcome};

use super::argument_groups::Colours;
use super::arguments::Combine;
use super::fault::{Exit, Fault};
use super::operands::{self, Operand};
use super::output::{self, Product, Target};
use super::report::{self, Measures};
use super::requests;
use super::session::Session;

/// Runs a boolean of the inputs.
pub(crate) fn run(
    operation: Operation,
    arguments: &Combine,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let requests = requests::requests(matches, arguments.inputs.reading.format)?;
    let targets = output::targets(&arguments.results.writing, &arguments.results.drawing, session.common)?;
    refuse_pointless(operation, arguments, requests.len(), &targets, session)?;
    if !arguments.dry_run {
        output::probe(&targets, &session.limits)?;
    }

    let control = session.control();
    let start = Instant::now();
    let operands =
        operands::operands(requests, arguments.inputs.using, &session.limits, &control, &session.console)?;
    session.took("read", start);
    describe(&operands, session);
    if arguments.dry_run {
        announce(operation, &operands, &targets, session);
        return Ok(Exit::Fine);
    }

    let start = Instant::now();
    let mut options = BooleanOptions::new().control(control);
    if let Some(threads) = session.common.threads {
        options = options.threads(usize::from(threads));
    }
    let outcome = options.run(operation, operands.iter().map(|operand| &operand.solid))?;
    let seconds = session.took("run", start);

    let measures = Measures::of_solid(outcome.solid());
    let mut result = measures.to_json();
    result.insert("certificate".into(), report::certificate(outcome.certificate()));
    session.note("result", result);
    if let Some(warning) = report::nearly_flush(outcome.certificate()) {
        session.warn(warning);
    }
    let format = operands.first().map(|operand| operand.format);
    write(arguments, &targets, &outcome, format, session)?;
    let names: Vec<String> = targets.iter().map(Target::name).collect();
    let arrow = if names.is_empty() { String::new() } else { format!(" -> {}", names.join(", ")) };
    session.console.say(&format!("result: {} ({}){arrow}", measures.line(), report::time(seconds)));
    session.console.detail(&outcome.certificate().to_string());
    Ok(Exit::Fine)
}

/// Command lines that are well formed but cannot be meant.
fn refuse_pointless(
    operation: Operation,
    arguments: &Combine,
    inputs: usize,
    targets: &[Target],
    session: &Session<'_>,
) -> Result<(), Fault> {
    if inputs < 2 && operation != Operation::Union {
        return Err(Fault::usage("at least two inputs are needed: FILE1 FILE2 ... -o OUTPUT"));
    }
    let common = session.common;
    if targets.is_empty() && !common.json && common.report.is_none() && !arguments.dry_run {
        return Err(Fault::usage(
            "nowhere to put the result: add -o FILE (or -o - for standard output, --png FILE, --json, --report FILE, \
             --dry-run)",
        ));
    }
    Ok(())
}

/// One line and one JSON object for every operand, and its warnings.
fn describe(operands: &[Operand], session: &mut Session<'_>) {
    let mut described = Vec::new();
    for (index, operand) in operands.iter().enumerate() {
        let measures = Measures::of_solid(&operand.solid);
        session.console.say(&report::operand_line(operand, &measures));
        if let (Some(cleaning), _) = report::cleaning(&operand.solid) {
            session.console.detail(&format!("  {cleaning}"));
        }
        for transform in &operand.request.transforms {
            session.console.detail(&format!("  {transform}"));
        }
        for warning in &operand.warnings {
            session.warn(format!("operand {} ({}): {warning}", index + 1, operand.request.name()));
        }
        described.push(report::operand_json(operand, index, &measures));
    }
    session.note("operands", described);
}

fn write(
    arguments: &Combine,
    targets: &[Target],
    outcome: &Outcome,
    format: Option<Format>,
    session: &mut Session<'_>,
) -> Result<(), Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let mesh = outcome.solid().mesh();
    let drawing = &arguments.results.drawing;
    let picture = || {
        let operands = outcome.origins().iter().map(|origin| origin.operand as usize);
        let colours = output::colours(drawing.png_color.unwrap_or(Colours::Operand), mesh, operands);
        trisect::render::mesh(mesh, &output::view(drawing, format), colours.as_deref())
    };
    let options = output::write_options(&arguments.results.writing, &session.limits);
    let product = Product { mesh, options, picture: &picture, documents: &[] };
    let (outputs, warnings) = output::write_all(targets, &product, &session.limits)?;
    session.note("outputs", outputs);
    for warning in warnings {
        session.warn(warning);
    }
    session.took("write", start);
    Ok(())
}

/// What `--dry-run` says.
fn announce(operation: Operation, operands: &[Operand], targets: &[Target], session: &mut Session<'_>) {
    let triangles = operands.iter().map(|operand| operand.solid.mesh().triangles.len()).sum();
    let names: Vec<String> =
        targets.iter().map(|target| format!("{} ({})", target.name(), target.format())).collect();
    let writing = if names.is_empty() { "nothing".into() } else { names.join(", ") };
    session.console.say(&format!(
        "dry run: would take the {operation} of {} with {} and write {writing}",
        report::counted(operands.len(), "operand"),
        report::counted(triangles, "triangle"),
    ));
    let outputs: Vec<Value> = targets
        .iter()
        .map(|target| serde_json::json!({ "file": target.path.display().to_string(), "format": target.format() }))
        .collect();
    session.note("outputs", outputs);
    session.note("dry_run", true);
}

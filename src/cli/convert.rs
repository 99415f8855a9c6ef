//! `convert`: read, move, write.

use std::path::PathBuf;
use std::time::Instant;

use clap::ArgMatches;
use serde_json::{Map, Value, json};
use trisect::control::Reservation;
use trisect::io::{Format, WriteOptions};
use trisect::{Error, Mesh};

use super::argument_groups::Writing;
use super::arguments::Convert;
use super::fault::{Exit, Fault};
use super::mended;
use super::output::{self, Target};
use super::reading::{self, Input};
use super::report::{self, Measures};
use super::requests::{self, Request};
use super::scenes;
use super::selection;
use super::session::Session;
use super::usable;
use super::words;
use super::written::Written;

/// Converts one input.
pub(crate) fn run(
    arguments: &Convert,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let (request, output) = input_and_output(arguments, matches)?;
    let writing = Writing { output, ..arguments.results.writing.clone() };
    let mut request = [request];
    scenes::name_node(&mut request, &writing)?;
    let [request] = request;
    let targets = output::targets(&writing, &arguments.results.drawing, session.common)?;
    if targets.is_empty() {
        return Err(Fault::usage("nowhere to put the result: add an output file, -o FILE or --png FILE"));
    }
    if !arguments.dry_run {
        output::probe(&targets, &session.limits)?;
    }

    let options = output::write_options(&writing, &session.limits);
    let options = scenes::kept(options, &writing, Some(&request))?;
    let read = read(&request, &writing, session)?;
    let names: Vec<String> = targets.iter().map(Target::name).collect();
    if arguments.dry_run {
        session.console.say(&format!("dry run: {}; would write {}", read.line, names.join(", ")));
        session.note("dry_run", true);
        return Ok(Exit::Fine);
    }
    write(arguments, &writing, &targets, &read, options, session)?;
    session.console.say(&format!("{} -> {}", read.line, names.join(", ")));
    Ok(Exit::Fine)
}

/// What was read, moved and repaired.
struct Read {
    mesh: Mesh,
    format: Format,
    /// What is said of it.
    line: String,
    /// Held while the mesh is.
    _reserved: Reservation,
}

fn read(request: &Request, writing: &Writing, session: &mut Session<'_>) -> Result<Read, Fault> {
    let control = session.control();
    let of_input = |error: Error| error.of_operand(0, request.name());
    let start = Instant::now();
    session.console.stage(&format!("reading {}", request.name()), 0.0);
    let request = &selection::together(request.clone(), &session.limits, &control).map_err(of_input)?;
    let Input { mesh, format, mut warnings, contents, reserved } =
        reading::read(request, &session.limits, &control).map_err(of_input)?;
    warnings.extend(scenes::lost(&contents, writing, 0));
    let (mesh, welded) = usable::welded(mesh, request.repairs.weld).map_err(of_input)?;
    let (mesh, turned) = if request.repairs.orient { usable::oriented(mesh) } else { (mesh, false) };
    let seconds = session.took("read", start);
    for warning in &warnings {
        session.warn(format!("{}: {warning}", request.name()));
    }
    // What nobody is told is not computed.
    if session.is_reported() {
        let mut object = described(&mesh, request);
        object.extend(report::into_map(json!({
            "format": format.extension(),
            "turned": turned,
            "welded": welded,
            "warnings": warnings,
            "seconds": seconds,
        })));
        session.note("input", object);
    }

    let line = format!(
        "{} ({format}): {}{}{} ({})",
        request.name(),
        words::counted(mesh.triangles.len(), "triangle"),
        mended::welded(welded),
        if turned { ", turned outwards" } else { "" },
        words::time(seconds)
    );
    Ok(Read { mesh, format, line, _reserved: reserved })
}

fn write(
    arguments: &Convert,
    writing: &Writing,
    targets: &[Target],
    Read { mesh, format, .. }: &Read,
    options: WriteOptions,
    session: &mut Session<'_>,
) -> Result<(), Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let written = Written::new(mesh, options, Some(*format));
    let outputs = written.to(targets, writing, &arguments.results.drawing, session)?;
    session.note("outputs", outputs);
    session.took("write", start);
    Ok(())
}

/// What the report says of the input's shape and where it comes from.
fn described(mesh: &Mesh, request: &Request) -> Map<String, Value> {
    let mut object = Measures::of_mesh(mesh).to_json();
    // Whether the surface is closed is not looked into here; `check` and `info` tell.
    object.retain(|key, _| !matches!(key.as_str(), "closed" | "manifold" | "shells" | "genus" | "volume"));
    let transforms: Vec<String> = request.transforms.iter().map(ToString::to_string).collect();
    object.extend(report::into_map(json!({ "file": request.name(), "transforms": transforms })));
    object
}

/// The one input, and the outputs: those of `-o`, or else the second file.
fn input_and_output(arguments: &Convert, matches: &ArgMatches) -> Result<(Request, Vec<PathBuf>), Fault> {
    let mut output = arguments.results.writing.output.clone();
    if let ([_, second], true) = (arguments.files.as_slice(), output.is_empty()) {
        output.push(second.clone());
    } else if arguments.files.len() > 1 {
        return Err(Fault::usage("convert takes one input; with -o the second file is one too many"));
    }
    let mut requests = requests::placed_requests(matches)?.into_iter();
    let input = requests.next().ok_or_else(|| Fault::usage("an input is needed"))?;
    let second = requests.next();
    // There is one input only, so what is to be mended is mended in it.
    let for_output = second.as_ref().map(|second| second.repairs).unwrap_or_default();
    if second.is_some_and(|second| !second.transforms.is_empty()) {
        return Err(Fault::usage("a transform stands after the output; put it right after the input"));
    }
    let mut input = [input];
    input[0].repairs = input[0].repairs.with(for_output);
    requests::name_formats(&mut input, arguments.reading.format)?;
    let [input] = input;
    Ok((input, output))
}

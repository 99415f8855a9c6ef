//! `curve join`, `curve mesh`, `curve convert`, `curve draw`: files in, files out.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::{Value, json};
use trisect::Error;

use super::curve_text::{self, JoinArguments};
use super::documents::{self, Document};
use super::fault::{Exit, Fault};
use super::field_arguments::{CurveConvert, CurveDraw, CurveJoin, CurveMesh, CurveVerb, Metric};
use super::reading;
use super::session::Session;
use super::words;

/// Runs a verb on curves.
pub(crate) fn run(verb: &CurveVerb, session: &mut Session<'_>) -> Result<Exit, Fault> {
    match verb {
        CurveVerb::Join(arguments) => join(arguments, session),
        CurveVerb::Mesh(arguments) => mesh(arguments, session),
        CurveVerb::Convert(arguments) => convert(arguments, session),
        CurveVerb::Draw(arguments) => draw(arguments, session),
    }
}

/// An input's text; faults name the input.
fn read(files: &[&PathBuf], session: &Session<'_>) -> Result<Vec<String>, Fault> {
    let text = |(index, path): (usize, &&PathBuf)| {
        reading::text(path, &session.limits)
            .map_err(|error| Fault::from(error.of_operand(index, path.display().to_string())))
    };
    files.iter().enumerate().map(text).collect()
}

fn join(arguments: &CurveJoin, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let common = session.common;
    if arguments.output.is_none() && arguments.svg.is_none() && !common.json && common.report.is_none() {
        return Err(Fault::usage(
            "nowhere to put the result: add -o FILE (or -o - for standard output, --svg FILE, --json, --report FILE)",
        ));
    }
    let places = [&arguments.output, &arguments.svg];
    documents::check(places.into_iter().flatten().map(PathBuf::as_path), common, &session.limits)?;
    let start = Instant::now();
    let texts = read(&[&arguments.first, &arguments.second], session)?;
    session.took("read", start);
    let start = Instant::now();
    let wanted = JoinArguments {
        discrete: arguments.metric == Metric::Discrete,
        keep: arguments.keep.map(|name| name.0),
        fix_ends: arguments.fix_ends,
        keep_at: arguments.keep_at.clone(),
        joint: arguments.joint.map(|name| name.0),
        degree: arguments.degree,
    };
    let names = [&arguments.first, &arguments.second].map(|path| path.display().to_string());
    let joined = curve_text::join([&texts[0], &texts[1]], &names, &wanted)?;
    session.took("run", start);
    session.note("join", joined.report);
    session.note("curve", joined.curve.clone());
    let mut made = Vec::new();
    if let Some(path) = &arguments.output {
        made.push(json_document(path, &joined.curve));
    }
    if let Some(path) = &arguments.svg {
        made.push(Document { path: path.clone(), format: "svg", bytes: joined.picture.into_bytes() });
    }
    write(&made, &joined.summary, session)
}

fn mesh(arguments: &CurveMesh, session: &mut Session<'_>) -> Result<Exit, Fault> {
    documents::check([arguments.output.as_path()], session.common, &session.limits)?;
    let texts = read(&[&arguments.file], session)?;
    let start = Instant::now();
    let (polyline, nodes) =
        curve_text::mesh(&texts[0], arguments.tolerance, arguments.nodes, arguments.halving)
            .map_err(|error| named(error, &arguments.file))?;
    let seconds = session.took("run", start);
    session.note("nodes", nodes);
    let said = format!("{} ({})", words::counted(nodes, "node"), words::time(seconds));
    write(&[json_document(&arguments.output, &polyline)], &said, session)
}

fn convert(arguments: &CurveConvert, session: &mut Session<'_>) -> Result<Exit, Fault> {
    documents::check([arguments.output.as_path()], session.common, &session.limits)?;
    let texts = read(&[&arguments.file], session)?;
    let (text, format) =
        curve_text::convert(&texts[0], arguments.tolerance).map_err(|error| named(error, &arguments.file))?;
    let bytes = (text + "\n").into_bytes();
    write(&[Document { path: arguments.output.clone(), format, bytes }], "converted", session)
}

fn draw(arguments: &CurveDraw, session: &mut Session<'_>) -> Result<Exit, Fault> {
    documents::check([arguments.output.as_path()], session.common, &session.limits)?;
    let files: Vec<&PathBuf> = arguments.files.iter().collect();
    let texts = read(&files, session)?;
    let names: Vec<String> = arguments.files.iter().map(|path| path.display().to_string()).collect();
    let bytes = curve_text::draw(&texts, &names)?.into_bytes();
    let said = format!("{} drawn", words::counted(texts.len(), "curve"));
    write(&[Document { path: arguments.output.clone(), format: "svg", bytes }], &said, session)
}

fn named(error: Error, path: &Path) -> Fault {
    error.of_operand(0, path.display().to_string()).into()
}

fn json_document(path: &Path, value: &Value) -> Document {
    Document { path: path.to_path_buf(), format: "json", bytes: format!("{value:#}\n").into_bytes() }
}

fn write(made: &[Document], said: &str, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let start = Instant::now();
    let outputs = documents::write(made, &session.limits)?;
    session.took("write", start);
    session.note("outputs", json!(outputs));
    let names: Vec<String> = made.iter().map(|document| document.path.display().to_string()).collect();
    let arrow = if names.is_empty() { String::new() } else { format!(" -> {}", names.join(", ")) };
    session.console.say(&format!("{said}{arrow}"));
    Ok(Exit::Fine)
}

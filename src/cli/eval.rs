//! `eval`: a model file evaluated to a mesh, or to contours.

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};
use trisect::field::Contours;
use trisect::model::{Evaluated, Evaluation, Model};
use trisect::{Mesh, Solid};

use super::argument_groups::Results;
use super::documents::{self, Document};
use super::fault::{Exit, Fault};
use super::field_arguments::Eval;
use super::output::{self, Target};
use super::reading;
use super::report::Measures;
use super::scenes;
use super::session::Session;
use super::stream::STANDARD;
use super::words;
use super::written::Written;

/// Evaluates a model.
pub(crate) fn run(arguments: &Eval, session: &mut Session<'_>) -> Result<Exit, Fault> {
    scenes::refuse(&arguments.results.writing)?;
    let targets = output::targets(&arguments.results.writing, &arguments.results.drawing, session.common)?;
    let common = session.common;
    let wanted = !targets.is_empty() || common.json || common.report.is_some();
    if !wanted && arguments.contours.is_none() && !arguments.dry_run {
        return Err(Fault::usage(
            "nowhere to put the result: add -o FILE (or -o - for standard output, --png FILE, --contours FILE, --json, \
             --report FILE, --dry-run)",
        ));
    }
    let format = arguments.contours.as_deref().map(contour_format).transpose()?;
    let places = targets.iter().map(|target| target.path.as_path()).chain(arguments.contours.as_deref());
    if !arguments.dry_run {
        documents::check(places, common, &session.limits)?;
    }

    let (model, name) = read(&arguments.model, session)?;
    if arguments.dry_run {
        return dry_run(&model, &name, session);
    }

    let start = Instant::now();
    let mut evaluation = Evaluation::new().control(session.control());
    if let Some(tolerance) = arguments.tolerance {
        evaluation = evaluation.tolerance(tolerance);
    }
    if arguments.smoothness.no_smooth {
        evaluation = evaluation.smooth(false);
    }
    let mut parts = Vec::new();
    let mut drawn = Vec::new();
    if let (Some(path), Some(format)) = (&arguments.contours, format) {
        let contours = evaluation.contours(&model, arguments.contour_height)?;
        parts.push(note_contours(&contours, arguments.contour_height, session));
        let bytes = if format == "svg" { svg(&contours) } else { polygons(&contours) }.into_bytes();
        drawn.push(Document { path: path.clone(), format, bytes });
    }
    // Contours alone need no mesh.
    let found = if wanted || drawn.is_empty() { Some(evaluation.run(&model)?) } else { None };
    let seconds = session.took("run", start);
    let mesh = found.as_ref().map(|found| measured(found, session)).transpose()?;
    let mesh = mesh.map(|(mesh, line)| {
        parts.push(line);
        mesh
    });
    write(arguments, &targets, mesh.as_ref(), &drawn, session)?;
    let names: Vec<String> = targets
        .iter()
        .map(Target::name)
        .chain(drawn.iter().map(|document| document.path.display().to_string()))
        .collect();
    let arrow = if names.is_empty() { String::new() } else { format!(" -> {}", names.join(", ")) };
    session.console.say(&format!("{name}: {} ({}){arrow}", parts.join("; "), words::time(seconds)));
    if let Some(extracted) = found.as_ref().and_then(|found| found.extraction) {
        session.console.detail(&format!(
            "extracted over {} cells; largest deviation found {:.3e}, tolerance {:.3e}; normals within {:.1} degrees (95 of 100)",
            extracted.cells, extracted.deviation, extracted.tolerance, extracted.normal_deviation
        ));
    }
    Ok(Exit::Fine)
}

/// Reads the model file, and gives it with its name in messages.
fn read(path: &Path, session: &mut Session<'_>) -> Result<(Model, String), Fault> {
    let start = Instant::now();
    let standard = path == Path::new(STANDARD);
    let name = if standard { "standard input".to_owned() } else { path.display().to_string() };
    session.console.stage(&format!("reading {name}"), 0.0);
    let folder = path.parent().filter(|_| !standard).unwrap_or(Path::new(""));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let model = Model::parse(&reading::text(path, &session.limits)?, folder)?;
    session.took("read", start);
    let files: Vec<String> = model.files().iter().map(|file| file.display().to_string()).collect();
    session
        .note("model", json!({ "file": name, "nodes": model.names().collect::<Vec<_>>(), "files": files }));
    Ok((model, name))
}

/// Notes contours in the report, and gives the text that says what they are.
fn note_contours(contours: &Contours, height: f64, session: &mut Session<'_>) -> String {
    let (count, points, area) = (contours.loops.len(), contours.len(), contours.area());
    session.note("contours", json!({ "height": height, "count": count, "points": points, "area": area }));
    format!(
        "{} of {}, area {}",
        words::counted(count, "contour"),
        words::counted(points, "point"),
        words::short(area)
    )
}

/// Notes the mesh in the report, and gives it with the line that says what it is.
fn measured(found: &Evaluated, session: &mut Session<'_>) -> Result<(Mesh, String), Fault> {
    let (mesh, measures) = if found.is_open {
        (found.mesh.clone(), Measures::of_mesh(&found.mesh))
    } else {
        let solid = Solid::try_from(found.mesh.clone()).map_err(trisect::Error::from)?;
        let measures = Measures::of_solid(&solid);
        (solid.into_mesh(), measures)
    };
    let mut result = measures.to_json();
    result.insert("extraction".into(), extraction(found));
    session.note("result", result);
    for warning in &found.warnings {
        session.warn(warning.clone());
    }
    Ok((mesh, measures.line()))
}

fn dry_run(model: &Model, name: &str, session: &mut Session<'_>) -> Result<Exit, Fault> {
    for file in model.files() {
        std::fs::metadata(&file).map_err(|source| trisect::Error::File {
            action: trisect::FileAction::Read,
            path: file.clone(),
            source,
        })?;
    }
    session.note("dry_run", true);
    session.console.say(&format!(
        "dry run: {name} is a model with {} and {}",
        words::counted(model.names().count(), "named node"),
        words::counted(model.files().len(), "mesh file"),
    ));
    Ok(Exit::Fine)
}

fn write(
    arguments: &Eval,
    targets: &[Target],
    mesh: Option<&Mesh>,
    drawn: &[Document],
    session: &mut Session<'_>,
) -> Result<(), Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let outputs = if let Some(mesh) = mesh {
        let Results { writing, drawing } = &arguments.results;
        let options = output::write_options(writing, &session.limits);
        let written = Written { documents: drawn, ..Written::new(mesh, options, None) };
        written.to(targets, writing, drawing, session)?
    } else {
        documents::write(drawn, &session.limits)?
    };
    session.note("outputs", outputs);
    session.took("write", start);
    Ok(())
}

/// What the report says of an extraction; null for a result of exact operations alone.
fn extraction(found: &Evaluated) -> Value {
    found.extraction.map_or(Value::Null, |report| {
        json!({
            "tolerance": report.tolerance,
            "deviation": report.deviation,
            "normal_deviation": report.normal_deviation,
            "cells": report.cells,
            "divided_cells": report.divided_cells,
        })
    })
}

fn contour_format(path: &Path) -> Result<&'static str, Fault> {
    let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
    match ending.as_deref().and_then(std::ffi::OsStr::to_str) {
        Some("svg") => Ok("svg"),
        Some("json") => Ok("json"),
        _ => Err(Fault::usage(format!("contours are written as *.svg or *.json, not {}", path.display()))),
    }
}

/// As a node of a model file.
fn polygons(contours: &Contours) -> String {
    json!({ "kind": "contour", "polygons": contours.loops }).to_string() + "\n"
}

/// One path; y upwards, as in the model.
fn svg(contours: &Contours) -> String {
    let points = || contours.loops.iter().flatten();
    let bound = |axis: usize, start: f64, pick: fn(f64, f64) -> f64| {
        if contours.is_empty() { 0.0 } else { points().fold(start, |bound, point| pick(bound, point[axis])) }
    };
    let low = [0, 1].map(|axis| bound(axis, f64::INFINITY, f64::min));
    let high = [0, 1].map(|axis| bound(axis, f64::NEG_INFINITY, f64::max));
    let margin = (high[0] - low[0]).max(high[1] - low[1]).max(1e-9) * 0.04;
    let mut data = String::new();
    for polygon in &contours.loops {
        for (k, [x, y]) in polygon.iter().enumerate() {
            data += &format!("{}{x} {} ", if k == 0 { "M" } else { "L" }, 0.0 - y);
        }
        data += "Z ";
    }
    let (width, height) = (high[0] - low[0] + 2.0 * margin, high[1] - low[1] + 2.0 * margin);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" height=\"{:.0}\" viewBox=\"{} {} {width} {height}\">\n\
         <path d=\"{}\" fill=\"#d9722e\" fill-opacity=\"0.25\" fill-rule=\"evenodd\" stroke=\"#1b1b1b\" \
         stroke-width=\"{}\"/>\n</svg>\n",
        800.0 * height / width,
        low[0] - margin,
        -high[1] - margin,
        data.trim_end(),
        width.max(height) / 600.0,
    )
}

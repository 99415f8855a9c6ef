//! `imprint`: the curve in which two surfaces meet, on both.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::Value;
use trisect::{Imprinted, Mesh};

use super::argument_groups::Results;
use super::combine::Style;
use super::cut_arguments::Imprint;
use super::fault::{Exit, Fault};
use super::output::{self, Target};
use super::report::Measures;
use super::requests;
use super::scenes;
use super::selection;
use super::session::Session;
use super::trim::{self, Sheet};
use super::words;
use super::written::Written;

/// Draws the curve in which two inputs meet on both.
pub(crate) fn run(
    arguments: &Imprint,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let mut requests = requests::requests(matches, arguments.from.reading.format)?;
    let writing = &arguments.results.writing;
    scenes::name_node(&mut requests, writing)?;
    let targets = output::targets(writing, &arguments.results.drawing, session.common)?;
    if targets.is_empty() && !session.is_reported() {
        return Err(Fault::usage("nowhere to put the results: add -o FILE, --png FILE or --json"));
    }
    let control = session.control();
    let requests = selection::joined(requests, &session.limits, &control)?;
    // (The scene is that of the first.)
    let plain = output::write_options(writing, &session.limits);
    let options = [scenes::kept(plain.clone(), writing, requests.first())?, plain];
    let both = <[_; 2]>::try_from(requests)
        .map_err(|_| Fault::usage("imprint takes two inputs, whose curve is drawn on both"))?;
    let places: Vec<Vec<Target>> = ["-1", "-2"]
        .iter()
        .map(|suffix| targets.iter().map(|target| target.with_suffix(suffix)).collect())
        .collect::<Result<_, _>>()?;
    places.iter().try_for_each(|targets| output::probe(targets, &session.limits))?;

    let start = Instant::now();
    let mut sheets: Vec<Sheet> = Vec::new();
    for (number, request) in both.iter().enumerate() {
        sheets.push(trim::sheet(request, number, writing, &control, session)?);
    }
    session.took("read", start);
    let [a, b] = &sheets[..] else { return Err(Fault::usage("two inputs are needed")) };
    let start = Instant::now();
    let made = session.boolean_options(control).imprint(&a.mesh, &b.mesh)?;
    let seconds = session.took("run", start);

    let (mut results, mut outputs) = (Vec::new(), Vec::new());
    let surfaces = made.iter().zip(options).zip(&places).zip(&sheets).zip(&both);
    for ((((made, options), targets), sheet), request) in surfaces {
        let Imprinted { mesh, incomplete, .. } = made;
        if *incomplete > 0 {
            let triangles = words::counted(*incomplete, "triangle");
            session.warn(format!("{}: the curve is not drawn in full on {triangles}", request.name()));
        }
        let measures = Measures::of_mesh(mesh);
        let style = Style { format: Some(sheet.format), options };
        let written = write(&arguments.results, targets, mesh, style, session)?;
        outputs.extend(written);
        results.push(measures.to_json());
        let arrow = output::arrow(targets);
        session.console.say(&format!(
            "{}: {} ({}){arrow}",
            request.name(),
            measures.line(),
            words::time(seconds)
        ));
    }
    session.note("results", results);
    session.note("outputs", outputs);
    Ok(Exit::Fine)
}

/// Writes one of the surfaces.
fn write(
    results: &Results,
    targets: &[Target],
    mesh: &Mesh,
    style: Style,
    session: &mut Session<'_>,
) -> Result<Vec<Value>, Fault> {
    let written = Written::new(mesh, style.options, style.format);
    written.to(targets, &results.writing, &results.drawing, session)
}

//! `grid`: a model, a mesh's signed distance, or a formula, sampled on a grid.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::json;
use trisect::field::{Grid, GridFormat};

use super::documents::{self, Document};
use super::fault::{Exit, Fault};
use super::field_arguments::SampleGrid;
use super::session::Session;
use super::source;
use super::words;

/// Samples a grid.
pub(crate) fn run(
    arguments: &SampleGrid,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    documents::check_ending(&arguments.output, &["npy", "raw"], "a grid is written as *.npy or *.raw")?;
    documents::check([arguments.output.as_path()], session.common, &session.limits)?;
    let control = session.control();
    let start = Instant::now();
    let field = source::field(&arguments.source, matches, session, &control)?;
    session.took("read", start);
    if arguments.band.is_some() && field.distance.is_none() {
        return Err(Fault::usage("--band is for meshes: only distances have a band"));
    }

    let start = Instant::now();
    let [low, high] = field.bounds;
    let grid = Grid::over(low, high, arguments.spacing)?;
    let grid = match (&field.distance, arguments.band) {
        (Some(distance), Some(band)) => grid.banded(distance, band, &control)?,
        (Some(distance), None) => grid.dense(distance, &control)?,
        (None, _) => grid.sample(&field.expression, &control)?,
    };
    let seconds = session.took("run", start);

    let start = Instant::now();
    let npy = arguments.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npy"));
    let (format, name) = if npy { (GridFormat::Npy, "npy") } else { (GridFormat::Raw, "raw") };
    let mut bytes = Vec::new();
    grid.write(format, &mut bytes).map_err(|error| Fault::output(&arguments.output, error))?;
    let document = Document { path: arguments.output.clone(), format: name, bytes };
    let outputs = documents::write(&[document], &session.limits)?;
    session.took("write", start);
    session.note(
        "grid",
        json!({ "of": field.name, "sign": field.sign(), "origin": grid.origin, "spacing": grid.spacing,
                "shape": grid.shape }),
    );
    session.note("outputs", outputs);
    let [nx, ny, nz] = grid.shape;
    session.console.say(&format!(
        "{}: {nx} x {ny} x {nz} values ({}) -> {}",
        field.name,
        words::time(seconds),
        arguments.output.display()
    ));
    Ok(Exit::Fine)
}

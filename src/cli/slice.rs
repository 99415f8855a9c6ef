//! `slice`: a picture of a plane section of a model, of a mesh's signed distance, or of a formula.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::json;
use trisect::field::Section;

use super::documents::{self, Document};
use super::fault::{Exit, Fault};
use super::field_arguments::{Axis, Slice};
use super::session::Session;
use super::source;
use super::words;

/// Draws a section.
pub(crate) fn run(arguments: &Slice, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    documents::check_ending(
        &arguments.output,
        &["png"],
        "a section is drawn as *.png (`eval MODEL --contours FILE.svg` writes outlines)",
    )?;
    documents::check([arguments.output.as_path()], session.common, &session.limits)?;
    let control = session.control();
    let start = Instant::now();
    let field = source::field(&arguments.source, matches, session, &control)?;
    session.took("read", start);

    let start = Instant::now();
    let axis = match arguments.axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    };
    let [low, high] = field.bounds;
    let position = arguments.at.unwrap_or(low[axis] * 0.5 + high[axis] * 0.5);
    let section = Section::across(axis, position, low, high)?;
    let picture = section.picture(&field.expression, arguments.width, arguments.bands, &control)?;
    let seconds = session.took("run", start);

    let start = Instant::now();
    let mut bytes = Vec::new();
    picture.write_png(&mut bytes).map_err(|error| Fault::output(&arguments.output, error))?;
    let document = Document { path: arguments.output.clone(), format: "png", bytes };
    let outputs = documents::write(&[document], &session.limits)?;
    session.took("write", start);
    let name = ["x", "y", "z"][axis];
    session.note(
        "section",
        json!({ "of": field.name, "sign": field.sign(), "axis": name, "at": position, "bounds": field.bounds,
                "size": [picture.width(), picture.height()] }),
    );
    session.note("outputs", outputs);
    session.console.say(&format!(
        "{}: section at {name} = {}, {} x {} pixels ({}) -> {}",
        field.name,
        words::short(position),
        picture.width(),
        picture.height(),
        words::time(seconds),
        arguments.output.display()
    ));
    Ok(Exit::Fine)
}

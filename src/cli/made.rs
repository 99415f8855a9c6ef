//! What a verb has made, written and told.

use std::time::Instant;

use trisect::io::Format;
use trisect::{Mesh, Solid};

use super::argument_groups::{Colours, Results};
use super::fault::Fault;
use super::output::{self, Product, Shown, Target};
use super::recenter;
use super::report::Measures;
use super::session::Session;
use super::words;

/// The outputs that are asked for, which can be written; a fault where there is no use of the result.
pub(crate) fn targets(results: &Results, session: &Session<'_>) -> Result<Vec<Target>, Fault> {
    let targets = output::targets(&results.writing, &results.drawing, session.common)?;
    if targets.is_empty() && !session.is_reported() {
        return Err(Fault::usage(
            "nowhere to put the result: add -o FILE (or -o - for standard output, --png FILE, --json, --report FILE)",
        ));
    }
    output::probe(&targets, &session.limits)?;
    Ok(targets)
}

/// Writes a solid and says what it is. `format` is that of the first input, which tells what is up in pictures.
pub(crate) fn deliver(
    solid: &Solid,
    results: &Results,
    targets: &[Target],
    format: Option<Format>,
    seconds: f64,
    session: &mut Session<'_>,
) -> Result<(), Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let measures = if session.is_reported() { Measures::of_solid(solid) } else { Measures::for_line(solid) };
    session.note("result", measures.to_json());
    let mesh = recenter::placed(solid.mesh(), &results.writing, session);
    let mesh: &Mesh = mesh.as_ref();
    let drawing = &results.drawing;
    let picture = || {
        let operands = mesh.triangles.iter().map(|_| 0);
        let colours = output::colours(drawing.png_color.unwrap_or(Colours::Operand), operands);
        trisect::render::mesh(mesh, &output::view(drawing, format), colours.as_deref())
    };
    let options = output::write_options(&results.writing, &session.limits);
    let shown = Shown::new(drawing, format, None);
    let product = Product { mesh, options, picture: &picture, documents: &[], shown };
    let (outputs, warnings) = output::write_all(targets, &product, &session.limits)?;
    for warning in warnings {
        session.warn(warning);
    }
    session.note("outputs", outputs);
    session.took("write", start);
    let arrow = output::arrow(targets);
    session.console.say(&format!("result: {} ({}){arrow}", measures.line(), words::time(seconds)));
    Ok(())
}

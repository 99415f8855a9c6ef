//! What a verb has made, written and told.

use std::time::Instant;

use trisect::Solid;
use trisect::io::Format;

use super::argument_groups::{Colours, Results};
use super::fault::Fault;
use super::output::{self, Target};
use super::report::Measures;
use super::session::Session;
use super::words;
use super::written::Written;

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
    let options = output::write_options(&results.writing, &session.limits);
    let written = Written { usual: Colours::Operand, ..Written::new(solid.mesh(), options, format) };
    let outputs = written.to(targets, &results.writing, &results.drawing, session)?;
    session.note("outputs", outputs);
    session.took("write", start);
    let arrow = output::arrow(targets);
    session.console.say(&format!("result: {} ({}){arrow}", measures.line(), words::time(seconds)));
    Ok(())
}

//! What a verb has made, written and told.

use std::time::Instant;

use clap::ArgMatches;
use trisect::io::{Format, WriteOptions};
use trisect::{Control, Solid};

use super::argument_groups::{Colours, Files, Results};
use super::fault::Fault;
use super::output::{self, Target};
use super::report::Measures;
use super::requests::{self, Request};
use super::scenes;
use super::selection;
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

/// What a verb that makes one result of `N` inputs begins with.
pub(crate) struct Begun<const N: usize> {
    /// The inputs, each as one mesh.
    pub(crate) requests: [Request; N],
    pub(crate) targets: Vec<Target>,
    /// How the result is written: in the scene of the first input, if that is asked for.
    pub(crate) options: WriteOptions,
    pub(crate) control: Control,
}

/// The inputs of a verb, and where its result goes; `otherwise` is said where they are more or fewer.
pub(crate) fn begin<const N: usize>(
    matches: &ArgMatches,
    from: &Files,
    results: &Results,
    otherwise: &str,
    session: &mut Session<'_>,
) -> Result<Begun<N>, Fault> {
    let mut requests = requests::requests(matches, from.reading.format)?;
    let writing = &results.writing;
    scenes::name_node(&mut requests, writing)?;
    let targets = targets(results, session)?;
    let control = session.control();
    let requests = selection::joined(requests, &session.limits, &control)?;
    let plain = output::write_options(writing, &session.limits);
    let options = scenes::kept(plain, writing, requests.first())?;
    let requests = <[Request; N]>::try_from(requests).map_err(|_| Fault::usage(otherwise))?;
    Ok(Begun { requests, targets, options, control })
}

/// Writes a mesh that was made, and notes where it went.
pub(crate) fn write(
    written: Written<'_>,
    results: &Results,
    targets: &[Target],
    session: &mut Session<'_>,
) -> Result<(), Fault> {
    let start = Instant::now();
    session.console.stage("writing", 1.0);
    let outputs = written.to(targets, &results.writing, &results.drawing, session)?;
    session.note("outputs", outputs);
    session.took("write", start);
    Ok(())
}

/// Says what the result is, where it went, and how long it took to make.
pub(crate) fn say(measures: &Measures, targets: &[Target], seconds: f64, session: &Session<'_>) {
    let arrow = output::arrow(targets);
    session.console.say(&format!("result: {} ({}){arrow}", measures.line(), words::time(seconds)));
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
    let measures = if session.is_reported() { Measures::of_solid(solid) } else { Measures::for_line(solid) };
    session.note("result", measures.to_json());
    let options = output::write_options(&results.writing, &session.limits);
    let written = Written { usual: Colours::Operand, ..Written::new(solid.mesh(), options, format) };
    write(written, results, targets, session)?;
    say(&measures, targets, seconds, session);
    Ok(())
}

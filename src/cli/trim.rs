//! `trim`: open surfaces trimmed by a solid.

use std::time::Instant;

use clap::ArgMatches;
use trisect::{BooleanOptions, TrimSide};

use super::argument_groups::Colours;
use super::combine;
use super::cut_arguments::Trim;
use super::fault::{Exit, Fault};
use super::operands;
use super::output::{self, Product, Target};
use super::reading::{self, Input};
use super::recenter;
use super::report::Measures;
use super::requests;
use super::scenes;
use super::selection;
use super::session::Session;
use super::words;

/// Trims the first input by the second.
pub(crate) fn run(arguments: &Trim, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let mut requests = requests::requests(matches, arguments.inputs.reading.format)?;
    let targets = output::targets(&arguments.results.writing, &arguments.results.drawing, session.common)?;
    if targets.is_empty() && !session.common.json && session.common.report.is_none() {
        return Err(Fault::usage("nowhere to put the result: add -o FILE, --png FILE or --json"));
    }
    let control = session.control();
    for (index, request) in requests.iter_mut().enumerate() {
        let name = request.name();
        *request = selection::together(request.clone(), &session.limits, &control)
            .map_err(|error| Fault::from(error.of_operand(index, name)))?;
    }
    let [sheet, by] = <[_; 2]>::try_from(requests).map_err(|_| {
        Fault::usage("trim takes two inputs: the surface, then the solid that it is trimmed by")
    })?;
    output::probe(&targets, &session.limits)?;

    let start = Instant::now();
    let Input { mesh, format, mut warnings, contents, reserved: _reserved } =
        reading::read(&sheet, &session.limits, &control)
            .map_err(|error| Fault::from(error.of_operand(0, sheet.name())))?;
    warnings.extend(scenes::lost(&contents, &arguments.results.writing, 0));
    for warning in warnings {
        session.warn(format!("{}: {warning}", sheet.name()));
    }
    session.console.say(&format!("{}: {}", sheet.name(), Measures::of_mesh(&mesh).line()));
    let assume_clean = arguments.inputs.using.assume_clean;
    let solids = operands::operands(vec![by], assume_clean, &session.limits, &control, &session.console)?;
    session.took("read", start);
    combine::describe(&solids, Some(&arguments.results.writing), session);
    let Some(by) = solids.first() else { return Err(Fault::usage("two inputs are needed")) };

    let start = Instant::now();
    let side = if arguments.inside { TrimSide::Inside } else { TrimSide::Outside };
    let options = BooleanOptions::new().rule(by.request.rule).assume_clean(assume_clean).control(control);
    let trimmed = options.trim(&mesh, &by.solid, side)?;
    let seconds = session.took("run", start);
    let measures = Measures::of_mesh(&trimmed.mesh);
    session.note("result", measures.to_json());

    let start = Instant::now();
    let placed = recenter::placed(&trimmed.mesh, &arguments.results.writing, session);
    let placed = placed.as_ref();
    let drawing = &arguments.results.drawing;
    let picture = || {
        let operands = placed.triangles.iter().map(|_| 0);
        let colours = output::colours(drawing.png_color.unwrap_or(Colours::Material), operands);
        trisect::render::mesh(placed, &output::view(drawing, Some(format)), colours.as_deref())
    };
    let options = output::write_options(&arguments.results.writing, &session.limits);
    let product = Product { mesh: placed, options, picture: &picture, documents: &[] };
    let (outputs, warnings) = output::write_all(&targets, &product, &session.limits)?;
    warnings.into_iter().for_each(|warning| session.warn(warning));
    session.note("outputs", outputs);
    session.took("write", start);
    let names: Vec<String> = targets.iter().map(Target::name).collect();
    let arrow = if names.is_empty() { String::new() } else { format!(" -> {}", names.join(", ")) };
    session.console.say(&format!("result: {} ({}){arrow}", measures.line(), words::time(seconds)));
    Ok(Exit::Fine)
}

//! `trim`: open surfaces trimmed by a solid.

use std::time::Instant;

use clap::ArgMatches;
use trisect::control::Reservation;
use trisect::io::Format;
use trisect::{Control, Error, Mesh, TrimSide};

use super::argument_groups::Writing;
use super::combine;
use super::cut_arguments::Trim;
use super::fault::{Exit, Fault};
use super::made::{self, Begun};
use super::mended;
use super::operands;
use super::reading::{self, Input};
use super::report::Measures;
use super::requests::Request;
use super::scenes;
use super::session::Session;
use super::usable;
use super::written::Written;

/// Trims the first input by the second.
pub(crate) fn run(arguments: &Trim, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let otherwise = "trim takes two inputs: the surface, then the solid that it is trimmed by";
    let Begun { requests: [request, by], targets, options: write_options, control } =
        made::begin(matches, &arguments.inputs.from, &arguments.results, otherwise, session)?;
    let writing = &arguments.results.writing;

    let start = Instant::now();
    let sheet = sheet(&request, 0, writing, &control, session)?;
    let assume_clean = arguments.inputs.using.assume_clean;
    let solids = operands::operands(vec![by], assume_clean, &session.limits, &control, &session.console)?;
    session.took("read", start);
    combine::describe(&solids, Some(writing), session);
    let Some(by) = solids.first() else { return Err(Fault::usage("two inputs are needed")) };

    let start = Instant::now();
    let side = if arguments.inside { TrimSide::Inside } else { TrimSide::Outside };
    let options = session.boolean_options(control).rule(by.request.rule).assume_clean(assume_clean);
    let trimmed = options.trim(&sheet.mesh, &by.solid, side)?;
    let seconds = session.took("run", start);
    let measures = Measures::of_mesh(&trimmed.mesh);
    session.note("result", measures.to_json());

    let written = Written::new(&trimmed.mesh, write_options, Some(sheet.format));
    made::write(written, &arguments.results, &targets, session)?;
    made::say(&measures, &targets, seconds, session);
    Ok(Exit::Fine)
}

/// A surface that may be open.
pub(super) struct Sheet {
    pub(super) mesh: Mesh,
    pub(super) format: Format,
    /// Held while the mesh is.
    _reserved: Reservation,
}

/// Reads the surface, joins its vertices and turns its faces where that is asked for, and says what it is.
pub(super) fn sheet(
    request: &Request,
    number: usize,
    writing: &Writing,
    control: &Control,
    session: &mut Session<'_>,
) -> Result<Sheet, Fault> {
    let of_sheet = |error: Error| error.of_operand(number, request.name());
    let Input { mesh, format, mut warnings, contents, reserved } =
        reading::read(request, &session.limits, control).map_err(of_sheet)?;
    warnings.extend(scenes::lost(&contents, writing, number));
    let repairs = request.repairs;
    if repairs.closed_parts || repairs.fill_holes.is_some() {
        warnings.push("--closed-parts and --fill-holes are for solids: this surface stays open".into());
    }
    for warning in warnings {
        session.warn(format!("{}: {warning}", request.name()));
    }
    let (mesh, welded) = usable::welded(mesh, repairs.weld).map_err(of_sheet)?;
    let (mesh, turned) = if repairs.orient { usable::oriented(mesh) } else { (mesh, false) };
    session.console.say(&format!(
        "{}: {}{}{}",
        request.name(),
        Measures::of_mesh(&mesh).line(),
        mended::welded(welded),
        if turned { ", turned outwards" } else { "" },
    ));
    Ok(Sheet { mesh, format, _reserved: reserved })
}

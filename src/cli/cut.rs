//! `cut`: solids cut at planes.

use std::time::Instant;

use clap::ArgMatches;
use trisect::exact::Plane;
use trisect::{BooleanOptions, Error, Outcome, PlaneCut, Solid};

use super::combine;
use super::cut_arguments::{Cut, Keep};
use super::fault::{Exit, Fault};
use super::operands;
use super::output::{self, Target};
use super::requests;
use super::scenes;
use super::selection;
use super::session::Session;
use super::surface;
use super::verbs;
use super::words;

/// Cuts an input.
pub(crate) fn run(arguments: &Cut, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    let mut requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    if arguments.plane.is_empty() {
        return Err(without_plane(&requests));
    }
    if requests.len() > 1 {
        return Err(Fault::usage("cut takes one input; cut others by runs of their own"));
    }
    let writing = &arguments.results.writing;
    scenes::name_node(&mut requests, writing)?;
    let control = session.control();
    let requests = selection::joined(requests, &session.limits, &control)?;
    let write_options =
        scenes::kept(output::write_options(writing, &session.limits), writing, requests.first())?;
    let targets = output::targets(writing, &arguments.results.drawing, session.common)?;
    if targets.is_empty() && !session.is_reported() && !arguments.dry_run {
        return Err(Fault::usage("nowhere to put the result: add -o FILE, --png FILE, --json or --dry-run"));
    }
    let suffixes = suffixes(arguments);
    let targets = places(arguments, &targets, &suffixes)?;
    if !arguments.dry_run {
        targets.iter().try_for_each(|targets| output::probe(targets, &session.limits))?;
    }

    let start = Instant::now();
    let assume_clean = arguments.inputs.using.assume_clean;
    let operands = operands::operands(requests, assume_clean, &session.limits, &control, &session.console)?;
    session.took("read", start);
    combine::describe(&operands, Some(writing), session);
    let Some(operand) = operands.first() else { return Err(Fault::usage("an input is needed")) };
    if arguments.dry_run {
        let planes = words::counted(arguments.plane.len(), "plane");
        session.console.say(&format!("dry run: would cut {} at {planes}", operand.request.name()));
        session.note("dry_run", true);
        return Ok(Exit::Fine);
    }

    let start = Instant::now();
    let material = arguments.cut_material.as_deref();
    let cut_faces =
        surface::cut_faces(material, arguments.cut_uv, operands.iter().map(|operand| &operand.solid));
    let options = session
        .boolean_options(control)
        .rule(operand.request.rule)
        .assume_clean(assume_clean)
        .cut_faces(cut_faces);
    let pieces = pieces(arguments, &operand.solid, &options)?;
    let seconds = session.took("run", start);
    if let Some(piece) = pieces.first() {
        combine::warn_of_inward(piece, &operands, session);
    }
    let style = combine::Style { format: Some(operand.format), options: write_options };
    let (mut results, mut outputs) = (Vec::new(), Vec::new());
    for ((piece, targets), suffix) in pieces.iter().zip(&targets).zip(&suffixes) {
        if piece.solid().is_empty() && arguments.keep == Keep::Both {
            session.warn(format!("{}: nothing of the solid is there", name_of(suffix)));
        }
        outputs.extend(combine::write(&arguments.results, targets, piece, &style, session)?);
        results.push(combine::tell(name_of(suffix), piece, targets, seconds, session));
    }
    session.note("results", results);
    session.note("outputs", outputs);
    Ok(Exit::Fine)
}

/// What somebody may have meant who gave no plane.
fn without_plane(requests: &[requests::Request]) -> Fault {
    let names: Vec<String> = requests.iter().map(requests::Request::name).collect();
    if let Some(plane) = names.iter().find(|name| verbs::is_plane(name)) {
        return Fault::usage(format!("'{plane}' is no file: say --plane {plane}"));
    }
    Fault::usage(if names.len() > 1 {
        format!(
            "cut cuts at planes (--plane z=12.5); to take files off the first one: `trisect difference {} -o OUTPUT`",
            names.join(" ")
        )
    } else {
        "cut needs a plane to cut at (--plane z=12.5); to take files off the first one, see `difference`, and for sections \
         `section` and `slice`"
            .into()
    })
}

/// What a piece is called in messages.
fn name_of(suffix: &str) -> &str {
    suffix.strip_prefix('-').unwrap_or("result")
}

/// The pieces that are wanted, by the ends of their names: for several planes a letter for each, below (`b`) or above (`a`).
fn suffixes(arguments: &Cut) -> Vec<String> {
    match (arguments.keep, arguments.plane.len()) {
        (Keep::Above | Keep::Below, _) => vec![String::new()],
        (Keep::Both, 1) => vec!["-above".into(), "-below".into()],
        (Keep::Both, planes) => {
            let sides =
                |piece: usize| (0..planes).map(move |plane| if piece >> plane & 1 == 0 { 'a' } else { 'b' });
            (0..1usize << planes.min(MOST_PLANES))
                .map(|piece| format!("-{}", sides(piece).collect::<String>()))
                .collect()
        }
    }
}

/// So many planes make 4096 pieces, which nobody wants by accident.
const MOST_PLANES: usize = 12;

/// The outputs of each piece.
fn places(arguments: &Cut, targets: &[Target], suffixes: &[String]) -> Result<Vec<Vec<Target>>, Fault> {
    if arguments.plane.len() > MOST_PLANES && arguments.keep == Keep::Both {
        return Err(Fault::usage(format!(
            "more than {MOST_PLANES} planes make too many pieces; --keep one side"
        )));
    }
    // A file for each of two pieces, and pictures of both; or a picture for each.
    let (mut pictures, mut files): (Vec<&Target>, Vec<&Target>) =
        targets.iter().partition(|target| target.is_picture());
    if files.is_empty() && arguments.results.writing.output.len() == 2 {
        files = pictures.drain(..2).collect();
    }
    if let ([_, _], [_, _]) = (suffixes, &*files) {
        return files
            .iter()
            .zip(suffixes)
            .map(|(file, suffix)| {
                let pictures = pictures.iter().map(|picture| picture.with_suffix(suffix));
                std::iter::once(Ok((*file).clone())).chain(pictures).collect()
            })
            .collect();
    }
    suffixes.iter().map(|suffix| targets.iter().map(|target| target.with_suffix(suffix)).collect()).collect()
}

/// The pieces, in the order of their names.
fn pieces(arguments: &Cut, solid: &Solid, options: &BooleanOptions) -> Result<Vec<Outcome>, Error> {
    let cut = |plane: &Plane| {
        let cut = PlaneCut::new(*plane).options(options.clone());
        match &arguments.cap {
            Some(cap) => cut.cap(cap.clone()),
            None => cut,
        }
    };
    let Some((first, others)) = arguments.plane.split_first() else { return Ok(Vec::new()) };
    let one = |plane: &Plane, solid: &Solid| match arguments.keep {
        Keep::Above => Ok(vec![cut(plane).above(solid)?]),
        Keep::Below => Ok(vec![cut(plane).below(solid)?]),
        Keep::Both => cut(plane).halves(solid).map(|(above, below)| vec![above, below]),
    };
    let mut pieces = one(first, solid)?;
    for (number, plane) in (2..).zip(others) {
        let mut halves: Vec<Vec<Outcome>> = Vec::new();
        for piece in &pieces {
            let parts = one(plane, piece.solid())?;
            halves.push(parts.into_iter().map(|part| part.after(piece, number)).collect());
        }
        // All that is above this plane, then all that is below it.
        let sides = if arguments.keep == Keep::Both { 2 } else { 1 };
        let mut halves: Vec<_> = halves.into_iter().map(Vec::into_iter).collect();
        pieces = (0..sides)
            .flat_map(|_| halves.iter_mut().filter_map(Iterator::next).collect::<Vec<_>>())
            .collect();
    }
    Ok(pieces)
}

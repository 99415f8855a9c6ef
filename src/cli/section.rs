//! `section`: the polygons where planes meet a solid.

use std::path::Path;
use std::time::Instant;

use clap::ArgMatches;
use serde_json::{Value, json};
use trisect::exact::Plane;
use trisect::io::drawing::{self, Layer};
use trisect::{Error, SectionSide, Sections};

use super::combine;
use super::cut_arguments::{Section, Side};
use super::documents::{self, Document};
use super::fault::{Exit, Fault};
use super::field_arguments::Axis;
use super::operands;
use super::requests;
use super::selection;
use super::session::Session;
use super::words;

/// Makes sections of an input.
pub(crate) fn run(
    arguments: &Section,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    if requests.len() > 1 {
        return Err(Fault::usage("section takes one input; unite several first"));
    }
    if arguments.output.is_empty() && !session.is_reported() {
        return Err(Fault::usage(
            "nowhere to put the sections: add -o FILE (*.svg, *.dxf, *.json), or --json for areas alone",
        ));
    }
    let formats: Vec<&'static str> =
        arguments.output.iter().map(|path| format(path)).collect::<Result<_, _>>()?;
    let paths = arguments.output.iter().map(std::path::PathBuf::as_path);
    documents::check(paths, session.common, &session.limits)?;
    let control = session.control();
    let requests = selection::joined(requests, &session.limits, &control)?;
    let start = Instant::now();
    let assume_clean = arguments.inputs.using.assume_clean;
    let operands = operands::operands(requests, assume_clean, &session.limits, &control, &session.console)?;
    session.took("read", start);
    combine::describe(&operands, None, session);
    let Some(operand) = operands.first() else { return Err(Fault::usage("an input is needed")) };

    let start = Instant::now();
    let planes = planes(arguments)?;
    let options = session.boolean_options(control).rule(operand.request.rule).assume_clean(assume_clean);
    let sections = Sections::new().side(side(arguments)).options(options).at(&operand.solid, &planes)?;
    let seconds = session.took("run", start);

    let layers = layers(&sections);
    note(&sections, &layers, session);
    let start = Instant::now();
    let written = |(path, format): (&std::path::PathBuf, &&'static str)| {
        let text = match *format {
            "svg" => drawing::svg(&layers),
            "dxf" => drawing::dxf(&layers),
            _ => drawing::json(&layers),
        };
        Document { path: path.clone(), format, bytes: text.into_bytes() }
    };
    let documents: Vec<Document> = arguments.output.iter().zip(&formats).map(written).collect();
    let outputs = documents::write(&documents, &session.limits)?;
    session.note("outputs", outputs);
    session.took("write", start);

    say(arguments, &sections, seconds, session);
    Ok(Exit::Fine)
}

/// The sections as layers of a drawing.
fn layers(sections: &[trisect::Section]) -> Vec<Layer<'_>> {
    let layer = |(index, section): (usize, &'_ trisect::Section)| match section.plane().as_level() {
        Some((axis, at)) => (format!("{}={at}", ["x", "y", "z"][axis]), at),
        None => (format!("plane {}", index + 1), 0.0),
    };
    let named = sections.iter().enumerate().map(layer);
    named
        .zip(sections)
        .map(|((name, height), section)| Layer { name, height, shapes: section.shapes() })
        .collect()
}

/// Says what was made.
fn say(arguments: &Section, sections: &[trisect::Section], seconds: f64, session: &Session<'_>) {
    let polygons: usize = sections.iter().map(|section| section.shapes().len()).sum();
    let area: f64 = sections.iter().map(trisect::Section::area).sum();
    let files: Vec<String> = arguments.output.iter().map(|path| path.display().to_string()).collect();
    let arrow = if files.is_empty() { String::new() } else { format!(" -> {}", files.join(", ")) };
    let of_all = if sections.len() > 1 { " in sum" } else { "" };
    session.console.say(&format!(
        "{}: {}, area {}{of_all} ({}){arrow}",
        words::counted(sections.len(), "section"),
        words::counted(polygons, "polygon"),
        words::short(area),
        words::time(seconds)
    ));
}

fn side(arguments: &Section) -> SectionSide {
    match arguments.side {
        Side::Inside => SectionSide::Inside,
        Side::Above => SectionSide::Above,
        Side::Below => SectionSide::Below,
    }
}

/// The format that a name tells.
fn format(path: &Path) -> Result<&'static str, Fault> {
    documents::check_ending(path, &["svg", "dxf", "json"], "sections are written as *.svg, *.dxf or *.json")?;
    let ending = path.extension().and_then(std::ffi::OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
    Ok(match ending.as_str() {
        "svg" => "svg",
        "dxf" => "dxf",
        _ => "json",
    })
}

fn planes(arguments: &Section) -> Result<Vec<Plane>, Error> {
    let axis = match arguments.axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    };
    match &arguments.heights {
        Some(heights) => heights.0.iter().map(|&at| Plane::across(axis, at).map_err(Error::from)).collect(),
        None => Ok(arguments.plane.clone()),
    }
}

/// The areas, layer by layer, for the report.
fn note(sections: &[trisect::Section], layers: &[Layer<'_>], session: &mut Session<'_>) {
    let described: Vec<Value> = sections
        .iter()
        .zip(layers)
        .map(|(section, layer)| {
            let holes: usize = section.shapes().iter().map(|shape| shape.len() - 1).sum();
            json!({
                "name": layer.name,
                "height": layer.height,
                "area": section.area(),
                "perimeter": section.perimeter(),
                "polygons": section.shapes().len(),
                "holes": holes,
            })
        })
        .collect();
    session.note("sections", described);
}

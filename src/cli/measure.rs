//! `measure` and `distance`.

use std::time::Instant;

use clap::ArgMatches;
use serde_json::{Map, Value, json};
use trisect::mesh::MassProperties;
use trisect::spatial::{Side, Thickness, TriangleTree};
use trisect::{Error, Solid};

use super::combine;
use super::fault::{Exit, Fault};
use super::json::json_of;
use super::making_arguments::{Distance, Measure};
use super::operands::{self, Operand};
use super::points;
use super::report::Measures;
use super::requests;
use super::selection;
use super::session::Session;
use super::stream;
use super::words::short;

/// Measures every input.
pub(crate) fn run(
    arguments: &Measure,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let control = session.control();
    let requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    let requests = selection::each(requests, &session.limits, &control)?;
    let mut asked = arguments.at.clone();
    if let Some(file) = &arguments.points {
        if file.as_os_str() == stream::STANDARD && requests.iter().any(requests::Request::is_standard) {
            return Err(Fault::usage("standard input can be only one of the inputs"));
        }
        asked.extend(points::of_file(file)?);
    }
    let start = Instant::now();
    let assume_clean = arguments.inputs.using.assume_clean;
    let operands = operands::operands(requests, assume_clean, &session.limits, &control, &session.console)?;
    session.took("read", start);
    let start = Instant::now();
    let mut files = Vec::new();
    for (index, operand) in operands.iter().enumerate() {
        for warning in &operand.warnings {
            session.warn(format!("operand {} ({}): {warning}", index + 1, operand.request.name()));
        }
        let found = operand.solid.mesh().mass_properties();
        let places = at_points(&operand.solid, &asked);
        if !session.common.json {
            let text = text_of(operand, found.as_ref(), &places);
            session.console.pause(|| stream::print(&text))?;
        }
        files.push(json_of_operand(operand, found.as_ref(), &places));
    }
    session.took("run", start);
    session.note("files", files);
    Ok(Exit::Fine)
}

/// What is known of a point.
struct Place {
    point: [f64; 3],
    side: Side,
    /// Of the nearest point of the surface.
    distance: f64,
    nearest: [f64; 3],
    thickness: Option<Thickness>,
}

fn at_points(solid: &Solid, points: &[[f64; 3]]) -> Vec<Place> {
    if points.is_empty() {
        return Vec::new();
    }
    let tree = TriangleTree::new(solid.mesh());
    let sides = tree.sides(points);
    let walls = tree.thickness_at_all(points);
    let found = points.iter().zip(sides).zip(walls).filter_map(|((&point, side), thickness)| {
        let closest = tree.closest(point)?;
        Some(Place {
            point,
            side,
            distance: closest.squared_distance.sqrt(),
            nearest: closest.point,
            thickness,
        })
    });
    found.collect()
}

fn side_name(side: Side) -> &'static str {
    match side {
        Side::Inside => "inside",
        Side::On => "on",
        Side::Outside => "outside",
    }
}

fn three(v: [f64; 3]) -> String {
    v.map(short).join(" ")
}

fn text_of(operand: &Operand, found: Option<&MassProperties>, places: &[Place]) -> String {
    let mut rows = Measures::of_solid(&operand.solid).table();
    if let Some(found) = found {
        rows.push(("centroid", three(found.centroid)));
        rows.push(("inertia", format!("{} (about the centroid, at density 1)", three(found.inertia[0]))));
        rows.extend([1, 2].map(|row| ("", three(found.inertia[row]))));
        for (moment, axis) in found.principal() {
            rows.push(("principal", format!("{} about {}", short(moment), three(axis.map(near_whole)))));
        }
    }
    let mut text = format!("{} ({})\n", operand.request.name(), operand.format);
    for (name, value) in rows {
        text.push_str(&format!("  {name:10} {value}\n"));
    }
    for place in places {
        let wall = match place.thickness {
            Some(Thickness { thickness, .. }) => format!(", wall {}", short(thickness)),
            None => String::new(),
        };
        text.push_str(&format!(
            "  at {}: {}, {} from the surface{wall}\n",
            three(place.point),
            side_name(place.side),
            short(place.distance)
        ));
    }
    text
}

/// A direction without digits of rounding.
fn near_whole(x: f64) -> f64 {
    // What eigenvectors of moments are good for.
    const STEP: f64 = 1e-9;
    (x / STEP).round() * STEP
}

fn json_of_operand(operand: &Operand, found: Option<&MassProperties>, places: &[Place]) -> Value {
    let mut object: Map<String, Value> = Measures::of_solid(&operand.solid).to_json();
    object.insert("file".into(), operand.request.name().into());
    object.insert("format".into(), operand.format.extension().into());
    object.insert("centroid".into(), json!(found.map(|found| found.centroid)));
    object.insert("inertia".into(), json!(found.map(|found| found.inertia)));
    let principal = found.map(|found| {
        found.principal().map(|(moment, axis)| json!({ "moment": moment, "axis": axis })).to_vec()
    });
    object.insert("principal".into(), json!(principal));
    let points = places.iter().map(|place| {
        json!({
            "point": place.point,
            "side": side_name(place.side),
            "distance": place.distance,
            "nearest": place.nearest,
            "thickness": place.thickness.map(|wall| wall.thickness),
            "wall": place.thickness.map(|wall| [wall.from, wall.to]),
        })
    });
    object.insert("points".into(), points.collect());
    object.into()
}

/// Tells how far two inputs are apart, or how much of them overlaps.
pub(crate) fn run_distance(
    arguments: &Distance,
    matches: &ArgMatches,
    session: &mut Session<'_>,
) -> Result<Exit, Fault> {
    let control = session.control();
    let requests = requests::requests(matches, arguments.inputs.from.reading.format)?;
    let requests = selection::joined(requests, &session.limits, &control)?;
    if requests.len() != 2 {
        return Err(Fault::usage(format!("distance takes two inputs, not {}", requests.len())));
    }
    let assume_clean = arguments.inputs.using.assume_clean;
    let operands = combine::read(requests, assume_clean, None, &control, session)?;
    let [a, b] = &*operands else { return Err(Fault::internal("two operands")) };
    let start = Instant::now();
    let Some(found) = a.solid.distance(&b.solid) else {
        return Err(Fault::unusable("one of the inputs is empty, and nothing is any distance from it"));
    };
    let overlap = if found.distance == 0.0 { overlap(a, b, session)? } else { 0.0 };
    session.took("run", start);
    let [p, q] = found.surfaces.points;
    if !session.common.json {
        let mut text = format!("distance {}\n", short(found.distance));
        if overlap > 0.0 {
            text.push_str(&format!("overlap  {} (volume in both)\n", short(overlap)));
        }
        if found.encloses {
            text.push_str(&format!(
                "surfaces {} apart: one lies inside the other\n",
                short(found.surfaces.distance)
            ));
        }
        text.push_str(&format!("from     {}\nto       {}\n", three(p), three(q)));
        session.console.pause(|| stream::print(&text))?;
    }
    session.note("distance", found.distance);
    session.note("points", json!([p, q]));
    session.note("surface_distance", found.surfaces.distance);
    session.note("encloses", found.encloses);
    session.note("overlap_volume", json_of(&overlap));
    Ok(Exit::Fine)
}

/// The volume that both inputs have.
fn overlap(a: &Operand, b: &Operand, session: &Session<'_>) -> Result<f64, Error> {
    session
        .boolean_options(session.control())
        .rules([a.request.rule, b.request.rule])
        .overlap_volume(&a.solid, &b.solid)
}

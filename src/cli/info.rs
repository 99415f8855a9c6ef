//! `info`: what is in files, and which formats there are.

use std::collections::HashSet;

use clap::ArgMatches;
use serde_json::{Value, json};
use trisect::io::{Contents, Format, PartName};
use trisect::mesh::Mending;
use trisect::{Error, Mesh};

use super::arguments::Info;
use super::fault::{Exit, Fault};
use super::held;
use super::json::json_of;
use super::reading::{self, Input};
use super::report::Measures;
use super::requests::{self, Request};
use super::selection;
use super::session::Session;
use super::stream;
use super::words::counted;

/// Names deeper than this are not indented further.
const DEEPEST: usize = 20;

/// Describes every input, or the formats.
pub(crate) fn run(arguments: &Info, matches: &ArgMatches, session: &mut Session<'_>) -> Result<Exit, Fault> {
    if arguments.formats {
        return formats(session);
    }
    let control = session.control();
    let mut objects = Vec::new();
    let requests = requests::requests(matches, arguments.reading.format)?;
    let requests = selection::each(requests, &session.limits, &control)?;
    for (index, request) in requests.into_iter().enumerate() {
        let name = request.name();
        let of_this = |error: Error| error.of_operand(index, name.clone());
        session.console.stage(&format!("reading {name}"), 0.0);
        let (request, parts) = selection::whole(request, &session.limits, &control).map_err(of_this)?;
        let Input { mesh, format, warnings, contents, reserved: _reserved } =
            reading::read(&request, &session.limits, &control).map_err(of_this)?;
        let (text, object) = describe(&request, &mesh, format, &warnings, &parts, &contents);
        if !session.common.json {
            session.console.pause(|| stream::print(&text))?;
        }
        for warning in warnings {
            session.warn(format!("{name}: {warning}"));
        }
        objects.push(object);
    }
    session.note("files", objects);
    Ok(Exit::Fine)
}

fn formats(session: &mut Session<'_>) -> Result<Exit, Fault> {
    let listed: Vec<Value> = Format::ALL
        .iter()
        .map(|format| json!({ "format": format.extension(), "name": format.to_string() }))
        .collect();
    session.note("formats", listed);
    if !session.common.json {
        let lines = Format::ALL
            .iter()
            .map(|format| format!(".{:6} {format}, read and written\n", format.extension()));
        stream::print(&lines.collect::<String>())?;
    }
    Ok(Exit::Fine)
}

fn describe(
    request: &Request,
    mesh: &Mesh,
    format: Format,
    warnings: &[String],
    parts: &[PartName],
    contents: &Contents,
) -> (String, Value) {
    let (measures, state, mending) = match trisect::Solid::try_from(mesh.clone()) {
        Ok(solid) => (Measures::of_solid(&solid), None, solid.mending().clone()),
        Err(error) => {
            let state = super::fault::one_line(&error.to_string());
            (Measures::of_mesh(mesh), Some(state), Mending::default())
        }
    };
    let mut rows = measures.table();
    if !mending.is_none() {
        rows.push(("mended", mending.to_string()));
    }
    if let Some(state) = &state {
        rows.push(("closed", state.clone()));
    }
    let mut text = format!("{} ({format})\n", request.name());
    for (name, value) in rows {
        text.push_str(&format!("  {name:10} {value}\n"));
    }
    let groups = groups(mesh);
    text.push_str(&format!("  {:10} {}\n", "groups", groups.len()));
    for group in &groups {
        text.push_str(&format!("    {}\n", group.line()));
    }

    text.push_str(&listed(parts, &groups));
    text.push_str(&held::text(mesh, contents));

    let mut object = measures.to_json();
    object.insert("parts".into(), json_of(&parts));
    object.insert("file".into(), request.name().into());
    object.insert("format".into(), format.extension().into());
    object.insert("state".into(), json!(state));
    object.insert("mending".into(), json_of(&mending));
    object.insert("groups".into(), groups.iter().map(Group::to_json).collect::<Vec<_>>().into());
    object.insert("warnings".into(), json!(warnings));
    object.extend(held::json(mesh, contents));
    (text, object.into())
}

/// The names that can stand after `#`, where they are more than the groups.
fn listed(parts: &[PartName], groups: &[Group<'_>]) -> String {
    let told: HashSet<&str> = groups.iter().map(|group| group.name).collect();
    if parts.iter().all(|part| told.contains(part.name.as_str())) {
        return String::new();
    }
    let mut text = format!("  {:10} {}\n", "parts", parts.len());
    for part in parts {
        let indent = "  ".repeat(2 + part.depth.min(DEEPEST));
        text.push_str(&format!("{indent}{}: {}\n", part.name, counted(part.triangles, "triangle")));
    }
    text
}

/// A group of faces with its size.
struct Group<'a> {
    name: &'a str,
    material: Option<&'a trisect::Material>,
    triangles: usize,
}

impl Group<'_> {
    fn line(&self) -> String {
        let name = if self.name.is_empty() { "(unnamed)" } else { self.name };
        let material = match self.material {
            Some(material) => format!(", material {}", material.name),
            None => String::new(),
        };
        format!("{name}: {}{material}", counted(self.triangles, "triangle"))
    }

    fn to_json(&self) -> Value {
        json!({
            "name": self.name,
            "triangles": self.triangles,
            "material": self.material.map(|material| &material.name),
            "base_color": self.material.map(|material| material.base_color),
        })
    }
}

fn groups(mesh: &Mesh) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = mesh
        .groups
        .list
        .iter()
        .map(|group| Group { name: &group.name, material: group.material.as_ref(), triangles: 0 })
        .collect();
    for &group in &mesh.groups.of_triangle {
        if let Some(group) = groups.get_mut(group as usize) {
            group.triangles += 1;
        }
    }
    groups
}

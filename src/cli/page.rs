//! A page that shows a result in a browser: one file, with the model, the library that draws it, and what is told of both.

use std::collections::HashMap;
use std::io::Write;

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use serde_json::{Value, json};
use trisect::io::{self, Format, WriteOptions, Written};
use trisect::mesh::Attribute;
use trisect::{Error, FileAction, Mesh, Outcome, Solid, render};

use super::argument_groups::Colours;
use super::output::Shown;
use super::report::{self, Measures};
use super::words;

/// The page, with names in double braces where something is put in.
const PAGE: &str = include_str!("../../assets/viewer/page.html");
const STYLE: &str = include_str!("../../assets/viewer/viewer.css");
const SCRIPT: &str = include_str!("../../assets/viewer/viewer.js");

/// three.js, packed; the page unpacks it. `assets/viewer/README.md` says which, and how it was made.
const LIBRARY: &[u8] = include_bytes!("../../assets/viewer/three.js.gz");
const LIBRARY_VERSION: &str = "0.187.0";

/// The attribute that tells the page where a triangle comes from: twice the operand's number, and one more for a cut face.
const ORIGIN: &str = "_OPERAND";

/// Writes the page.
///
/// # Errors
/// Those of a GLB file.
pub(crate) fn write(
    mesh: &Mesh,
    shown: &Shown<'_>,
    name: &str,
    options: &WriteOptions,
    out: &mut dyn Write,
) -> Result<Written, Error> {
    let mut model = Vec::new();
    let written = match shown.outcome.and_then(|outcome| with_origins(mesh, outcome)) {
        Some(mesh) => io::write_report(&mesh, Format::Glb, &mut model, options)?,
        None => io::write_report(mesh, Format::Glb, &mut model, options)?,
    };
    put_together(mesh, shown, name, &model, out).map_err(|source| Error::File {
        action: FileAction::Write,
        path: name.into(),
        source,
    })?;
    Ok(written)
}

/// The page around a model.
fn put_together(
    mesh: &Mesh,
    shown: &Shown<'_>,
    name: &str,
    model: &[u8],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let title = escaped(name);
    let data = data(mesh, shown);
    let mut rest = PAGE;
    while let Some((before, after)) = rest.split_once("{{") {
        out.write_all(before.as_bytes())?;
        let (what, after) = after.split_once("}}").unwrap_or((after, ""));
        match what {
            "VERSION" => out.write_all(env!("CARGO_PKG_VERSION").as_bytes())?,
            "TITLE" => out.write_all(title.as_bytes())?,
            "STYLE" => out.write_all(STYLE.as_bytes())?,
            "DATA" => out.write_all(data.as_bytes())?,
            "MODEL" => encode(model, out)?,
            "LIBRARY_VERSION" => out.write_all(LIBRARY_VERSION.as_bytes())?,
            "LIBRARY" => encode(LIBRARY, out)?,
            "SCRIPT" => out.write_all(SCRIPT.as_bytes())?,
            _ => {}
        }
        rest = after;
    }
    out.write_all(rest.as_bytes())
}

fn encode(bytes: &[u8], out: &mut dyn Write) -> std::io::Result<()> {
    let mut encoder = EncoderWriter::new(out, &STANDARD);
    encoder.write_all(bytes)?;
    encoder.finish().map(drop)
}

/// The mesh with an attribute that tells where its triangles come from; nothing if they are others than the result's.
fn with_origins(mesh: &Mesh, outcome: &Outcome) -> Option<Mesh> {
    let origins = outcome.origins();
    if origins.len() != mesh.triangles.len() {
        return None;
    }
    let mut attribute = Attribute::new(ORIGIN, 1);
    let mut known: HashMap<u32, u32> = HashMap::new();
    for origin in origins {
        let code = origin.operand.saturating_mul(2).saturating_add(u32::from(origin.reversed));
        let index = *known.entry(code).or_insert_with(|| {
            attribute.values.push(f64::from(code));
            attribute.values.len() as u32 - 1
        });
        attribute.of_corner.extend([index; 3]);
    }
    let mut mesh = mesh.clone();
    mesh.attributes.retain(|other| other.name != ORIGIN);
    mesh.attributes.push(attribute);
    Some(mesh)
}

/// What the script has to know, as JSON that may stand in a page.
fn data(mesh: &Mesh, shown: &Shown<'_>) -> String {
    let usual = if shown.outcome.is_some() { Colours::Operand } else { Colours::Material };
    let way = match shown.colours.unwrap_or(usual) {
        Colours::Operand => "operand",
        Colours::Material => "material",
        Colours::None => "plain",
    };
    let colour = |index| {
        let [red, green, blue] = render::palette(index);
        format!("#{red:02x}{green:02x}{blue:02x}")
    };
    let data = json!({
        "facts": facts(mesh, shown.outcome),
        "palette": (0..8).map(colour).collect::<Vec<String>>(),
        "way": way,
        "up": shown.view.up,
        "from": shown.view.direction,
    });
    // "</script>" in a name would end the element.
    data.to_string().replace('<', "\\u003c")
}

/// Measures, and what the certificate says besides, line by line.
fn facts(mesh: &Mesh, outcome: Option<&Outcome>) -> Vec<(String, String)> {
    let measures = match (outcome, Solid::try_from(mesh.clone())) {
        (_, Ok(solid)) => Measures::of_solid(&solid),
        (Some(outcome), _) => Measures::of_solid(outcome.solid()),
        (None, Err(_)) => Measures::of_mesh(mesh),
    };
    let mut facts: Vec<(String, String)> =
        measures.table().into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    let certificate = outcome.map(|outcome| report::certificate(outcome.certificate()));
    for (key, value) in certificate.as_ref().and_then(Value::as_object).into_iter().flatten() {
        const TOLD: [&str; 8] =
            ["triangles", "closed", "manifold", "components", "genus", "volume", "area", "vertices"];
        let value = match value {
            Value::Number(number) if number.as_f64() != Some(0.0) => number.as_f64().map(words::short),
            Value::Bool(true) => Some("yes".to_owned()),
            Value::String(text) => Some(text.clone()),
            _ => None,
        };
        if let Some(value) = value.filter(|_| !TOLD.contains(&key.as_str())) {
            facts.push((key.replace('_', " "), value));
        }
    }
    facts
}

/// Text as it may stand in a page.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_in_braces_is_known() {
        let names: Vec<&str> =
            PAGE.split("{{").skip(1).filter_map(|rest| Some(rest.split_once("}}")?.0)).collect();
        let known =
            ["VERSION", "TITLE", "STYLE", "TITLE", "DATA", "MODEL", "LIBRARY_VERSION", "LIBRARY", "SCRIPT"];
        assert_eq!(names, known);
        assert!(!SCRIPT.contains("</script") && !STYLE.contains("</style"));
        assert!(LIBRARY.starts_with(b"\x1f\x8b"));
    }
}

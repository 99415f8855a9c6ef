//! The XML of a model.

use std::fmt::Write as _;
use std::io::Write;

use quick_xml::escape::escape;

use super::super::super::WriteOptions;
use super::super::super::text::{NumberWriter, write_all, write_blocks};
use super::super::space;
use super::objects::ObjectParts;
use super::palette::{Made, Palette};
use crate::{Error, Mesh};

/// The numbers of the resources that all objects share.
const MATERIALS_ID: u32 = 1;
const COLOURS_ID: u32 = 2;

/// The number of the first object.
const FIRST_OBJECT: usize = 3;

/// Text of triangle sets is written by this much, bytes.
const BLOCK: usize = 64 << 10;

/// Writes the model.
pub(super) fn model(
    mesh: &Mesh,
    objects: &[ObjectParts],
    palette: &Palette<'_>,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<(), Error> {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    text.push_str(&format!("<model unit=\"millimeter\" xml:lang=\"en-US\" xmlns=\"{}\"", space::CORE));
    if !palette.colours.is_empty() {
        text.push_str(&format!(" xmlns:m=\"{}\"", space::MATERIALS));
    }
    if objects.iter().any(|object| !object.sets.is_empty()) {
        text.push_str(&format!(" xmlns:t=\"{}\"", space::TRIANGLE_SETS));
    }
    let version = env!("CARGO_PKG_VERSION");
    text.push_str(&format!(">\n<metadata name=\"Application\">trisect {version}</metadata>\n<resources>\n"));
    properties(palette, &mut text);
    write_all(output, text.as_bytes())?;
    for (index, object) in objects.iter().enumerate() {
        write_object(mesh, object, FIRST_OBJECT + index, palette, output, options)?;
    }
    text.clear();
    text.push_str("</resources>\n<build>\n");
    for index in 0..objects.len() {
        text.push_str(&format!("<item objectid=\"{}\"/>\n", FIRST_OBJECT + index));
    }
    text.push_str("</build>\n</model>\n");
    write_all(output, text.as_bytes())
}

/// Base materials and colours.
fn properties(palette: &Palette<'_>, text: &mut String) {
    let hexadecimal =
        |[red, green, blue, opacity]: [u8; 4]| format!("#{red:02X}{green:02X}{blue:02X}{opacity:02X}");
    if !palette.materials.is_empty() {
        text.push_str(&format!("<basematerials id=\"{MATERIALS_ID}\">\n"));
        for (name, colour) in &palette.materials {
            text.push_str(&format!(
                "<base name=\"{}\" displaycolor=\"{}\"/>\n",
                xml_name(name),
                hexadecimal(*colour)
            ));
        }
        text.push_str("</basematerials>\n");
    }
    if !palette.colours.is_empty() {
        text.push_str(&format!("<m:colorgroup id=\"{COLOURS_ID}\">\n"));
        for colour in &palette.colours {
            text.push_str(&format!("<m:color color=\"{}\"/>\n", hexadecimal(*colour)));
        }
        text.push_str("</m:colorgroup>\n");
    }
}

/// A name as an attribute: XML has no place for control characters.
fn xml_name(name: &str) -> String {
    let is_forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    let clean: String = name.chars().map(|c| if is_forbidden(c) { '_' } else { c }).collect();
    escape(&clean).into_owned()
}

fn write_object(
    mesh: &Mesh,
    object: &ObjectParts,
    id: usize,
    palette: &Palette<'_>,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<(), Error> {
    let selection = object.selection.as_ref();
    let count = selection.map_or(mesh.triangles.len(), |selection| selection.triangles.len());
    let in_mesh = |index: usize| selection.map_or(index, |selection| selection.triangles[index] as usize);
    // 1. The object, with what its triangles have where they say nothing, which is asked for where any says something.
    let default = default_of(palette, count, in_mesh);
    let mut text =
        format!("<object id=\"{id}\" type=\"{}\"", if object.is_closed { "model" } else { "surface" });
    if !object.name.is_empty() {
        text.push_str(&format!(" name=\"{}\"", xml_name(&object.name)));
    }
    match default {
        Made::Plain => {}
        Made::Material(index) => text.push_str(&format!(" pid=\"{MATERIALS_ID}\" pindex=\"{index}\"")),
        Made::Colours([index, ..]) => text.push_str(&format!(" pid=\"{COLOURS_ID}\" pindex=\"{index}\"")),
    }
    text.push_str(">\n<mesh>\n<vertices>\n");
    write_all(output, text.as_bytes())?;
    // 2. Vertices.
    let vertices = selection.map_or(mesh.positions.len(), |selection| selection.vertices.len());
    write_blocks(output, vertices, &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        for index in range {
            let vertex = selection.map_or(index, |selection| selection.vertices[index] as usize);
            let [x, y, z] = mesh.positions[vertex];
            text.extend_from_slice(b"<vertex x=\"");
            numbers.float(text, x);
            text.extend_from_slice(b"\" y=\"");
            numbers.float(text, y);
            text.extend_from_slice(b"\" z=\"");
            numbers.float(text, z);
            text.extend_from_slice(b"\"/>\n");
        }
    })?;
    write_all(output, b"</vertices>\n<triangles>\n")?;
    // 3. Triangles, with what they are made of where that is not the object's.
    write_blocks(output, count, &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        for index in range {
            let corners =
                selection.map_or_else(|| mesh.triangles[index], |selection| selection.corners[index]);
            for (key, corner) in [&b"<triangle v1=\""[..], b"\" v2=\"", b"\" v3=\""].into_iter().zip(corners)
            {
                text.extend_from_slice(key);
                numbers.integer(text, u64::from(corner));
            }
            let made = palette.made(in_mesh(index));
            if made != default {
                made_of(made, &mut numbers, text);
            }
            text.extend_from_slice(b"\"/>\n");
        }
    })?;
    // 4. Names of its parts.
    write_all(output, b"</triangles>\n")?;
    if !object.sets.is_empty() {
        sets(&object.sets, output)?;
    }
    write_all(output, b"</mesh>\n</object>\n")
}

/// What an object is made of where its triangles say nothing; plain if any triangle is.
fn default_of(palette: &Palette<'_>, count: usize, in_mesh: impl Fn(usize) -> usize) -> Made {
    let mut default = Made::Plain;
    for index in 0..count {
        match palette.made(in_mesh(index)) {
            Made::Plain => return Made::Plain,
            Made::Colours([first, ..]) if default == Made::Plain => default = Made::Colours([first; 3]),
            made if default == Made::Plain => default = made,
            _ => {}
        }
    }
    default
}

/// Appends the attributes of a triangle, but for the last quotation mark.
fn made_of(made: Made, numbers: &mut NumberWriter, text: &mut Vec<u8>) {
    let (id, indices) = match made {
        Made::Plain => return,
        Made::Material(index) => (MATERIALS_ID, [index; 3]),
        Made::Colours(indices) => (COLOURS_ID, indices),
    };
    text.extend_from_slice(b"\" pid=\"");
    numbers.integer(text, u64::from(id));
    text.extend_from_slice(b"\" p1=\"");
    numbers.integer(text, u64::from(indices[0]));
    if indices != [indices[0]; 3] {
        text.extend_from_slice(b"\" p2=\"");
        numbers.integer(text, u64::from(indices[1]));
        text.extend_from_slice(b"\" p3=\"");
        numbers.integer(text, u64::from(indices[2]));
    }
}

/// Writes the triangle sets, triangle by triangle: the element for a range of them is younger than lib3mf 2.5, which refuses it.
fn sets(sets: &[(String, Vec<[u32; 2]>)], output: &mut dyn Write) -> Result<(), Error> {
    let mut text = String::from("<t:trianglesets>\n");
    for (index, (name, runs)) in sets.iter().enumerate() {
        text.push_str(&format!("<t:triangleset name=\"{}\" identifier=\"group{index}\">\n", xml_name(name)));
        for triangle in runs.iter().flat_map(|&[first, last]| first..=last) {
            // Writing to a string does not fail.
            let _ = writeln!(text, "<t:ref index=\"{triangle}\"/>");
            if text.len() >= BLOCK {
                write_all(output, text.as_bytes())?;
                text.clear();
            }
        }
        text.push_str("</t:triangleset>\n");
    }
    text.push_str("</t:trianglesets>\n");
    write_all(output, text.as_bytes())
}

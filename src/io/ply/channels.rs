//! Attributes as properties of vertices and faces.

use super::super::color::{encoded, encoded_byte, linear};
use super::super::labels::{agree, from_below};
use super::super::text::NumberWriter;
use super::super::{Encoding, Precision};
use crate::Mesh;
use crate::mesh::{Attribute, AttributeKind};

/// How the numbers of a property are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Byte,
    Single,
    Double,
}

/// A property of each vertex or of each triangle.
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) values: Vec<f64>,
}

/// What a file holds beside positions and corners.
#[derive(Default)]
pub(super) struct Channels<'a> {
    pub(super) of_vertices: Vec<Channel>,
    pub(super) of_faces: Vec<Channel>,
    /// Texture coordinates that differ from face to face.
    pub(super) texture: Option<&'a Attribute>,
    pub(super) warnings: Vec<String>,
}

impl<'a> Channels<'a> {
    pub(super) fn of(mesh: &'a Mesh, precision: Precision) -> Self {
        let mut channels = Self::default();
        let mut lost = Vec::new();
        for attribute in &mesh.attributes {
            if attribute.of_corner.iter().all(|&index| index == Attribute::NONE) {
                continue;
            }
            let Some(names) = names(attribute) else {
                lost.push(&*attribute.name);
                continue;
            };
            let (first, torn) = of_vertices(mesh, attribute);
            let kind = kind(attribute, precision);
            if torn == 0 {
                channels.of_vertices.extend(split(attribute, names, kind, &first));
            } else if is_flat(attribute) {
                let first: Vec<u32> = attribute.of_corner.iter().step_by(3).copied().collect();
                channels.of_faces.extend(split(attribute, names, kind, &first));
            } else if attribute.name == "TEXCOORD_0" {
                channels.texture = Some(attribute);
            } else {
                channels.of_vertices.extend(split(attribute, names, kind, &first));
                channels.warnings.push(format!(
                    "PLY has one value of {} a vertex: of {torn} vertices with several the first is written",
                    attribute.name
                ));
            }
        }
        if !lost.is_empty() {
            channels.warnings.push(format!("PLY has no place for {}: not written", lost.join(", ")));
        }
        channels
    }

    /// The lines of the header for properties.
    pub(super) fn header(list: &[Channel]) -> String {
        let line = |channel: &Channel| {
            let kind = match channel.kind {
                Kind::Byte => "uchar",
                Kind::Single => "float",
                Kind::Double => "double",
            };
            format!("property {kind} {}\n", channel.name)
        };
        list.iter().map(line).collect()
    }

    /// Whether two corners at one vertex have the same texture coordinates, where faces list them, and their triangles the same
    /// properties.
    pub(super) fn are_one(&self, a: u32, b: u32) -> bool {
        let value = |corner: u32| {
            self.texture.and_then(|texture| texture.at(corner as usize / 3, corner as usize % 3))
        };
        let number =
            |channel: &Channel, corner: u32| channel.values.get(corner as usize / 3).map(|x| x.to_bits());
        value(a) == value(b) && self.of_faces.iter().all(|channel| number(channel, a) == number(channel, b))
    }

    /// Whether there is nothing.
    pub(super) fn is_empty(&self) -> bool {
        self.of_vertices.is_empty() && self.of_faces.is_empty() && self.texture.is_none()
    }
}

impl Channel {
    /// Appends the number of a vertex or face; in text after a blank.
    pub(super) fn write(&self, item: usize, encoding: Encoding, out: &mut Vec<u8>) {
        let value = self.values.get(item).copied().unwrap_or(0.0);
        match (encoding, self.kind) {
            (Encoding::Ascii, Kind::Byte) => {
                out.push(b' ');
                NumberWriter::new(Precision::Double).integer(out, value as u64);
            }
            (Encoding::Ascii, kind) => {
                out.push(b' ');
                let precision = if kind == Kind::Single { Precision::Single } else { Precision::Double };
                if value.is_finite() {
                    NumberWriter::new(precision).float(out, value);
                } else {
                    out.extend_from_slice(b"nan");
                }
            }
            (_, Kind::Byte) => out.push(value as u8),
            (encoding, Kind::Single) => push_single(value, encoding, out),
            (Encoding::BinaryBigEndian, Kind::Double) => out.extend_from_slice(&value.to_be_bytes()),
            (_, Kind::Double) => out.extend_from_slice(&value.to_le_bytes()),
        }
    }
}

pub(super) fn push_single(value: f64, encoding: Encoding, out: &mut Vec<u8>) {
    let value = value as f32;
    match encoding {
        Encoding::BinaryBigEndian => out.extend_from_slice(&value.to_be_bytes()),
        _ => out.extend_from_slice(&value.to_le_bytes()),
    }
}

/// The names of the properties of an attribute; nothing if PLY has none for it.
fn names(attribute: &Attribute) -> Option<Vec<String>> {
    let list = |names: &[&str]| Some(names.iter().map(|&name| name.to_owned()).collect());
    match &*attribute.name {
        "NORMAL" => list(&["nx", "ny", "nz"]),
        "COLOR_0" => list(&["red", "green", "blue", "alpha"][..attribute.components.min(4)]),
        "TEXCOORD_0" => list(&["s", "t"]),
        name => {
            // A name is one word.
            let own: String = name.strip_prefix('_')?.chars().filter(|c| !c.is_whitespace()).collect();
            let own =
                if own.is_empty() || ["x", "y", "z"].contains(&&*own) { format!("_{own}") } else { own };
            match attribute.components {
                1 => Some(vec![own]),
                count => Some((0..count).map(|k| format!("{own}_{k}")).collect()),
            }
        }
    }
}

fn kind(attribute: &Attribute, precision: Precision) -> Kind {
    if attribute.kind() == AttributeKind::Colour {
        // Bytes are usual; floats where most colours are none.
        let is_byte = |&&value: &&f64| linear(f64::from(encoded_byte(value)) / 255.0) == value;
        let bytes = attribute.values.iter().filter(is_byte).count();
        return if 2 * bytes >= attribute.values.len() { Kind::Byte } else { Kind::Single };
    }
    let is_single = attribute.values.iter().all(|&value| f64::from(value as f32) == value);
    if is_single || precision == Precision::Single { Kind::Single } else { Kind::Double }
}

/// The properties of an attribute, given the value that each vertex or face has.
fn split(attribute: &Attribute, names: Vec<String>, kind: Kind, values: &[u32]) -> Vec<Channel> {
    let number = |k: usize, index: u32| {
        let value = attribute.value(index).and_then(|value| value.get(k)).copied();
        match (attribute.kind(), value) {
            (AttributeKind::Colour, None) if kind == Kind::Byte => 255.0,
            (AttributeKind::Colour, None) => 1.0,
            (AttributeKind::Colour, Some(value)) if k == 3 && kind == Kind::Byte => (value * 255.0).round(),
            (AttributeKind::Colour, Some(value)) if k == 3 => value,
            (AttributeKind::Colour, Some(value)) if kind == Kind::Byte => f64::from(encoded_byte(value)),
            (AttributeKind::Colour, Some(value)) => encoded(value),
            (_, Some(value)) if k == 1 && attribute.name == "TEXCOORD_0" => from_below(value),
            (_, Some(value)) => value,
            (AttributeKind::Normal, None) => 0.0,
            (_, None) => f64::NAN,
        }
    };
    let channel =
        |(k, name)| Channel { name, kind, values: values.iter().map(|&index| number(k, index)).collect() };
    names.into_iter().enumerate().map(channel).collect()
}

/// The first value at each vertex, and how many vertices have further ones.
fn of_vertices(mesh: &Mesh, attribute: &Attribute) -> (Vec<u32>, usize) {
    let mut first = vec![Attribute::NONE; mesh.positions.len()];
    let mut torn = vec![false; mesh.positions.len()];
    for (&vertex, &index) in mesh.triangles.as_flattened().iter().zip(&attribute.of_corner) {
        let known = &mut first[vertex as usize];
        if *known == Attribute::NONE {
            *known = index;
        } else if index != Attribute::NONE && !agree(attribute.value(index), attribute.value(*known)) {
            torn[vertex as usize] = true;
        }
    }
    (first, torn.iter().filter(|&&torn| torn).count())
}

/// Whether the corners of every triangle have one value.
fn is_flat(attribute: &Attribute) -> bool {
    attribute.of_corner.chunks_exact(3).all(|corners| {
        let value = |k: usize| attribute.value(corners[k]);
        value(0) == value(1) && value(0) == value(2)
    })
}

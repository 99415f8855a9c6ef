//! Properties of vertices and faces as attributes.

use super::super::color::linear;
use super::super::labels::of_triangles;
use super::super::notes::Notes;
use super::body::{Body, Channel};
use super::header::Type;
use crate::mesh::Attribute;

/// Names that programs give to the two texture coordinates of a vertex.
pub(super) const TEXTURE: [[&str; 2]; 4] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// The attributes of triangles, each of a face. What corners name may take `room` bytes.
pub(super) fn attributes(
    triangles: &[[u32; 3]],
    faces: &[u32],
    body: Body,
    room: usize,
    notes: &mut Notes,
) -> Vec<Attribute> {
    let Body { of_vertices, of_faces, before_faces, texture, labels, .. } = body;
    let mut list = Vec::new();
    // Every attribute takes 12 bytes a triangle, of which a file has eight or more.
    let most = room / (12 * triangles.len()).max(1);
    let vertices: Vec<u32> =
        if of_vertices.is_empty() { Vec::new() } else { triangles.as_flattened().to_vec() };
    taken(of_vertices, &vertices, most, &mut list, notes);
    let item = |face: u32| face.checked_sub(before_faces as u32).unwrap_or(Attribute::NONE);
    let corners: Vec<u32> = if of_faces.is_empty() {
        Vec::new()
    } else {
        faces.iter().flat_map(|&face| [item(face); 3]).collect()
    };
    taken(of_faces, &corners, most, &mut list, notes);
    if !texture.is_empty() && list.iter().all(|attribute| attribute.name != "TEXCOORD_0") {
        let corners = of_triangles(triangles, faces, &labels, [texture.len(), 0]);
        let values = texture.iter().flat_map(|&[u, v]| [finite(u), 1.0 - finite(v)]).collect();
        list.push(Attribute { name: "TEXCOORD_0".into(), components: 2, values, of_corner: corners.texture });
    }
    list
}

/// Makes attributes of channels: normals, colours and texture coordinates by their names, all others by one each.
fn taken(
    mut channels: Vec<Channel>,
    corners: &[u32],
    most: usize,
    list: &mut Vec<Attribute>,
    notes: &mut Notes,
) {
    // 1. Channels that belong together.
    let normals = several(&mut channels, &["nx", "ny", "nz"]);
    let colors = several(&mut channels, &["red", "green", "blue", "alpha"])
        .or_else(|| several(&mut channels, &["red", "green", "blue"]));
    let texture = TEXTURE.iter().find_map(|names| several(&mut channels, names));
    // 2. What their numbers mean.
    let mut add = |name: String, channels: &[Channel], value: &dyn Fn(usize, &Channel, f64) -> f64| {
        if list.len() >= most {
            notes.add("property left out, there are too many for the size of the file", 1);
        } else if list.iter().any(|attribute| attribute.name == name) {
            notes.add("property of faces with the name of one of vertices left out", 1);
        } else {
            let attribute = attribute(name, channels, corners, value);
            list.extend(Some(attribute).filter(|attribute| !attribute.is_empty()));
        }
    };
    let as_it_is = |_: usize, _: &Channel, number: f64| number;
    if let Some(found) = normals {
        add("NORMAL".into(), &found, &as_it_is);
    }
    if let Some(found) = colors {
        add("COLOR_0".into(), &found, &|k, channel, number| color(k, channel.kind, number));
    }
    if let Some(found) = texture {
        // The file counts from the lower edge of pictures, meshes from the upper one.
        add("TEXCOORD_0".into(), &found, &|k, _, number| if k == 1 { 1.0 - number } else { number });
    }
    for channel in channels {
        add(format!("_{}", channel.name), &[channel], &as_it_is);
    }
}

/// Takes out the channels of these names, if all are there.
fn several(channels: &mut Vec<Channel>, names: &[&str]) -> Option<Vec<Channel>> {
    let places: Option<Vec<usize>> =
        names.iter().map(|name| channels.iter().position(|channel| channel.name == *name)).collect();
    let mut places = places?;
    let mut found: Vec<Option<Channel>> = (0..names.len()).map(|_| None).collect();
    let order = places.clone();
    places.sort_unstable();
    for place in places.into_iter().rev() {
        let at = order.iter().position(|&wanted| wanted == place)?;
        found[at] = Some(channels.remove(place));
    }
    found.into_iter().collect()
}

/// The attribute of channels; `corners` name their items, and `value` says what a number of a channel is. An item with a number that
/// is not finite is no value.
fn attribute(
    name: String,
    channels: &[Channel],
    corners: &[u32],
    value: &dyn Fn(usize, &Channel, f64) -> f64,
) -> Attribute {
    let count = channels.first().map_or(0, |channel| channel.values.len());
    let mut attribute = Attribute::new(name, channels.len());
    let mut is_whole = vec![true; count];
    attribute.values.reserve(count * channels.len());
    for item in 0..count {
        for (k, channel) in channels.iter().enumerate() {
            let number = value(k, channel, channel.values[item]);
            is_whole[item] &= number.is_finite();
            attribute.values.push(finite(number));
        }
    }
    let index = |&item: &u32| {
        let is_there = is_whole.get(item as usize).copied().unwrap_or(false);
        if is_there { item } else { Attribute::NONE }
    };
    attribute.of_corner = corners.iter().map(index).collect();
    attribute
}

/// A channel of a colour, linear; the fourth one is opacity.
fn color(k: usize, kind: Type, number: f64) -> f64 {
    let part = match kind {
        Type::U8 | Type::I8 => number / 255.0,
        Type::U16 | Type::I16 => number / 65_535.0,
        _ => number,
    };
    let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { return f64::NAN };
    if k == 3 { part } else { linear(part) }
}

fn finite(number: f64) -> f64 {
    if number.is_finite() { number } else { 0.0 }
}

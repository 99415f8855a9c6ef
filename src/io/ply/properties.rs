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
    let Body { of_vertices, of_faces, texture, labels, .. } = body;
    let mut list = Vec::new();
    // Every attribute takes 12 bytes a triangle, of which a file has eight or more.
    let most = room / (12 * triangles.len()).max(1);
    let vertices: Vec<u32> =
        if of_vertices.is_empty() { Vec::new() } else { triangles.as_flattened().to_vec() };
    taken(of_vertices, &vertices, most, &mut list, notes);
    let corners: Vec<u32> =
        if of_faces.is_empty() { Vec::new() } else { faces.iter().flat_map(|&face| [face; 3]).collect() };
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
    let mut several = |names: &[&str]| -> Option<Vec<Channel>> {
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
    };
    let mut groups: Vec<(&str, Vec<Channel>)> = Vec::new();
    groups.extend(several(&["nx", "ny", "nz"]).map(|found| ("NORMAL", found)));
    let colors = several(&["red", "green", "blue", "alpha"]).or_else(|| several(&["red", "green", "blue"]));
    groups.extend(colors.map(|found| ("COLOR_0", found)));
    let texture = TEXTURE.iter().find_map(|names| several(names));
    groups.extend(texture.map(|found| ("TEXCOORD_0", found)));
    let mut add = |name: String, channels: &[Channel], value: &dyn Fn(usize, &Channel, f64) -> f64| {
        if list.len() >= most {
            notes.add("property left out, there are too many for the size of the file", 1);
            return;
        }
        if list.iter().any(|attribute| attribute.name == name) {
            notes.add("property of faces with the name of one of vertices left out", 1);
            return;
        }
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
        if !attribute.is_empty() {
            list.push(attribute);
        }
    };
    for (name, found) in groups {
        match name {
            "COLOR_0" => add(name.into(), &found, &|k, channel, number| color(k, channel.kind, number)),
            // The file counts from the lower edge of pictures, meshes from the upper one.
            "TEXCOORD_0" => {
                add(name.into(), &found, &|k, _, number| if k == 1 { 1.0 - number } else { number });
            }
            _ => add(name.into(), &found, &|_, _, number| number),
        }
    }
    for channel in channels {
        add(format!("_{}", channel.name), &[channel], &|_, _, number| number);
    }
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

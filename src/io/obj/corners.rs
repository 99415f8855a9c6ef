//! Texture coordinates, normals and colours of faces as attributes.

use super::super::color::linear;
use super::super::labels::NO_INDEX;
use super::super::notes::Notes;
use super::parse::NO_COLOR;
use crate::mesh::Attribute;

/// The attributes of the mesh, from what the file lists and what its corners name.
pub(super) fn attributes(
    triangles: &[[u32; 3]],
    texture: (Vec<[f64; 2]>, Vec<u32>),
    normals: (Vec<[f64; 3]>, Vec<u32>),
    colors: &[[f64; 3]],
    notes: &mut Notes,
) -> Vec<Attribute> {
    let mut list = Vec::new();
    let is_named = |indices: &[u32]| indices.iter().any(|&index| index != NO_INDEX);
    let mut add = |name: &str, components, values, mut of_corner: Vec<u32>| {
        of_corner.resize(3 * triangles.len(), Attribute::NONE);
        list.push(Attribute { name: name.into(), components, values, of_corner });
    };
    if is_named(&normals.1) {
        add("NORMAL", 3, normals.0.into_flattened(), normals.1);
    }
    if is_named(&texture.1) {
        // OBJ counts from the lower edge of pictures, meshes from the upper one.
        let values = texture.0.iter().flat_map(|&[u, v]| [u, 1.0 - v]).collect();
        add("TEXCOORD_0", 2, values, texture.1);
    }
    if !colors.is_empty() {
        let has = |&vertex: &u32| colors.get(vertex as usize).is_some_and(|color| color[0].is_finite());
        let index = |vertex: &u32| if has(vertex) { *vertex } else { Attribute::NONE };
        let of_corner = triangles.as_flattened().iter().map(index).collect();
        let range = colors.iter().flatten().fold(0.0_f64, |most, &x| most.max(x));
        // Some programs write 0 to 255.
        let unit = if range > 1.0 { 255.0 } else { 1.0 };
        if range > 1.0 {
            notes.say("vertex colours above 1 are taken for parts of 255");
        }
        let channel = |&x: &f64| if x.is_finite() { linear((x / unit).clamp(0.0, 1.0)) } else { 0.0 };
        add("COLOR_0", 3, colors.iter().flatten().map(channel).collect(), of_corner);
    }
    list
}

/// Colours of chunks one after the other, each filled up to its chunk's vertices.
pub(super) fn join_colors(chunks: impl Iterator<Item = (Vec<[f64; 3]>, usize)>) -> Vec<[f64; 3]> {
    let mut all: Vec<[f64; 3]> = Vec::new();
    let mut vertices = 0;
    for (colors, count) in chunks {
        if !colors.is_empty() {
            all.resize(vertices, NO_COLOR);
            all.extend(colors);
        }
        vertices += count;
    }
    all
}

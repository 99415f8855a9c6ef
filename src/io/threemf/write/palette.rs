//! Materials and colours as a package has them, and what it has no place for.

use std::collections::HashMap;

use serde_json::Value;

use super::super::super::{color, pictures};
use crate::Mesh;
use crate::mesh::{Attribute, Material, MaterialLanguage};

/// The colours of a mesh, in the order in which they occur.
pub(super) struct Palette<'a> {
    mesh: &'a Mesh,
    /// Base materials: name and colour, encoded for screens, with opacity.
    pub(super) materials: Vec<(String, [u8; 4])>,
    /// For every group its material.
    of_group: Vec<Option<u32>>,
    /// Colours of corners.
    pub(super) colours: Vec<[u8; 4]>,
    /// The attribute that they are, and for each of its values the colour.
    of_value: Option<(&'a Attribute, Vec<u32>)>,
}

/// What a triangle is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Made {
    Plain,
    Material(u32),
    /// Colours of its corners.
    Colours([u32; 3]),
}

impl<'a> Palette<'a> {
    pub(super) fn of(mesh: &'a Mesh) -> Self {
        let (mut materials, mut known) = (Vec::new(), HashMap::new());
        let mut number = |material: &Material| {
            let entry = (material.name.clone(), bytes(&material.base_color.map(f64::from)));
            *known.entry(entry).or_insert_with_key(|entry| {
                materials.push(entry.clone());
                materials.len() as u32 - 1
            })
        };
        let of_group =
            mesh.groups.list.iter().map(|group| group.material.as_ref().map(&mut number)).collect();
        let mut palette = Self { mesh, materials, of_group, colours: Vec::new(), of_value: None };
        if let Some(attribute) = colour_attribute(mesh) {
            let mut known = HashMap::new();
            let colours = &mut palette.colours;
            let of_value = (attribute.values.chunks_exact(attribute.components))
                .map(|value| {
                    let colour = bytes(value);
                    *known.entry(colour).or_insert_with(|| {
                        colours.push(colour);
                        colours.len() as u32 - 1
                    })
                })
                .collect();
            palette.of_value = Some((attribute, of_value));
        }
        palette
    }

    /// What a triangle is made of: colours of corners count before materials.
    #[inline]
    pub(super) fn made(&self, triangle: usize) -> Made {
        if let Some((attribute, of_value)) = &self.of_value {
            let corners = &attribute.of_corner[3 * triangle..3 * triangle + 3];
            if corners.iter().all(|&value| value != Attribute::NONE) {
                return Made::Colours([0, 1, 2].map(|k| of_value[corners[k] as usize]));
            }
        }
        let group = self.mesh.groups.of_triangle.get(triangle);
        let material = group.and_then(|&group| self.of_group[group as usize]);
        material.map_or(Made::Plain, Made::Material)
    }
}

/// The colours of corners that are written.
fn colour_attribute(mesh: &Mesh) -> Option<&Attribute> {
    let has_values =
        |attribute: &&Attribute| attribute.of_corner.iter().any(|&value| value != Attribute::NONE);
    mesh.attributes.iter().find(|attribute| attribute.name == "COLOR_0").filter(has_values)
}

/// A linear colour as bytes for screens, with its opacity.
fn bytes(value: &[f64]) -> [u8; 4] {
    let channel = |k: usize| value.get(k).copied().unwrap_or(0.0);
    let opacity = value.get(3).copied().unwrap_or(1.0).clamp(0.0, 1.0);
    [
        color::encoded_byte(channel(0)),
        color::encoded_byte(channel(1)),
        color::encoded_byte(channel(2)),
        (opacity * 255.0).round() as u8,
    ]
}

/// What of a mesh a package has no place for, one sentence each.
pub(super) fn lost(mesh: &Mesh) -> Vec<String> {
    let mut warnings = Vec::new();
    let names: Vec<&str> =
        mesh.attributes.iter().map(|attribute| &*attribute.name).filter(|name| *name != "COLOR_0").collect();
    if !names.is_empty() {
        warnings.push(format!("3MF has no place for {}: not written", names.join(", ")));
    }
    let materials = || mesh.groups.list.iter().filter_map(|group| group.material.as_ref());
    if colour_attribute(mesh).is_some() && materials().next().is_some() {
        warnings.push(
            "3MF has either a material or colours of corners: where there are colours, these are written"
                .into(),
        );
    }
    if materials().any(|material| pictures::of_material(material).next().is_some()) {
        warnings.push("3MF is written without pictures: of materials, names and colours are kept".into());
    } else if materials().any(says_more) {
        warnings.push("of materials, 3MF keeps names and colours alone".into());
    }
    warnings
}

/// Whether a material says more than its name and colour.
fn says_more(material: &Material) -> bool {
    let Some(said) = &material.text else { return false };
    match said.language {
        MaterialLanguage::Mtl => {
            let is_more =
                |line: &str| matches!(line.split_whitespace().next(), Some("Ke" | "Pr" | "Pm" | "Ps" | "Pc"));
            said.text.lines().any(is_more)
        }
        MaterialLanguage::Gltf => {
            let json: Value = serde_json::from_str(&said.text).unwrap_or_default();
            let keys = |value: &Value, known: &[&str]| {
                value.as_object().into_iter().flatten().any(|(key, _)| !known.contains(&key.as_str()))
            };
            keys(&json, &["name", "pbrMetallicRoughness", "doubleSided", "alphaMode"])
                || keys(&json["pbrMetallicRoughness"], &["baseColorFactor"])
        }
    }
}

//! What glTF says of materials that a material library has no words for.

use std::collections::BTreeSet;
use std::sync::Arc;

use serde_json::{Map, Value};

use crate::Mesh;
use crate::mesh::{MaterialLanguage, MaterialText};

/// So many keys are named.
const MOST_KEYS: usize = 16;

/// Longer keys are cut, letters.
const LONGEST_KEY: usize = 80;

/// Keys of a material for which there are statements, or which say nothing there: the faces of an OBJ are seen from both sides.
const SAID: [&str; 6] =
    ["name", "pbrMetallicRoughness", "emissiveFactor", "normalTexture", "emissiveTexture", "doubleSided"];

/// Keys of its surface for which there are statements.
const SAID_OF_SURFACE: [&str; 4] =
    ["baseColorFactor", "baseColorTexture", "metallicFactor", "roughnessFactor"];

/// What of the materials of a mesh a library has no words for, as a sentence.
pub(super) fn unsaid(mesh: &Mesh) -> Option<String> {
    let mut keys = BTreeSet::new();
    let mut seen: Vec<&Arc<MaterialText>> = Vec::new();
    for said in mesh.groups.list.iter().filter_map(|group| group.material.as_ref()?.text.as_ref()) {
        if said.language == MaterialLanguage::Gltf && !seen.iter().any(|known| Arc::ptr_eq(known, said)) {
            seen.push(said);
            if let Ok(Value::Object(json)) = serde_json::from_str::<Value>(&said.text) {
                of_material(&json, &mut keys);
            }
        }
    }
    let list: Vec<&str> = keys.iter().take(MOST_KEYS).map(String::as_str).collect();
    let more = if keys.len() > MOST_KEYS { ", ..." } else { "" };
    (!list.is_empty()).then(|| {
        format!("parts of materials not written, since MTL has no word for them: {}{more}", list.join(", "))
    })
}

/// Adds the keys of a material, of its surface and of their textures.
fn of_material(json: &Map<String, Value>, keys: &mut BTreeSet<String>) {
    // Where it is transparent by its opacity, the library says so; where by a threshold, it does not.
    let is_masked = json.get("alphaMode").is_some_and(|mode| mode == "MASK");
    for (key, value) in json {
        match key.as_str() {
            "alphaMode" | "alphaCutoff" if !is_masked => {}
            "extensions" => keys.extend(members(value).map(|(name, _)| short(name))),
            key if SAID.contains(&key) => {}
            key => drop(keys.insert(short(key))),
        }
    }
    let surface = json.get("pbrMetallicRoughness").and_then(Value::as_object);
    let of_surface = surface.into_iter().flatten().map(|(key, _)| key);
    keys.extend(of_surface.filter(|key| !SAID_OF_SURFACE.contains(&key.as_str())).map(|key| short(key)));
    for name in ["baseColorTexture", "normalTexture", "emissiveTexture"] {
        let texture = json.get(name).or_else(|| surface?.get(name));
        of_texture(name, texture.unwrap_or(&Value::Null), keys);
    }
}

/// Adds what is said of how a texture lies. A library says of the base colour's where it is moved to and scaled.
fn of_texture(name: &str, texture: &Value, keys: &mut BTreeSet<String>) {
    for (key, value) in members(texture) {
        let is_usual = match key.as_str() {
            "index" => true,
            "texCoord" => value == 0,
            "scale" => value.as_f64() == Some(1.0),
            _ => false,
        };
        if key == "extensions" {
            let turned =
                |said: &Value| said.get("rotation").and_then(Value::as_f64).is_some_and(|angle| angle != 0.0);
            let is_said = |extension: &str, said: &Value| {
                name == "baseColorTexture" && extension == "KHR_texture_transform" && !turned(said)
            };
            let unsaid = members(value).filter(|(extension, said)| !is_said(extension, said));
            keys.extend(unsaid.map(|(extension, _)| format!("{name}.{}", short(extension))));
        } else if !is_usual {
            keys.insert(format!("{name}.{}", short(key)));
        }
    }
}

fn members(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

fn short(key: &str) -> String {
    key.chars().filter(|character| !character.is_control()).take(LONGEST_KEY).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn keys(material: &Value) -> Vec<String> {
        let mut keys = BTreeSet::new();
        of_material(material.as_object().unwrap(), &mut keys);
        keys.into_iter().collect()
    }

    #[test]
    fn what_a_library_can_say_is_not_named() {
        let moved = json!({"KHR_texture_transform": {"offset": [0.5, 0], "scale": [2, 2]}});
        let said = json!({
            "name": "a", "doubleSided": true, "alphaMode": "BLEND", "alphaCutoff": 0.5, "emissiveFactor": [1, 1, 1],
            "pbrMetallicRoughness": {
                "baseColorFactor": [1, 1, 1, 0.5], "metallicFactor": 0, "roughnessFactor": 1,
                "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": moved}
            },
            "normalTexture": {"index": 1, "scale": 1}
        });
        assert_eq!(keys(&said), [""; 0]);
    }

    #[test]
    fn what_it_cannot_say_is_named_once() {
        let moved = json!({"KHR_texture_transform": {"rotation": 1}});
        let said = json!({
            "alphaMode": "MASK", "alphaCutoff": 0.5, "occlusionTexture": {"index": 0}, "extras": 7,
            "extensions": {"KHR_materials_ior": {}, "KHR_materials_clear\ncoat": {}},
            "pbrMetallicRoughness": {
                "metallicRoughnessTexture": {"index": 0}, "baseColorTexture": {"index": 0, "texCoord": 1, "extensions": moved}
            },
            "normalTexture": {"index": 1, "scale": 2}, "emissiveTexture": 7
        });
        assert_eq!(
            keys(&said),
            [
                "KHR_materials_clearcoat",
                "KHR_materials_ior",
                "alphaCutoff",
                "alphaMode",
                "baseColorTexture.KHR_texture_transform",
                "baseColorTexture.texCoord",
                "extras",
                "metallicRoughnessTexture",
                "normalTexture.scale",
                "occlusionTexture"
            ]
        );
    }
}

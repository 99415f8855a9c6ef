//! Materials of OBJ in words of glTF: what both can say.

use serde_json::{Value, json};

use super::super::super::mtl::MapStatement;
use super::super::plain::channel;
use crate::mesh::{MaterialText, TextureUse, Wrap};

/// Statements that glTF has no words for are named once; these say what its plain material says in any case.
const UNDERSTOOD: [&str; 9] = ["Kd", "d", "Tr", "map_Kd", "Ke", "Pr", "Pm", "illum", "newmtl"];

/// Adds to a material what the statements of a library say beside colour and opacity, and gives what is said of the others.
/// `info` is what a material says of a texture.
pub(super) fn translate(
    text: &MaterialText,
    material: &mut Value,
    info: &mut dyn FnMut(&TextureUse) -> Option<Value>,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut textures = text.textures.iter();
    for line in text.text.lines() {
        let mut words = line.split_whitespace();
        let Some(keyword) = words.next() else { continue };
        let numbers: Vec<f32> = words.map_while(|word| word.parse().ok()).collect();
        let surface = &mut material["pbrMetallicRoughness"];
        match (keyword, &numbers[..]) {
            ("Pr", &[value, ..]) => surface["roughnessFactor"] = json!(channel(value)),
            ("Pm", &[value, ..]) => surface["metallicFactor"] = json!(channel(value)),
            ("Ke", &[red, green, blue, ..]) if [red, green, blue] != [0.0; 3] => {
                material["emissiveFactor"] = json!([red, green, blue].map(channel));
            }
            _ => {}
        }
        let texture = MapStatement::parse(line).and_then(|_| textures.next());
        let place = match keyword {
            "norm" => "normalTexture",
            "map_Ke" => "emissiveTexture",
            _ if UNDERSTOOD.contains(&keyword) => continue,
            _ => {
                if !matches!(keyword, "Ka" | "Ks" | "Ns" | "Ni" | "Tf" | "map_Ka") {
                    warnings.push(format!(
                        "statement {keyword} of materials not written: glTF has no word for it"
                    ));
                }
                continue;
            }
        };
        let image = texture.and_then(|texture| texture.images.first());
        let said = image.and_then(|image| {
            info(&TextureUse {
                image: image.clone(),
                coordinates: 0,
                wrap: [Wrap::Repeat; 2],
                nearest: false,
                transform: TextureUse::UNMOVED,
            })
        });
        if let Some(said) = said {
            material[place] = said;
            if place == "emissiveTexture" && material.get("emissiveFactor").is_none() {
                material["emissiveFactor"] = json!([1, 1, 1]);
            }
        }
    }
    warnings
}

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
        let statement = MapStatement::parse(line);
        let texture = statement.as_ref().and_then(|_| textures.next());
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
        let (wrap, transform) = statement.map_or(([Wrap::Repeat; 2], TextureUse::UNMOVED), |statement| {
            let wrap = if statement.how.clamp { Wrap::Clamp } else { Wrap::Repeat };
            ([wrap; 2], statement.how.transform())
        });
        warnings.extend(statement.and_then(|statement| lost_options(&statement)));
        let said = image.and_then(|image| {
            info(&TextureUse { image: image.clone(), coordinates: 0, wrap, nearest: false, transform })
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

/// What is said of options for which glTF has no words.
fn lost_options(statement: &MapStatement<'_>) -> Option<String> {
    let is_lost = |word: &&str| {
        word.starts_with('-') && word.parse::<f64>().is_err() && !matches!(*word, "-o" | "-s" | "-clamp")
    };
    let lost: Vec<&str> = statement.options.split_whitespace().filter(is_lost).collect();
    (!lost.is_empty()).then(|| {
        format!("options {} of {} not written: glTF has no word for them", lost.join(" "), statement.keyword)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Image, MaterialLanguage, Texture};
    use std::sync::Arc;

    #[test]
    fn a_picture_of_normals_lies_as_its_options_say() {
        let texture = Texture { text: "n.png".into(), images: vec![Arc::new(Image::default())] };
        let text = MaterialText {
            language: MaterialLanguage::Mtl,
            text: "norm -s 2 3 -clamp on -bm 0.5 n.png\n".into(),
            textures: vec![Arc::new(texture)],
        };
        let (mut material, mut asked) = (json!({"pbrMetallicRoughness": {}}), Vec::new());
        let warnings = translate(&text, &mut material, &mut |texture| {
            asked.push((texture.wrap, texture.transform));
            Some(json!({"index": 0}))
        });
        assert_eq!(asked, [([Wrap::Clamp; 2], [[2.0, 0.0, 0.0], [0.0, 3.0, -2.0]])]);
        assert_eq!(material["normalTexture"], json!({"index": 0}));
        assert_eq!(warnings, ["options -bm of norm not written: glTF has no word for them"]);
    }
}

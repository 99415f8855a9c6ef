//! Writing the material library beside an OBJ.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::sync::Arc;

use serde_json::Value;

use super::super::Precision;
use super::super::mtl::MapStatement;
use super::super::pictures::{PictureFile, file_of};
use super::super::text::{NumberWriter, line_name};
use super::groups::NO_MATERIAL;
use crate::Mesh;
use crate::mesh::{Image, Material, MaterialLanguage, MaterialText, TextureUse, Wrap};

/// The material library of a mesh, if it has any materials; the names of pictures are those of their files.
pub(in crate::io) fn library(mesh: &Mesh, pictures: &[PictureFile]) -> Option<Vec<u8>> {
    let names = MaterialNames::of(mesh);
    if names.list.is_empty() {
        return None;
    }
    let mut text = String::new();
    for (name, material) in &names.list {
        let _ = writeln!(text, "newmtl {name}");
        write_material(material, pictures, &mut text);
    }
    Some(text.into_bytes())
}

fn write_material(material: &Material, pictures: &[PictureFile], text: &mut String) {
    let said = material.text.as_deref();
    match said {
        Some(said) if said.language == MaterialLanguage::Mtl => {
            write_statements(material, said, pictures, text);
            return;
        }
        _ => write_color(material, text),
    }
    if let Some(texture) = &material.base_color_texture
        && let Some(file) = file_of(pictures, &texture.image)
    {
        let _ = writeln!(text, "map_Kd {}{}", options(texture), line_name(file));
    }
    if let Some(said) = said {
        write_surface(said, pictures, text);
    }
}

/// Colour and opacity.
fn write_color(material: &Material, text: &mut String) {
    let [red, green, blue, opacity] =
        material.base_color.map(|channel| if channel.is_finite() { channel } else { 1.0 });
    let mut bytes = Vec::new();
    let mut numbers = NumberWriter::new(Precision::Single);
    bytes.extend_from_slice(b"Kd ");
    numbers.point(&mut bytes, [red, green, blue].map(f64::from));
    bytes.extend_from_slice(b"\nd ");
    numbers.float(&mut bytes, f64::from(opacity));
    bytes.push(b'\n');
    text.push_str(&String::from_utf8_lossy(&bytes));
}

/// The statements as they were, but for the names of pictures; colour and opacity only if they are other ones now.
fn write_statements(material: &Material, said: &MaterialText, pictures: &[PictureFile], text: &mut String) {
    let mut textures = said.textures.iter();
    // What the statements say themselves; a colour that was changed is written anew.
    let channels = |line: &str| -> Option<[f32; 3]> {
        let numbers: Vec<f32> = line.split_whitespace().skip(1).map_while(|word| word.parse().ok()).collect();
        match numbers[..] {
            [gray] => Some([gray; 3]),
            [red, green, blue, ..] => Some([red, green, blue]),
            _ => None,
        }
    };
    let keyword = |line: &str| line.split_whitespace().next().unwrap_or_default().to_string();
    let color = said.text.lines().rfind(|line| keyword(line) == "Kd").and_then(channels).unwrap_or([1.0; 3]);
    let [red, green, blue, _] = material.base_color;
    let is_same = color.map(|channel| channel.clamp(0.0, 1.0)) == [red, green, blue];
    if !is_same {
        write_color(material, text);
    }
    for line in said.text.lines() {
        if let Some(map) = MapStatement::parse(line) {
            let image = textures.next().and_then(|texture| texture.images.first());
            let file = image.and_then(|image| file_of(pictures, image)).unwrap_or(map.file);
            let _ = writeln!(text, "{} {}{}", map.keyword, map.options, line_name(file));
        } else if is_same || !matches!(&*keyword(line), "Kd" | "d" | "Tr") {
            text.push_str(line);
            text.push('\n');
        }
    }
}

/// The options of a map.
fn options(texture: &TextureUse) -> String {
    let mut text = String::new();
    let [[width, _, x], [_, height, y]] = texture.transform;
    if texture.transform != TextureUse::UNMOVED {
        let _ = write!(text, "-o {x} {} -s {width} {height} ", 1.0 - height - y);
    }
    if texture.wrap == [Wrap::Clamp; 2] {
        text.push_str("-clamp on ");
    }
    text
}

/// What glTF says of a surface, in the words that many programs have for it.
fn write_surface(said: &MaterialText, pictures: &[PictureFile], text: &mut String) {
    let Ok(json) = serde_json::from_str::<Value>(&said.text) else { return };
    let surface = json.get("pbrMetallicRoughness");
    for (key, word) in [("roughnessFactor", "Pr"), ("metallicFactor", "Pm")] {
        let number = surface.and_then(|surface| surface.get(key)).and_then(Value::as_f64);
        let _ = writeln!(text, "{word} {}", number.unwrap_or(1.0));
    }
    let emission = json.get("emissiveFactor").and_then(Value::as_array);
    if let Some([red, green, blue]) = emission.map(Vec::as_slice) {
        let _ = writeln!(text, "Ke {red} {green} {blue}");
    }
    for (key, word) in [("normalTexture", "norm"), ("emissiveTexture", "map_Ke")] {
        let file = picture_of(&json, key, said).and_then(|image| file_of(pictures, &image));
        if let Some(file) = file {
            let _ = writeln!(text, "{word} {}", line_name(file));
        }
    }
}

/// The picture of a texture that a material names under a key.
fn picture_of(json: &Value, key: &str, said: &MaterialText) -> Option<Arc<Image>> {
    let index = json.get(key)?.get("index")?.as_u64()? as usize;
    said.textures.get(index)?.images.first().cloned()
}

/// The name and the bits of the colour of a material: nearly always enough to tell it from others.
type LookingAlike<'a> = (&'a str, [u32; 4]);

/// Names for the materials of a mesh: different for different materials, though their own names may be equal.
pub(super) struct MaterialNames<'a> {
    pub(super) list: Vec<(String, &'a Material)>,
    pub(super) of_group: Vec<Option<String>>,
}

impl<'a> MaterialNames<'a> {
    pub(super) fn of(mesh: &'a Mesh) -> Self {
        let mut names = Self { list: Vec::new(), of_group: Vec::new() };
        let mut known: HashMap<LookingAlike<'_>, Vec<(&Material, String)>> = HashMap::new();
        let mut taken: HashMap<String, usize> = HashMap::new();
        for group in &mesh.groups.list {
            let Some(material) = &group.material else {
                names.of_group.push(None);
                continue;
            };
            let same = known.entry((&material.name, material.base_color.map(f32::to_bits))).or_default();
            if let Some((_, name)) = same.iter().find(|(other, _)| is_same(other, material)) {
                names.of_group.push(Some(name.clone()));
                continue;
            }
            let mut base = line_name(&material.name);
            if base.is_empty() || base == NO_MATERIAL {
                base = "material".to_string();
            }
            let mut unique = base.clone();
            while taken.contains_key(&unique) {
                let number = taken.entry(base.clone()).or_insert(1);
                *number += 1;
                unique = format!("{base}.{number}");
            }
            taken.insert(unique.clone(), 1);
            names.list.push((unique.clone(), material));
            same.push((material, unique.clone()));
            names.of_group.push(Some(unique));
        }
        names
    }
}

/// Whether two materials of one name and colour are one.
fn is_same(a: &Material, b: &Material) -> bool {
    let same_text = match (&a.text, &b.text) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
        (a, b) => a.is_none() && b.is_none(),
    };
    same_text && a.base_color_texture == b.base_color_texture
}

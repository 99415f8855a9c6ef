//! What a file holds besides triangles and groups: attributes, materials, pictures, animations.

use serde_json::{Map, Value, json};
use trisect::io::Contents;
use trisect::mesh::{Attribute, Image, Texture};
use trisect::{Material, Mesh};

use super::json::json_of;
use super::words::counted;

/// How many corners have a value.
fn covered(attribute: &Attribute) -> usize {
    attribute.of_corner.iter().filter(|&&index| index != Attribute::NONE).count()
}

/// The materials of a mesh, each once.
fn materials(mesh: &Mesh) -> Vec<&Material> {
    let mut list: Vec<&Material> = Vec::new();
    for material in mesh.groups.list.iter().filter_map(|group| group.material.as_ref()) {
        if !list.contains(&material) {
            list.push(material);
        }
    }
    list
}

/// The pictures of materials, each once.
fn pictures<'a>(materials: &[&'a Material]) -> Vec<&'a Image> {
    let mut list: Vec<&Image> = Vec::new();
    let textures =
        materials.iter().filter_map(|material| material.text.as_ref()).flat_map(|text| &text.textures);
    for image in textures.flat_map(|texture: &std::sync::Arc<Texture>| &texture.images) {
        if !list.contains(&&**image) {
            list.push(image);
        }
    }
    list
}

/// What a picture is called: its file, or its kind.
fn picture_name(image: &Image) -> String {
    let kind = if image.mime_type.is_empty() { "unknown kind" } else { &image.mime_type };
    let bytes =
        if image.bytes.is_empty() { "not read".to_string() } else { counted(image.bytes.len(), "byte") };
    if image.file.is_empty() {
        format!("{kind}, {bytes}")
    } else {
        format!("{}: {kind}, {bytes}", image.file)
    }
}

/// The lines of `info`; none for what is not there.
pub(crate) fn text(mesh: &Mesh, contents: &Contents) -> String {
    let mut text = String::new();
    let mut list = |name: &str, lines: Vec<String>| {
        if !lines.is_empty() {
            text.push_str(&format!("  {name:10} {}\n", lines.len()));
            lines.iter().for_each(|line| text.push_str(&format!("    {line}\n")));
        }
    };
    let corners = 3 * mesh.triangles.len();
    let attribute = |attribute: &Attribute| {
        let covered = covered(attribute);
        let part =
            if covered == corners { String::new() } else { format!(", at {covered} of {corners} corners") };
        let components = counted(attribute.components, "component");
        format!("{}: {components}, {}{part}", attribute.name, counted(attribute.len(), "value"))
    };
    list("attributes", mesh.attributes.iter().map(attribute).collect());
    let materials = materials(mesh);
    list("pictures", pictures(&materials).into_iter().map(picture_name).collect());
    list("animations", contents.animations.clone());
    for (name, count) in [
        ("cameras", contents.cameras),
        ("lights", contents.lights),
        ("skinned", contents.skinned),
        ("morphed", contents.morphed),
        ("variants", contents.variants),
        ("extras", contents.extras),
    ] {
        if count > 0 {
            text.push_str(&format!("  {name:10} {count}\n"));
        }
    }
    text
}

/// The same in the JSON object.
pub(crate) fn json(mesh: &Mesh, contents: &Contents) -> Map<String, Value> {
    let attribute = |attribute: &Attribute| {
        json!({
            "name": attribute.name, "components": attribute.components, "values": attribute.len(),
            "corners": covered(attribute)
        })
    };
    let materials = materials(mesh);
    let picture =
        |image: &Image| json!({"file": image.file, "mime_type": image.mime_type, "bytes": image.bytes.len()});
    let material = |material: &&Material| {
        let textures = material.text.as_ref().map_or(0, |text| text.textures.len());
        json!({"name": material.name, "base_color": material.base_color, "textures": textures})
    };
    let mut object = Map::new();
    object.insert("attributes".into(), mesh.attributes.iter().map(attribute).collect());
    object.insert("materials".into(), materials.iter().map(material).collect());
    object.insert("pictures".into(), pictures(&materials).into_iter().map(picture).collect());
    object.insert("contents".into(), json_of(contents));
    object
}

//! Where materials and textures name others by number, in the standard and in its extensions.

use serde_json::{Map, Value};

/// Whether a key is that of an object that names a texture: "baseColorTexture", and those of extensions, "sheenColorTexture".
pub(super) fn names_texture(key: &str) -> bool {
    key.ends_with("Texture")
}

/// Visits the `index` of every texture that a material names, with its key.
pub(super) fn for_each_texture(material: &mut Map<String, Value>, visit: &mut dyn FnMut(&str, &mut u64)) {
    for (key, value) in material.iter_mut() {
        let Value::Object(inner) = value else { continue };
        if names_texture(key) {
            visit_number(inner, "index", &mut |place| visit(key, place));
        }
        // What stands under "extras" is nobody's business but its writer's.
        if key != "extras" {
            for_each_texture(inner, visit);
        }
    }
}

/// Visits the `source` of a texture and those of its extensions: alternatives in other formats.
pub(super) fn for_each_source(texture: &mut Map<String, Value>, visit: &mut dyn FnMut(&mut u64)) {
    visit_number(texture, "source", visit);
    if let Some(Value::Object(extensions)) = texture.get_mut("extensions") {
        for extension in extensions.values_mut() {
            if let Value::Object(extension) = extension {
                visit_number(extension, "source", visit);
            }
        }
    }
}

/// The names of all extensions used in a value.
pub(super) fn for_each_extension(value: &Value, visit: &mut dyn FnMut(&str)) {
    match value {
        Value::Object(object) => {
            if let Some(Value::Object(extensions)) = object.get("extensions") {
                extensions.keys().for_each(|name| visit(name));
            }
            for (_, inner) in object.iter().filter(|(key, _)| *key != "extras") {
                for_each_extension(inner, visit);
            }
        }
        Value::Array(list) => list.iter().for_each(|inner| for_each_extension(inner, visit)),
        _ => {}
    }
}

fn visit_number(object: &mut Map<String, Value>, key: &str, visit: &mut dyn FnMut(&mut u64)) {
    if let Some(value) = object.get_mut(key)
        && let Some(mut number) = value.as_u64()
    {
        visit(&mut number);
        *value = number.into();
    }
}

/// A file name as part of a URI. What is a URI with a scheme already (no file here has such a name) stays as it is.
pub(super) fn percent_encode(name: &str) -> String {
    if name.contains("://") {
        return name.to_string();
    }
    let mut encoded = String::with_capacity(name.len());
    for byte in name.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                encoded.push(byte.into());
            }
            _ => encoded.push_str(&format!("%{byte:02X}")),
        }
    }
    encoded
}

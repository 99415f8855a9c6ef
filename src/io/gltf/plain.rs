//! A material of a name and a colour, in JSON.

use serde_json::{Value, json};

/// The shortest digits of a single-precision number, which JSON would write as a double.
pub(super) fn channel(value: f32) -> f64 {
    let value = if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
    value.to_string().parse::<f64>().unwrap_or(1.0)
}

/// A material of a name and a colour.
pub(super) fn plain_object(name: &str, color: [f32; 4]) -> Value {
    let mut material = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": color.map(channel), "metallicFactor": 0, "roughnessFactor": 1
        }
    });
    if !name.is_empty() {
        material["name"] = json!(name);
    }
    if color[3] < 1.0 {
        material["alphaMode"] = json!("BLEND");
    }
    material
}

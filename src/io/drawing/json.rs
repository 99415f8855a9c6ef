//! JSON: polygons with their holes, layer by layer.

use serde_json::{Value, json as object};

use super::Layer;
use crate::polygon::ring_area;

/// The drawing as JSON: `{"layers": [{"name", "height", "area", "polygons": [{"outline": [[x, y], ...], "holes": [...]}]}]}`.
#[must_use]
pub fn json(layers: &[Layer<'_>]) -> String {
    let layers: Vec<Value> = layers
        .iter()
        .map(|layer| {
            let polygons: Vec<Value> = layer
                .shapes
                .iter()
                .map(|shape| object!({ "outline": shape.first(), "holes": shape.get(1..).unwrap_or_default() }))
                .collect();
            let area: f64 = layer.rings().map(ring_area).sum();
            object!({ "name": layer.name, "height": layer.height, "area": area, "polygons": polygons })
        })
        .collect();
    format!("{}\n", object!({ "layers": layers }))
}

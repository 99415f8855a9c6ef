//! JSON: polygons with their holes, layer by layer.

use serde_json::{Value, json as object};

use super::Layer;

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
            let area: f64 = layer.rings().map(area).sum();
            object!({ "name": layer.name, "height": layer.height, "area": area, "polygons": polygons })
        })
        .collect();
    format!("{}\n", object!({ "layers": layers }))
}

/// Area inside a ring, negative where it runs clockwise.
fn area(ring: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = ring.first() else { return 0.0 };
    let twice = ring.windows(2).map(|edge| {
        let ([a, b], [c, d]) = (edge[0], edge[1]);
        (a - x) * (d - y) - (b - y) * (c - x)
    });
    0.5 * twice.sum::<f64>()
}

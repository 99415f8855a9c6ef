//! Plane drawings: polygons in layers, written as SVG, DXF and JSON.

mod dxf;
mod json;
mod svg;

pub use dxf::dxf;
pub use json::json;
pub use svg::svg;

/// Polygons of one height: each an outline and its holes.
#[derive(Clone, Debug)]
pub struct Layer<'a> {
    /// What the layer is called, such as `z=1.5`; a layer of the drawing.
    pub name: String,
    /// The height that its points get where a format has one.
    pub height: f64,
    /// The polygons.
    pub shapes: &'a [Vec<Vec<[f64; 2]>>],
}

impl Layer<'_> {
    /// All rings.
    fn rings(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        self.shapes.iter().flatten().map(Vec::as_slice)
    }
}

/// The box around all layers; `None` if there is nothing in them.
fn bounds(layers: &[Layer<'_>]) -> Option<[[f64; 2]; 2]> {
    let mut points = layers.iter().flat_map(Layer::rings).flatten();
    let first = *points.next()?;
    Some(points.fold([first, first], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square_with_hole() -> Vec<Vec<Vec<[f64; 2]>>> {
        let outline = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        vec![vec![outline, vec![[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]]]]
    }

    #[test]
    fn every_format_has_all_points() {
        let shapes = square_with_hole();
        let layers =
            [0.0, 0.5].map(|height| Layer { name: format!("z={height}"), height, shapes: &shapes }).to_vec();
        let text = dxf(&layers);
        assert_eq!(text.matches("VERTEX").count(), 16);
        assert_eq!(text.matches("POLYLINE").count(), 4);
        assert!(text.starts_with("0\nSECTION") && text.ends_with("0\nEOF\n"));
        let text = svg(&layers);
        assert_eq!(text.matches("<path").count(), 2);
        assert!(text.contains("evenodd") && text.contains("id=\"z=0.5\""));
        let value: serde_json::Value = serde_json::from_str(&json(&layers)).unwrap();
        assert_eq!(value["layers"][1]["polygons"][0]["holes"][0][2], serde_json::json!([2.0, 2.0]));
        assert_eq!(value["layers"][0]["area"], 15.0);
    }

    #[test]
    fn nothing_is_a_drawing_too() {
        let layers = [Layer { name: "empty <&>".into(), height: 1.0, shapes: &[] }];
        assert!(svg(&layers).contains("empty &lt;&amp;&gt;"));
        assert!(dxf(&layers).contains("ENTITIES"));
        assert!(json(&layers).contains("\"polygons\":[]"));
    }
}

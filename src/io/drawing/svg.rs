//! SVG: a path for each layer, upwards as in the plane.

use std::fmt::Write as _;

use super::{Layer, bounds};

/// The drawing as SVG, one unit of the coordinates a unit of the picture, with a margin of a twentieth. Each layer is a group with
/// its name as `id`; holes are holes by the rule `evenodd`. Numbers are written so that they are read back the same.
#[must_use]
pub fn svg(layers: &[Layer<'_>]) -> String {
    let [low, high] = bounds(layers).unwrap_or([[0.0; 2], [1.0; 2]]);
    let size = [high[0] - low[0], high[1] - low[1]];
    let margin = 0.05 * size[0].max(size[1]);
    let (width, height) = (size[0] + 2.0 * margin, size[1] + 2.0 * margin);
    let line = 0.002 * size[0].max(size[1]);
    let mut text = String::new();
    // (Writing to a string cannot fail.)
    let _ = write!(
        text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{} {} {width} {height}\">\n\
         <g transform=\"scale(1,-1)\" fill=\"#7aa0c4\" fill-rule=\"evenodd\" fill-opacity=\"{}\" stroke=\"#1d3557\" \
         stroke-width=\"{line}\" stroke-linejoin=\"round\">\n",
        low[0] - margin,
        -(high[1] + margin),
        // Layers over one another stay to be seen.
        if layers.len() > 1 { 0.15 } else { 1.0 },
    );
    for layer in layers {
        let _ = writeln!(text, "<g id=\"{}\">", escaped(&layer.name));
        if layer.rings().next().is_some() {
            text.push_str("<path d=\"");
            for ring in layer.rings() {
                for (i, [x, y]) in ring.iter().enumerate() {
                    let _ = write!(text, "{}{x},{y}", if i == 0 { "M" } else { " " });
                }
                text.push('Z');
            }
            text.push_str("\"/>\n");
        }
        text.push_str("</g>\n");
    }
    text.push_str("</g>\n</svg>\n");
    text
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

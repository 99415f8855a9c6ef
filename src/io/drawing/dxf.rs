//! DXF, release 12 in ASCII: what every program for drawings reads. Closed polylines alone are wanted of it, which is less than
//! any of the crates for it bring.

use std::fmt::Write as _;

use super::Layer;

/// The drawing as DXF R12: every ring a closed polyline, in a layer of its name, at its height. Numbers are written so that they are
/// read back the same.
#[must_use]
pub fn dxf(layers: &[Layer<'_>]) -> String {
    let mut text = String::from("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n");
    let names: Vec<String> = layers.iter().map(|layer| layer_name(&layer.name)).collect();
    // (Writing to a string cannot fail.)
    let _ = write!(text, "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n{}\n", names.len());
    for name in &names {
        let _ = write!(text, "0\nLAYER\n2\n{name}\n70\n0\n62\n7\n6\nCONTINUOUS\n");
    }
    text.push_str("0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    for (layer, name) in layers.iter().zip(&names) {
        let height = layer.height;
        for ring in layer.rings() {
            let _ = write!(text, "0\nPOLYLINE\n8\n{name}\n66\n1\n10\n0.0\n20\n0.0\n30\n{height:?}\n70\n1\n");
            for [x, y] in ring {
                let _ = write!(text, "0\nVERTEX\n8\n{name}\n10\n{x:?}\n20\n{y:?}\n30\n{height:?}\n");
            }
            let _ = write!(text, "0\nSEQEND\n8\n{name}\n");
        }
    }
    text.push_str("0\nENDSEC\n0\nEOF\n");
    text
}

/// A name that a layer may have: letters, digits, `$`, `_` and `-`, 31 at most.
fn layer_name(name: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() || matches!(c, '$' | '_' | '-') => c,
        '.' => 'p',
        _ => '_',
    };
    let name: String = name.chars().take(31).map(letter).collect();
    if name.is_empty() { "0".into() } else { name }
}

//! SVG files: the paths in them.

use super::path::{PathContours, read};
use crate::parametric::FillRule;
use crate::parametric::error::{GeometryError, Result};

/// A path of an SVG file.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SvgPath {
    /// The element's `id`; may be empty.
    pub id: String,
    /// Its fill rule.
    pub fill_rule: FillRule,
    /// Its curves, moved by the transforms of the element and those around it.
    pub contours: PathContours,
}

/// The paths of an SVG file, in its order, and how many other shapes (rectangles, circles, texts ...) were passed over.
/// Paths in `defs`, `symbol` and `clipPath` are not drawn and not read.
///
/// # Errors
/// [`GeometryError::Svg`] for text that is not XML or not SVG, or a path or transform that makes no sense.
pub fn read_paths(text: &str) -> Result<(Vec<SvgPath>, usize)> {
    let document = roxmltree::Document::parse(text).map_err(|error| GeometryError::Svg {
        place: format!("line {}, column {}", error.pos().row, error.pos().col),
        what: error.to_string(),
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let what = format!("the file's root is <{}>, not <svg>", root.tag_name().name());
        return Err(GeometryError::Svg { place: "line 1".into(), what });
    }
    let mut paths = Vec::new();
    let mut passed_over = 0;
    let mut pending = vec![(root, svgtypes::Transform::default())];
    while let Some((node, outer)) = pending.pop() {
        // Counts lines from the start of the file: for faults only.
        let place = || {
            let position = document.text_pos_at(node.range().start);
            format!("line {}, column {}", position.row, position.col)
        };
        let own: svgtypes::Transform = match node.attribute("transform") {
            None => svgtypes::Transform::default(),
            Some(text) => text.parse().map_err(|error: svgtypes::Error| GeometryError::Svg {
                place: place(),
                what: format!("transform: {error}"),
            })?,
        };
        let transform = composed(&outer, &own);
        match node.tag_name().name() {
            "svg" | "g" | "a" => {
                // Last first: the pile turns the order round.
                let children: Vec<_> = node.children().filter(roxmltree::Node::is_element).collect();
                pending.extend(children.into_iter().rev().map(|child| (child, transform)));
            }
            "path" => {
                let contours =
                    read(node.attribute("d").unwrap_or(""), &transform).map_err(|fault| match fault {
                        GeometryError::Svg { what, .. } => GeometryError::Svg { place: place(), what },
                        other => GeometryError::Svg { place: place(), what: other.to_string() },
                    })?;
                let fill_rule = match node.attribute("fill-rule") {
                    Some("evenodd") => FillRule::EvenOdd,
                    _ => FillRule::NonZero,
                };
                let id = node.attribute("id").unwrap_or("").to_owned();
                paths.push(SvgPath { id, fill_rule, contours });
            }
            "rect" | "circle" | "ellipse" | "line" | "polyline" | "polygon" | "text" | "image" | "use" => {
                passed_over += 1;
            }
            _ => {}
        }
    }
    Ok((paths, passed_over))
}

/// First `inner`, then `outer`.
fn composed(outer: &svgtypes::Transform, inner: &svgtypes::Transform) -> svgtypes::Transform {
    svgtypes::Transform {
        a: outer.a * inner.a + outer.c * inner.b,
        b: outer.b * inner.a + outer.d * inner.b,
        c: outer.a * inner.c + outer.c * inner.d,
        d: outer.b * inner.c + outer.d * inner.d,
        e: outer.a * inner.e + outer.c * inner.f + outer.e,
        f: outer.b * inner.e + outer.d * inner.f + outer.f,
    }
}

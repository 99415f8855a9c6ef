//! Pictures of curves, control polygons, nodes and regions as SVG.

use std::fmt::Write;

use super::write::path_data;
use crate::parametric::error::Result;
use crate::parametric::numeric::vector::{self, Point};
use crate::parametric::{Curve, Polygons};

/// How something is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// The subject: dark, strong.
    Main,
    /// A second subject: blue.
    First,
    /// A third: orange.
    Second,
    /// Background: grey.
    Faint,
}

impl Ink {
    fn colour(self) -> &'static str {
        match self {
            Self::Main => "#1b1b1b",
            Self::First => "#2f6fb0",
            Self::Second => "#d9722e",
            Self::Faint => "#9a9a9a",
        }
    }
}

/// A picture in the making: things drawn one over the other, fitted into the frame at the end.
///
/// ```
/// use trisect::parametric::{Bezier, svg::{Ink, Picture}};
///
/// let curve = Bezier::new(&[[0.0, 0.0], [1.0, 2.0], [3.0, 0.0]])?;
/// let mut picture = Picture::new();
/// picture.control_polygon(curve.control(), Ink::Faint);
/// picture.curve(&curve, Ink::Main)?;
/// assert!(picture.svg(400.0).starts_with("<svg"));
/// # Ok::<(), trisect::parametric::GeometryError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Picture {
    items: Vec<Item>,
    bounds: Option<[Point<2>; 2]>,
}

#[derive(Clone, Debug)]
enum Item {
    Path { data: String, ink: Ink, width: f64, dashed: bool },
    Area { data: String, ink: Ink },
    Dots { points: Vec<Point<2>>, ink: Ink, radius: f64, hollow: bool },
    Text { at: Point<2>, text: String },
}

/// Curves that SVG cannot carry exactly are drawn within this part of their size.
const FLATNESS: f64 = 1e-4;

impl Picture {
    /// An empty picture.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    fn extend_bounds(&mut self, points: &[Point<2>]) {
        let all = points.iter().copied().chain(self.bounds.into_iter().flatten());
        self.bounds = vector::bounding_box(all);
    }

    /// Draws a curve.
    ///
    /// # Errors
    /// Those of [`path_data`].
    pub fn curve(&mut self, curve: &dyn Curve<2>, ink: Ink) -> Result<()> {
        let bounds = curve.bounds();
        let data = path_data(curve, FLATNESS * vector::extent(&bounds).max(1e-300))?;
        self.extend_bounds(&bounds);
        self.items.push(Item::Path { data, ink, width: 1.0, dashed: false });
        Ok(())
    }

    /// Draws a polygon of straight edges (a curve's mesh, say), open as given.
    pub fn polygon(&mut self, points: &[[f64; 2]], ink: Ink) {
        self.extend_bounds(points);
        self.items.push(Item::Path { data: polygon_data(points), ink, width: 0.6, dashed: false });
    }

    /// Draws control points and the dashed polygon between them.
    pub fn control_polygon(&mut self, points: &[[f64; 2]], ink: Ink) {
        self.extend_bounds(points);
        self.items.push(Item::Path { data: polygon_data(points), ink, width: 0.5, dashed: true });
        self.items.push(Item::Dots { points: points.to_vec(), ink, radius: 1.6, hollow: true });
    }

    /// Draws points as dots.
    pub fn dots(&mut self, points: &[[f64; 2]], ink: Ink) {
        self.extend_bounds(points);
        self.items.push(Item::Dots { points: points.to_vec(), ink, radius: 1.4, hollow: false });
    }

    /// Fills a region.
    pub fn region(&mut self, region: &Polygons, ink: Ink) {
        let mut data = String::new();
        for contour in region.contours() {
            self.extend_bounds(contour);
            data.push_str(&polygon_data(contour));
            data.push('Z');
        }
        self.items.push(Item::Area { data, ink });
    }

    /// Writes a text with its lower left corner at `at`.
    pub fn text(&mut self, at: [f64; 2], text: &str) {
        self.extend_bounds(&[at]);
        self.items.push(Item::Text { at, text: text.into() });
    }

    /// The picture, `width` pixels wide, on white.
    #[must_use]
    pub fn svg(&self, width: f64) -> String {
        let [low, high] = self.bounds.unwrap_or([[0.0; 2], [1.0; 2]]);
        let size = vector::sub(high, low);
        let longest = size[0].max(size[1]).max(1e-300);
        let margin = 0.04 * longest;
        // Flat pictures get some height.
        let height = size[1].max(0.1 * longest);
        let (w, h) = (size[0].max(0.1 * longest) + 2.0 * margin, height + 2.0 * margin);
        let (x, y) = (low[0] - margin, -(high[1] + margin));
        // One unit of line width is a 300th of the picture.
        let unit = w.max(h) / 300.0;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{:.0}\" viewBox=\"{x} {y} {w} {h}\">\n\
             <rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
            width * h / w
        );
        for item in &self.items {
            item.write(&mut svg, unit);
        }
        svg.push_str("</svg>\n");
        svg
    }
}

fn polygon_data(points: &[Point<2>]) -> String {
    let mut data = String::new();
    for (i, p) in points.iter().enumerate() {
        let _ = write!(data, "{}{} {}", if i == 0 { "M" } else { "L" }, p[0] + 0.0, 0.0 - p[1]);
    }
    data
}

impl Item {
    fn write(&self, svg: &mut String, unit: f64) {
        // Writing to a string cannot fail.
        let _ = match self {
            Self::Path { data, ink, width, dashed } => {
                let dash = if *dashed {
                    format!(" stroke-dasharray=\"{0} {0}\"", 3.0 * unit)
                } else {
                    String::new()
                };
                writeln!(
                    svg,
                    "<path d=\"{data}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dash}/>",
                    ink.colour(),
                    width * unit
                )
            }
            Self::Area { data, ink } => writeln!(
                svg,
                "<path d=\"{data}\" fill=\"{0}\" fill-opacity=\"0.25\" fill-rule=\"evenodd\" stroke=\"{0}\" stroke-width=\"{1}\"/>",
                ink.colour(),
                0.4 * unit
            ),
            Self::Dots { points, ink, radius, hollow } => {
                for p in points {
                    let fill = if *hollow { "#ffffff" } else { ink.colour() };
                    let _ = writeln!(
                        svg,
                        "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{fill}\" stroke=\"{}\" stroke-width=\"{}\"/>",
                        p[0],
                        0.0 - p[1],
                        radius * unit,
                        ink.colour(),
                        0.5 * unit
                    );
                }
                Ok(())
            }
            Self::Text { at, text } => {
                let escaped = text.replace('&', "&amp;").replace('<', "&lt;");
                writeln!(
                    svg,
                    "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\">{escaped}</text>",
                    at[0],
                    0.0 - at[1],
                    9.0 * unit
                )
            }
        };
    }
}

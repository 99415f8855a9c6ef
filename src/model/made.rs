//! Nodes made of other nodes as meshes: hulls, Minkowski sums, patterns, offsets, shells; and text.

use std::path::Path;

use serde_json::{Map, Value};

use super::{fault, take};
use crate::making::{self, Drain, OffsetOptions, Pattern};
use crate::{Control, Error, Mesh, Solid};

/// The kinds read here.
pub(super) const KINDS: [&str; 6] = ["hull", "minkowski", "pattern", "text", "offset", "hollow"];

/// What is made of the operands.
#[derive(Clone, Debug)]
pub(super) enum Made {
    /// The convex hull of all.
    Hull,
    /// The first one thickened by the second, which is convex.
    Minkowski,
    /// Copies.
    Pattern(Pattern),
    /// Grown or shrunk.
    Offset(f64),
    /// With a wall of this thickness, and holes through it.
    Hollow(f64, Vec<Drain>),
    /// Text, of no operand.
    #[cfg_attr(not(feature = "text"), allow(dead_code, reason = "such a build has no text"))]
    Text(Text),
}

/// Text, as a node describes it.
#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "text"), allow(dead_code, reason = "such a build has no text"))]
pub(super) struct Text {
    text: String,
    font: String,
    size: f64,
    depth: f64,
    #[serde(default)]
    align: Option<String>,
}

/// Reads a node's own keys, and gives its operands with their places.
pub(super) fn parse(
    kind: &str,
    object: &mut Map<String, Value>,
) -> Result<(Made, Vec<(String, Value)>), Error> {
    if kind == "text" {
        let keys = Value::Object(std::mem::take(object));
        let text: Text = serde_json::from_value(keys).map_err(|error| fault(error.to_string()))?;
        if let Some(align) =
            text.align.as_deref().filter(|align| !["left", "center", "right"].contains(align))
        {
            return Err(fault(format!("`align` is `left`, `center` or `right`, not `{align}`")));
        }
        return Ok((Made::Text(text), Vec::new()));
    }
    let operands: Vec<(String, Value)> = match (object.remove("operands"), object.remove("operand")) {
        (Some(Value::Array(list)), None) => {
            list.into_iter().enumerate().map(|(k, value)| (format!("operands/{k}"), value)).collect()
        }
        (None, Some(value)) => vec![("operand".to_owned(), value)],
        (None, None) => return Err(fault("`operands`, a list of nodes, or `operand`, one node, is missing")),
        _ => {
            return Err(fault("`operands` is a list of nodes; `operand`, which is one, does not go with it"));
        }
    };
    let made = match kind {
        "hull" => Made::Hull,
        "minkowski" => Made::Minkowski,
        "offset" => Made::Offset(length(object, "distance")?),
        "hollow" => {
            let drains = take(object, "drains")?.unwrap_or_default();
            Made::Hollow(length(object, "wall")?, drains)
        }
        _ => {
            let pattern = object.remove("pattern").ok_or_else(|| fault("`pattern` is missing"))?;
            Made::Pattern(serde_json::from_value(pattern).map_err(|error| {
                fault(format!("`pattern` (linear, grid, circular, points or along): {error}"))
            })?)
        }
    };
    let (least, most) = match made {
        Made::Hull | Made::Text(_) => (1, usize::MAX),
        Made::Minkowski => (2, 2),
        Made::Pattern(_) | Made::Offset(_) | Made::Hollow(..) => (1, 1),
    };
    if !(least..=most).contains(&operands.len()) {
        let wanted = if most > 2 { "at least one operand".to_owned() } else { format!("{least}") };
        return Err(fault(format!("`{kind}` takes {wanted}, and there are {}", operands.len())));
    }
    Ok((made, operands))
}

/// A number of a node.
fn length(object: &mut Map<String, Value>, key: &str) -> Result<f64, Error> {
    take(object, key)?.ok_or_else(|| fault(format!("`{key}`, a number, is missing")))
}

/// How surfaces that are not exact become meshes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meshing {
    pub(super) tolerance: Option<f64>,
    pub(super) smooth: bool,
}

impl Meshing {
    fn offsetting(self, control: &Control) -> OffsetOptions {
        let options = OffsetOptions::new().smooth(self.smooth).control(control.clone());
        match self.tolerance {
            Some(tolerance) => options.tolerance(tolerance),
            None => options,
        }
    }
}

impl Made {
    /// The mesh. File names start at `folder`.
    pub(super) fn mesh(
        &self,
        operands: &[&Solid],
        meshing: Meshing,
        folder: &Path,
        control: &Control,
    ) -> Result<Mesh, Error> {
        let missing = || fault("operands are missing");
        match self {
            Self::Hull => {
                let points: Vec<[f64; 3]> =
                    operands.iter().flat_map(|solid| &solid.mesh().positions).copied().collect();
                making::convex_hull(&points)
            }
            Self::Minkowski => {
                let [body, tool] = operands else { return Err(missing()) };
                Ok(making::minkowski_sum(body, tool, control)?.into_mesh())
            }
            Self::Pattern(pattern) => {
                let mesh = operands.first().ok_or_else(missing)?.mesh();
                let _copies = control.reserve(pattern.memory(mesh))?;
                pattern.repeat(mesh)
            }
            Self::Offset(distance) => {
                let operand = operands.first().ok_or_else(missing)?;
                Ok(meshing.offsetting(control).offset(operand, *distance)?.solid.into_mesh())
            }
            Self::Hollow(wall, drains) => {
                let operand = operands.first().ok_or_else(missing)?;
                Ok(meshing.offsetting(control).hollow(operand, *wall, drains)?.solid.into_mesh())
            }
            Self::Text(text) => text.mesh(meshing.tolerance, folder),
        }
    }
}

impl Text {
    #[cfg(feature = "text")]
    fn mesh(&self, tolerance: Option<f64>, folder: &Path) -> Result<Mesh, Error> {
        use crate::making::{Font, Lettering, TextAlign};

        let align = match self.align.as_deref() {
            Some("center") => TextAlign::Center,
            Some("right") => TextAlign::Right,
            _ => TextAlign::Left,
        };
        let mut lettering = Lettering::new(self.size, self.depth).align(align);
        lettering.tolerance = tolerance;
        lettering.mesh(&self.text, &Font::load(&folder.join(&self.font))?)
    }

    #[cfg(not(feature = "text"))]
    fn mesh(&self, _: Option<f64>, _: &Path) -> Result<Mesh, Error> {
        Err(fault("`text` needs a build with the feature `text`"))
    }
}

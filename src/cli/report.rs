//! What a run says about meshes: one summary line for people, one JSON object for programs.

use serde_json::{Map, Value, json};
use trisect::{Certificate, Mesh, NearContacts, OperandState, Snapping, Solid};

use super::json::json_of;
use super::mended;
use super::operands::Operand;
use super::words::{counted, short, time};
use trisect::mesh::Bounds;

/// Measures of a mesh. Those that only a closed surface has are absent for the others.
#[derive(Clone, Debug)]
pub(crate) struct Measures {
    vertices: usize,
    triangles: usize,
    /// Absent where nobody is told.
    area: Option<f64>,
    bounds: Option<Bounds>,
    closed: Option<Closed>,
}

#[derive(Clone, Copy, Debug)]
struct Closed {
    manifold: bool,
    shells: usize,
    /// Absent where more than two triangles meet at an edge.
    genus: Option<usize>,
    volume: f64,
}

impl Measures {
    /// Measures of a mesh that need not be closed.
    pub(crate) fn of_mesh(mesh: &Mesh) -> Self {
        Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            area: Some(mesh.area()),
            bounds: mesh.bounds(),
            closed: None,
        }
    }

    /// Measures of a solid.
    pub(crate) fn of_solid(solid: &Solid) -> Self {
        Self { area: Some(solid.area()), ..Self::for_line(solid) }
    }

    /// What [`line`](Self::line) tells of a solid, and what costs nothing beside it.
    pub(crate) fn for_line(solid: &Solid) -> Self {
        let closed = Closed {
            manifold: solid.is_manifold(),
            shells: solid.components(),
            genus: solid.genus(),
            volume: solid.volume(),
        };
        let mesh = solid.mesh();
        Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            area: None,
            bounds: solid.bounds(),
            closed: Some(closed),
        }
    }

    /// The part of a summary line after the name.
    pub(crate) fn line(&self) -> String {
        let mut parts = vec![counted(self.triangles, "triangle")];
        match self.closed {
            _ if self.triangles == 0 => return "empty".into(),
            Some(Closed { manifold, shells, genus, volume }) => {
                parts.push(if manifold { "closed" } else { "closed, not manifold" }.into());
                parts.push(counted(shells, "shell"));
                if let Some(genus) = genus.filter(|&genus| genus != 0) {
                    parts.push(format!("genus {genus}"));
                }
                parts.push(format!("volume {}", short(volume)));
            }
            None => parts.push("not closed".into()),
        }
        parts.join(", ")
    }

    /// Lines of a description, each a name and its value.
    pub(crate) fn table(&self) -> Vec<(&'static str, String)> {
        let mut rows =
            vec![("vertices", self.vertices.to_string()), ("triangles", self.triangles.to_string())];
        if let Some(bounds) = self.bounds {
            let three = |v: [f64; 3]| v.map(short).join(" ");
            rows.push(("bounds", format!("{} to {}", three(bounds.low), three(bounds.high))));
            rows.push(("size", three(bounds.size())));
        }
        rows.extend(self.area.map(|area| ("area", short(area))));
        if let Some(Closed { manifold, shells, genus, volume }) = self.closed {
            rows.push(("volume", short(volume)));
            rows.push(("closed", if manifold { "yes, manifold" } else { "yes, not manifold" }.into()));
            rows.push(("shells", shells.to_string()));
            rows.extend(genus.map(|genus| ("genus", genus.to_string())));
        }
        rows
    }

    /// The measures as JSON keys. What only a closed surface has is null for the others.
    pub(crate) fn to_json(&self) -> Map<String, Value> {
        let closed = self.closed;
        let object = json!({
            "vertices": self.vertices,
            "triangles": self.triangles,
            "empty": self.triangles == 0,
            "area": self.area,
            "bounds": self.bounds.map(|bounds| [bounds.low, bounds.high]),
            "closed": closed.is_some(),
            "manifold": closed.map(|closed| closed.manifold),
            "shells": closed.map(|closed| closed.shells),
            "genus": closed.and_then(|closed| closed.genus),
            "volume": closed.map(|closed| closed.volume),
        });
        into_map(object)
    }
}

/// What was left out or joined to make a solid of its mesh, in words and as JSON.
pub(crate) fn cleaning(solid: &Solid) -> (Option<String>, Value) {
    let done = solid.cleaning();
    let counts = [
        (done.welded_vertices, "vertex of equal coordinates joined", "vertices of equal coordinates joined"),
        (
            done.repeated_corners,
            "triangle with a repeated corner left out",
            "triangles with a repeated corner left out",
        ),
        (done.opposite_pairs, "pair of opposite triangles left out", "pairs of opposite triangles left out"),
        (done.unreferenced_vertices, "unused vertex left out", "unused vertices left out"),
    ];
    let words: Vec<String> = counts
        .iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, several)| format!("{count} {}", if *count == 1 { one } else { several }))
        .collect();
    let object = json!({
        "welded_vertices": done.welded_vertices,
        "repeated_corners": done.repeated_corners,
        "opposite_pairs": done.opposite_pairs,
        "unreferenced_vertices": done.unreferenced_vertices,
    });
    ((!words.is_empty()).then(|| words.join(", ")), object)
}

/// The JSON object of an operand.
pub(crate) fn operand_json(operand: &Operand, index: usize, measures: &Measures) -> Value {
    let mut object = measures.to_json();
    let transforms: Vec<String> = operand.request.transforms.iter().map(ToString::to_string).collect();
    object.extend(into_map(json!({
        "operand": index + 1,
        "file": operand.request.name(),
        "format": operand.format.extension(),
        "transforms": transforms,
        "turned": operand.solid.mending().turned > 0,
        "welded": mended::welded_vertices(operand.solid.mending()),
        "cleaning": cleaning(&operand.solid).1,
        "mending": json_of(operand.solid.mending()),
        "self_crossings": operand.crossings.as_ref().map(|crossings| &crossings.object),
        "rule": operand.request.rule.name(),
        "warnings": operand.warnings,
        "seconds": operand.seconds,
    })));
    object.into()
}

/// The summary line of an operand.
pub(crate) fn operand_line(operand: &Operand, measures: &Measures) -> String {
    let mut line = format!("{}: {}", operand.request.name(), measures.line());
    line.push_str(&mended::in_line(operand.solid.mending()));
    match &operand.crossings {
        None => line.push_str(", not checked for self-crossings"),
        Some(crossings) if crossings.count > 0 => {
            line.push_str(&format!(
                ", {} resolved by winding number ({})",
                counted(crossings.count, "self-crossing"),
                operand.request.rule
            ));
        }
        Some(crossings) if crossings.touching > 0 => {
            let count = counted(crossings.touching, "pair");
            line.push_str(&format!(", {count} of triangles that lie on each other resolved"));
        }
        Some(crossings) if crossings.tolerated > 0 => {
            let count = counted(crossings.tolerated, "self-crossing");
            line.push_str(&format!(", {count} no deeper than rounding"));
        }
        Some(_) => {}
    }
    format!("{line} ({})", time(operand.seconds))
}

/// The certificate of a result as JSON.
pub(crate) fn certificate(certificate: &Certificate) -> Value {
    let operands = certificate.operands.iter().map(|state| match state {
        OperandState::Clean { tolerated } => json!({ "self_crossings": 0, "tolerated": tolerated }),
        OperandState::Crossing { count } => json!({ "self_crossings": count }),
        OperandState::Resolved { crossings, touching, winding_volume, inward_volume } => json!({
            "resolved": true,
            "self_crossings": crossings,
            "self_touching": touching,
            "winding_volume": winding_volume,
            "inward_volume": inward_volume,
        }),
        _ => json!({ "self_crossings": null }),
    });
    let mut object = into_map(json_of(certificate));
    object.insert("operands".into(), operands.collect());
    object.into()
}

/// What snapping moved and split, in words.
pub(crate) fn snapping(snapping: &Snapping) -> String {
    format!(
        "snapped by up to {}: {} moved, {} and {} split, nothing further than {}",
        short(snapping.distance),
        if snapping.moved == 1 { "1 vertex".into() } else { format!("{} vertices", snapping.moved) },
        counted(snapping.split_edges as usize, "edge"),
        counted(snapping.split_faces as usize, "face"),
        short(snapping.farthest),
    ) + &match snapping.collapsed + snapping.walls {
        0 => String::new(),
        left_out => format!(", {} left out", counted(left_out as usize, "triangle")),
    }
}

/// The power of ten that is well above some distances, and above what rounding does to coordinates there. Where only the nearest of them are
/// known it is above what single precision rounds, as they all are.
fn distance_to_snap(near: &NearContacts) -> f64 {
    let farthest = near.places.iter().map(|found| found.distance).fold(0.0, f64::max);
    let largest = near.places.iter().flat_map(|found| found.place).fold(0.0f64, |most, x| most.max(x.abs()));
    let knows_all = near.count <= near.places.len();
    let rounding = if knows_all { 64.0 * f64::EPSILON } else { 2.0 * f64::from(f32::EPSILON) };
    let least = (10.0 * farthest).max(rounding * largest);
    10f64.powi(least.log10().ceil() as i32)
}

/// What there is to say about films and gaps too thin for single precision.
pub(crate) fn nearly_flush(near: &NearContacts) -> Option<String> {
    let places: Vec<String> = near
        .places
        .iter()
        .take(3)
        .map(|found| {
            let [x, y, z] = found.place.map(short);
            format!("{:.1e} at ({x}, {y}, {z})", found.distance)
        })
        .collect();
    (near.count > 0).then(|| {
        format!(
            "{} nearly flush with a face of another operand, apart by {}{}: films or gaps that thin are \
             lost in single precision (STL, GLB); give coordinates that are flush, let the tool reach further, or make \
             them flush with --snap {:e}",
            if near.count == 1 { "1 corner of the result is".into() } else { format!("{} corners of the result are", near.count) },
            places.join(", "),
            if near.count > places.len() { ", ..." } else { "" },
            distance_to_snap(near),
        )
    })
}

/// The keys of a JSON object.
pub(crate) fn into_map(object: Value) -> Map<String, Value> {
    match object {
        Value::Object(map) => map,
        other => [("value".to_string(), other)].into_iter().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_of_an_open_mesh_leave_out_what_it_does_not_have() {
        let square = Mesh::new(
            vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 3.0, 0.0], [0.0, 3.0, 0.0], [9.0; 3]],
            vec![[0, 1, 2], [0, 2, 3]],
        );
        let measures = Measures::of_mesh(&square);
        let object = measures.to_json();
        assert_eq!(object["area"], 6.0);
        assert_eq!(
            object["bounds"],
            json!([[0.0, 0.0, 0.0], [2.0, 3.0, 0.0]]),
            "unused vertices do not count"
        );
        assert_eq!(object["closed"], false);
        assert_eq!(object["volume"], Value::Null);
        assert_eq!(measures.line(), "2 triangles, not closed");
        assert_eq!(Measures::of_mesh(&Mesh::default()).line(), "empty");
    }
}

//! What is wrong with a mesh: counts and a few places each.

use std::fmt;

use super::places::{Fault, PLACES};
use super::{Bounds, Mending};

/// What [`diagnose`](super::diagnose) found in a mesh: how many faults of each kind, where a few of them are, and
/// measures where they have a meaning.
///
/// All indices are the caller's. Edges, shells and measures are those of the surface as a [`Solid`](super::Solid)
/// would see it: triangles out of range, not finite or with repeated corners left out, opposite copies left out in
/// pairs, and vertices of equal coordinates on open edges sewn together.
///
/// [`Display`](fmt::Display) writes the faults in one line with up to two places each; `{:#}` one line for each
/// kind with all the places kept.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Diagnosis {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Triangles that name a vertex that does not exist.
    pub index_out_of_range: Fault,
    /// Vertices used by triangles with a coordinate that is not a finite number.
    pub not_finite: Fault,
    /// Vertices no triangle uses. No harm: they are left out.
    pub unreferenced_vertices: Fault,
    /// Triangles with a repeated corner, as given. No harm: they are left out.
    pub repeated_corners: Fault,
    /// Further triangles whose corners lie exactly on one line.
    pub zero_area: Fault,
    /// Further copies of a triangle with the same orientation (both triangles are named): the surface is double.
    pub duplicates: Fault,
    /// Pairs of triangles on the same corners with opposite orientation. No harm: they are left out.
    pub opposite_duplicates: Fault,
    /// Edges with one triangle only: the rims of holes.
    pub open_edges: Fault,
    /// Edges whose two triangles run along them in the same direction: one of the two faces the wrong way.
    pub misoriented_edges: Fault,
    /// Edges with more than two triangles. No harm where the directions cancel.
    pub non_manifold_edges: Fault,
    /// Those of the edges with more than two triangles whose directions do not cancel.
    pub unbalanced_edges: Fault,
    /// Vertices whose triangles form several fans. No harm.
    pub pinched_vertices: Fault,
    /// Used vertices with exactly the coordinates of an earlier one (both are named). No harm.
    pub split_vertices: Fault,
    /// Number of shells: pieces of the surface connected by edges.
    pub shells: usize,
    /// Closed shells that face inwards without lying inside another, or outwards inside another. (Told of the
    /// pieces between edges with more than two triangles: bodies that touch in an edge are judged each for itself.
    /// Shells that cross others are not judged.)
    pub inside_out_shells: Fault,
    /// Pairs of triangles that cross or overlap each other; `None` if that has not been looked for.
    pub self_crossings: Option<Fault>,
    /// Whether every directed edge is met by its opposite equally often.
    pub closed: bool,
    /// Where the surface is not closed, but can be mended with certainty: what [`Gate`](super::Gate) does by default. `None`
    /// if that was tried already and did not close it.
    pub mending: Option<Box<Mending>>,
    /// Where the surface is not closed: the least power of ten between 1e-9 and 1e-3 of the size within which
    /// welding the vertices on open edges would close it (not looked for where more than 500 000 vertices are on
    /// open edges). [`Mesh::welded`](super::Mesh::welded) does it.
    pub closing_distance: Option<f64>,
    /// The box around the triangles.
    pub bounds: Option<Bounds>,
    /// The area of the triangles.
    pub area: f64,
    /// The signed volume, if closed.
    pub volume: Option<f64>,
    /// Vertices minus edges plus triangles.
    pub euler_characteristic: i64,
    /// The genus, if closed and every edge has two triangles; pinched vertices taken apart, summed over the shells.
    pub genus: Option<usize>,
}

impl Diagnosis {
    /// The kinds of fault, each with its name for one and for several.
    fn faults(&self) -> [(&'static str, &'static str, &Fault); 13] {
        [
            (
                "triangle with an index out of range",
                "triangles with an index out of range",
                &self.index_out_of_range,
            ),
            ("vertex that is not finite", "vertices that are not finite", &self.not_finite),
            ("open edge", "open edges", &self.open_edges),
            ("misoriented edge", "misoriented edges", &self.misoriented_edges),
            (
                "edge with more than two triangles in unequal directions",
                "edges with more than two triangles in unequal directions",
                &self.unbalanced_edges,
            ),
            ("inside-out shell", "inside-out shells", &self.inside_out_shells),
            ("duplicate triangle", "duplicate triangles", &self.duplicates),
            ("non-manifold edge", "non-manifold edges", &self.non_manifold_edges),
            ("vertex with several fans", "vertices with several fans", &self.pinched_vertices),
            ("zero-area triangle", "zero-area triangles", &self.zero_area),
            ("triangle with a repeated corner", "triangles with a repeated corner", &self.repeated_corners),
            ("pair of opposite triangles", "pairs of opposite triangles", &self.opposite_duplicates),
            ("unreferenced vertex", "unreferenced vertices", &self.unreferenced_vertices),
        ]
    }

    /// The faults without advice: a text for each kind there is, with up to `places` places (of at most five that are kept).
    #[must_use]
    pub fn listed(&self, places: usize) -> Vec<String> {
        let crossings = self.self_crossings.as_ref().map(|fault| ("crossing pair", "crossing pairs", fault));
        let kinds = self.faults().into_iter().chain(crossings).filter(|(.., fault)| !fault.is_none());
        kinds.map(|(one, several, fault)| fault.text(one, several, places)).collect()
    }

    /// How to mend a surface that no welding closes.
    fn advice(&self) -> Option<&'static str> {
        let (open, turned) = (!self.open_edges.is_none(), !self.misoriented_edges.is_none());
        match (open, turned) {
            (true, false) => Some("its holes must be filled first"),
            (false, true) if self.unbalanced_edges.is_none() => {
                Some("triangles that face the wrong way can be turned, if they are not many")
            }
            _ => None,
        }
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (separator, shown) = if f.alternate() { ("\n", PLACES) } else { ("; ", 2) };
        let mut parts = self.listed(shown);
        if let Some(mending) = &self.mending {
            parts.push(format!("mending would close it: {mending}"));
        } else if let Some(distance) = self.closing_distance {
            parts.push(format!("welding vertices within {distance:e} would close it"));
        } else if let Some(advice) = self.advice() {
            parts.push(advice.into());
        }
        if parts.is_empty() { f.write_str("no faults") } else { f.write_str(&parts.join(separator)) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Place;
    use super::*;

    fn fault(count: usize) -> Fault {
        let place = |index: u32| Place {
            triangles: vec![index],
            vertices: vec![index, index + 1],
            position: [f64::from(index) / 3.0, -1e-9, 0.0],
        };
        Fault { count, places: (0..count.min(PLACES) as u32).map(place).collect() }
    }

    #[test]
    fn text_is_short_and_has_places() {
        assert_eq!(Diagnosis::default().to_string(), "no faults");
        let diagnosis = Diagnosis {
            open_edges: fault(7),
            zero_area: fault(1),
            closing_distance: Some(1e-7),
            ..Diagnosis::default()
        };
        let expected = "7 open edges: triangle 0 vertices 0-1 at (0, -1e-9, 0), \
            triangle 1 vertices 1-2 at (0.3333333, -1e-9, 0), ...; \
            1 zero-area triangle: triangle 0 vertices 0-1 at (0, -1e-9, 0); \
            welding vertices within 1e-7 would close it";
        assert_eq!(diagnosis.to_string(), expected);
        assert_eq!(format!("{diagnosis:#}").lines().count(), 3);
        assert_eq!(format!("{diagnosis:#}").matches(" at ").count(), 6);
    }

    #[test]
    #[cfg(feature = "serde")]
    fn numbers_that_are_none_are_null() {
        let diagnosis = Diagnosis { not_finite: fault(2), area: f64::NAN, ..Diagnosis::default() };
        let json = serde_json::to_value(&diagnosis).unwrap();
        assert_eq!(json["not_finite"]["count"], 2);
        assert_eq!(json["not_finite"]["places"][1]["vertices"][1], 2);
        assert!(json["area"].is_null() && json["self_crossings"].is_null());
        // As many keys as fields: Debug names each once at the first level.
        let fields = format!("{:#?}", Diagnosis::default());
        let fields = fields.lines().filter(|line| line.starts_with("    ") && !line.starts_with("     "));
        let fields = fields.filter_map(|line| line.trim().split_once(':')).map(|(name, _)| name.to_string());
        let fields: std::collections::BTreeSet<String> = fields.collect();
        let keys: std::collections::BTreeSet<String> = json.as_object().unwrap().keys().cloned().collect();
        assert_eq!(keys, fields);
    }
}

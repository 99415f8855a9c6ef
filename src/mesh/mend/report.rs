//! What mending has done.

use std::fmt;

use super::super::places::{Fault, short};

/// What was done to make a closed surface of a mesh that was none, each kind counted, with its first places. All numbers
/// are those of the mesh as given. Nothing was done where all counts are zero: the case of every mesh that is closed.
///
/// [`Display`](fmt::Display) writes it in one line, without places.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Mending {
    /// Vertices on open edges joined with another one a rounding away, or within the distance that was asked for.
    pub seams: Fault,
    /// The largest distance of two vertices that were joined, in units of the coordinates.
    pub widest_seam: f64,
    /// The distance within which vertices were joined, if more than rounding was asked for and needed.
    pub distance: Option<f64>,
    /// Vertices in the middle of an open edge, which was split there.
    pub split_edges: Fault,
    /// Triangles left out that have no area.
    pub zero_area: Fault,
    /// Holes filled because that was asked for, each placed at a vertex of its rim.
    pub filled: Fault,
    /// How many triangles fill them.
    pub filled_triangles: usize,
    /// How many new vertices these have, where fillings were refined.
    pub filled_vertices: usize,
    /// The area of these, in squared units of the coordinates.
    pub filled_area: f64,
    /// Further copies of a triangle left out.
    pub copies: Fault,
    /// Shells left out as further copies of another shell, each placed at its first triangle.
    pub copied_shells: Fault,
    /// Triangles of fins left out: flat pieces that hang on the surface by an edge and enclose nothing.
    pub fins: Fault,
    /// Triangles left out that hang on nothing.
    pub strays: Fault,
    /// Triangles left out of walls inside the body that were stored once.
    pub walls: Fault,
    /// Triangles of parts that are not closed, left out because that was asked for.
    pub open_parts: Fault,
    /// How many open parts these triangles make.
    pub open_part_count: usize,
    /// The area of the open parts, in squared units of the coordinates.
    pub open_area: f64,
    /// Triangles turned because that was asked for.
    pub turned: usize,
}

impl Mending {
    pub(crate) const NOTHING: Self = Self {
        seams: Fault::NONE,
        widest_seam: 0.0,
        distance: None,
        split_edges: Fault::NONE,
        zero_area: Fault::NONE,
        filled: Fault::NONE,
        filled_triangles: 0,
        filled_vertices: 0,
        filled_area: 0.0,
        copies: Fault::NONE,
        copied_shells: Fault::NONE,
        fins: Fault::NONE,
        strays: Fault::NONE,
        walls: Fault::NONE,
        open_parts: Fault::NONE,
        open_part_count: 0,
        open_area: 0.0,
        turned: 0,
    };

    /// Whether nothing was done.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.turned == 0 && self.kinds().iter().all(|(.., fault)| fault.is_none())
    }

    /// What leaves the surface as it was but for rounding, for what counted twice and for holes filled, with the name of one and of
    /// several.
    #[must_use]
    pub fn sewn(&self) -> Vec<(&'static str, &'static str, &Fault)> {
        self.kinds()[..6].iter().filter(|(.., fault)| !fault.is_none()).copied().collect()
    }

    /// What left out a piece of surface that the mesh had, with the name of one and of several.
    #[must_use]
    pub fn left_out(&self) -> Vec<(&'static str, &'static str, &Fault)> {
        self.kinds()[6..].iter().filter(|(.., fault)| !fault.is_none()).copied().collect()
    }

    fn kinds(&self) -> [(&'static str, &'static str, &Fault); 10] {
        [
            ("vertex of a seam joined", "vertices of seams joined", &self.seams),
            (
                "vertex in the middle of an edge, which was split there",
                "vertices in the middle of edges, which were split there",
                &self.split_edges,
            ),
            ("triangle without area left out", "triangles without area left out", &self.zero_area),
            ("copy of a triangle left out", "copies of triangles left out", &self.copies),
            ("copy of a shell left out", "copies of shells left out", &self.copied_shells),
            ("hole filled", "holes filled", &self.filled),
            ("triangle of a fin left out", "triangles of fins left out", &self.fins),
            ("stray triangle left out", "stray triangles left out", &self.strays),
            (
                "triangle of a wall inside the body left out",
                "triangles of walls inside the body left out",
                &self.walls,
            ),
            ("triangle of an open part left out", "triangles of open parts left out", &self.open_parts),
        ]
    }
}

impl fmt::Display for Mending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words: Vec<String> = Vec::new();
        for (one, several, fault) in self.kinds() {
            if !fault.is_none() {
                words.push(format!("{} {}", fault.count, if fault.count == 1 { one } else { several }));
            }
            if std::ptr::eq(fault, &self.filled) && self.filled_triangles > 0 {
                let count = self.filled_triangles;
                let triangles = if count == 1 { "triangle" } else { "triangles" };
                let vertices = match self.filled_vertices {
                    0 => String::new(),
                    1 => " with 1 new vertex".to_owned(),
                    vertices => format!(" with {vertices} new vertices"),
                };
                let text = format!(" ({count} {triangles}{vertices}, area {})", short(self.filled_area));
                words.last_mut().into_iter().for_each(|word| word.push_str(&text));
            }
        }
        if !self.seams.is_none() {
            words[0].push_str(&format!(" (at most {:.1e} apart)", self.widest_seam));
        }
        if self.turned > 0 {
            let triangles = if self.turned == 1 { "triangle" } else { "triangles" };
            words.push(format!("{} {triangles} turned", self.turned));
        }
        if words.is_empty() { f.write_str("nothing") } else { f.write_str(&words.join(", ")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_says_what_was_done() {
        assert!(Mending::default().is_none());
        assert_eq!(Mending::default(), Mending::NOTHING);
        assert_eq!(Mending::default().to_string(), "nothing");
        let fault = |count| Fault { count, places: Vec::new() };
        let mending = Mending {
            seams: fault(2),
            widest_seam: 2.5e-16,
            walls: fault(1),
            turned: 3,
            ..Mending::default()
        };
        assert!(!mending.is_none());
        assert_eq!(
            mending.to_string(),
            "2 vertices of seams joined (at most 2.5e-16 apart), 1 triangle of a wall inside the body left out, 3 triangles turned"
        );
        assert_eq!((mending.sewn().len(), mending.left_out().len()), (1, 1));
    }
}

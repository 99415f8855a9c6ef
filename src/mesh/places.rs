//! Faults counted, with places: indices and a point.

use std::fmt;

use super::Mesh;
use super::edges::Edge;

/// At most this many places are kept of each kind of fault.
pub(super) const PLACES: usize = 5;

/// Faults of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fault {
    /// How many there are.
    pub count: usize,
    /// Where the first of them are.
    pub places: Vec<Place>,
}

/// Where a fault is.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Place {
    /// The triangles concerned (of an edge with many, the first few).
    pub triangles: Vec<u32>,
    /// The vertices concerned: the ends of an edge, the corners of a triangle.
    pub vertices: Vec<u32>,
    /// A point at the fault: the vertex, the middle of the edge or of the triangle. Not a number where a
    /// coordinate is not finite or missing.
    pub position: [f64; 3],
}

impl Fault {
    /// None of them.
    pub(super) const NONE: Self = Self { count: 0, places: Vec::new() };

    /// Counts one more, and keeps its place if there is room.
    pub(super) fn add(&mut self, place: impl FnOnce() -> Place) {
        if self.places.len() < PLACES {
            self.places.push(place());
        }
        self.count += 1;
    }

    /// The count, a name for one or for several, and up to `shown` places.
    #[must_use]
    pub fn text(&self, one: &str, several: &str, shown: usize) -> String {
        let mut text = format!("{} {}", self.count, if self.count == 1 { one } else { several });
        let places: Vec<String> = self.places.iter().take(shown).map(ToString::to_string).collect();
        if !places.is_empty() {
            text.push_str(": ");
            text.push_str(&places.join(", "));
        }
        if self.count > places.len() {
            text.push_str(", ...");
        }
        text
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.count == 0
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |indices: &[u32]| indices.iter().map(u32::to_string).collect::<Vec<_>>().join("-");
        match self.triangles[..] {
            [] => {}
            [triangle] => write!(f, "triangle {triangle} ")?,
            _ => write!(f, "triangles {} ", list(&self.triangles).replace('-', ", "))?,
        }
        match self.vertices[..] {
            [] => {}
            [vertex] => write!(f, "vertex {vertex} ")?,
            _ => write!(f, "vertices {} ", list(&self.vertices))?,
        }
        let [x, y, z] = self.position.map(short);
        write!(f, "at ({x}, {y}, {z})")
    }
}

/// The number with seven digits at most.
pub(super) fn short(x: f64) -> String {
    let rounded = format!("{x:.6e}").parse().unwrap_or(x);
    if rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Makes places out of indices of the mesh.
pub(super) struct Spots<'a> {
    pub(super) mesh: &'a Mesh,
}

impl Spots<'_> {
    fn middle(&self, vertices: &[u32]) -> [f64; 3] {
        let mut middle = [0.0; 3];
        for &vertex in vertices {
            let position = self.mesh.positions.get(vertex as usize).unwrap_or(&[f64::NAN; 3]);
            for axis in 0..3 {
                middle[axis] += position[axis] / vertices.len() as f64;
            }
        }
        middle
    }

    pub(super) fn vertices(&self, vertices: &[u32]) -> Place {
        Place { triangles: vec![], vertices: vertices.to_vec(), position: self.middle(&vertices[..1]) }
    }

    pub(super) fn triangles(&self, triangles: &[u32]) -> Place {
        let vertices = self.mesh.triangles[triangles[0] as usize];
        Place { triangles: triangles.to_vec(), vertices: vertices.to_vec(), position: self.middle(&vertices) }
    }

    /// Vertices at a triangle, placed at the last of them.
    pub(super) fn vertices_at(&self, triangle: u32, vertices: &[u32]) -> Place {
        let last = vertices.last().map_or(&[][..], std::slice::from_ref);
        Place { triangles: vec![triangle], vertices: vertices.to_vec(), position: self.middle(last) }
    }

    pub(super) fn edge(&self, edge: Edge<'_>, source: &[u32]) -> Place {
        let triangles = edge.triangles().take(4).map(|triangle| source[triangle as usize]).collect();
        let vertices = vec![edge.low, edge.high];
        Place { triangles, position: self.middle(&vertices), vertices }
    }
}

//! What is known of a surface's crossings with itself.

use std::fmt;

use super::places::{Fault, Place, short};

/// A pair of triangles of one surface that cross.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SelfCrossing {
    /// The two triangles, the lower index first.
    pub triangles: [u32; 2],
    /// A point of the crossing, roughly.
    pub place: [f64; 3],
    /// How deep the one reaches through the other, in units of the coordinates: how far one would have to be moved at most for the
    /// two to come apart, or the length of what they have in common, where that is less. 0 where they overlap in one plane or
    /// along an edge.
    pub depth: f64,
}

/// The crossings of a surface with itself.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SelfCrossings {
    /// Pairs of triangles that cross each other really: the surface encloses something twice, or inside out.
    pub count: usize,
    /// Pairs that cross no deeper than rounding; every computed mesh may have some. They are tolerated. (One that all the same leaves
    /// something beside it that is enclosed twice, or inside out, counts as crossing really. That is asked of surfaces alone that
    /// cross themselves nowhere deeper.) Triangles that touch each other without a point inside both are not counted.
    pub tolerated: usize,
    /// Those of the `count` pairs that are no deeper than 64 times what is tolerated, and not flat: what a chain of operations
    /// may leave. The multiplicities of the boolean of two operands carry them.
    pub shallow: usize,
    /// Pairs that lie on each other in one plane, with area in common: bodies that touch face to face, or sheets without
    /// thickness.
    pub touching: usize,
    /// Pairs that touch, and cross as the surface shrinks a little.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) contacts: usize,
    /// The depth that counts as rounding at the largest coordinates, in units of these; where all coordinates are smaller than a
    /// sixteenth of the largest, less in proportion.
    pub tolerance: f64,
    /// The deepest few of the `count` pairs.
    pub places: Vec<SelfCrossing>,
}

impl SelfCrossings {
    /// Whether the surface does not cross itself (but for rounding).
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.count == 0
    }
}

impl SelfCrossings {
    /// Whether the surface crosses itself nowhere deeper than a few roundings, nor lies on itself.
    pub(crate) fn is_nearly_simple(&self) -> bool {
        self.count == self.shallow && self.touching == 0
    }

    /// Whether it is known that the surface crosses itself nowhere, not even by a rounding or where it shrinks a little.
    pub(crate) fn has_nothing(&self) -> bool {
        self.is_simple() && self.tolerated == 0 && self.contacts == 0
    }

    /// Whether the surface neither crosses itself, except by rounding, nor lies on itself anywhere.
    #[must_use]
    pub fn is_simple(&self) -> bool {
        self.count == 0 && self.touching == 0
    }
}

impl From<&SelfCrossings> for Fault {
    fn from(crossings: &SelfCrossings) -> Self {
        let place = |crossing: &SelfCrossing| Place {
            triangles: crossing.triangles.to_vec(),
            vertices: Vec::new(),
            position: crossing.place,
        };
        Self { count: crossings.count, places: crossings.places.iter().map(place).collect() }
    }
}

impl fmt::Display for SelfCrossings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} pairs of triangles cross each other", self.count)?;
        for (i, crossing) in self.places.iter().enumerate().take(2) {
            let [s, t] = crossing.triangles;
            let [x, y, z] = crossing.place.map(short);
            write!(f, "{} triangles {s} and {t} at ({x}, {y}, {z})", if i == 0 { "," } else { ";" })?;
            write!(f, ", {:.2e} deep", crossing.depth)?;
        }
        Ok(())
    }
}

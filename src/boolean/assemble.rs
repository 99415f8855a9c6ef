//! The result's arrays: untouched triangles in their order, then what was cut.

use super::cut_edges::CutEdges;
use super::cut_faces::{BitSet, CutFaces};
use super::identify::Identification;
use super::multiplicity::Part;
use super::operands::Operands;
use super::outcome::Origin;
use crate::Error;

/// A triangle that cutting made or changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewTriangle {
    /// Points: vertices by number, then nodes, then copies.
    pub(super) corners: [u32; 3],
    pub(super) origin: Origin,
    /// Whether the corners lay on one line before they were rounded.
    pub(super) flat: bool,
}

/// The arrays of a result.
#[derive(Debug, Default)]
pub(super) struct Assembled {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) origins: Vec<Origin>,
    /// Decisions that plain positions left open.
    pub(super) ties: u64,
    /// Whether rounding turned over some triangle.
    pub(super) has_inverted: bool,
}

impl Assembled {
    /// Both, as bodies of their own.
    pub(super) fn beside(mut self, other: Self) -> Result<Self, Error> {
        if self.triangles.is_empty() {
            return Ok(other);
        }
        let vertices = self.positions.len() + other.positions.len();
        if vertices > u32::MAX as usize {
            return Err(Error::TooLarge { what: format!("{vertices} vertices in one result") });
        }
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v + offset)));
        self.origins.extend(other.origins);
        self.has_inverted |= other.has_inverted;
        Ok(self)
    }
}

/// What the arrays are made of.
pub(super) struct Ingredients<'a> {
    pub(super) operands: &'a Operands<'a>,
    pub(super) parts: &'a [Part],
    pub(super) faces: &'a [CutFaces; 2],
    /// Winding numbers of the vertices, by side; empty where all are 0.
    pub(super) windings: &'a [Vec<i32>; 2],
    pub(super) identification: &'a Identification,
    pub(super) edges: &'a CutEdges,
    pub(super) new: &'a [NewTriangle],
    /// Uncut triangles that `new` replaces, by side.
    pub(super) replaced: Option<&'a [BitSet; 2]>,
    /// Positions of the points after the nodes.
    pub(super) copies: &'a [[f64; 3]],
}

impl Ingredients<'_> {
    /// How often an uncut triangle counts in a part.
    #[inline]
    fn count(&self, part: Part, triangle: u32, corners: [u32; 3]) -> u32 {
        if self.faces[part.side].is_cut(triangle)
            || self.replaced.is_some_and(|r| r[part.side].contains(triangle))
        {
            return 0;
        }
        let winding = self.windings[part.side].get(corners[0] as usize).copied().unwrap_or(0);
        part.multiplicity(winding).unsigned_abs()
    }

    /// Builds the arrays.
    pub(super) fn assemble(&self) -> Assembled {
        let operands = self.operands;
        let points = operands.vertex_count() as usize + self.edges.positions.len() + self.copies.len();
        // First mark the points in use, then number them in order: A's, B's, nodes, copies.
        let mut number = vec![UNUSED; points];
        let mut count = self.new.len();
        for &part in self.parts {
            let first = operands.first_vertex(part.side);
            for (t, &corners) in operands.sides[part.side].triangles.iter().enumerate() {
                let times = self.count(part, t as u32, corners);
                if times > 0 {
                    count += times as usize;
                    for v in corners {
                        number[self.identification.representative(first + v) as usize] = USED;
                    }
                }
            }
        }
        for triangle in self.new {
            for point in triangle.corners {
                number[point as usize] = USED;
            }
        }
        let mut positions = Vec::new();
        for (point, entry) in number.iter_mut().enumerate() {
            if *entry == USED {
                *entry = positions.len() as u32;
                positions.push(self.position(point as u32));
            }
        }

        let mut result = Assembled {
            positions,
            triangles: Vec::with_capacity(count),
            origins: Vec::with_capacity(count),
            ..Assembled::default()
        };
        for &part in self.parts {
            let first = operands.first_vertex(part.side);
            for (t, &corners) in operands.sides[part.side].triangles.iter().enumerate() {
                let times = self.count(part, t as u32, corners);
                if times == 0 {
                    continue;
                }
                let [a, b, c] =
                    corners.map(|v| number[self.identification.representative(first + v) as usize]);
                // A negative multiplicity turns the triangle over once more.
                let winding = self.windings[part.side].get(corners[0] as usize).copied().unwrap_or(0);
                let reversed = part.reversed != (part.multiplicity(winding) < 0);
                let origin = Origin { operand: part.side as u32, triangle: t as u32, reversed };
                for _ in 0..times {
                    result.triangles.push(if reversed { [a, c, b] } else { [a, b, c] });
                    result.origins.push(origin);
                }
            }
        }
        for triangle in self.new {
            result.triangles.push(triangle.corners.map(|point| number[point as usize]));
            result.origins.push(triangle.origin);
        }
        result
    }

    fn position(&self, point: u32) -> [f64; 3] {
        let first_node = self.operands.vertex_count();
        if point < first_node {
            return *self.operands.position(point);
        }
        let node = (point - first_node) as usize;
        match self.edges.positions.get(node) {
            Some(position) => *position,
            None => self.copies[node - self.edges.positions.len()],
        }
    }
}

const UNUSED: u32 = u32::MAX;
const USED: u32 = u32::MAX - 1;

//! What the clean-up asks the rest of the pipeline: this file is the only one that knows the arrangement.
//!
//! Its points are the vertices of both operands and the nodes, under their common numbers; everything else in this room
//! speaks of the points of a [`Patch`](super::patch::Patch).

use crate::boolean::classify::multiplicity::Part;
use crate::boolean::complex::planes::{Planes, source_and_projection};
use crate::boolean::cut::Cutter;
use crate::boolean::result::outcome::Origin;
use crate::exact::Projection;

/// An uncut triangle that the result keeps.
pub(super) struct KeptTriangle {
    /// Its vertices, or the points that stand for them, as the operand has them.
    pub(super) points: [u32; 3],
    /// Where it comes from, and whether the result turns it over.
    pub(super) origin: Origin,
    /// How often the result has it.
    pub(super) copies: u32,
    /// Whether its multiplicity is 1: the result has it as the part of the operand does.
    pub(super) is_simple: bool,
}

/// The arrangement of both operands, as far as the clean-up needs it.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) cutter: &'a Cutter<'a>,
    pub(super) planes: &'a Planes<'a>,
    pub(super) parts: &'a [Part],
}

impl Source<'_> {
    /// Number of vertices of both operands; the nodes are numbered after them.
    pub(super) fn vertex_count(&self) -> u32 {
        self.cutter.operands.vertex_count()
    }

    /// Number of vertices and nodes.
    pub(super) fn point_count(&self) -> usize {
        self.vertex_count() as usize + self.cutter.edges.positions.len()
    }

    /// Where a vertex or node is.
    pub(super) fn position(&self, point: u32) -> [f64; 3] {
        *self.cutter.position(point)
    }

    /// Number of triangles of an operand.
    pub(super) fn triangle_count(&self, side: usize) -> usize {
        self.cutter.operands.sides[side].triangles.len()
    }

    /// What a rounded point can be off, in units of the coordinates.
    pub(super) fn rounding(&self) -> f64 {
        self.cutter.rounding
    }

    /// Whether the operands touch: some decision was left to the perturbation.
    pub(super) fn has_contacts(&self) -> bool {
        self.cutter.operands.ties() > 0
    }

    /// The points that stand for others at the same place, ascending.
    pub(super) fn representatives(&self) -> Vec<u32> {
        self.cutter.identification.representatives()
    }

    /// The nodes that cutting left inside plane faces.
    pub(super) fn nodes_in_plane_faces(&self) -> Vec<u32> {
        let first_node = self.vertex_count();
        self.cutter.plane_faces.left().iter().map(|node| first_node + node).collect()
    }

    /// Whether cutting can have left anything to clean up: points that became one, nodes inside plane faces, or surface
    /// that counts other than once. O(points).
    pub(super) fn needs_clean_up(&self) -> bool {
        !self.cutter.identification.is_empty()
            || !self.cutter.plane_faces.left().is_empty()
            || self.has_multiple_surface()
    }

    /// Whether some vertex or part of an edge has a winding number other than 0 or 1: a rounded operand crosses itself.
    fn has_multiple_surface(&self) -> bool {
        let Cutter { operands, crossings, edges, windings, .. } = *self.cutter;
        windings.iter().flatten().any(|&winding| !(0..=1).contains(&winding))
            || edges.edges.iter().enumerate().any(|(index, edge)| {
                let side = operands.side_of(edge.low);
                let mut winding = windings[side][(edge.low - operands.first_vertex(side)) as usize];
                edges.nodes(index as u32).iter().any(|&node| {
                    winding += if crossings.nodes[node as usize].leaves { -1 } else { 1 };
                    !(0..=1).contains(&winding)
                })
            })
    }

    /// The triangle that a face comes from, turned over if the face was, and how it is projected: counter-clockwise, along
    /// the axis it looks along most.
    pub(super) fn source_and_projection(&self, origin: Origin) -> ([[f64; 3]; 3], Projection) {
        source_and_projection(self.cutter.operands, origin)
    }

    /// Whether two faces look the same way from one plane and belong to one group: the edge between them is coplanar, and
    /// nothing is lost with it.
    pub(super) fn are_mergeable(&self, x: Origin, y: Origin) -> bool {
        self.planes.mergeable(x, y)
    }

    /// Whether two faces lie in one plane, exactly.
    pub(super) fn are_coplanar(&self, x: Origin, y: Origin) -> bool {
        self.planes.coplanar(x, y)
    }

    /// Whether three points lay on one line before they were rounded; false if one of them is a copy.
    pub(super) fn were_collinear(&self, points: [u32; 3]) -> bool {
        self.cutter.were_on_one_line(points)
    }

    /// Calls `visit` for every uncut triangle of the result, in order. O(triangles).
    pub(super) fn for_each_kept(&self, mut visit: impl FnMut(&KeptTriangle)) {
        let Cutter { operands, faces, windings, identification, .. } = *self.cutter;
        for &part in self.parts {
            let first = operands.first_vertex(part.side);
            let windings = &windings[part.side];
            for (t, corners) in operands.sides[part.side].triangles.iter().enumerate() {
                if faces[part.side].is_cut(t as u32) {
                    continue;
                }
                let count = part.multiplicity(windings[corners[0] as usize]);
                if count != 0 {
                    let reversed = part.reversed != (count < 0);
                    visit(&KeptTriangle {
                        points: corners.map(|v| identification.representative(first + v)),
                        origin: Origin { operand: part.side as u32, triangle: t as u32, reversed },
                        copies: count.unsigned_abs(),
                        is_simple: count == 1,
                    });
                }
            }
        }
    }
}

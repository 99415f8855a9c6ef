//! Which faces of the result lie in one plane, by the exact planes of their source triangles.

use super::super::cut::{Cutter, dominant_axis};
use super::super::operands::Operands;
use super::super::outcome::Origin;
use super::patch::Patch;
use crate::exact::{Sign, collinear, orient2d, orient3d, orient3d_filter};

/// Compares source planes of triangles of the result.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes<'a> {
    pub(super) operands: &'a Operands<'a>,
    pub(super) groups: [&'a [u32]; 2],
}

impl Planes<'_> {
    fn corners(&self, origin: Origin) -> [[f64; 3]; 3] {
        source(self.operands, origin)
    }

    /// Whether a triangle looks the way of the face it was cut from.
    pub(super) fn is_sound(&self, patch: &Patch<'_>, corners: &[u32; 3], origin: Origin) -> bool {
        let (x, y) = self.axes(origin);
        let [a, b, c] = corners.map(|point| {
            let position = patch.position(point);
            [position[x], position[y]]
        });
        orient2d(a, b, c) == Sign::Positive
    }

    fn group(&self, origin: Origin) -> u32 {
        self.groups[origin.operand as usize].get(origin.triangle as usize).copied().unwrap_or(0)
    }

    /// The two axes onto which a face is best projected, in the order in which it is seen counter-clockwise.
    pub(super) fn axes(&self, origin: Origin) -> (usize, usize) {
        source_and_axes(self.operands, origin).1
    }

    /// Whether two faces look the same way from the same plane and belong to the same group, so that the border between
    /// them means nothing.
    pub(super) fn mergeable(&self, x: Origin, y: Origin) -> bool {
        if self.group(x) != self.group(y) {
            return false;
        }
        if x.operand == y.operand && x.triangle == y.triangle {
            return x.reversed == y.reversed;
        }
        self.coplanar(x, y) && same_way(&self.corners(x), &self.corners(y))
    }

    /// Whether two faces lie in the same plane, exactly; false for source triangles without area.
    pub(super) fn coplanar(&self, x: Origin, y: Origin) -> bool {
        let ([a, b, c], other) = (self.corners(x), self.corners(y));
        // Nearly always they have corners in common, and those need no test.
        other.iter().filter(|d| ![a, b, c].contains(d)).all(|d| orient3d(&a, &b, &c, d) == Sign::Zero)
            && !collinear(&a, &b, &c)
            && !collinear(&other[0], &other[1], &other[2])
    }

    /// Nodes on edges between two mergeable faces of their own operand: they lie inside a plane face or on a straight
    /// crease. Ascending point numbers.
    pub(super) fn removable_nodes(&self, cutter: &Cutter<'_>) -> Vec<u32> {
        const NONE: u32 = u32::MAX;
        let nodes = &cutter.crossings.nodes;
        let mut beside = vec![[NONE; 2]; nodes.len()];
        for segment in &cutter.crossings.segments {
            for node in [segment.tail, segment.head] {
                let side = self.operands.side_of(nodes[node as usize].low);
                let triangle = segment.triangles[side];
                let slots = &mut beside[node as usize];
                let slot = usize::from(slots[0] != NONE);
                slots[slot] = triangle;
            }
        }
        let first_node = self.operands.vertex_count();
        (0..nodes.len())
            .filter(|&node| {
                let side = self.operands.side_of(nodes[node].low);
                let [t, u] = beside[node];
                if t == NONE || u == NONE {
                    return false;
                }
                // Nearly always the two faces are visibly not coplanar.
                let [a, b, c] = self.operands.corners(side, t).map(|corner| corner.position);
                let visible = self.operands.corners(side, u).iter().any(|d| {
                    let (determinant, bound) = orient3d_filter(&a, &b, &c, &d.position);
                    determinant.abs() > bound
                });
                !visible
                    && self.mergeable(
                        Origin { operand: side as u32, triangle: t, reversed: false },
                        Origin { operand: side as u32, triangle: u, reversed: false },
                    )
            })
            .map(|node| first_node + node as u32)
            .collect()
    }
}

/// The face a triangle comes from, turned over if it was.
fn source(operands: &Operands<'_>, origin: Origin) -> [[f64; 3]; 3] {
    let [a, b, c] = operands.corners(origin.operand as usize, origin.triangle).map(|corner| corner.position);
    if origin.reversed { [a, c, b] } else { [a, b, c] }
}

/// The face a triangle comes from, and the two axes onto which it is best projected, in the order in which it is seen
/// counter-clockwise.
pub(super) fn source_and_axes(operands: &Operands<'_>, origin: Origin) -> ([[f64; 3]; 3], (usize, usize)) {
    let source = source(operands, origin);
    let (axis, positive) = dominant_axis(&source);
    let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
    (source, if positive { (x, y) } else { (y, x) })
}

/// Whether the normals of two triangles of one plane point the same way.
fn same_way(x: &[[f64; 3]; 3], y: &[[f64; 3]; 3]) -> bool {
    let (axis, positive) = dominant_axis(x);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let [a, b, c] = y.map(|p| [p[i], p[j]]);
    (orient2d(a, b, c) == Sign::Positive) == positive
}

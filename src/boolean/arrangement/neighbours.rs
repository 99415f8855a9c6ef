//! Pairs of triangles of one surface that plainly do not meet, by what is cheapest: the vertices they share, then their planes.

use super::apart::are_disjoint;
use crate::Mesh;
use crate::boolean::complex::planes;
use crate::exact::{FILTER_RANGE, PlaneFilter};
use crate::mesh::plain_fans;

/// The most triangles of which each can have three numbers of its own beside those of the vertices.
const MOST_TRIANGLES: u32 = (1 << 31) / 3;

/// What tells pairs of triangles of one closed surface apart.
pub(super) struct Neighbours<'a> {
    mesh: &'a Mesh,
    /// For each vertex whether its triangles have nothing in common but the vertex and the edges they share.
    plain: Vec<bool>,
    /// Whether coordinates are small enough for filters.
    has_filter: bool,
}

impl<'a> Neighbours<'a> {
    /// Of a mesh without coordinates larger than `largest`, given which vertices are known to have plain fans, and the triangles that
    /// have others. O(n).
    pub(super) fn new(mesh: &'a Mesh, largest: f64, known: Vec<bool>, around: &[u32]) -> Self {
        let plain = plain_fans(mesh, largest, known, around);
        Self { mesh, plain, has_filter: largest <= FILTER_RANGE }
    }

    /// Whether the triangles round a vertex have nothing in common but it and the edges they share.
    pub(super) fn is_plain(&self, vertex: u32) -> bool {
        self.plain[vertex as usize]
    }

    /// Three numbers of a triangle: its vertices where their fans are plain, and numbers that nothing else has. Triangles that have
    /// one in common have nothing else in common.
    #[inline]
    pub(super) fn marks(&self, triangle: u32) -> [u32; 3] {
        let (vertices, own) = (self.mesh.triangles[triangle as usize], own_marks(triangle));
        std::array::from_fn(|k| if self.plain[vertices[k] as usize] { vertices[k] } else { own[k] })
    }

    /// Whether there are few enough triangles for [`marks`](Self::marks).
    pub(super) fn has_marks(mesh: &Mesh) -> bool {
        mesh.triangles.len() <= MOST_TRIANGLES as usize
    }

    /// Whether two triangles may cross or lie on each other; false only where it is certain that they have nothing in common but
    /// corners and an edge that they share.
    #[inline]
    pub(super) fn may_meet(&self, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|t| self.mesh.triangles[t as usize]);
        // 1. Vertices of both, and whether one of them has a plain fan.
        let (mut common, mut is_plain) = (0, false);
        for v in a {
            if b[0] == v || b[1] == v || b[2] == v {
                common += 1;
                is_plain |= self.plain[v as usize];
            }
        }
        match common {
            0 => !self.are_apart(a, b),
            1 => !is_plain,
            // They meet in the common edge alone, unless they are folded back on each other.
            2 => !is_plain && self.lie_on_each_other(a, b),
            // One triangle twice.
            _ => true,
        }
    }

    /// Whether one of two triangles without common vertices certainly lies on one side of the other's plane, or of a line that
    /// they are seen on different sides of.
    #[inline]
    fn are_apart(&self, a: [u32; 3], b: [u32; 3]) -> bool {
        let [a, b] = [a, b].map(|corners| corners.map(|v| &self.mesh.positions[v as usize]));
        (self.has_filter && (is_on_one_side(a, b) || is_on_one_side(b, a)))
            || are_disjoint(&a.map(|corner| *corner), &b.map(|corner| *corner))
    }

    fn lie_on_each_other(&self, a: [u32; 3], b: [u32; 3]) -> bool {
        let [a, b] = [a, b].map(|corners| corners.map(|v| self.mesh.positions[v as usize]));
        planes::lie_on_each_other(&a, &b)
    }
}

/// Three numbers of a triangle that nothing else has.
#[inline]
pub(super) fn own_marks(triangle: u32) -> [u32; 3] {
    // No vertex has so large a number, and there are no more triangles than so many.
    const OWN: u32 = 1 << 31;
    std::array::from_fn(|k| OWN | (3 * triangle.min(MOST_TRIANGLES) + k as u32))
}

/// Whether points certainly lie strictly on one side of the plane through others.
#[inline]
fn is_on_one_side([a, b, c]: [&[f64; 3]; 3], points: [&[f64; 3]; 3]) -> bool {
    let plane = PlaneFilter::new(a, b, c);
    let sides = points.map(|point| {
        let (determinant, bound) = plane.determinant(point);
        (determinant > bound, determinant < -bound)
    });
    let all = |side: [bool; 3]| side[0] & side[1] & side[2];
    all(sides.map(|side| side.0)) | all(sides.map(|side| side.1))
}

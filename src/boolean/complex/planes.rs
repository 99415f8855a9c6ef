//! Which faces of the result lie in one plane, by the exact planes of their source triangles.

use crate::boolean::complex::operands::Operands;
use crate::boolean::result::outcome::Origin;
use crate::exact::{Projection, Sign, collinear, orient2d, orient3d, orient3d_filter};

/// Compares source planes of triangles of the result.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planes<'a> {
    pub(crate) operands: &'a Operands<'a>,
    pub(crate) groups: [&'a [u32]; 2],
}

impl Planes<'_> {
    fn corners(&self, origin: Origin) -> [[f64; 3]; 3] {
        source(self.operands, origin)
    }

    fn group(&self, origin: Origin) -> u32 {
        self.groups[origin.operand as usize].get(origin.triangle as usize).copied().unwrap_or(0)
    }

    /// Whether two faces look the same way from the same plane and belong to the same group, so that the border between
    /// them means nothing.
    pub(crate) fn mergeable(&self, x: Origin, y: Origin) -> bool {
        if self.group(x) != self.group(y) {
            return false;
        }
        if x.operand == y.operand && x.triangle == y.triangle {
            return x.reversed == y.reversed;
        }
        self.coplanar(x, y) && same_way(&self.corners(x), &self.corners(y))
    }

    /// Whether two faces lie in the same plane, exactly; false for source triangles without area.
    pub(crate) fn coplanar(&self, x: Origin, y: Origin) -> bool {
        let ([a, b, c], other) = (self.corners(x), self.corners(y));
        // Nearly always they have corners in common, and those need no test.
        other.iter().filter(|d| ![a, b, c].contains(d)).all(|d| orient3d(&a, &b, &c, d) == Sign::Zero)
            && !collinear(&a, &b, &c)
            && !collinear(&other[0], &other[1], &other[2])
    }

    /// Whether two triangles of an operand are mergeable; fast where they are visibly not coplanar, as nearly all are.
    pub(crate) fn are_mergeable(&self, side: usize, t: u32, u: u32) -> bool {
        let [a, b, c] = self.operands.corners(side, t).map(|corner| corner.position);
        let visible = self.operands.corners(side, u).iter().any(|d| {
            let (determinant, bound) = orient3d_filter(&a, &b, &c, &d.position);
            determinant.abs() > bound
        });
        let origin = |triangle: u32| Origin { operand: side as u32, triangle, reversed: false };
        !visible && self.mergeable(origin(t), origin(u))
    }
}

/// The face a triangle comes from, turned over if it was.
fn source(operands: &Operands<'_>, origin: Origin) -> [[f64; 3]; 3] {
    let [a, b, c] = operands.corners(origin.operand as usize, origin.triangle).map(|corner| corner.position);
    if origin.reversed { [a, c, b] } else { [a, b, c] }
}

/// The face a triangle comes from, and how it is projected.
pub(crate) fn source_and_projection(operands: &Operands<'_>, origin: Origin) -> ([[f64; 3]; 3], Projection) {
    let source = source(operands, origin);
    (source, Projection::of(&source))
}

/// Whether the normals of two triangles of one plane point the same way.
fn same_way(x: &[[f64; 3]; 3], y: &[[f64; 3]; 3]) -> bool {
    let seen = Projection::of(x);
    let [a, b, c] = y.map(|p| seen.project(&p));
    orient2d(a, b, c) == Sign::Positive
}

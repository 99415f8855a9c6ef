//! How two triangles without a common corner meet: at most ten signs.

use super::Corner;
use super::predicates::{Plane, Predicates};

/// Two triangles that meet, `pqr` and `uvw`: each has one corner alone on its side of the other's plane, here p and u.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    /// By triangle, the place of the corner that is alone.
    pub(crate) alone: [usize; 2],
    /// By triangle, whether that corner lies inside the other's plane.
    pub(crate) inside: [bool; 2],
    /// By triangle, whether its edge to the corner after the one alone (`pq`, `uv`), and that to the corner before it (`pr`,
    /// `uw`), pierce the other triangle. Two of these four do, or none.
    pub(crate) pierces: [[bool; 2]; 2],
}

impl Meeting {
    /// How they meet, if each has corners on both sides of the other's plane. Given are which corners of the first lie inside the
    /// plane of the second, and what tells the same of the second.
    #[inline(always)]
    pub(crate) fn of(
        predicates: &Predicates<'_>,
        a: &[Corner; 3],
        b: &[Corner; 3],
        a_inside: [bool; 3],
        b_inside: impl FnOnce() -> [bool; 3],
    ) -> Option<Self> {
        // 1. One corner of each is alone on its side.
        let i = odd_one_out(a_inside)?;
        let b_inside = b_inside();
        let j = odd_one_out(b_inside)?;
        let [p, q, r] = [0, 1, 2].map(|k| &a[(i + k) % 3]);
        let [u, v, w] = [0, 1, 2].map(|k| &b[(j + k) % 3]);
        // 2. Both cut the line in which their planes meet in an interval, bounded by their edges at the corner that is alone.
        //    An edge pierces the other triangle iff it passes that one's two edges on different sides.
        let (pqu, pru) = (Plane::new(p, q, u), Plane::new(p, r, u));
        let qv = predicates.is_inside(&pqu, v);
        let qw = predicates.is_inside(&pqu, w);
        let rv = predicates.is_inside(&pru, v);
        let rw = predicates.is_inside(&pru, w);
        Some(Self {
            alone: [i, j],
            inside: [a_inside[i], b_inside[j]],
            pierces: [[qv != qw, rv != rw], [qv != rv, qw != rw]],
        })
    }
}

/// The index of the one that differs from the other two.
#[inline]
fn odd_one_out(inside: [bool; 3]) -> Option<usize> {
    match inside {
        [a, b, c] if a == b && b == c => None,
        [a, b, _] if a == b => Some(2),
        [a, _, c] if a == c => Some(1),
        _ => Some(0),
    }
}

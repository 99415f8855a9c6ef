//! The faces of a patch, and the numbers by which a patch knows its points and faces.

use crate::boolean::complex::origin::Origin;

/// The number of a point within a patch: first the vertices and nodes the patch has, in their own order, then the copies
/// made by the clean-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct LocalPoint(pub(super) u32);

impl LocalPoint {
    #[inline]
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// The number of a face within a patch; dropped faces keep theirs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct LocalFace(pub(super) u32);

impl LocalFace {
    #[inline]
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// An edge without direction, from its lower point to its higher one.
pub(super) type Edge = (LocalPoint, LocalPoint);

/// The edge between two points.
#[inline]
pub(super) fn edge_between(u: LocalPoint, v: LocalPoint) -> Edge {
    (u.min(v), u.max(v))
}

/// The directed sides of a triangle; the k-th starts at the k-th corner.
#[inline]
pub(super) fn sides([a, b, c]: [LocalPoint; 3]) -> [(LocalPoint, LocalPoint); 3] {
    [(a, b), (b, c), (c, a)]
}

/// A triangle of the patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) corners: [LocalPoint; 3],
    pub(super) origin: Origin,
    /// The only copy of an uncut triangle, with its corners as they were.
    pub(super) untouched: bool,
    /// Whether its corners lay on one line before they were rounded.
    pub(super) flat: bool,
    /// Whether it has not been dropped.
    pub(super) alive: bool,
}

impl Face {
    /// Its directed sides; the k-th starts at the k-th corner.
    #[inline]
    pub(super) fn sides(&self) -> [(LocalPoint, LocalPoint); 3] {
        sides(self.corners)
    }

    /// The corner that is neither of two others.
    #[inline]
    pub(super) fn third_corner(&self, a: LocalPoint, c: LocalPoint) -> Option<LocalPoint> {
        self.corners.into_iter().find(|&point| point != a && point != c)
    }
}

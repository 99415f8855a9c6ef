//! Putting a mesh where its bounds say: centred, aligned, mirrored, fitted into a box.

use super::{Mesh, MeshError, TransformFault};

/// Which side of a mesh's bounds along an axis is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BoundsSide {
    /// Where the coordinate is least.
    Low,
    /// Half way between.
    Middle,
    /// Where the coordinate is greatest.
    High,
}

impl Mesh {
    /// The mesh moved along `axis` (0, 1 or 2 for x, y, z) so that this side of its bounds comes to lie at `at`. The extreme
    /// vertices are at exactly that coordinate then, so that faces there are flush with whatever else is. O(n).
    ///
    /// ```
    /// use trisect::mesh::BoundsSide;
    /// use trisect::primitives;
    ///
    /// let block = primitives::cuboid([0.1, 0.2, 0.3], [1.1, 1.2, 1.3])?;
    /// let dropped = block.aligned(2, BoundsSide::Low, 0.0);
    /// assert_eq!(dropped.bounds().unwrap().low, [0.1, 0.2, 0.0]);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Panics
    /// If there is no such axis.
    #[must_use]
    pub fn aligned(mut self, axis: usize, side: BoundsSide, at: f64) -> Self {
        assert!(axis < 3, "no axis {axis}");
        let Some(bounds) = self.bounds() else { return self };
        let (low, high) = (bounds.low[axis], bounds.high[axis]);
        let from = match side {
            BoundsSide::Low => low,
            BoundsSide::Middle => bounds.center()[axis],
            BoundsSide::High => high,
        };
        let by = at - from;
        for position in &mut self.positions {
            let x = position[axis];
            // The sum may be rounded past the plane that the side is to lie in.
            position[axis] = match side {
                BoundsSide::Low if x == low => at,
                BoundsSide::High if x == high => at,
                BoundsSide::Low if x > low => (x + by).max(at),
                BoundsSide::High if x < high => (x + by).min(at),
                _ => x + by,
            };
        }
        self
    }

    /// The mesh moved so that the middle of its bounds is at the origin, along those axes that are asked for. O(n).
    ///
    /// For files of single precision see [`recentered`](Self::recentered), which moves by short numbers.
    #[must_use]
    pub fn centered(self, axes: [bool; 3]) -> Self {
        let wanted = (0..3).filter(|&axis| axes[axis]);
        wanted.fold(self, |mesh, axis| mesh.aligned(axis, BoundsSide::Middle, 0.0))
    }

    /// The mesh mirrored in the plane through the origin across `axis` (0, 1 or 2), its faces outwards still. No coordinate is
    /// rounded. O(n).
    ///
    /// # Panics
    /// If there is no such axis.
    #[must_use]
    pub fn mirrored(self, axis: usize) -> Self {
        let mut factors = [1.0; 3];
        factors[axis] = -1.0;
        // (No factor is zero, which is all that can be refused.)
        self.scaled(factors).unwrap_or_default()
    }

    /// The mesh scaled evenly about the origin so that it just fits into a box of `size`: at least one of its extents is then
    /// that of the box, to rounding. Extents of zero do not count. O(n).
    ///
    /// ```
    /// use trisect::primitives;
    ///
    /// let rod = primitives::cuboid([0.0; 3], [1.0, 2.0, 8.0])?;
    /// assert_eq!(rod.fitted([100.0, 100.0, 4.0])?.bounds().unwrap().size(), [0.5, 1.0, 4.0]);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::Transform`] if a size is not positive and finite, or the mesh has no extent.
    pub fn fitted(self, size: [f64; 3]) -> Result<Self, MeshError> {
        let extents = self.bounds().map_or([0.0; 3], |bounds| bounds.size());
        let factor =
            (0..3).filter(|&k| extents[k] > 0.0).map(|k| size[k] / extents[k]).fold(f64::INFINITY, f64::min);
        if size.iter().any(|&x| !(x > 0.0 && x.is_finite())) || !factor.is_finite() {
            return Err(MeshError::Transform(TransformFault::Fit { size, extents }));
        }
        self.scaled([factor; 3])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Solid, primitives};

    fn odd() -> Mesh {
        primitives::icosphere(0.3, 2).unwrap().translated([0.1, 1.0 / 3.0, -7.7])
    }

    #[test]
    fn sides_come_to_lie_exactly_where_they_are_asked_to() {
        for at in [0.0, 0.1, -1e6, 1.0 / 3.0] {
            for axis in 0..3 {
                let low = odd().aligned(axis, BoundsSide::Low, at).bounds().unwrap().low[axis];
                let high = odd().aligned(axis, BoundsSide::High, at).bounds().unwrap().high[axis];
                assert_eq!((low, high), (at, at));
            }
        }
        let middle = odd().centered([true, false, true]).bounds().unwrap().center();
        assert!(middle[0].abs() < 1e-15 && middle[2].abs() < 1e-14, "{middle:?}");
        assert_eq!(middle[1], odd().bounds().unwrap().center()[1]);
        assert_eq!(Mesh::default().centered([true; 3]), Mesh::default());
    }

    #[test]
    fn mirrored_twice_is_the_same_and_once_faces_outwards() {
        let body = primitives::cuboid([1.0; 3], [2.0, 4.0, 9.0]).unwrap();
        let once = body.clone().mirrored(1);
        assert_eq!(once.bounds().unwrap().high[1], -1.0);
        assert_eq!(Solid::try_from(once.clone()).unwrap().volume(), 24.0);
        assert_eq!(once.mirrored(1), body);
    }

    #[test]
    fn fitting_needs_an_extent_and_a_size() {
        let fitted = odd().fitted([5.0, 6.0, 7.0]).unwrap().bounds().unwrap().size();
        assert!((fitted[0] - 5.0).abs() < 1e-12 && fitted[1] <= 6.0 && fitted[2] <= 7.0, "{fitted:?}");
        for size in [[0.0, 1.0, 1.0], [1.0, f64::NAN, 1.0], [-1.0; 3], [f64::INFINITY; 3]] {
            assert!(odd().fitted(size).is_err(), "{size:?}");
        }
        assert!(Mesh::default().fitted([1.0; 3]).unwrap_err().to_string().contains("no extent"));
    }
}

//! Moving a mesh to the origin.

use super::{Bounds, Mesh};

/// How much of the mesh's size its middle may be off the origin: coordinates are then at most 17/32 of the size, and the
/// numbers it is moved by stay short.
const COARSENESS: f64 = 1.0 / 16.0;

impl Mesh {
    /// The mesh moved so that the middle of its bounds is near the origin, within a 32nd of its size, and what was added to
    /// every vertex; subtracting that again moves it back. Files of single precision keep more digits there.
    ///
    /// The numbers are multiples of a power of two that is a 32nd to a 16th of the size, or one unit in the last place of the
    /// largest coordinate if that is more: short numbers, exact in binary. Coordinates farther from the origin than the mesh
    /// is large are moved without rounding. O(n).
    ///
    /// ```
    /// use trisect::primitives;
    ///
    /// let house = primitives::cuboid([500_000.0, 4_649_776.25, 120.0], [500_010.0, 4_649_782.0, 123.1])?;
    /// let (moved, by) = house.clone().recentered();
    /// assert_eq!(by, [-500_005.0, -4_649_779.0, -121.5]);
    /// assert_eq!(moved.bounds().unwrap().low[1], -2.75);
    /// assert_eq!(moved.translated(by.map(|x| -x)), house);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn recentered(self) -> (Self, [f64; 3]) {
        let by = self.bounds().map_or([0.0; 3], |bounds| offset(&bounds));
        if by == [0.0; 3] {
            return (self, by);
        }
        (self.translated(by), by)
    }
}

/// What to add to bring the middle of `bounds` near the origin.
fn offset(bounds: &Bounds) -> [f64; 3] {
    // Half of each, so that nothing overflows.
    let half = (0..3).map(|k| bounds.high[k] * 0.5 - bounds.low[k] * 0.5).fold(0.0, f64::max);
    let largest = bounds.largest();
    let step = power_of_two_below(half * (2.0 * COARSENESS)).max(largest.next_up() - largest);
    if !(step.is_finite() && step >= f64::MIN_POSITIVE) {
        return [0.0; 3];
    }
    bounds.center().map(|middle| 0.0 - (middle / step).round() * step)
}

/// The largest power of two at or below a positive number, zero for what is too small to have one.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (0x7ff << 52))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn moving_and_moving_back_changes_no_bit_far_from_the_origin() {
        let ball = primitives::icosphere(1.0, 3).unwrap();
        for place in [[1e3, -1e6, 50.0], [1e9, 1e9, 1e9], [-1e15, 1e15, 7e14]] {
            let there = ball.clone().translated(place);
            let (moved, by) = there.clone().recentered();
            let bounds = moved.bounds().unwrap();
            assert!(bounds.largest() <= 17.0 / 32.0 * bounds.size()[0].max(bounds.size()[1]), "{bounds:?}");
            assert_eq!(moved.translated(by.map(|x| -x)), there, "{place:?}");
        }
    }

    #[test]
    fn what_is_at_the_origin_or_nowhere_stays() {
        let ball = primitives::icosphere(1.0, 2).unwrap();
        assert_eq!(ball.clone().recentered(), (ball, [0.0; 3]));
        assert_eq!(Mesh::default().recentered(), (Mesh::default(), [0.0; 3]));
        let huge = primitives::cuboid([-1e308; 3], [1.5e308; 3]).unwrap();
        assert!(huge.recentered().0.positions.as_flattened().iter().all(|x| x.is_finite()));
    }
}

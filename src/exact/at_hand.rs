//! What rounding is measured by: the sizes of the coordinates at hand.
//!
//! A correctly rounded coordinate is off by half its own unit in the last place, not by that of some vertex far away. Where it is
//! asked whether something may be the work of rounding, the answer therefore goes by the points that are asked about. Nothing
//! that decides what is inside, or what crosses what, asks this.

/// Lengths and heights up to so many units in the last place may be rounding: each of two points is off by less than one in
/// every direction, and their distance by less than twice that.
pub(crate) const ROUNDING_ULPS: f64 = 4.0;

/// Coordinates no smaller than one in this many of the largest of all are measured by the largest.
///
/// Points that were computed elsewhere (turned, say) carry the rounding of the coordinates they were computed from, which were
/// about as large as the object. So decisions do not depend on where in an object of one size something lies, but next to the
/// origin; and what is taken for rounding is never more than 64 units in the last place of the point itself. (With a factor of 4
/// a sliver of an ordinary model is told apart that 16 leaves to the clean-up; 256 does nothing that 16 does not: measured on
/// 2026-11-27 by the 52,209 results of `fixtures/same-bits.txt`.)
const NEAR_ONE_SIZE: f64 = 16.0;

/// The size that rounding is measured by at points whose largest coordinate is `own`, among others up to `largest`.
#[inline]
pub(crate) fn size_at_hand(largest: f64, own: f64) -> f64 {
    largest.min(NEAR_ONE_SIZE * own)
}

/// The largest coordinate of a point.
#[inline]
pub(crate) fn largest_coordinate<const N: usize>(point: &[f64; N]) -> f64 {
    point.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// The largest coordinate beside a point near the line between two others, `part` of the way along: its own, or that of the
/// line there. Rounding of a far end moves the line near the other end by its share alone.
pub(crate) fn largest_beside<const N: usize>(
    from: &[f64; N],
    middle: &[f64; N],
    to: &[f64; N],
    part: f64,
) -> f64 {
    let [from, middle, to] = [from, middle, to].map(largest_coordinate);
    let of_line = from + part.clamp(0.0, 1.0) * (to - from);
    middle.max(if of_line.is_finite() { of_line } else { from })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_end_counts_by_its_share() {
        let (near, far) = ([1.0, -2.0], [1e30, 0.0]);
        assert_eq!(largest_beside(&near, &[2.5, -2.0], &far, 1e-30), 3.0);
        assert_eq!(largest_beside(&near, &[5.0, -2.0], &far, 0.0), 5.0);
        assert_eq!(largest_beside(&near, &[5.0, -2.0], &far, f64::NAN), 5.0);
        // Through the origin the ends count.
        assert_eq!(largest_beside(&[-1.0], &[0.0], &[1.0], 0.5), 1.0);
    }

    #[test]
    fn objects_of_one_size_are_measured_alike() {
        assert_eq!(size_at_hand(8.0, 0.5), 8.0);
        assert_eq!(size_at_hand(8.0, 0.25), 4.0);
        assert_eq!(size_at_hand(8.0, 0.0), 0.0);
    }
}

//! Order of points along a space-filling curve: neighbours in the order are neighbours in space.

use glam::DVec3;
use obvhs::ploc::morton::morton_encode_u32;

/// The last cell along an axis.
pub(crate) const LAST: u32 = 1023;
/// Bits of a code.
pub(crate) const BITS: u32 = 30;

/// Indices of `points` along a Morton curve over their bounds; points that are not finite come last.
pub(crate) fn coherent_order(points: &[[f64; 3]]) -> Vec<u32> {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for point in points.iter().map(|&point| DVec3::from_array(point)).filter(|point| point.is_finite()) {
        low = low.min(point);
        high = high.max(point);
    }
    let size = high * 0.5 - low * 0.5;
    let scale = DVec3::from_array(size.to_array().map(|side| if side > 0.0 { 511.5 / side } else { 0.0 }));
    let cell_of = |point: DVec3| ((point * 0.5 - low * 0.5) * scale * 2.0).to_array().map(|x| x as u32);
    let mut keyed: Vec<(u32, u32)> = points
        .iter()
        .enumerate()
        .map(|(index, &point)| {
            let point = DVec3::from_array(point);
            let key = if point.is_finite() { code(cell_of(point)) } else { u32::MAX };
            (key, index as u32)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, index)| index).collect()
}

/// The code of a cell of a grid with 1024 cells along each axis: ten bits of each coordinate, interleaved, those of the first
/// in the lowest places. Larger coordinates count as the last one.
#[inline]
pub(crate) fn code(cell: [u32; 3]) -> u32 {
    let [x, y, z] = cell.map(|coordinate| coordinate.min(LAST) as u16);
    morton_encode_u32(x, y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_interleave_bits() {
        for bit in 0..10 {
            for axis in 0..3 {
                let mut cell = [0; 3];
                cell[axis] = 1 << bit;
                assert_eq!(code(cell), 1 << (3 * bit + axis));
            }
        }
        assert_eq!(code([LAST, LAST + 1, u32::MAX]), (1 << BITS) - 1);
    }

    #[test]
    fn order_is_a_permutation_and_keeps_octants_together() {
        let points: Vec<[f64; 3]> =
            (0..64).map(|i| [f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16)]).collect();
        let order = coherent_order(&points);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(i, &index)| i as u32 == index));
        let first_octant = order[..8].iter().all(|&i| points[i as usize].iter().all(|&x| x < 2.0));
        assert!(first_octant, "{order:?}");
    }

    #[test]
    fn degenerate_bounds_and_bad_points_are_ordered_too() {
        assert!(coherent_order(&[]).is_empty());
        let order = coherent_order(&[[1.0; 3], [f64::NAN, 0.0, 0.0], [1.0; 3]]);
        assert_eq!(order, [0, 2, 1]);
    }
}

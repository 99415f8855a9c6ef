//! Order of points along a space-filling curve: neighbours in the order are neighbours in space.

use glam::DVec3;

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
    let mut keyed: Vec<(u32, u32)> = points
        .iter()
        .enumerate()
        .map(|(index, &point)| {
            let point = DVec3::from_array(point);
            let key =
                if point.is_finite() { key_of((point * 0.5 - low * 0.5) * scale * 2.0) } else { u32::MAX };
            (key, index as u32)
        })
        .collect();
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, index)| index).collect()
}

/// Interleaves ten bits of each coordinate in `0..1024`.
fn key_of(cell: DVec3) -> u32 {
    let [x, y, z] = cell.to_array().map(|value| spread((value as u32).min(1023)));
    x | y << 1 | z << 2
}

/// Puts two zero bits between the ten low bits of `bits`.
fn spread(bits: u32) -> u32 {
    let bits = (bits | bits << 16) & 0x0300_00ff;
    let bits = (bits | bits << 8) & 0x0300_f00f;
    let bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_leaves_two_zeros_between_bits() {
        for bit in 0..10 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(0x3ff).count_ones(), 10);
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

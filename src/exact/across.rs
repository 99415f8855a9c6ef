//! The direction across two sides, also of needles.

use super::double_double::{DoubleDouble, power_of_two, scaled_difference};
use super::vector::cross;

/// The unit vector across two sides, each from its first point to its second, that they turn round counter-clockwise; right to a
/// few roundings. None if they are parallel, but for the last bits of twice the precision.
///
/// Sides of a needle are nearly parallel, and the direction across them is lost in one rounding of their products where it is a
/// thousand units in the last place wide.
pub(crate) fn unit_across(u: [&[f64; 3]; 2], v: [&[f64; 3]; 2]) -> Option<[f64; 3]> {
    let side = |[from, to]: [&[f64; 3]; 2]| -> [DoubleDouble; 3] {
        let longest = (0..3).fold(0.0f64, |most, k| most.max((to[k] - from[k]).abs()));
        scaled_difference(to, from, power_of_two(longest))
    };
    let across = cross(&side(u), &side(v)).map(|x| x.high);
    let size = across.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let across = across.map(|x| x / size);
    let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
    // (Sides without length and parallel ones leave no numbers.)
    length.is_finite().then(|| across.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needles_have_the_direction_across_them() {
        // The second side is off the first by a few units in the last place, along y.
        let (from, to) = ([0.1, 0.2, 0.3], [1.7, 0.2, 0.3]);
        let beside = [1.3, 0.2f64.next_up().next_up(), 0.3];
        assert_eq!(unit_across([&from, &to], [&from, &beside]), Some([0.0, 0.0, 1.0]));
        assert_eq!(unit_across([&from, &to], [&from, &from]), None);
        assert_eq!(unit_across([&from, &to], [&to, &from]), None);
        for scale in [1e-300, 1e300] {
            let (u, v) = ([scale, 0.0, 0.0], [scale, scale, 0.0]);
            assert_eq!(unit_across([&[0.0; 3], &u], [&[0.0; 3], &v]), Some([0.0, 0.0, 1.0]));
        }
    }
}

//! How deep two triangles reach into each other.

use crate::exact::unit_across;

/// A triangle.
type Triangle = [[f64; 3]; 3];

/// How far one of two triangles must be moved, in the best direction, so that the two no longer share more than points of their
/// boundaries, in units of the coordinates; 0 or less if they do not. To a few roundings of their size, and never too small by more.
///
/// This is the depth of a crossing that rounding makes: where the corners of two triangles that did not cross moved by no more than
/// r, the plane that parted them parts them still, but for 2 r. Heights across the planes of the two alone can be far larger: the
/// plane of a needle turns by as much as its corners move over its width, and a corner of the other is beyond it by that angle
/// times the length of the needle's neighbours.
///
/// Two convex bodies are parted best along the normal of a face of their Minkowski difference: for triangles the normals of both and
/// the products of their sides (11 directions).
pub(super) fn penetration(a: &Triangle, b: &Triangle) -> f64 {
    // (Two without area may have no direction, and are nowhere apart from a line.)
    overlaps(a, b).map(|(_, overlap)| overlap).reduce(f64::min).unwrap_or(0.0)
}

/// How far rounding may have moved the corners of two triangles towards each other along a direction in which they overlap by no
/// more than twice that, and are many times longer; `None` if there is no such direction, so that rounding does not explain
/// that they cross.
///
/// Each coordinate is off by half of its own unit in the last place, however small coordinates are where the two cross: a needle
/// through the origin ends elsewhere. Along an axis where coordinates are small, huge ones along others do not count.
pub(super) fn rounding(a: &Triangle, b: &Triangle) -> Option<f64> {
    /// Triangles no longer than so many roundings may be anywhere; of these nothing is known.
    const LONGER: f64 = 64.0;
    let unit = [0, 1, 2].map(|k| {
        let largest = a.iter().chain(b).fold(0.0f64, |most, p| most.max(p[k].abs()));
        largest.next_up() - largest
    });
    let length = |t: &Triangle| {
        let along = |[p, q]: [&[f64; 3]; 2]| (0..3).fold(0.0f64, |most, k| most.max((q[k] - p[k]).abs()));
        sides(t).map(along).into_iter().fold(0.0, f64::max)
    };
    let shorter = length(a).min(length(b));
    overlaps(a, b)
        .map(|(axis, overlap)| ((0..3).map(|k| axis[k].abs() * unit[k]).sum::<f64>(), overlap))
        .filter(|(moved, overlap)| *overlap <= 2.0 * moved && shorter > LONGER * moved)
        .map(|(moved, _)| moved)
        .reduce(f64::min)
}

/// The directions along which two triangles may be parted best, and how far they overlap along each.
fn overlaps<'a>(a: &'a Triangle, b: &'a Triangle) -> impl Iterator<Item = ([f64; 3], f64)> + 'a {
    let (of_a, of_b) = (sides(a), sides(b));
    // About a corner, so that nothing is lost far from the origin.
    let [from_a, from_b] = [a, b].map(|t| t.map(|p| [0, 1, 2].map(|k| p[k] - a[0][k])));
    let normals = [[of_a[0], of_a[1]], [of_b[0], of_b[1]]];
    let products = of_a.into_iter().flat_map(move |u| of_b.map(|v| [u, v]));
    let axes = normals.into_iter().chain(products).filter_map(|[u, v]| unit_across(u, v));
    axes.map(move |axis| (axis, overlap(&axis, &from_a, &from_b)))
}

/// The direction across a triangle, right to a few roundings however thin it is; none if it is flat.
pub(super) fn unit_normal(t: &Triangle) -> Option<[f64; 3]> {
    let [u, v, _] = sides(t);
    unit_across(u, v)
}

/// The sides of a triangle, each from a corner to the next.
fn sides(t: &Triangle) -> [[&[f64; 3]; 2]; 3] {
    [0, 1, 2].map(|k| [&t[k], &t[(k + 1) % 3]])
}

/// How far one has to be moved along an axis to be beyond the other.
fn overlap(axis: &[f64; 3], a: &Triangle, b: &Triangle) -> f64 {
    let range = |t: &Triangle| {
        let along = t.map(|p| (0..3).map(|k| axis[k] * p[k]).sum::<f64>());
        (
            along.iter().fold(f64::INFINITY, |low, &x| low.min(x)),
            along.iter().fold(f64::NEG_INFINITY, |high, &x| high.max(x)),
        )
    };
    let ((a_low, a_high), (b_low, b_high)) = (range(a), range(b));
    (a_high - b_low).min(b_high - a_low)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: Triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn assert_near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }

    #[test]
    fn a_corner_through_a_face_is_as_deep_as_it_reaches() {
        assert_near(penetration(&FLOOR, &[[1.0, 1.0, -0.25], [1.0, 1.5, 3.0], [1.5, 1.0, 3.0]]), 0.25);
        // Apart, by the same measure with another sign.
        assert_near(penetration(&FLOOR, &[[1.0, 1.0, 0.25], [1.0, 1.5, 3.0], [1.5, 1.0, 3.0]]), -0.25);
    }

    #[test]
    fn a_thin_needle_through_the_middle_is_deep() {
        let needle = [[1.0, 1.0, -1.0], [1.0, 1.0 + 1e-9, -1.0], [1.0, 1.0, 1.0]];
        assert!(penetration(&FLOOR, &needle) > 0.5);
    }

    #[test]
    fn sides_that_pass_each_other_are_as_deep_as_they_overlap() {
        // Two upright triangles whose slanting sides cross each other at a right angle, seen along z.
        let below = [[-1.0, 0.0, -5.0], [-1.0, 0.0, 0.125], [1.0, 0.0, 0.125]];
        let above = [[0.0, -1.0, 5.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_near(penetration(&below, &above), 0.125);
    }

    #[test]
    fn the_plane_of_a_needle_does_not_make_a_crossing_deep() {
        // A needle of width 1e-13 whose middle corner is off by as much, so that its plane is turned by half a right angle; beside
        // it a triangle that reaches across that plane by 0.7, but crosses the needle itself by its width.
        let needle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1e-13, 1e-13]];
        let beside = [[1.0, 0.5e-13, 0.2e-13], [1.0, 1.0, 0.0], [1.5, 1.0, 0.0]];
        assert!(penetration(&needle, &beside) < 2e-13);
        assert!(penetration(&beside, &needle) < 2e-13);
    }

    #[test]
    fn what_was_apart_is_no_deeper_than_its_corners_were_moved() {
        use rand::rngs::ChaCha8Rng;
        use rand::{RngExt, SeedableRng};
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut crossed = 0;
        for _ in 0..20_000 {
            // On both sides of a plane, some corners on it; needles among them.
            let width = 10f64.powf(random.random_range(-12.0..0.0));
            let mut one = |side: f64| -> Triangle {
                [0, 1, 2].map(|k| {
                    let height = if k < 2 { 0.0 } else { side * random.random_range(0.0..1.0) * width };
                    let x = random.random_range(-1.0..1.0);
                    [x, x + width * random.random_range(-1.0..1.0), height]
                })
            };
            let (a, b) = (one(1.0), one(-1.0));
            let r = 1e-10;
            let mut moved =
                |t: Triangle| t.map(|p| p.map(|x| x + r / 3f64.sqrt() * random.random_range(-1.0..1.0)));
            let (a, b) = (moved(a), moved(b));
            let found = penetration(&a, &b);
            crossed += usize::from(found > 0.0);
            assert!(found <= 2.0 * r + 1e-14, "{found:e}: {a:?} {b:?}");
        }
        assert!(crossed > 1000, "{crossed}");
    }

    #[test]
    fn needles_of_a_few_roundings_are_no_deeper_than_rounding() {
        // Of a symmetric difference of the live comparison (seed 4294971342): 3e-6 by directions of one rounding.
        let needle = [
            [0.13729380058327664, -0.2769148635063949, 0.6187932544755349],
            [0.18214562829377792, -0.28968449564048465, 0.6020717018443106],
            [0.1756074158672982, -0.2878230203837889, 0.6045092627818308],
        ];
        let beside = [
            [0.1756074158672982, -0.2878230203837889, 0.6045092627818308],
            [0.10268215466332709, -0.267060683453669, 0.6316970866814237],
            [0.18214562829377792, -0.28968449564048465, 0.6020717018443106],
        ];
        assert!(penetration(&needle, &beside) < 1e-15);
    }

    #[test]
    fn rounding_is_that_of_the_corners_along_the_direction() {
        // Two needles that pass each other at the origin by less than their ends are rounded.
        let one = [[-0.75, -1e-9, 1e-9], [0.75, -1e-9, 1e-9], [0.0, 1e-9, -1e-9]];
        let other = [[-1e-9, 0.75, -0.75], [1e-9, -0.75, 0.75f64.next_down()], [0.0, 1e-3, 1e-3]];
        let found = rounding(&one, &other).expect("it is rounding");
        assert!((1e-16..3e-16).contains(&found), "{found:e}");
        // Not where it is deeper.
        let deep = other.map(|p| [p[0], p[1] - 1e-9, p[2] - 1e-9]);
        assert_eq!(rounding(&one, &deep), None);
        // Nor where a face is huge along other axes only, or so huge that what is near it is shorter than its rounding.
        let face = [[-1e30, -1e30, 0.5], [1e30, -1e30, 0.5], [0.0, 1e30, 0.5]];
        let small = [[0.0, 0.0, 0.4], [0.1, 0.0, 1.0], [0.0, 0.1, 1.0]];
        assert_eq!(rounding(&face, &small), None);
        let slanting = [[-1e30, -1e30, -1e30], [1e30, -1e30, 0.7e30], [0.0, 1e30, 0.3e30]];
        assert_eq!(rounding(&slanting, &small), None);
    }

    #[test]
    fn sizes_do_not_matter() {
        let other = [[1.0, 1.0, -0.25], [1.0, 1.5, 3.0], [1.5, 1.0, 3.0]];
        for scale in [1e-300, 1e300] {
            let [a, b] = [FLOOR, other].map(|t| t.map(|p| p.map(|x| x * scale)));
            assert_near(penetration(&a, &b) / scale, 0.25);
        }
    }
}

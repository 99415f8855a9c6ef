//! Solids from contours.

use super::Contours;
use crate::primitives::prism;
use crate::{Error, Mesh};

/// The closed prism over the region enclosed by `contours` (by parity), from `z = low` to `z = high`. Vertices: the points
/// of the contours in order at the lower height, then at the upper. O(n log n) for ordinary contours.
///
/// # Errors
/// [`Error::InvalidArgument`] if `low` is not below `high`, or if polygons cross or have a point in common, or a
/// coordinate is not finite.
pub fn extrude(contours: &Contours, low: f64, high: f64) -> Result<Mesh, Error> {
    prism(&contours.loops, low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(half: f64) -> Vec<[f64; 2]> {
        vec![[-half, -half], [half, -half], [half, half], [-half, half]]
    }

    #[test]
    fn a_square_with_a_hole_is_a_closed_frame() {
        let contours = Contours { loops: vec![square(2.0), square(1.0)] };
        let mesh = extrude(&contours, 0.0, 3.0).expect("a frame");
        let mut edges: Vec<[u32; 2]> =
            mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|pair| pair[0] != pair[1]));
        assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()));
        let at = |v: u32| glam::DVec3::from_array(mesh.positions[v as usize]);
        let volume: f64 = mesh.triangles.iter().map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0).sum();
        assert!((volume - 36.0).abs() < 1e-12);
    }

    #[test]
    fn any_magnitude_will_do() {
        for scale in [1e-300, 1e-60, 1e60, 1e300] {
            let loops = [2.0, 1.0].map(|half| square(half * scale)).to_vec();
            let mesh = extrude(&Contours { loops }, 0.0, scale).expect("a frame");
            assert_eq!((mesh.positions.len(), mesh.triangles.len()), (16, 32), "{scale}");
        }
    }

    #[test]
    fn crossing_and_touching_contours_are_refused() {
        let bow = vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(extrude(&Contours { loops: vec![bow] }, 0.0, 1.0).is_err());
        let twice = Contours { loops: vec![square(1.0), square(1.0)] };
        assert!(extrude(&twice, 0.0, 1.0).is_err());
        assert!(extrude(&Contours { loops: vec![square(1.0)] }, 1.0, 1.0).is_err());
        let unbounded = vec![[0.0, 0.0], [f64::INFINITY, 0.0], [0.0, 1.0]];
        assert!(extrude(&Contours { loops: vec![unbounded] }, 0.0, 1.0).is_err());
    }
}

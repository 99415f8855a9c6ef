//! Transforms that turn left hands into right ones.

use glam::DMat3;

use crate::exact::{Sign, orient3d};

/// Whether the linear part of a transform is a mirror: exactly, by the sign of its determinant. What is not finite is none.
pub(super) fn is_mirrored(linear: &DMat3) -> bool {
    let [x, y, z] = linear.to_cols_array_2d();
    linear.is_finite() && orient3d(&x, &y, &z, &[0.0; 3]) == Sign::Negative
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn mirrors_of_every_size_are_mirrors() {
        for size in [1e-300, 1e-120, 1.0, 1e120, 1e300] {
            assert!(is_mirrored(&DMat3::from_diagonal(DVec3::new(-size, size, size))), "{size:e}");
            assert!(!is_mirrored(&DMat3::from_diagonal(DVec3::new(-size, -size, size))), "{size:e}");
        }
        let flat = DMat3::from_cols_array(&[0.1, 0.2, 0.3, 0.2, 0.4, 0.6, -1.0, 0.0, 0.5]);
        assert!(!is_mirrored(&flat) && !is_mirrored(&DMat3::from_diagonal(DVec3::splat(f64::NEG_INFINITY))));
    }
}

//! From `f64` coordinates to `f32` boxes that lose no overlap.

use glam::Vec3A;
use obvhs::aabb::Aabb;

/// A common frame for boxes in single precision: coordinates are shifted by the centre of a region and scaled by a power
/// of two, so that the region fills about [-1, 1], then rounded. Both steps are monotone, so boxes that meet in `f64` meet in
/// the frame (as closed boxes); the converse need not hold. Only boxes of the same frame may be compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    centre: [f64; 3],
    scale: f64,
}

impl Frame {
    /// Coordinates in the frame are no larger. A triangle with such a corner may have been bent: its box is right, what is
    /// inside the box is not known.
    pub(crate) const LIMIT: f32 = 1e30;

    /// Whether a triangle in the frame may be another one than before.
    #[inline]
    pub(crate) fn is_bent(corners: &[Vec3A; 3]) -> bool {
        corners.iter().any(|corner| corner.abs().max_element() >= Self::LIMIT)
    }

    /// The frame of the region between two corners.
    pub(crate) fn of(low: [f64; 3], high: [f64; 3]) -> Self {
        let centre = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
        let half = (0..3).fold(0.0f64, |half, k| half.max(0.5 * high[k] - 0.5 * low[k]));
        let power = f64::from_bits(half.to_bits() & 0x7ff0_0000_0000_0000);
        let scale = 1.0 / power;
        Self { centre, scale: if scale.is_finite() && scale > 0.0 { scale } else { 1.0 } }
    }

    /// A point in the frame. Coordinates far outside the region saturate instead of becoming infinite.
    #[inline]
    pub(crate) fn point(&self, position: &[f64; 3]) -> Vec3A {
        const LIMIT: f64 = Frame::LIMIT as f64;
        let map = |k: usize| ((position[k] - self.centre[k]) * self.scale).clamp(-LIMIT, LIMIT) as f32;
        Vec3A::new(map(0), map(1), map(2))
    }

    /// The box of a triangle.
    #[inline]
    pub(crate) fn triangle(&self, corners: [&[f64; 3]; 3]) -> Aabb {
        let [a, b, c] = corners.map(|corner| self.point(corner));
        Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
    }
}

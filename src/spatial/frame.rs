//! From `f64` coordinates to `f32` boxes that lose no overlap.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;

/// Half-extents below this are taken for it, so that the scale stays finite.
const SMALLEST: f64 = f64::from_bits((1023 - 1000) << 52);
/// The exponent of an `f64`, without sign and mantissa.
const EXPONENT: u64 = 0x7ff0_0000_0000_0000;

/// A common frame for boxes in single precision: coordinates are shifted by the centre of a region and scaled by a power
/// of two, so that the region has a half-extent in 1..2, then rounded. All steps are monotone, so boxes that meet in `f64`
/// meet in the frame (as closed boxes); the converse need not hold. Only boxes of the same frame may be compared.
///
/// Scaling by a power of two is exact, and recentring keeps boxes tight for small models far from the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    centre: DVec3,
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
        let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
        // Halved first: the sum and the difference of two finite numbers may overflow.
        let half = (0.5 * high - 0.5 * low).max_element();
        let power = f64::from_bits(half.max(SMALLEST).to_bits() & EXPONENT);
        Self { centre: 0.5 * low + 0.5 * high, scale: if half > 0.0 { 1.0 / power } else { 1.0 } }
    }

    /// Length in the frame of one unit outside.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// A point in the frame, still in double precision.
    #[inline]
    pub(crate) fn local(&self, position: DVec3) -> DVec3 {
        (position - self.centre) * self.scale
    }

    /// A point of the frame where it was before, to rounding.
    #[inline]
    pub(crate) fn outside(&self, local: DVec3) -> DVec3 {
        local / self.scale + self.centre
    }

    /// A point in the frame. Coordinates far outside the region saturate instead of becoming infinite.
    #[inline]
    pub(crate) fn point(&self, position: &[f64; 3]) -> Vec3A {
        const LIMIT: f64 = Frame::LIMIT as f64;
        let local = self.local(DVec3::from_array(*position)).to_array();
        Vec3A::from_array(local.map(|x| x.clamp(-LIMIT, LIMIT) as f32))
    }

    /// The box of a triangle.
    #[inline]
    pub(crate) fn triangle(&self, corners: [&[f64; 3]; 3]) -> Aabb {
        let [a, b, c] = corners.map(|corner| self.point(corner));
        Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    /// A box around a point that is strictly larger than it, so that the rounding of recentring is covered too: distances
    /// to it are never more than those to the point.
    #[inline]
    pub(crate) fn around(&self, position: DVec3) -> Aabb {
        let local = self.local(position).to_array().map(|x| x as f32);
        Aabb {
            min: Vec3A::from_array(local.map(f32::next_down)),
            max: Vec3A::from_array(local.map(f32::next_up)),
        }
    }
}

//! The single-precision frame of a hierarchy: coordinates about the model's centre, scaled by a power of two.

use glam::DVec3;

/// Maps `f64` coordinates to the hierarchy's single-precision ones. Scaling by a power of two is exact, and
/// recentring keeps the boxes tight for small models far from the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalFrame {
    centre: DVec3,
    scale: f64,
}

impl LocalFrame {
    /// The frame in which the box `low..high` has a half-extent in `0.5..=1`.
    pub(crate) fn of(low: DVec3, high: DVec3) -> Self {
        // Halved first: the sum and the difference of two finite numbers may overflow.
        let centre = low * 0.5 + high * 0.5;
        let half = (high * 0.5 - low * 0.5).max_element();
        let scale = if half > 0.0 && half.is_finite() {
            2f64.powi(-(half.log2().ceil().clamp(-1000.0, 1000.0) as i32))
        } else {
            1.0
        };
        Self { centre, scale }
    }

    /// Length in the frame of one unit outside.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// `point` in the frame, still in double precision.
    pub(crate) fn local(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    /// Single-precision bounds of `point` in the frame: strictly below and above it, so that the rounding of
    /// recentring is covered too.
    pub(crate) fn around(&self, point: DVec3) -> SmallBox {
        let local = self.local(point).to_array();
        SmallBox { low: local.map(|x| (x as f32).next_down()), high: local.map(|x| (x as f32).next_up()) }
    }
}

/// An axis-aligned box in the frame of a hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SmallBox {
    pub(crate) low: [f32; 3],
    pub(crate) high: [f32; 3],
}

impl SmallBox {
    /// Contains nothing; the neutral element of [`joined`](Self::joined).
    pub(crate) const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    /// The smallest box around both.
    pub(crate) fn joined(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// Half the surface area; zero for an empty box.
    pub(crate) fn half_area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|axis| (self.high[axis] - self.low[axis]).max(0.0));
        x * y + y * z + z * x
    }

    /// Twice the centre along `axis`.
    pub(crate) fn doubled_centre(&self, axis: usize) -> f32 {
        self.low[axis] + self.high[axis]
    }
}

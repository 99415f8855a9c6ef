//! Four boxes side by side, so that one step tests all of them.

use glam::{Vec3A, Vec4};
use obvhs::aabb::Aabb;

/// Boxes in a pack: the lanes of a 128-bit register, which every target this runs on has.
pub(crate) const LANES: usize = 4;

/// Four boxes, coordinate by coordinate. A lane that is not used holds no numbers, and so meets nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(crate) struct Pack {
    low: [[f32; LANES]; 3],
    high: [[f32; LANES]; 3],
}

impl Pack {
    /// No boxes.
    pub(super) const EMPTY: Self = Self { low: [[f32::NAN; LANES]; 3], high: [[f32::NAN; LANES]; 3] };

    /// The pack of at most four boxes.
    pub(super) fn new(boxes: impl Iterator<Item = Aabb>) -> Self {
        let mut pack = Self::EMPTY;
        for (lane, aabb) in boxes.enumerate() {
            pack.set(lane, &aabb);
        }
        pack
    }

    /// Puts a box into a lane.
    #[inline]
    pub(super) fn set(&mut self, lane: usize, aabb: &Aabb) {
        let (low, high) = (aabb.min.to_array(), aabb.max.to_array());
        for k in 0..3 {
            self.low[k][lane] = low[k];
            self.high[k][lane] = high[k];
        }
    }

    /// The box in a lane that is used.
    #[inline]
    pub(super) fn lane(&self, lane: usize) -> Aabb {
        let corner = |of: &[[f32; LANES]; 3]| Vec3A::new(of[0][lane], of[1][lane], of[2][lane]);
        Aabb { min: corner(&self.low), max: corner(&self.high) }
    }

    /// The box round all boxes.
    #[inline]
    pub(super) fn hull(&self) -> Aabb {
        // (Lanes that are not used hold no numbers, which these leave out.)
        let low = self.low.map(|[a, b, c, d]| a.min(b).min(c.min(d)));
        let high = self.high.map(|[a, b, c, d]| a.max(b).max(c.max(d)));
        Aabb { min: Vec3A::from_array(low), max: Vec3A::from_array(high) }
    }

    /// The lanes whose boxes meet a box (closed boxes), as bits.
    #[inline(always)]
    pub(super) fn meeting(&self, low: [f32; 3], high: [f32; 3]) -> u32 {
        let axis = |k: usize| {
            let (from, to) = (Vec4::from_array(self.low[k]), Vec4::from_array(self.high[k]));
            from.cmple(Vec4::splat(high[k])) & Vec4::splat(low[k]).cmple(to)
        };
        (axis(0) & axis(1) & axis(2)).bitmask()
    }

    /// The pairs of lanes whose boxes meet: lanes i of this pack and j of the other as bit 4 i + j.
    #[inline(always)]
    pub(super) fn meeting_pack(&self, other: &Self) -> u32 {
        // In registers throughout: a box put together in memory and read back as a whole would be waited for.
        let [lows, highs] = [&other.low, &other.high].map(|corner| corner.map(Vec4::from_array));
        let of_lane = |i: usize| {
            let axis = |k: usize| {
                lows[k].cmple(Vec4::splat(self.high[k][i])) & Vec4::splat(self.low[k][i]).cmple(highs[k])
            };
            (axis(0) & axis(1) & axis(2)).bitmask() << (LANES * i)
        };
        of_lane(0) | of_lane(1) | of_lane(2) | of_lane(3)
    }

    /// Squared distances from the point bounded by `query` to the four boxes, never more than the true ones by more than
    /// the rounding of a few single-precision operations; without meaning for unused lanes.
    #[inline]
    pub(super) fn squared_distances(&self, query: &Aabb) -> [f32; LANES] {
        let (low, high) = (query.min.to_array(), query.max.to_array());
        let mut sum = [0f32; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let below = self.low[axis][lane] - high[axis];
                let above = low[axis] - self.high[axis][lane];
                let gap = below.max(above).max(0.0);
                sum[lane] += gap * gap;
            }
        }
        sum
    }
}

/// Calls `found` for the places of the ones, ascending.
#[inline(always)]
pub(super) fn for_each_bit(mut mask: u32, mut found: impl FnMut(u32)) {
    while mask != 0 {
        found(mask.trailing_zeros());
        mask &= mask - 1;
    }
}

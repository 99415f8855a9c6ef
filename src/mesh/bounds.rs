//! Axis-aligned boxes.

use super::BitSet;

/// An axis-aligned box, closed: `low[k] <= x[k] <= high[k]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bounds {
    /// The corner with the least coordinates.
    pub low: [f64; 3],
    /// The corner with the greatest coordinates.
    pub high: [f64; 3],
}

impl Bounds {
    /// The smallest box round `points`; `None` for no points. Not-a-number coordinates are ignored.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Option<Self> {
        let mut bounds = Self::NOTHING;
        for point in points {
            bounds.include(point);
        }
        (bounds.low[0] <= bounds.high[0]).then_some(bounds)
    }

    /// The smallest box round the corners of triangles; those out of range are left out.
    pub(crate) fn of_corners(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Option<Self> {
        let corners = triangles.iter().flatten().filter(|&&corner| (corner as usize) < positions.len());
        // Of a few triangles of many.
        if 3 * triangles.len() < positions.len() / 64 {
            return Self::of(corners.map(|&corner| &positions[corner as usize]));
        }
        // Marked first, so that the positions, each of which belongs to six triangles, are read once and in order.
        let mut used = BitSet::new(positions.len());
        corners.for_each(|&corner| used.insert(corner));
        Self::of(used.iter().map(|corner| &positions[corner as usize]))
    }

    /// Contains nothing: the neutral element of [`include`](Self::include) and [`union`](Self::union).
    pub(crate) const NOTHING: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    /// The smallest box round both, one of which may contain nothing.
    pub(crate) fn united(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
        }
    }

    /// Grows the box to contain `point`.
    #[inline]
    pub(crate) fn include(&mut self, point: &[f64; 3]) {
        for axis in 0..3 {
            // Comparisons, not f64::min: they compile to one instruction and skip not-a-numbers alike.
            self.low[axis] = if point[axis] < self.low[axis] { point[axis] } else { self.low[axis] };
            self.high[axis] = if point[axis] > self.high[axis] { point[axis] } else { self.high[axis] };
        }
    }

    /// The box that reaches so much further on all sides.
    pub(crate) fn grown(&self, reach: f64) -> Self {
        Self { low: self.low.map(|low| low - reach), high: self.high.map(|high| high + reach) }
    }

    /// Which sides a point lies beyond, a bit for each of the six. A triangle is beside the box, along some axis, iff its corners have a side in
    /// common.
    #[inline(always)]
    pub(crate) fn sides_beyond(self, point: &[f64; 3]) -> u8 {
        let mut sides = 0;
        for axis in 0..3 {
            sides |= u8::from(point[axis] < self.low[axis]) << (2 * axis);
            sides |= u8::from(point[axis] > self.high[axis]) << (2 * axis + 1);
        }
        sides
    }

    /// [`sides_beyond`](Self::sides_beyond) of many points.
    pub(crate) fn mark_sides_beyond(self, points: &[[f64; 3]], marks: &mut [u8]) {
        for (mark, point) in marks.iter_mut().zip(points) {
            *mark = self.sides_beyond(point);
        }
    }

    /// The smallest box that contains both.
    #[must_use]
    pub fn union(mut self, other: &Self) -> Self {
        self.include(&other.low);
        self.include(&other.high);
        self
    }

    /// Whether `other` lies in this box; their borders may touch.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }

    /// The edge lengths; infinite where they exceed the largest number.
    #[must_use]
    pub fn size(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.high[axis] - self.low[axis])
    }

    /// The largest absolute value of a coordinate.
    pub(crate) fn largest(&self) -> f64 {
        self.low.iter().chain(&self.high).fold(0.0, |largest, x| x.abs().max(largest))
    }

    /// The middle, computed without overflow.
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.low[axis].midpoint(self.high[axis]))
    }

    /// A point near the middle, beside it: the middle of a body lies in planes through corners and edges of many.
    pub(crate) fn beside_center(&self) -> [f64; 3] {
        /// As parts of the size along each axis, without a common measure.
        const OFF: [f64; 3] = [0.0037, 0.0061, -0.0023];
        let middle = self.center();
        std::array::from_fn(|k| middle[k] + OFF[k] * (self.high[k] - self.low[k]))
    }

    /// The length of the diagonal; infinite where it exceeds the largest number.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let [x, y, z] = self.size();
        x.hypot(y).hypot(z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_round_points() {
        assert_eq!(Bounds::of([]), None);
        let bounds = Bounds::of(&[[1.0, -2.0, 0.5], [0.0, 4.0, 0.5]]).unwrap();
        assert_eq!(bounds, Bounds { low: [0.0, -2.0, 0.5], high: [1.0, 4.0, 0.5] });
        assert_eq!(bounds.size(), [1.0, 6.0, 0.0]);
        assert_eq!(bounds.center(), [0.5, 1.0, 0.5]);
        assert!(bounds.contains(&bounds));
    }

    #[test]
    fn corners_of_few_and_of_many_triangles_have_a_box() {
        let positions: Vec<[f64; 3]> = (0..1_000).map(|i| [f64::from(i), f64::from(-i % 7), 1.0]).collect();
        let triangles: Vec<[u32; 3]> = (0..990).map(|i| [i, i + 1, i + 5]).collect();
        for count in [0, 1, 5, 6, 100, 990] {
            let triangles = &triangles[990 - count..];
            let corners = triangles.iter().flatten().map(|&v| &positions[v as usize]);
            assert_eq!(Bounds::of_corners(&positions, triangles), Bounds::of(corners), "{count}");
            let out_of_range = [triangles, &[[1_000, 2_000, u32::MAX]]].concat();
            assert_eq!(
                Bounds::of_corners(&positions, &out_of_range),
                Bounds::of_corners(&positions, triangles)
            );
        }
    }

    #[test]
    fn sides_tell_what_is_beyond_a_box() {
        let bounds = Bounds { low: [0.0; 3], high: [1.0, 2.0, 3.0] };
        let sides = |point, reach| bounds.grown(reach).sides_beyond(&point);
        assert_eq!((sides([0.5, 1.0, 1.0], 0.0), sides([0.0, 2.0, 3.0], 0.0)), (0, 0));
        assert_eq!((sides([-0.5, 3.0, 1.0], 0.0), sides([1.0, 1.0, 3.5], 0.0)), (0b1001, 0b100000));
        assert_eq!((sides([-0.5, 3.0, 1.0], 0.75), sides([1.0, 1.0, 3.5], 0.5)), (0b1000, 0));
    }

    #[test]
    fn huge_boxes_do_not_overflow() {
        let bounds = Bounds { low: [-f64::MAX; 3], high: [f64::MAX; 3] };
        assert_eq!(bounds.center(), [0.0; 3]);
        assert_eq!(bounds.diagonal(), f64::INFINITY);
    }
}

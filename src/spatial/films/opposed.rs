//! Which cells of a coarse grid hold triangles with nearly opposite normals: only there may a surface have films and gaps, and most
//! surfaces have no such cell but where a wall is thinner than a cell.

use std::ops::RangeInclusive;

use glam::DVec3;

/// Triangles to a cell that a surface passes, about: so many that few pass several cells.
const TRIANGLES_PER_CELL: usize = 150;
/// A surface such as a ball passes about so many times n^2 cells of a grid of n^3.
const PASSED: usize = 3;
/// Cells along each axis, at most: the grid then has 7 MB.
const MOST_CELLS: usize = 64;

/// The normals of the triangles that pass a cell.
#[derive(Clone, Copy)]
pub(super) struct Normals {
    /// The least and the greatest of each component.
    least: [f32; 3],
    most: [f32; 3],
    /// Whether some triangle is one that has moved.
    moved: bool,
}

impl Normals {
    pub(super) const NOTHING: Self =
        Self { least: [f32::INFINITY; 3], most: [f32::NEG_INFINITY; 3], moved: false };

    pub(super) fn of(normal: [f32; 3], moved: bool) -> Self {
        Self { least: normal, most: normal, moved }
    }

    #[inline]
    pub(super) fn with(self, other: &Self) -> Self {
        Self {
            least: [0, 1, 2].map(|k| self.least[k].min(other.least[k])),
            most: [0, 1, 2].map(|k| self.most[k].max(other.most[k])),
            moved: self.moved || other.moved,
        }
    }

    /// Whether some of one and some of the other may be opposite, but for `slack` in each component, and one of them have moved.
    #[inline]
    pub(super) fn may_oppose(&self, other: &Self, slack: f32) -> bool {
        (self.moved || other.moved)
            && (0..3)
                .all(|k| self.least[k] + other.least[k] <= slack && self.most[k] + other.most[k] >= -slack)
    }
}

/// The normals of triangles in a grid.
pub(super) struct Cells {
    low: DVec3,
    /// Cells for each unit of length along each axis.
    scale: DVec3,
    along: usize,
    normals: Vec<Normals>,
}

/// The cells that a box meets, by axis.
type Range = [RangeInclusive<usize>; 3];

impl Cells {
    /// Cells over a box for about so many triangles.
    pub(super) fn new(low: DVec3, high: DVec3, triangles: usize) -> Self {
        let finest = (triangles / (TRIANGLES_PER_CELL * PASSED)).isqrt().clamp(1, MOST_CELLS);
        let along = 1 << finest.ilog2();
        let extent = high - low;
        let scale = extent.to_array().map(|x| if x > 0.0 && x.is_finite() { along as f64 / x } else { 0.0 });
        Self { low, scale: DVec3::from_array(scale), along, normals: vec![Normals::NOTHING; along.pow(3)] }
    }

    /// The cells that the box between two ends meets. (What is outside the grid is in its outermost cells.)
    #[inline]
    fn range(&self, [least, most]: [DVec3; 2]) -> Range {
        let last = DVec3::splat((self.along - 1) as f64);
        let cell = |point: DVec3| ((point - self.low) * self.scale).clamp(DVec3::ZERO, last).to_array();
        let (from, to) = (cell(least), cell(most));
        [0, 1, 2].map(|k| from[k] as usize..=to[k] as usize)
    }

    /// Adds a triangle in a box; the cell that this meets, if it is one, and how many it meets.
    #[inline]
    pub(super) fn add(&mut self, ends: [DVec3; 2], normals: &Normals) -> (Option<u32>, usize) {
        let range = self.range(ends);
        let (mut count, mut last) = (0, 0);
        for cell in numbers(range, self.along) {
            let of = &mut self.normals[cell];
            *of = of.with(normals);
            (count, last) = (count + 1, cell);
        }
        ((count == 1).then_some(last as u32), count)
    }

    /// Whether a cell holds nearly opposite normals.
    #[inline]
    pub(super) fn is_opposed(&self, cell: u32, slack: f32) -> bool {
        let normals = &self.normals[cell as usize];
        normals.may_oppose(normals, slack)
    }

    /// Whether one of those that a box meets does.
    pub(super) fn is_any_opposed(&self, ends: [DVec3; 2], slack: f32) -> bool {
        numbers(self.range(ends), self.along).any(|cell| self.is_opposed(cell as u32, slack))
    }
}

fn numbers([xs, ys, zs]: Range, along: usize) -> impl Iterator<Item = usize> {
    zs.flat_map(move |z| {
        let xs = xs.clone();
        ys.clone().flat_map(move |y| xs.clone().map(move |x| (z * along + y) * along + x))
    })
}

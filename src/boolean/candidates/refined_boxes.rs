//! Boxes of triangles, several for a large one.
//!
//! The box of a long or large triangle that lies askew is mostly empty, and small triangles of the other operand meet it in
//! vain. Such a triangle is halved until its parts are about as large as those triangles, and every part gets a box.
//!
//! For few large triangles that lie askew against many small ones. With one box for each triangle: 1.2 for a sphere of 330,000
//! triangles less a turned cube.

use glam::Vec3A;
use obvhs::aabb::Aabb;

use crate::spatial::Frame;

/// Pairs of triangles below which all of them are tested sooner than boxes are refined.
const FROM_PAIRS: usize = 1 << 14;
/// Triangles are halved while their box is more than this many times as wide as the other operand's boxes usually are long.
const WIDE: f32 = 2.0;
/// Boxes that stand for all where it is asked how long they usually are.
const SAMPLE: usize = 1_000;
/// Times that a triangle is halved, at most: it then has 64 parts.
const MOST_HALVINGS: u32 = 6;
/// Parts of all large triangles together, at most: this many,
const FEW_PARTS: usize = 4_096;
/// and this many for each triangle of both operands, so that refining never costs more than building the trees.
const PARTS_PER_TRIANGLE: usize = 2;

/// Corners of a triangle in the frame of the boxes.
pub(crate) type Corners = [Vec3A; 3];

/// Coordinates count as at least this large, so that margins do not vanish.
const TINY: f32 = 1e-12;
/// Boxes with the triangles they belong to.
#[derive(Debug, Default)]
pub(crate) struct Boxes {
    pub(crate) triangles: Vec<u32>,
    pub(crate) boxes: Vec<Aabb>,
}

impl Boxes {
    /// One box for each triangle.
    pub(crate) fn new(triangles: &[u32], corners: impl Fn(u32) -> Corners) -> Self {
        let boxes = triangles.iter().map(|&t| box_of(&corners(t))).collect();
        Self { triangles: triangles.to_vec(), boxes }
    }

    /// How long boxes are on the average.
    fn usual_length(&self) -> f32 {
        let sample = self.boxes.iter().step_by(self.boxes.len().div_ceil(SAMPLE).max(1));
        let sum: f64 = sample.clone().map(|aabb| f64::from((aabb.max - aabb.min).max_element())).sum();
        (sum / sample.len().max(1) as f64) as f32
    }

    fn push(&mut self, triangle: u32, aabb: Aabb) {
        self.triangles.push(triangle);
        self.boxes.push(aabb);
    }

    /// Gives triangles that are large next to those of `other` several boxes. Parts outside `common` have none.
    fn refined(self, usual: f32, room: usize, common: &Aabb, corners: impl Fn(u32) -> Corners) -> Self {
        let widest = WIDE * usual;
        let wide = self.boxes.iter().filter(|aabb| width(aabb) > widest).count();
        if wide == 0 {
            return self;
        }
        let halvings = (room / wide).checked_ilog2().unwrap_or(0).min(MOST_HALVINGS);
        let mut refined = Self::default();
        let mut stack = Vec::new();
        for (&triangle, aabb) in self.triangles.iter().zip(&self.boxes) {
            if width(aabb) <= widest || halvings == 0 {
                refined.push(triangle, *aabb);
                continue;
            }
            let whole = corners(triangle);
            if Frame::is_bent(&whole) {
                refined.push(triangle, *aabb);
                continue;
            }
            // Middles are rounded, each time by less than a unit in the last place of a coordinate.
            let largest = whole.iter().fold(0.0f32, |most, corner| most.max(corner.abs().max_element()));
            let margin = Vec3A::splat(2.0 * MOST_HALVINGS as f32 * f32::EPSILON * largest.max(TINY));
            stack.push((whole, halvings));
            while let Some((part, halvings)) = stack.pop() {
                let tight = box_of(&part);
                let part_box =
                    Aabb { min: (tight.min - margin).max(aabb.min), max: (tight.max + margin).min(aabb.max) };
                if !part_box.intersect_aabb(common) {
                    continue;
                }
                if halvings == 0 || width(&part_box) <= widest {
                    refined.push(triangle, part_box);
                } else {
                    stack.extend(halves(&part).map(|half| (half, halvings - 1)));
                }
            }
        }
        refined
    }
}

/// Refines the boxes of both operands against each other. `common` is a box that holds all of interest.
pub(crate) fn refine(both: [Boxes; 2], common: &Aabb, corners: impl Fn(usize, u32) -> Corners) -> [Boxes; 2] {
    let counts = both.each_ref().map(|boxes| boxes.boxes.len());
    if counts[0].saturating_mul(counts[1]) < FROM_PAIRS {
        return both;
    }
    let room = FEW_PARTS + PARTS_PER_TRIANGLE * (counts[0] + counts[1]);
    let usual = both.each_ref().map(Boxes::usual_length);
    let corners = &corners;
    let [a, b] = both;
    [
        a.refined(usual[1], room, common, |t| corners(0, t)),
        b.refined(usual[0], room, common, |t| corners(1, t)),
    ]
}

/// The second largest extent of a box: a needle along an axis has a narrow one.
fn width(aabb: &Aabb) -> f32 {
    let [x, y, z] = (aabb.max - aabb.min).to_array();
    x.min(y).max(x.max(y).min(z))
}

/// The box of a triangle.
pub(crate) fn box_of([a, b, c]: &Corners) -> Aabb {
    Aabb { min: a.min(*b).min(*c), max: a.max(*b).max(*c) }
}

/// A triangle halved across its longest side.
fn halves(part: &Corners) -> [Corners; 2] {
    let length = |k: usize| (part[(k + 1) % 3] - part[k]).length_squared();
    let lengths = [0, 1, 2].map(length);
    let k = (1..3).fold(0, |best, k| if lengths[k] > lengths[best] { k } else { best });
    let [p, q, r] = [0, 1, 2].map(|i| part[(k + i) % 3]);
    let middle = 0.5 * p + 0.5 * q;
    [[p, middle, r], [middle, q, r]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn parts_cover_their_triangle() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut point =
            |size: f32| Vec3A::from_array([(); 3].map(|()| size * rng.random_range(-1.0f32..1.0)));
        for _ in 0..200 {
            let whole: Corners = [point(1.0), point(1.0), point(1.0)];
            let everything = Aabb { min: Vec3A::splat(-2.0), max: Vec3A::splat(2.0) };
            let boxes = Boxes::new(&[7], |_| whole);
            let refined = boxes.refined(0.05, 1_000, &everything, |_| whole);
            assert!(refined.boxes.len() <= 64 && refined.triangles.iter().all(|&t| t == 7));
            for _ in 0..50 {
                let weights = point(1.0).abs();
                let weights = weights / weights.element_sum();
                let inside = whole[0] * weights.x + whole[1] * weights.y + whole[2] * weights.z;
                let slack = Vec3A::splat(4.0 * f32::EPSILON);
                assert!(
                    refined.boxes.iter().any(|aabb| {
                        (inside + slack).cmpge(aabb.min).all() && (inside - slack).cmple(aabb.max).all()
                    }),
                    "{inside} of {whole:?}"
                );
            }
        }
    }

    #[test]
    fn small_and_level_triangles_keep_one_box() {
        let needle = [Vec3A::ZERO, Vec3A::new(1.0, 0.0, 0.0), Vec3A::new(1.0, 0.01, 0.0)];
        let everything = Aabb { min: Vec3A::splat(-2.0), max: Vec3A::splat(2.0) };
        let refined = Boxes::new(&[0], |_| needle).refined(0.05, 1_000, &everything, |_| needle);
        assert_eq!(refined.boxes.len(), 1);
    }
}

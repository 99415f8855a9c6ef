//! Hierarchies of axis-aligned boxes over triangles, and the queries that walk them (Vyatkin 2019, step 1: AABB
//! hierarchies; tighter volumes do not pay where overlap is expected).

mod box_tree;
mod frame;
mod occupancy;

pub(crate) use box_tree::{BoxTree, self_overlapping_pairs, visit_pairs};
pub(crate) use frame::Frame;
pub(crate) use occupancy::Occupancy;

/// For each point a number that sorts points which are near each other near each other.
pub(crate) fn morton_codes(points: &[[f64; 3]]) -> Vec<u64> {
    let low: [f64; 3] = std::array::from_fn(|k| points.iter().fold(f64::INFINITY, |low, p| low.min(p[k])));
    let high: [f64; 3] =
        std::array::from_fn(|k| points.iter().fold(f64::NEG_INFINITY, |high, p| high.max(p[k])));
    let frame = Frame::of(low, high);
    points.iter().map(|point| u64::from(box_tree::morton((frame.point(point) + 2.0) * 255.0))).collect()
}

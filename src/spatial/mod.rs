//! Hierarchies of axis-aligned boxes over triangles, and the queries that walk them (Vyatkin 2019, step 1: AABB
//! hierarchies; tighter volumes do not pay where overlap is expected).
//!
//! [`TriangleTree`] answers nearest-point queries, exact ray crossings and fast winding numbers over the triangles
//! of a mesh. Boxes are single precision about the model's centre, always rounded outward, so that they only ever
//! spare work; distances and signs come from the `f64` vertices. Booleans build simpler trees for one walk each.

#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a NaN fails every comparison, and is meant to be refused"
)]

mod box_pairs;
mod box_tree;
mod branches;
mod build;
mod closest;
mod crossing;
mod disc;
mod fast_winding;
mod films;
mod frame;
mod marks;
mod morton;
mod nearest;
mod occupancy;
mod pack;
mod radix;
mod regions;
mod thickness;
mod triangle;
mod triangle_tree;
mod wide;

pub use closest::Closest;
pub use crossing::{Crossings, Side};
pub use fast_winding::FastWinding;
pub use nearest::{Nearest, SolidDistance};
pub use thickness::Thickness;
pub use triangle::{Feature, closest_on_segment, closest_on_triangle};
pub use triangle_tree::TriangleTree;

pub(crate) use box_pairs::{self_overlapping_pairs, self_overlapping_pairs_apart, visit_pairs};
pub(crate) use box_tree::BoxTree;
pub(crate) use branches::{Branch, Branches};
pub(crate) use build::binary_tree;
pub(crate) use films::{Film, lost_films};
pub(crate) use frame::Frame;
pub(crate) use morton::{code as morton_code, coherent_order};
pub(crate) use occupancy::{Cell, Occupancy};
pub(crate) use pack::LANES;
pub(crate) use radix::sort as radix_sort;
pub(crate) use regions::Regions;
pub(crate) use wide::WideTree;

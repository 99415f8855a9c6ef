//! Hierarchies of axis-aligned boxes over triangles, and the queries that walk them (Vyatkin 2019, step 1: AABB
//! hierarchies; tighter volumes do not pay where overlap is expected).

mod box_tree;
mod frame;

pub(crate) use box_tree::{BoxTree, overlapping_pairs, self_overlapping_pairs};
pub(crate) use frame::Frame;

//! A binary tree of boxes, filled top-down.
//!
//! The nodes are those of `obvhs`, whose traversals and optimisers work on the result. Splitting top-down by the surface area
//! heuristic over sixteen bins, and by halves once a branch gets deep, takes O(n log n) on anything, with depth at most
//! [`HEURISTIC_DEPTH`] + log2 n.
//!
//! The builder of `obvhs` (PLOC: it merges mutual nearest neighbours bottom-up) has no such bound: among equal or nested boxes
//! few are mutual. Measured on 2026-11-27 on an AMD EPYC virtual machine, 2 cores, shared with others (processor time of one
//! thread, least of three; builds include all of a `TriangleTree`; closest points far from and near the mesh, rays from the
//! same points, winding numbers):
//!
//! | | build, ms | closest, us | rays, us | winding, us |
//! |---|---:|---:|---:|---:|
//! | Armadillo, 52,000 triangles: this | 27 | 7.2, 2.9 | 0.5, 2.8 | 4 |
//! | search distance 1 | 26 | 6.9, 3.2 | 0.5, 3.0 | 6 |
//! | search distance 14, then reinsertion | 73 | 9.7, 3.7 | 0.5, 3.0 | 6 |
//! | this, then reinsertion | 37 | 8.5, 3.1 | 0.7, 2.9 | 4 |
//! | Nefertiti, 70,000 triangles: this | 29 | 6.5, 1.9 | 0.5, 1.5 | 4 |
//! | search distance 1 | 56 | 12, 3.5 | 1.0, 2.5 | 8 |
//! | search distance 14, then reinsertion | 72 | 7.0, 2.0 | 0.5, 2.0 | 8 |
//! | double cone of 8,000 triangles: this | 4 | 32, 56 | 12, 16 | 241 |
//! | search distance 1 | 12 | 57, 121 | 21, 18 | 287 |
//! | search distance 14 | 87 | 37, 65 | 14, 20 | 257 |
//! | 20,000 equal triangles: this | 9 | | | |
//! | search distance 1 | not finished | | | |
//!
//! (Not finished: with 2,000 queries it was stopped after about 50 s by the clock, where this took 5 s for three rounds.) All
//! other answers agree. So the nodes, the boxes and the codes are those of `obvhs`, the builder is this.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

use crate::parallel::join;

/// Below this depth a branch is split in halves by count.
const HEURISTIC_DEPTH: usize = 40;
/// Bins tried per split.
const BINS: usize = 16;
/// Branches with more boxes than this are built on several threads.
const PARALLEL_ABOVE: usize = 8192;

/// Contains nothing; the neutral element of the union.
const EMPTY: Aabb = Aabb { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

/// A tree with exactly one box per leaf. `primitive_indices[first_index]` of a leaf is the index of its box.
/// The same boxes give the same tree for any number of threads.
pub(crate) fn binary_tree(boxes: &[Aabb]) -> Bvh2 {
    if boxes.is_empty() {
        return Bvh2::default();
    }
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default(); 2 * boxes.len() - 1];
    if let Some((root, rest)) = nodes.split_first_mut() {
        build(boxes, Branch { order: &mut order, first: 0, root, below: rest, below_first: 1, depth: 0 });
    }
    // The index order is the leaf order already, so leaves point straight into it.
    let max_depth = HEURISTIC_DEPTH + boxes.len().ilog2() as usize + 2;
    Bvh2 { nodes, primitive_indices: order, max_depth, ..Bvh2::default() }
}

/// A part of the tree yet to be built: its boxes, its root, and the room for the nodes below it.
struct Branch<'a> {
    order: &'a mut [u32],
    /// Position of `order[0]` in the whole order.
    first: u32,
    root: &'a mut Bvh2Node,
    below: &'a mut [Bvh2Node],
    /// Index of `below[0]` among the nodes.
    below_first: u32,
    depth: usize,
}

/// Builds one branch, large halves on several threads. The explicit stack holds at most one entry per level.
fn build(boxes: &[Aabb], branch: Branch<'_>) {
    let mut stack = vec![branch];
    while let Some(branch) = stack.pop() {
        if let Some((left, right)) = split(boxes, branch) {
            if left.order.len().min(right.order.len()) > PARALLEL_ABOVE {
                // Nested at most log2(n / PARALLEL_ABOVE) plus the heuristic's depth.
                join(usize::MAX, || build(boxes, left), || build(boxes, right));
                continue;
            }
            stack.push(left);
            stack.push(right);
        }
    }
}

/// Fills the root of `branch` and returns its two halves, or nothing for a leaf.
fn split<'a>(boxes: &[Aabb], branch: Branch<'a>) -> Option<(Branch<'a>, Branch<'a>)> {
    let Branch { order, first, root, below, below_first, depth } = branch;
    let aabb = order.iter().fold(EMPTY, |all, &index| all.union(&boxes[index as usize]));
    if order.len() == 1 {
        *root = Bvh2Node::new(aabb, 1, first);
        return None;
    }
    *root = Bvh2Node::new(aabb, 0, below_first);
    let middle = divide(boxes, order, depth < HEURISTIC_DEPTH);
    let (left_order, right_order) = order.split_at_mut(middle);
    let (pair, rest) = below.split_at_mut(2);
    let (left_below, right_below) = rest.split_at_mut(2 * (middle - 1));
    let (left_root, right_root) = pair.split_at_mut(1);
    let right_first = below_first + 2 + left_below.len() as u32;
    Some((
        Branch {
            order: left_order,
            first,
            root: &mut left_root[0],
            below: left_below,
            below_first: below_first + 2,
            depth: depth + 1,
        },
        Branch {
            order: right_order,
            first: first + middle as u32,
            root: &mut right_root[0],
            below: right_below,
            below_first: right_first,
            depth: depth + 1,
        },
    ))
}

/// Rearranges `order` in two parts and returns where the second begins (never at an end).
fn divide(boxes: &[Aabb], order: &mut [u32], heuristic: bool) -> usize {
    // Twice the centres, which are compared with each other only.
    let centre = |index: u32| boxes[index as usize].min + boxes[index as usize].max;
    let (mut low, mut high) = (Vec3A::splat(f32::INFINITY), Vec3A::splat(f32::NEG_INFINITY));
    for &index in order.iter() {
        (low, high) = (low.min(centre(index)), high.max(centre(index)));
    }
    let extent = (high - low).to_array();
    let axis = (0..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    if heuristic && order.len() > 4 && extent[axis] > 0.0 && extent[axis].is_finite() {
        let scale = BINS as f32 * 0.999 / extent[axis];
        let bin_of = |index: u32| (((centre(index)[axis] - low[axis]) * scale) as usize).min(BINS - 1);
        if let Some(cut) = best_cut(boxes, order, bin_of) {
            let middle = partition(order, |index| bin_of(index) < cut);
            if middle > 0 && middle < order.len() {
                return middle;
            }
        }
    }
    let middle = order.len() / 2;
    order
        .select_nth_unstable_by(middle, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
    middle
}

/// The bin before which to cut, by least expected cost of a query.
fn best_cut(boxes: &[Aabb], order: &[u32], bin_of: impl Fn(u32) -> usize) -> Option<usize> {
    let mut counts = [0usize; BINS];
    let mut bounds = [EMPTY; BINS];
    for &index in order {
        let bin = bin_of(index);
        counts[bin] += 1;
        bounds[bin] = bounds[bin].union(&boxes[index as usize]);
    }
    let mut right_cost = [0f32; BINS];
    let (mut count, mut joined) = (0, EMPTY);
    for bin in (1..BINS).rev() {
        count += counts[bin];
        joined = joined.union(&bounds[bin]);
        right_cost[bin] = count as f32 * half_area(&joined);
    }
    let (mut count, mut joined) = (0, EMPTY);
    let mut best = None;
    for cut in 1..BINS {
        count += counts[cut - 1];
        joined = joined.union(&bounds[cut - 1]);
        if count == 0 || count == order.len() {
            continue;
        }
        let cost = count as f32 * half_area(&joined) + right_cost[cut];
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, cut));
        }
    }
    best.map(|(_, cut)| cut)
}

/// Half the surface area of a box.
fn half_area(aabb: &Aabb) -> f32 {
    let [x, y, z] = aabb.diagonal().to_array();
    x * y + y * z + z * x
}

/// Moves the indices that satisfy `first_part` to the front and returns how many there are.
fn partition(order: &mut [u32], first_part: impl Fn(u32) -> bool) -> usize {
    let mut middle = 0;
    for at in 0..order.len() {
        if first_part(order[at]) {
            order.swap(middle, at);
            middle += 1;
        }
    }
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(tree: &Bvh2) -> usize {
        let mut stack = if tree.nodes.is_empty() { vec![] } else { vec![(0usize, 1usize)] };
        let mut deepest = 0;
        while let Some((node, depth)) = stack.pop() {
            deepest = deepest.max(depth);
            if !tree.nodes[node].is_leaf() {
                let first = tree.nodes[node].first_index as usize;
                stack.extend([(first, depth + 1), (first + 1, depth + 1)]);
            }
        }
        deepest
    }

    fn check(boxes: &[Aabb]) {
        let tree = binary_tree(boxes);
        let report = tree.validate(boxes, false, true);
        assert_eq!(report.prim_count, boxes.len());
        assert!(depth(&tree) <= tree.max_depth, "{} > {}", depth(&tree), tree.max_depth);
    }

    fn cube(centre: [f32; 3], half: f32) -> Aabb {
        let centre = Vec3A::from_array(centre);
        Aabb { min: centre - half, max: centre + half }
    }

    #[test]
    fn trees_are_valid_and_shallow_on_degenerate_boxes() {
        let n = 20_000;
        check(&[]);
        check(&[cube([0.0; 3], 1.0)]);
        check(&vec![cube([0.5; 3], 0.25); n]);
        check(&(0..n).map(|i| cube([0.0; 3], 1.0 + i as f32)).collect::<Vec<_>>());
        check(&(0..n).map(|i| cube([i as f32, 0.0, 0.0], 0.5)).collect::<Vec<_>>());
        let fan = |i: usize| {
            let (sine, cosine) = (i as f32 / n as f32).sin_cos();
            Aabb { min: Vec3A::ZERO, max: Vec3A::new(cosine, sine, 0.0) }
        };
        check(&(0..n).map(fan).collect::<Vec<_>>());
        check(&(0..n).map(|i| cube([(i as f32).exp2(), 0.0, 0.0], 0.1)).take(100).collect::<Vec<_>>());
    }
}

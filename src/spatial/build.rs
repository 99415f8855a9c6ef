//! A binary tree of boxes, filled top-down.
//!
//! The nodes are those of `obvhs`, whose traversals work on the result. Its own builder merges mutual nearest
//! neighbours bottom-up and takes quadratic time on fans, nested and equal boxes; splitting top-down by the
//! surface area heuristic over sixteen bins, and by halves once a branch gets deep, takes O(n log n) on anything,
//! with depth at most [`HEURISTIC_DEPTH`] + log2 n.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

use super::SmallBox;

/// Below this depth a branch is split in halves by count.
const HEURISTIC_DEPTH: usize = 40;
/// Bins tried per split.
const BINS: usize = 16;
/// Branches with more boxes than this are built on several threads.
#[cfg(feature = "parallel")]
const PARALLEL_ABOVE: usize = 8192;

/// A tree with exactly one box per leaf. `primitive_indices[first_index]` of a leaf is the index of its box.
/// The same boxes give the same tree for any number of threads.
pub(crate) fn binary_tree(boxes: &[SmallBox]) -> Bvh2 {
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
fn build(boxes: &[SmallBox], branch: Branch<'_>) {
    let mut stack = vec![branch];
    while let Some(branch) = stack.pop() {
        if let Some((left, right)) = split(boxes, branch) {
            #[cfg(feature = "parallel")]
            if left.order.len().min(right.order.len()) > PARALLEL_ABOVE {
                // Nested at most log2(n / PARALLEL_ABOVE) plus the heuristic's depth.
                rayon::join(|| build(boxes, left), || build(boxes, right));
                continue;
            }
            stack.push(left);
            stack.push(right);
        }
    }
}

/// Fills the root of `branch` and returns its two halves, or nothing for a leaf.
fn split<'a>(boxes: &[SmallBox], branch: Branch<'a>) -> Option<(Branch<'a>, Branch<'a>)> {
    let Branch { order, first, root, below, below_first, depth } = branch;
    let bounds = order.iter().fold(SmallBox::EMPTY, |all, &index| all.joined(&boxes[index as usize]));
    let aabb = Aabb::new(Vec3A::from_array(bounds.low), Vec3A::from_array(bounds.high));
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
fn divide(boxes: &[SmallBox], order: &mut [u32], heuristic: bool) -> usize {
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for &index in order.iter() {
        for axis in 0..3 {
            let centre = boxes[index as usize].doubled_centre(axis);
            low[axis] = low[axis].min(centre);
            high[axis] = high[axis].max(centre);
        }
    }
    let extent: [f32; 3] = std::array::from_fn(|axis| high[axis] - low[axis]);
    let axis = (0..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    if heuristic && order.len() > 4 && extent[axis] > 0.0 && extent[axis].is_finite() {
        let scale = BINS as f32 * 0.999 / extent[axis];
        let bin_of = |index: u32| {
            (((boxes[index as usize].doubled_centre(axis) - low[axis]) * scale) as usize).min(BINS - 1)
        };
        if let Some(cut) = best_cut(boxes, order, bin_of) {
            let middle = partition(order, |index| bin_of(index) < cut);
            if middle > 0 && middle < order.len() {
                return middle;
            }
        }
    }
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&a, &b| {
        let centre = |index: u32| boxes[index as usize].doubled_centre(axis);
        centre(a).total_cmp(&centre(b)).then(a.cmp(&b))
    });
    middle
}

/// The bin before which to cut, by least expected cost of a query.
fn best_cut(boxes: &[SmallBox], order: &[u32], bin_of: impl Fn(u32) -> usize) -> Option<usize> {
    let mut counts = [0usize; BINS];
    let mut bounds = [SmallBox::EMPTY; BINS];
    for &index in order {
        let bin = bin_of(index);
        counts[bin] += 1;
        bounds[bin] = bounds[bin].joined(&boxes[index as usize]);
    }
    let mut right_cost = [0f32; BINS];
    let (mut count, mut joined) = (0, SmallBox::EMPTY);
    for bin in (1..BINS).rev() {
        count += counts[bin];
        joined = joined.joined(&bounds[bin]);
        right_cost[bin] = count as f32 * joined.half_area();
    }
    let (mut count, mut joined) = (0, SmallBox::EMPTY);
    let mut best = None;
    for cut in 1..BINS {
        count += counts[cut - 1];
        joined = joined.joined(&bounds[cut - 1]);
        if count == 0 || count == order.len() {
            continue;
        }
        let cost = count as f32 * joined.half_area() + right_cost[cut];
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, cut));
        }
    }
    best.map(|(_, cut)| cut)
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

    fn check(boxes: &[SmallBox]) {
        let tree = binary_tree(boxes);
        let aabbs: Vec<Aabb> =
            boxes.iter().map(|b| Aabb::new(Vec3A::from_array(b.low), Vec3A::from_array(b.high))).collect();
        let report = tree.validate(&aabbs, false, true);
        assert_eq!(report.prim_count, boxes.len());
        assert!(depth(&tree) <= tree.max_depth, "{} > {}", depth(&tree), tree.max_depth);
    }

    fn cube(centre: [f32; 3], half: f32) -> SmallBox {
        SmallBox { low: centre.map(|x| x - half), high: centre.map(|x| x + half) }
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
            SmallBox { low: [0.0; 3], high: [cosine, sine, 0.0] }
        };
        check(&(0..n).map(fan).collect::<Vec<_>>());
        check(&(0..n).map(|i| cube([(i as f32).exp2(), 0.0, 0.0], 0.1)).take(100).collect::<Vec<_>>());
    }
}

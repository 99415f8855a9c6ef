//! The tree that queries walk: four boxes per node, laid out so that one step tests all four at once.
//!
//! Beside the trees of `obvhs` over the same binary tree (Nefertiti, 70,000 triangles, as `build` says, least of three by the
//! clock): to find what meets 8,000 beams in +x took 3.9 ms here, 3.4 ms by `Bvh2::aabb_traverse`, 2.9 ms in its eight-wide
//! compressed tree, which took 31 ms to make, this one 5 ms. Neither has a search for the closest point, for which this one
//! is made, and a second tree for the rays would pay from about 250,000 rays on.

use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use smallvec::{SmallVec, smallvec};

use super::pack::{LANES, Pack, for_each_bit};

/// Marks a child that is a single primitive.
const LEAF: u32 = 1 << 31;

/// Up to four children with their boxes.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct WideNode {
    pub(super) boxes: Pack,
    child: [u32; LANES],
}

/// What a lane of a node holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Child {
    /// Another node, by index.
    Node(u32),
    /// A primitive, by its position in the leaf order.
    Leaf(u32),
    /// Nothing: the lane is not used.
    None,
}

impl WideNode {
    const EMPTY: Self = Self { boxes: Pack::EMPTY, child: [u32::MAX; LANES] };

    /// The child in `lane`.
    pub(crate) fn child(&self, lane: usize) -> Child {
        match self.child[lane] {
            u32::MAX => Child::None,
            child if child & LEAF == 0 => Child::Node(child),
            child => Child::Leaf(child & !LEAF),
        }
    }
}

/// A tree of [`WideNode`]s; node 0 is the root.
#[derive(Clone, Debug, Default)]
pub(crate) struct WideTree {
    pub(crate) nodes: Vec<WideNode>,
}

impl WideTree {
    /// Gathers the nodes of a binary tree with one primitive per leaf by fours, larger boxes first.
    pub(crate) fn from_binary(tree: &Bvh2) -> Self {
        let mut nodes = Vec::with_capacity(tree.primitive_indices.len() / 2 + 1);
        if tree.nodes.is_empty() {
            return Self { nodes };
        }
        nodes.push(WideNode::EMPTY);
        // Depth first, so that a branch is contiguous in memory.
        let mut stack = vec![(0usize, 0usize)];
        while let Some((source, target)) = stack.pop() {
            let mut lanes = [source; LANES];
            let mut used = 1;
            while used < LANES {
                let half_area = |node: usize| tree.nodes[node].aabb().half_area();
                let widest = (0..used)
                    .filter(|&lane| !tree.nodes[lanes[lane]].is_leaf())
                    .max_by(|&a, &b| half_area(lanes[a]).total_cmp(&half_area(lanes[b])));
                let Some(widest) = widest else { break };
                let first = tree.nodes[lanes[widest]].first_index as usize;
                lanes[widest] = first;
                lanes[used] = first + 1;
                used += 1;
            }
            for (lane, &node) in lanes[..used].iter().enumerate() {
                let node = &tree.nodes[node];
                nodes[target].boxes.set(lane, node.aabb());
                nodes[target].child[lane] = if node.is_leaf() {
                    LEAF | node.first_index
                } else {
                    nodes.push(WideNode::EMPTY);
                    (nodes.len() - 1) as u32
                };
            }
            for lane in (0..used).rev() {
                if let Child::Node(child) = nodes[target].child(lane) {
                    stack.push((lanes[lane], child as usize));
                }
            }
        }
        Self { nodes }
    }

    /// Calls `visit` for every primitive whose box meets `query` (closed boxes).
    pub(crate) fn visit_meeting(&self, query: &Aabb, visit: impl FnMut(u32)) {
        let (low, high) = (query.min.to_array(), query.max.to_array());
        self.visit(|boxes| boxes.meeting(low, high), visit);
    }

    /// Calls `visit` for every primitive whose box `wanted` accepts on the way down: it returns the lanes of a pack, as bits.
    pub(crate) fn visit(&self, wanted: impl Fn(&Pack) -> u32, mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack: SmallVec<[u32; 96]> = smallvec![0];
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            for_each_bit(wanted(&node.boxes), |lane| match node.child(lane as usize) {
                Child::Node(child) => stack.push(child),
                Child::Leaf(primitive) => visit(primitive),
                Child::None => {}
            });
        }
    }
}

//! The tree that queries walk: four boxes per node, laid out so that one step tests all four at once.

use obvhs::bvh2::Bvh2;

/// Children per node.
pub(crate) const LANES: usize = 4;
/// Marks a child that is a single primitive.
const LEAF: u32 = 1 << 31;

/// Up to four children with their boxes, coordinate by coordinate.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct WideNode {
    pub(crate) low: [[f32; LANES]; 3],
    pub(crate) high: [[f32; LANES]; 3],
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
    const EMPTY: Self = Self {
        low: [[f32::INFINITY; LANES]; 3],
        high: [[f32::NEG_INFINITY; LANES]; 3],
        child: [u32::MAX; LANES],
    };

    /// The child in `lane`.
    pub(crate) fn child(&self, lane: usize) -> Child {
        match self.child[lane] {
            u32::MAX => Child::None,
            child if child & LEAF == 0 => Child::Node(child),
            child => Child::Leaf(child & !LEAF),
        }
    }

    /// Squared distances from the point bounded by `low..high` to the four boxes, never more than the true ones
    /// by more than the rounding of a few single-precision operations; infinite for unused lanes.
    pub(crate) fn squared_distances(&self, low: &[f32; 3], high: &[f32; 3]) -> [f32; LANES] {
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
                let (low, high) = (node.aabb().min.to_array(), node.aabb().max.to_array());
                for axis in 0..3 {
                    nodes[target].low[axis][lane] = low[axis];
                    nodes[target].high[axis][lane] = high[axis];
                }
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

    /// Calls `visit` for every primitive whose box `wanted` accepts on the way down.
    pub(crate) fn visit(&self, wanted: impl Fn(&WideNode, usize) -> bool, mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack: smallvec::SmallVec<[u32; 96]> = smallvec::smallvec![0];
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            for lane in 0..LANES {
                if wanted(node, lane) {
                    match node.child(lane) {
                        Child::Node(child) => stack.push(child),
                        Child::Leaf(primitive) => visit(primitive),
                        Child::None => {}
                    }
                }
            }
        }
    }
}

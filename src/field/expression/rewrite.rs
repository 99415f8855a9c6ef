//! Expressions made from expressions: other arguments, the sign form, normalisation.

use rustc_hash::FxHashMap;

use super::{Binary, Graph, Node, NodeId, Unary};

impl Graph {
    /// Nodes that `root` is made of, in an order in which operands come first.
    pub(super) fn reachable(&self, root: NodeId) -> Vec<NodeId> {
        let mut wanted = vec![false; root.0 as usize + 1];
        wanted[root.0 as usize] = true;
        // Operands always have lower numbers than the node they were made for.
        for index in (0..=root.0).rev() {
            if wanted[index as usize] {
                for operand in self.operands(NodeId(index)) {
                    wanted[operand.0 as usize] = true;
                }
            }
        }
        (0..=root.0).filter(|&index| wanted[index as usize]).map(NodeId).collect()
    }

    pub(super) fn operands(&self, id: NodeId) -> smallvec::SmallVec<[NodeId; 3]> {
        match self.node(id) {
            Node::Constant(_) | Node::Axis(_) => smallvec::smallvec![],
            Node::Unary(_, a) => smallvec::smallvec![a],
            Node::Binary(_, a, b) => smallvec::smallvec![a, b],
            Node::Select(a, b, c) => smallvec::smallvec![a, b, c],
            Node::Leaf(_, at) | Node::LeafSlope(_, _, at) => at.into_iter().collect(),
        }
    }

    /// `root` of the point whose coordinates are the nodes `arguments`, in place of x, y and z.
    pub fn substitute(&mut self, root: NodeId, arguments: [NodeId; 3]) -> NodeId {
        let mut new: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in self.reachable(root) {
            let node = match self.node(id) {
                Node::Constant(_) => id,
                Node::Axis(axis) => arguments[usize::from(axis)],
                Node::Unary(operation, a) => self.unary(operation, new[&a]),
                Node::Binary(operation, a, b) => self.binary(operation, new[&a], new[&b]),
                Node::Select(a, b, c) => self.select(new[&a], new[&b], new[&c]),
                Node::Leaf(leaf, at) => self.intern(Node::Leaf(leaf, at.map(|id| new[&id]))),
                Node::LeafSlope(leaf, axis, at) => {
                    self.intern(Node::LeafSlope(leaf, axis, at.map(|id| new[&id])))
                }
            };
            new.insert(id, node);
        }
        new[&root]
    }

    /// Copies `root` of another graph into this one.
    pub fn import(&mut self, other: &Self, root: NodeId) -> NodeId {
        let mut new: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in other.reachable(root) {
            let node = match other.node(id) {
                node @ (Node::Constant(_) | Node::Axis(_)) => self.intern(node),
                Node::Unary(operation, a) => self.unary(operation, new[&a]),
                Node::Binary(operation, a, b) => self.binary(operation, new[&a], new[&b]),
                Node::Select(a, b, c) => self.select(new[&a], new[&b], new[&c]),
                Node::Leaf(leaf, at) => {
                    let leaf = self.known_leaf(&other.leaves[leaf as usize]);
                    self.intern(Node::Leaf(leaf, at.map(|id| new[&id])))
                }
                Node::LeafSlope(leaf, axis, at) => {
                    let leaf = self.known_leaf(&other.leaves[leaf as usize]);
                    self.intern(Node::LeafSlope(leaf, axis, at.map(|id| new[&id])))
                }
            };
            new.insert(id, node);
        }
        new[&root]
    }

    fn known_leaf(&mut self, leaf: &std::sync::Arc<dyn super::Leaf>) -> u32 {
        let node = self.leaf(std::sync::Arc::clone(leaf));
        match self.node(node) {
            Node::Leaf(index, _) => index,
            _ => 0,
        }
    }

    /// `a` where `condition` is not negative, else `b`.
    pub(crate) fn select(&mut self, condition: NodeId, a: NodeId, b: NodeId) -> NodeId {
        match self.as_constant(condition) {
            Some(value) => {
                if value >= 0.0 {
                    a
                } else {
                    b
                }
            }
            None if a == b => a,
            None => self.intern(Node::Select(condition, a, b)),
        }
    }

    /// A function with the sign of `root` everywhere, in which R-functions that reach the root through nothing but
    /// R-functions and negations are minimum and maximum.
    pub fn sign_form(&mut self, root: NodeId) -> NodeId {
        let mut logical = vec![false; root.0 as usize + 1];
        logical[root.0 as usize] = true;
        let order = self.reachable(root);
        for &id in order.iter().rev() {
            if logical[id.0 as usize]
                && let Node::Binary(Binary::And(_) | Binary::Or(_) | Binary::Min | Binary::Max, ..)
                | Node::Unary(Unary::Neg, _) = self.node(id)
            {
                for operand in self.operands(id) {
                    logical[operand.0 as usize] = true;
                }
            }
        }
        let mut new: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in order {
            if !logical[id.0 as usize] {
                continue;
            }
            let node = match self.node(id) {
                Node::Binary(Binary::And(_) | Binary::Min, a, b) => self.min(new[&a], new[&b]),
                Node::Binary(Binary::Or(_) | Binary::Max, a, b) => self.max(new[&a], new[&b]),
                Node::Unary(Unary::Neg, a) => self.neg(new[&a]),
                _ => id,
            };
            new.insert(id, node);
        }
        new[&root]
    }

    /// `root` normalised to first order, `w / sqrt(w^2 + |grad w|^2)`: where `root` is zero and its gradient is not,
    /// the result has a unit gradient, so near the boundary it is the distance to first order.
    pub fn normalised(&mut self, root: NodeId) -> NodeId {
        let mut sum = self.square(root);
        for axis in 0..3 {
            let slope = self.derivative(root, axis);
            let square = self.square(slope);
            sum = self.add(sum, square);
        }
        let length = self.sqrt(sum);
        self.div(root, length)
    }

    /// `argument` repeated with the period `period` about 0: the argument minus its nearest multiple of the period,
    /// and, with `copies`, of at most that many multiples to either side.
    pub fn repeated(&mut self, argument: NodeId, period: f64, copies: Option<u32>) -> NodeId {
        let width = self.constant(period);
        let count = self.div(argument, width);
        let mut nearest = self.round(count);
        if let Some(copies) = copies {
            let (low, high) = (self.constant(-f64::from(copies)), self.constant(f64::from(copies)));
            nearest = self.max(nearest, low);
            nearest = self.min(nearest, high);
        }
        let shift = self.mul(width, nearest);
        self.sub(argument, shift)
    }

    /// `root` of the point mapped by the affine map `rows * point + offset`.
    pub fn affine(&mut self, root: NodeId, rows: [[f64; 3]; 3], offset: [f64; 3]) -> NodeId {
        let axes = self.axes();
        let arguments = std::array::from_fn(|row| {
            let mut sum = self.constant(offset[row]);
            for column in 0..3 {
                if rows[row][column] != 0.0 {
                    let factor = self.constant(rows[row][column]);
                    let term = self.mul(factor, axes[column]);
                    sum = self.add(sum, term);
                }
            }
            sum
        });
        self.substitute(root, arguments)
    }
}

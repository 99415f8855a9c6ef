//! Expressions of the coordinates: a graph in which equal subexpressions are one node.

mod derivative;
mod rewrite;
mod tape;

use std::collections::hash_map::Entry;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::interval::Interval;
use super::rfunction::System;
pub(crate) use tape::{Choice, Scratch, Tape};

/// A node of a [`Graph`]. Valid only in the graph that made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub(crate) u32);

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Unary {
    Neg,
    Abs,
    Square,
    Sqrt,
    Sin,
    Cos,
    Exp,
    Ln,
    Round,
    /// An integer power.
    Powi(i32),
    /// A real power of a number that is not negative; the exponent's bits.
    Powf(u64),
}

/// A function of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    And(SystemKey),
    Or(SystemKey),
}

/// A [`System`] with its parameter as bits, so that it can be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SystemKey {
    Alpha(u64),
    R0,
    R0m(u32),
}

impl SystemKey {
    /// The key, or nothing for minimum and maximum.
    fn of(system: System) -> Option<Self> {
        match system {
            System::R1 => None,
            // The limit is minimum and maximum.
            System::Alpha(1.0) => None,
            System::Alpha(alpha) => Some(Self::Alpha(alpha.to_bits())),
            System::R0 => Some(Self::R0),
            System::R0m(order) => Some(Self::R0m(order)),
        }
    }

    pub(crate) fn system(self) -> System {
        match self {
            Self::Alpha(bits) => System::Alpha(f64::from_bits(bits)),
            Self::R0 => System::R0,
            Self::R0m(order) => System::R0m(order),
        }
    }
}

/// A node: what it computes from which others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    Constant(u64),
    /// Coordinate 0, 1 or 2.
    Axis(u8),
    Unary(Unary, NodeId),
    Binary(Binary, NodeId, NodeId),
    /// The second node where the first is not negative, else the third.
    Select(NodeId, NodeId, NodeId),
    /// A leaf function at the point given by three nodes.
    Leaf(u32, [NodeId; 3]),
    /// A component of a leaf's gradient there.
    LeafSlope(u32, u8, [NodeId; 3]),
}

/// A function of space that an expression uses as a whole, such as the distance of a mesh.
pub trait Leaf: Send + Sync + std::fmt::Debug {
    /// The value at `point`.
    fn value(&self, point: [f64; 3]) -> f64;
    /// The value and the gradient at `point`.
    fn gradient(&self, point: [f64; 3]) -> (f64, [f64; 3]);
    /// Bounds of the value over the box `low..high`.
    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval;
    /// Bounds of the gradient over the box `low..high`; the whole line where it has none.
    fn gradient_bounds(&self, low: [f64; 3], high: [f64; 3]) -> [Interval; 3] {
        let _ = (low, high);
        [Interval::ENTIRE; 3]
    }
}

/// A graph of expressions of `x`, `y` and `z`.
///
/// Nodes are made bottom-up and never change; making an equal node again returns the first one, so shared
/// subexpressions are evaluated once. Constants are folded.
///
/// ```
/// use trisect::field::{Expression, Graph, System};
/// let mut graph = Graph::new();
/// let [x, y, _] = graph.axes();
/// let (x2, y2) = (graph.square(x), graph.square(y));
/// let one = graph.constant(1.0);
/// let (a, b) = (graph.sub(one, x2), graph.sub(one, y2));
/// let square = graph.and(System::R0, a, b);
/// let square = Expression::new(graph, square);
/// assert!(square.at([0.5, 0.5, 0.0]) > 0.0 && square.at([1.5, 0.0, 0.0]) < 0.0);
/// assert_eq!(square.at([1.0, 0.0, 0.0]), 0.0);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    known: FxHashMap<Node, NodeId>,
    leaves: Vec<Arc<dyn Leaf>>,
}

impl Graph {
    /// An empty graph.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no nodes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    pub(crate) fn node(&self, id: NodeId) -> Node {
        self.nodes[id.0 as usize]
    }

    pub(crate) fn intern(&mut self, node: Node) -> NodeId {
        let next = NodeId(u32::try_from(self.nodes.len()).unwrap_or(u32::MAX));
        match self.known.entry(node) {
            Entry::Occupied(entry) => *entry.get(),
            Entry::Vacant(entry) => {
                entry.insert(next);
                self.nodes.push(node);
                next
            }
        }
    }

    pub(crate) fn as_constant(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> NodeId {
        // One zero, so that equal expressions have equal nodes.
        self.intern(Node::Constant((value + 0.0).to_bits()))
    }

    /// The coordinates x, y and z.
    pub fn axes(&mut self) -> [NodeId; 3] {
        [0, 1, 2].map(|axis| self.intern(Node::Axis(axis)))
    }

    pub(crate) fn unary(&mut self, operation: Unary, a: NodeId) -> NodeId {
        if let Some(value) = self.as_constant(a) {
            return self.constant(tape::unary(operation, value));
        }
        match (operation, self.node(a)) {
            (Unary::Neg, Node::Unary(Unary::Neg, inner)) => inner,
            _ => self.intern(Node::Unary(operation, a)),
        }
    }

    pub(crate) fn binary(&mut self, operation: Binary, a: NodeId, b: NodeId) -> NodeId {
        let constants = (self.as_constant(a), self.as_constant(b));
        if let (Some(x), Some(y)) = constants {
            return self.constant(tape::binary(operation, x, y));
        }
        match (operation, constants) {
            (Binary::Add, (Some(0.0), _)) | (Binary::Mul, (Some(1.0), _)) => return b,
            (Binary::Add | Binary::Sub, (_, Some(0.0))) | (Binary::Mul | Binary::Div, (_, Some(1.0))) => {
                return a;
            }
            (Binary::Sub, (Some(0.0), _)) => return self.unary(Unary::Neg, b),
            (Binary::Min | Binary::Max, _) if a == b => return a,
            (Binary::Mul, _) if a == b => return self.unary(Unary::Square, a),
            _ => {}
        }
        // Commutative operations have one order.
        let commutes = matches!(operation, Binary::Add | Binary::Mul);
        let (a, b) = if commutes && b < a { (b, a) } else { (a, b) };
        self.intern(Node::Binary(operation, a, b))
    }

    /// `a + b`.
    pub fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Add, a, b)
    }
    /// `a - b`.
    pub fn sub(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Sub, a, b)
    }
    /// `a b`.
    pub fn mul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Mul, a, b)
    }
    /// `a / b`.
    pub fn div(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Div, a, b)
    }
    /// The lesser.
    pub fn min(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Min, a, b)
    }
    /// The greater.
    pub fn max(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.binary(Binary::Max, a, b)
    }
    /// `-a`, which is also the logical NOT.
    pub fn neg(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Neg, a)
    }
    /// The absolute value.
    pub fn abs(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Abs, a)
    }
    /// `a^2`.
    pub fn square(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Square, a)
    }
    /// The square root.
    pub fn sqrt(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Sqrt, a)
    }
    /// The sine.
    pub fn sin(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Sin, a)
    }
    /// The cosine.
    pub fn cos(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Cos, a)
    }
    /// The exponential.
    pub fn exp(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Exp, a)
    }
    /// The natural logarithm.
    pub fn ln(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Ln, a)
    }
    /// The nearest integer.
    pub fn round(&mut self, a: NodeId) -> NodeId {
        self.unary(Unary::Round, a)
    }

    /// `base` to the power `exponent`. A constant integer exponent takes any base; others are undefined for a
    /// negative one.
    pub fn pow(&mut self, base: NodeId, exponent: NodeId) -> NodeId {
        match self.as_constant(exponent) {
            Some(0.0) => self.constant(1.0),
            Some(1.0) => base,
            Some(2.0) => self.square(base),
            Some(value) if value.fract() == 0.0 && value.abs() <= 1024.0 => {
                self.unary(Unary::Powi(value as i32), base)
            }
            Some(value) => self.unary(Unary::Powf(value.to_bits()), base),
            None => {
                let logarithm = self.ln(base);
                let product = self.mul(exponent, logarithm);
                self.exp(product)
            }
        }
    }

    /// The R-conjunction of two functions.
    pub fn and(&mut self, system: System, a: NodeId, b: NodeId) -> NodeId {
        match SystemKey::of(system) {
            None => self.min(a, b),
            Some(key) => self.binary(Binary::And(key), a, b),
        }
    }

    /// The R-disjunction of two functions.
    pub fn or(&mut self, system: System, a: NodeId, b: NodeId) -> NodeId {
        match SystemKey::of(system) {
            None => self.max(a, b),
            Some(key) => self.binary(Binary::Or(key), a, b),
        }
    }

    /// The conjunction of any number of functions, folded from the left; nothing for none.
    pub fn all(&mut self, system: System, nodes: &[NodeId]) -> Option<NodeId> {
        nodes.iter().copied().reduce(|a, b| self.and(system, a, b))
    }

    /// The disjunction of any number of functions, folded from the left; nothing for none.
    pub fn any(&mut self, system: System, nodes: &[NodeId]) -> Option<NodeId> {
        nodes.iter().copied().reduce(|a, b| self.or(system, a, b))
    }

    /// Rvachev's blending term `a0 / (1 + (f/a1)^2 + (g/a2)^2)`: added to a combination of `f` and `g` it rounds off
    /// their common edge.
    pub fn blending(&mut self, f: NodeId, g: NodeId, amounts: [f64; 3]) -> NodeId {
        let [a0, a1, a2] = amounts.map(|amount| self.constant(amount));
        let (f, g) = (self.div(f, a1), self.div(g, a2));
        let (f, g) = (self.square(f), self.square(g));
        let one = self.constant(1.0);
        let sum = self.add(f, g);
        let sum = self.add(one, sum);
        self.div(a0, sum)
    }

    /// A leaf function at the coordinates.
    pub fn leaf(&mut self, leaf: Arc<dyn Leaf>) -> NodeId {
        let index = match self.leaves.iter().position(|known| Arc::ptr_eq(known, &leaf)) {
            Some(index) => index,
            None => {
                self.leaves.push(leaf);
                self.leaves.len() - 1
            }
        };
        let axes = self.axes();
        self.intern(Node::Leaf(index as u32, axes))
    }
}

/// An expression ready to be evaluated: at points, over boxes, with gradients.
#[derive(Clone, Debug)]
pub struct Expression {
    graph: Arc<Graph>,
    root: NodeId,
    tape: Arc<Tape>,
}

impl Expression {
    /// The function computed by `root` of `graph`.
    #[must_use]
    pub fn new(graph: Graph, root: NodeId) -> Self {
        let tape = Arc::new(Tape::compile(&graph, root));
        Self { graph: Arc::new(graph), root, tape }
    }

    /// The graph and the node the expression is.
    #[must_use]
    pub fn graph(&self) -> (&Graph, NodeId) {
        (&self.graph, self.root)
    }

    /// Number of operations an evaluation takes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tape.len()
    }

    /// Whether there is nothing to evaluate (never).
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tape.len() == 0
    }

    /// The value at `point`.
    #[must_use]
    pub fn at(&self, point: [f64; 3]) -> f64 {
        self.tape.value(point, &mut Scratch::default())
    }

    /// Values at many points, on several threads.
    ///
    /// # Errors
    /// Only the limits of `control`.
    pub fn at_all(&self, points: &[[f64; 3]], control: &crate::Control) -> Result<Vec<f64>, crate::Error> {
        let pieces = super::work::pieces(points.len(), 4096, control, "evaluate", |range| {
            let mut scratch = Scratch::default();
            Ok(points[range].iter().map(|&point| self.tape.value(point, &mut scratch)).collect::<Vec<f64>>())
        })?;
        Ok(pieces.concat())
    }

    /// The value and the gradient at `point` (forward differentiation). Where the function has a kink, the gradient
    /// is that of the branch taken there.
    #[must_use]
    pub fn gradient(&self, point: [f64; 3]) -> (f64, [f64; 3]) {
        let (value, gradient) = self.tape.gradient(point, &mut Scratch::default());
        (value, gradient.to_array())
    }

    /// Bounds of the values over the box `low..high`, rounding included.
    #[must_use]
    pub fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        self.tape.bounds(low, high, &mut Scratch::default())
    }

    /// The expression with R-functions that decide its sign alone replaced by minimum and maximum: the same sign
    /// everywhere, and at every point one operand that wins.
    #[must_use]
    pub fn sign_form(&self) -> Self {
        let mut graph = (*self.graph).clone();
        let root = graph.sign_form(self.root);
        Self::new(graph, root)
    }

    pub(crate) fn tape(&self) -> &Arc<Tape> {
        &self.tape
    }
}

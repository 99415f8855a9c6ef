//! Symbolic derivatives, for expressions that contain a gradient.

use rustc_hash::FxHashMap;

use super::{Binary, Graph, Node, NodeId, Unary};

impl Graph {
    /// The derivative of `root` along coordinate `axis` (0, 1, 2). At kinks that of one of the branches; roots of
    /// zero have the derivative zero. Second derivatives of leaves are taken as zero.
    ///
    /// # Panics
    /// If `axis` is above 2.
    pub fn derivative(&mut self, root: NodeId, axis: u8) -> NodeId {
        assert!(axis < 3, "coordinate {axis}");
        let mut slopes: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in self.reachable(root) {
            let slope = match self.node(id) {
                Node::Constant(_) | Node::LeafSlope(..) => self.constant(0.0),
                Node::Axis(own) => self.constant(if own == axis { 1.0 } else { 0.0 }),
                Node::Unary(operation, a) => self.unary_slope(operation, id, a, slopes[&a]),
                Node::Binary(operation, a, b) => {
                    self.binary_slope(operation, id, (a, slopes[&a]), (b, slopes[&b]))
                }
                Node::Select(condition, a, b) => self.select(condition, slopes[&a], slopes[&b]),
                Node::Leaf(leaf, at) => {
                    let mut sum = self.constant(0.0);
                    for k in 0..3 {
                        let component = self.intern(Node::LeafSlope(leaf, k as u8, at));
                        let term = self.product(component, slopes[&at[k]]);
                        sum = self.add(sum, term);
                    }
                    sum
                }
            };
            slopes.insert(id, slope);
        }
        slopes[&root]
    }

    /// A product in which a zero factor makes the whole zero.
    fn product(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.as_constant(a) == Some(0.0) || self.as_constant(b) == Some(0.0) {
            return self.constant(0.0);
        }
        self.mul(a, b)
    }

    fn unary_slope(&mut self, operation: Unary, whole: NodeId, a: NodeId, slope: NodeId) -> NodeId {
        if self.as_constant(slope) == Some(0.0) {
            return slope;
        }
        let one = self.constant(1.0);
        let factor = match operation {
            Unary::Neg => self.constant(-1.0),
            Unary::Abs => {
                let minus = self.constant(-1.0);
                self.select(a, one, minus)
            }
            Unary::Square => {
                let two = self.constant(2.0);
                self.mul(two, a)
            }
            Unary::Sqrt => {
                // Zero at zero: the slope is taken where the root is at least the least normal number.
                let tiny = self.constant(f64::MIN_POSITIVE);
                let half = self.constant(0.5);
                let quotient = self.div(half, whole);
                let zero = self.constant(0.0);
                let positive = self.sub(whole, tiny);
                self.select(positive, quotient, zero)
            }
            Unary::Sin => self.cos(a),
            Unary::Cos => {
                let sine = self.sin(a);
                self.neg(sine)
            }
            Unary::Exp => whole,
            Unary::Ln => self.div(one, a),
            Unary::Round => self.constant(0.0),
            Unary::Powi(exponent) => {
                let (factor, lower) =
                    (self.constant(f64::from(exponent)), self.constant(f64::from(exponent - 1)));
                let power = self.pow(a, lower);
                self.mul(factor, power)
            }
            Unary::Powf(bits) => {
                let exponent = f64::from_bits(bits);
                let (factor, lower) = (self.constant(exponent), self.constant(exponent - 1.0));
                let power = self.pow(a, lower);
                self.mul(factor, power)
            }
        };
        self.product(factor, slope)
    }

    fn binary_slope(
        &mut self,
        operation: Binary,
        whole: NodeId,
        (a, da): (NodeId, NodeId),
        (b, db): (NodeId, NodeId),
    ) -> NodeId {
        match operation {
            Binary::Add => self.add(da, db),
            Binary::Sub => self.sub(da, db),
            Binary::Mul => {
                let (left, right) = (self.product(da, b), self.product(a, db));
                self.add(left, right)
            }
            Binary::Div => {
                let carried = self.product(whole, db);
                let difference = self.sub(da, carried);
                self.div(difference, b)
            }
            Binary::Min => {
                let order = self.sub(b, a);
                self.select(order, da, db)
            }
            Binary::Max => {
                let order = self.sub(a, b);
                self.select(order, da, db)
            }
            Binary::And(key) | Binary::Or(key) => {
                let side = if matches!(operation, Binary::And(_)) { -1.0 } else { 1.0 };
                self.r_slope(key.system(), side, (a, da), (b, db))
            }
        }
    }

    /// The derivative of an R-function through its formula.
    fn r_slope(
        &mut self,
        system: crate::field::System,
        side: f64,
        (a, da): (NodeId, NodeId),
        (b, db): (NodeId, NodeId),
    ) -> NodeId {
        use crate::field::System;
        let (alpha, order) = match system {
            System::Alpha(alpha) => (alpha, 0),
            System::R1 => (1.0, 0),
            System::R0 => (0.0, 0),
            System::R0m(order) => (0.0, order),
        };
        let (a2, b2) = (self.square(a), self.square(b));
        let squares = self.add(a2, b2);
        let product = self.mul(a, b);
        let cross = self.constant(2.0 * alpha);
        let cross = self.product(cross, product);
        let radicand = self.sub(squares, cross);
        let root = self.sqrt(radicand);
        let signed = self.constant(side);
        let signed = self.mul(signed, root);
        let sum = self.add(a, b);
        let sum = self.add(sum, signed);
        let scale = self.constant(1.0 / (1.0 + alpha));
        let mut value = self.mul(sum, scale);
        if order > 0 {
            let exponent = self.constant(f64::from(order));
            let length = self.sqrt(squares);
            let power = self.pow(length, exponent);
            value = self.mul(value, power);
        }
        // The formula's nodes above a and b, differentiated with da and db given.
        let mut slopes: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        slopes.insert(a, da);
        slopes.insert(b, db);
        for id in self.reachable(value) {
            if slopes.contains_key(&id) {
                continue;
            }
            let slope = match self.node(id) {
                Node::Unary(operation, x) => match slopes.get(&x) {
                    Some(&dx) => self.unary_slope(operation, id, x, dx),
                    None => self.constant(0.0),
                },
                Node::Binary(operation @ (Binary::Add | Binary::Sub | Binary::Mul | Binary::Div), x, y) => {
                    let zero = self.constant(0.0);
                    let dx = slopes.get(&x).copied().unwrap_or(zero);
                    let dy = slopes.get(&y).copied().unwrap_or(zero);
                    self.binary_slope(operation, id, (x, dx), (y, dy))
                }
                // Below a and b, or a constant of the formula: not part of the chain.
                _ => self.constant(0.0),
            };
            slopes.insert(id, slope);
        }
        slopes[&value]
    }
}

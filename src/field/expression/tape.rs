//! Evaluation: the nodes of an expression as a list of instructions, run over any kind of number.

use std::sync::Arc;

use glam::DVec3;

use super::{Binary, Graph, Leaf, Node, NodeId, Unary};
use crate::field::dual::{Dual, Slope};
use crate::field::interval::Interval;
use crate::field::number::Number;
use crate::field::rfunction::RFunctions;

/// One instruction; operands are positions of earlier instructions.
#[derive(Clone, Copy, Debug)]
enum Instruction {
    Constant(f64),
    Axis(u8),
    Unary(Unary, u32),
    Arithmetic(Binary, u32, u32),
    /// Minimum, maximum or absolute value: takes one of two branches. The last number counts the branchings.
    Min(u32, u32, u32),
    Max(u32, u32, u32),
    Abs(u32, u32),
    Select(u32, u32, u32),
    Leaf(u32, [u32; 3]),
    LeafSlope(u32, u8, [u32; 3]),
}

/// Which branch a minimum, a maximum or an absolute value takes (for the latter: left is the argument itself).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Choice {
    Left,
    Right,
    Both,
}

/// An expression compiled for evaluation.
#[derive(Clone, Debug)]
pub(crate) struct Tape {
    code: Vec<Instruction>,
    branchings: u32,
    leaves: Arc<[Arc<dyn Leaf>]>,
}

/// Room for intermediate values, to be reused between evaluations.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    values: Vec<f64>,
    duals: Vec<Dual<DVec3>>,
    intervals: Vec<Interval>,
    slope_bounds: Vec<Dual<[Interval; 3]>>,
    /// The branches taken in the last evaluation that records them.
    pub(crate) choices: Vec<Choice>,
}

/// A number with everything a leaf needs to be evaluated over it.
trait Field: RFunctions {
    fn leaf(leaf: &dyn Leaf, at: [Self; 3]) -> Self;
    fn leaf_slope(leaf: &dyn Leaf, axis: usize, at: [Self; 3]) -> Self;
    /// -1 if certainly less, 1 if certainly greater or equal, 0 if either.
    fn compare(self, other: Self) -> i8;
    fn join(self, other: Self) -> Self;
}

impl Field for f64 {
    fn leaf(leaf: &dyn Leaf, at: [Self; 3]) -> Self {
        leaf.value(at)
    }
    fn leaf_slope(leaf: &dyn Leaf, axis: usize, at: [Self; 3]) -> Self {
        leaf.gradient(at).1[axis]
    }
    fn compare(self, other: Self) -> i8 {
        if self < other { -1 } else { 1 }
    }
    fn join(self, _: Self) -> Self {
        self
    }
}

impl Field for Interval {
    fn leaf(leaf: &dyn Leaf, at: [Self; 3]) -> Self {
        leaf.bounds(at.map(|x| x.low), at.map(|x| x.high))
    }
    fn leaf_slope(leaf: &dyn Leaf, axis: usize, at: [Self; 3]) -> Self {
        leaf.gradient_bounds(at.map(|x| x.low), at.map(|x| x.high))[axis]
    }
    fn compare(self, other: Self) -> i8 {
        if self.high < other.low {
            -1
        } else if self.low >= other.high {
            1
        } else {
            0
        }
    }
    fn join(self, other: Self) -> Self {
        self.hull(other)
    }
}

impl Field for Dual<DVec3> {
    fn leaf(leaf: &dyn Leaf, at: [Self; 3]) -> Self {
        let (value, gradient) = leaf.gradient(at.map(|x| x.value));
        let slope = (0..3).fold(DVec3::ZERO, |sum, k| sum + at[k].slope.times(gradient[k]));
        Self { value, slope }
    }
    fn leaf_slope(leaf: &dyn Leaf, axis: usize, at: [Self; 3]) -> Self {
        Self::constant(leaf.gradient(at.map(|x| x.value)).1[axis])
    }
    fn compare(self, other: Self) -> i8 {
        self.value.compare(other.value)
    }
    fn join(self, _: Self) -> Self {
        self
    }
}

impl Field for Dual<[Interval; 3]> {
    fn leaf(leaf: &dyn Leaf, at: [Self; 3]) -> Self {
        let (low, high) = (at.map(|x| x.value.low), at.map(|x| x.value.high));
        let gradient = leaf.gradient_bounds(low, high);
        let slope = (0..3).fold(<[Interval; 3]>::ZERO, |sum, k| sum.plus(at[k].slope.times(gradient[k])));
        Self { value: leaf.bounds(low, high), slope }
    }
    fn leaf_slope(leaf: &dyn Leaf, axis: usize, at: [Self; 3]) -> Self {
        let value = Interval::leaf_slope(leaf, axis, at.map(|x| x.value));
        Self { value, slope: [Interval::ENTIRE; 3] }
    }
    fn compare(self, other: Self) -> i8 {
        self.value.compare(other.value)
    }
    fn join(self, other: Self) -> Self {
        Self { value: self.value.hull(other.value), slope: self.slope.either(other.slope) }
    }
}

/// Applies a function of one argument.
pub(super) fn unary<N: Number>(operation: Unary, a: N) -> N {
    match operation {
        Unary::Neg => a.neg(),
        Unary::Abs => a.abs(),
        Unary::Square => a.square(),
        Unary::Sqrt => a.sqrt(),
        Unary::Sin => a.sin(),
        Unary::Cos => a.cos(),
        Unary::Exp => a.exp(),
        Unary::Ln => a.ln(),
        Unary::Round => a.round(),
        Unary::Powi(exponent) => a.powi(exponent),
        Unary::Powf(bits) => a.powf(f64::from_bits(bits)),
    }
}

/// Applies a function of two arguments.
pub(super) fn binary<N: RFunctions>(operation: Binary, a: N, b: N) -> N {
    match operation {
        Binary::Add => a.add(b),
        Binary::Sub => a.sub(b),
        Binary::Mul => a.mul(b),
        Binary::Div => a.div(b),
        Binary::Min => a.minimum(b),
        Binary::Max => a.maximum(b),
        Binary::And(key) => a.combine(key.system(), -1.0, b),
        Binary::Or(key) => a.combine(key.system(), 1.0, b),
    }
}

impl Tape {
    /// The instructions for `root`, each node once.
    pub(super) fn compile(graph: &Graph, root: NodeId) -> Self {
        let order = graph.reachable(root);
        let mut position = vec![0u32; root.0 as usize + 1];
        let mut branchings = 0;
        let mut next = || {
            branchings += 1;
            branchings - 1
        };
        let code = order
            .iter()
            .enumerate()
            .map(|(index, &id)| {
                position[id.0 as usize] = index as u32;
                let at = |id: NodeId| position[id.0 as usize];
                match graph.node(id) {
                    Node::Constant(bits) => Instruction::Constant(f64::from_bits(bits)),
                    Node::Axis(axis) => Instruction::Axis(axis),
                    Node::Unary(Unary::Abs, a) => Instruction::Abs(at(a), next()),
                    Node::Unary(operation, a) => Instruction::Unary(operation, at(a)),
                    Node::Binary(Binary::Min, a, b) => Instruction::Min(at(a), at(b), next()),
                    Node::Binary(Binary::Max, a, b) => Instruction::Max(at(a), at(b), next()),
                    Node::Binary(operation, a, b) => Instruction::Arithmetic(operation, at(a), at(b)),
                    Node::Select(a, b, c) => Instruction::Select(at(a), at(b), at(c)),
                    Node::Leaf(leaf, point) => Instruction::Leaf(leaf, point.map(at)),
                    Node::LeafSlope(leaf, axis, point) => Instruction::LeafSlope(leaf, axis, point.map(at)),
                }
            })
            .collect();
        Self { code, branchings, leaves: graph.leaves.clone().into() }
    }

    /// Number of instructions.
    pub(crate) fn len(&self) -> usize {
        self.code.len()
    }

    /// Whether there is a leaf, such as the distance of a mesh.
    pub(crate) fn has_leaf(&self) -> bool {
        self.code.iter().any(|instruction| matches!(instruction, Instruction::Leaf(..)))
    }

    /// Number of minima, maxima and absolute values.
    pub(crate) fn branchings(&self) -> usize {
        self.branchings as usize
    }

    /// Runs the instructions. `branch` is given every branching's number and its comparison (as of
    /// [`Field::compare`]) and says which branch counts.
    fn run<N: Field>(
        &self,
        axes: [N; 3],
        values: &mut Vec<N>,
        mut branch: impl FnMut(u32, i8) -> Choice,
    ) -> N {
        values.clear();
        for instruction in &self.code {
            let value = match *instruction {
                Instruction::Constant(value) => N::constant(value),
                Instruction::Axis(axis) => axes[usize::from(axis)],
                Instruction::Unary(operation, a) => unary(operation, values[a as usize]),
                Instruction::Arithmetic(operation, a, b) => {
                    binary(operation, values[a as usize], values[b as usize])
                }
                Instruction::Min(a, b, number) => {
                    let (a, b) = (values[a as usize], values[b as usize]);
                    match branch(number, b.compare(a)) {
                        Choice::Left => a,
                        Choice::Right => b,
                        Choice::Both => a.minimum(b),
                    }
                }
                Instruction::Max(a, b, number) => {
                    let (a, b) = (values[a as usize], values[b as usize]);
                    match branch(number, a.compare(b)) {
                        Choice::Left => a,
                        Choice::Right => b,
                        Choice::Both => a.maximum(b),
                    }
                }
                Instruction::Abs(a, number) => {
                    let a = values[a as usize];
                    match branch(number, a.compare(N::constant(0.0))) {
                        Choice::Left => a,
                        Choice::Right => a.neg(),
                        Choice::Both => a.abs(),
                    }
                }
                Instruction::Select(condition, a, b) => {
                    let (a, b) = (values[a as usize], values[b as usize]);
                    match values[condition as usize].compare(N::constant(0.0)) {
                        1 => a,
                        -1 => b,
                        _ => a.join(b),
                    }
                }
                Instruction::Leaf(leaf, at) => {
                    N::leaf(self.leaves[leaf as usize].as_ref(), at.map(|k| values[k as usize]))
                }
                Instruction::LeafSlope(leaf, axis, at) => N::leaf_slope(
                    self.leaves[leaf as usize].as_ref(),
                    usize::from(axis),
                    at.map(|k| values[k as usize]),
                ),
            };
            values.push(value);
        }
        values.last().copied().unwrap_or(N::constant(f64::NAN))
    }

    /// The value at `point`.
    pub(crate) fn value(&self, point: [f64; 3], scratch: &mut Scratch) -> f64 {
        // Both: the numbers' own minimum and maximum, which keep a NaN.
        self.run(point, &mut scratch.values, |_, _| Choice::Both)
    }

    /// The value and gradient at `point`; records the branches taken.
    pub(crate) fn gradient(&self, point: [f64; 3], scratch: &mut Scratch) -> (f64, DVec3) {
        scratch.choices.clear();
        let choices = &mut scratch.choices;
        let result = self.run(axes(point), &mut scratch.duals, |_, comparison| {
            let choice = if comparison > 0 { Choice::Left } else { Choice::Right };
            choices.push(choice);
            choice
        });
        (result.value, result.slope)
    }

    /// The value and gradient at `point` of the branch given by `choices`, whether it wins there or not.
    pub(crate) fn gradient_of_branch(
        &self,
        point: [f64; 3],
        choices: &[Choice],
        scratch: &mut Scratch,
    ) -> (f64, DVec3) {
        let result = self.run(axes(point), &mut scratch.duals, |number, _| choices[number as usize]);
        (result.value, result.slope)
    }

    /// Bounds of the values over a box; records which branches are certain.
    pub(crate) fn bounds(&self, low: [f64; 3], high: [f64; 3], scratch: &mut Scratch) -> Interval {
        scratch.choices.clear();
        let choices = &mut scratch.choices;
        let axes = std::array::from_fn(|axis| Interval::new(low[axis], high[axis]));
        self.run(axes, &mut scratch.intervals, |_, comparison| {
            let choice = certain(comparison);
            choices.push(choice);
            choice
        })
    }

    /// Bounds of the gradient over a box: of the branch given by `choices`, or of all branches that may win there
    /// if `choices` is empty.
    pub(crate) fn gradient_bounds(
        &self,
        low: [f64; 3],
        high: [f64; 3],
        choices: &[Choice],
        scratch: &mut Scratch,
    ) -> [Interval; 3] {
        let axes = std::array::from_fn(|axis| {
            let mut slope = <[Interval; 3]>::ZERO;
            slope[axis] = Interval::constant(1.0);
            Dual { value: Interval::new(low[axis], high[axis]), slope }
        });
        let result = self.run(axes, &mut scratch.slope_bounds, |number, comparison| {
            choices.get(number as usize).copied().unwrap_or_else(|| certain(comparison))
        });
        result.slope
    }

    /// The tape with the certain branches of `choices` followed and everything only the others need left out: equal
    /// to this one, to the bit, wherever those branches win. Nothing if no branch is certain.
    pub(crate) fn simplified(&self, choices: &[Choice]) -> Option<Self> {
        if choices.iter().all(|&choice| choice == Choice::Both) {
            return None;
        }
        let count = self.code.len();
        // Where each instruction's value comes from once branches are followed.
        let mut source: Vec<u32> = (0..count as u32).collect();
        let mut code = self.code.clone();
        for index in 0..count {
            let from = |k: u32| source[k as usize];
            match &mut code[index] {
                Instruction::Constant(_) | Instruction::Axis(_) => {}
                Instruction::Unary(_, a) => *a = from(*a),
                Instruction::Arithmetic(_, a, b) => (*a, *b) = (from(*a), from(*b)),
                Instruction::Select(a, b, c) => (*a, *b, *c) = (from(*a), from(*b), from(*c)),
                Instruction::Leaf(_, at) | Instruction::LeafSlope(_, _, at) => *at = at.map(from),
                Instruction::Min(a, b, number) | Instruction::Max(a, b, number) => {
                    (*a, *b) = (from(*a), from(*b));
                    match choices[*number as usize] {
                        Choice::Left => source[index] = *a,
                        Choice::Right => source[index] = *b,
                        Choice::Both => {}
                    }
                }
                Instruction::Abs(a, number) => {
                    *a = from(*a);
                    match choices[*number as usize] {
                        Choice::Left => source[index] = *a,
                        Choice::Right => code[index] = Instruction::Unary(Unary::Neg, *a),
                        Choice::Both => {}
                    }
                }
            }
        }
        let mut wanted = vec![false; count];
        let root = source[count - 1];
        wanted[root as usize] = true;
        for index in (0..count).rev().filter(|&index| index <= root as usize) {
            if wanted[index] {
                for operand in operands(&code[index]) {
                    wanted[operand as usize] = true;
                }
            }
        }
        let mut position = vec![0u32; count];
        let mut kept = Vec::new();
        let mut branchings = 0;
        for index in (0..count).filter(|&index| wanted[index]) {
            position[index] = kept.len() as u32;
            kept.push(renumbered(code[index], &position, &mut branchings));
        }
        Some(Self { code: kept, branchings, leaves: Arc::clone(&self.leaves) })
    }
}

fn axes(point: [f64; 3]) -> [Dual<DVec3>; 3] {
    std::array::from_fn(|axis| Dual { value: point[axis], slope: DVec3::AXES[axis] })
}

fn certain(comparison: i8) -> Choice {
    match comparison {
        1 => Choice::Left,
        -1 => Choice::Right,
        _ => Choice::Both,
    }
}

fn operands(instruction: &Instruction) -> smallvec::SmallVec<[u32; 3]> {
    match *instruction {
        Instruction::Constant(_) | Instruction::Axis(_) => smallvec::smallvec![],
        Instruction::Unary(_, a) | Instruction::Abs(a, _) => smallvec::smallvec![a],
        Instruction::Arithmetic(_, a, b) | Instruction::Min(a, b, _) | Instruction::Max(a, b, _) => {
            smallvec::smallvec![a, b]
        }
        Instruction::Select(a, b, c) => smallvec::smallvec![a, b, c],
        Instruction::Leaf(_, at) | Instruction::LeafSlope(_, _, at) => at.into_iter().collect(),
    }
}

/// The instruction with operands at their new positions and its branching counted anew.
fn renumbered(instruction: Instruction, position: &[u32], branchings: &mut u32) -> Instruction {
    let at = |k: u32| position[k as usize];
    let mut next = || {
        *branchings += 1;
        *branchings - 1
    };
    match instruction {
        Instruction::Constant(_) | Instruction::Axis(_) => instruction,
        Instruction::Unary(operation, a) => Instruction::Unary(operation, at(a)),
        Instruction::Abs(a, _) => Instruction::Abs(at(a), next()),
        Instruction::Arithmetic(operation, a, b) => Instruction::Arithmetic(operation, at(a), at(b)),
        Instruction::Min(a, b, _) => Instruction::Min(at(a), at(b), next()),
        Instruction::Max(a, b, _) => Instruction::Max(at(a), at(b), next()),
        Instruction::Select(a, b, c) => Instruction::Select(at(a), at(b), at(c)),
        Instruction::Leaf(leaf, point) => Instruction::Leaf(leaf, point.map(at)),
        Instruction::LeafSlope(leaf, axis, point) => Instruction::LeafSlope(leaf, axis, point.map(at)),
    }
}

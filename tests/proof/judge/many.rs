//! Operands of several bodies that overlap and touch, and expressions of several operands, from a seed.
//!
//! All bodies are turned outwards, so an operand is the union of its bodies: another engine is given these one by one.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::{Expression, Mesh};

use super::cases::Family;
use super::placement::{anywhere, mapped, moved, rotated, rotation, turned_on_grid};
use super::shapes;

/// The seeds from here on are those of [`Many`].
pub(crate) const MANY_FROM: u64 = 1 << 33;

/// Bodies by operand, and a set made of the operands.
#[derive(Clone, Debug)]
pub(crate) struct Many {
    pub(crate) family: Family,
    pub(crate) operands: Vec<Vec<Mesh>>,
    pub(crate) expression: Expression,
}

/// How bodies are placed.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// On small integers: contacts are exact.
    Grid,
    /// Anywhere.
    Generic,
    /// On small integers, then all turned together: contacts are off by rounding.
    Turned,
}

impl Many {
    /// The case of a seed.
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let random = &mut random;
        let place = match random.random_range(0..20) {
            0..10 => Place::Grid,
            10..17 => Place::Generic,
            _ => Place::Turned,
        };
        let (family, counts): (Family, Vec<usize>) = match random.random_range(0..3) {
            0 => (Family::Bodies, (0..2).map(|_| random.random_range(1..5)).collect()),
            1 => (Family::Several, vec![1; random.random_range(3..9)]),
            _ => (Family::Mixed, (0..random.random_range(2..6)).map(|_| random.random_range(1..4)).collect()),
        };
        let mut operands: Vec<Vec<Mesh>> =
            counts.iter().map(|&count| (0..count).map(|_| body(place, random)).collect()).collect();
        if place == Place::Turned {
            let matrix = rotation(random);
            let factor = [1.0, 0.1, 1.0 / 3.0][random.random_range(0..3)];
            let turned = |mesh: &Mesh| mapped(&rotated(mesh, &matrix), false, |p| p.map(|x| x * factor));
            operands = operands.iter().map(|bodies| bodies.iter().map(turned).collect()).collect();
        }
        let all = (0..operands.len()).map(Expression::Operand).collect();
        let expression = match random.random_range(0..if family == Family::Bodies { 4 } else { 6 }) {
            0 => Expression::Union(all),
            1 => Expression::Intersection(all),
            2 => Expression::Difference(all),
            3 => Expression::SymmetricDifference(all),
            _ => expression(random, operands.len(), 3),
        };
        Self { family, operands, expression }
    }

    /// Each operand as one mesh.
    pub(crate) fn merged(&self) -> Vec<Mesh> {
        let one = |bodies: &Vec<Mesh>| {
            bodies.iter().fold(Mesh::default(), |mut sum, body| {
                sum.append(body).expect("small");
                sum
            })
        };
        self.operands.iter().map(one).collect()
    }

    /// How often a result winds round a point that the operands wind round so often.
    pub(crate) fn expected(&self, windings: &[i32]) -> i32 {
        i32::from(self.expression.contains(&|operand| windings[operand] >= 1))
    }
}

fn body(place: Place, random: &mut ChaCha8Rng) -> Mesh {
    if place == Place::Generic {
        return anywhere(&shapes::round_or_any(random), 0.8, random);
    }
    let step = if random.random_range(0..4) == 0 { 0.5 } else { 1.0 };
    let by = [0; 3].map(|_| step * f64::from(random.random_range(-3..4)));
    moved(&turned_on_grid(&shapes::on_grid(random), random), by)
}

fn expression(random: &mut ChaCha8Rng, operands: usize, depth: u32) -> Expression {
    if depth == 0 || (depth < 3 && random.random_range(0..3) == 0) {
        return Expression::Operand(random.random_range(0..operands));
    }
    let count = random.random_range(2..4);
    let sets: Vec<_> = (0..count).map(|_| expression(random, operands, depth - 1)).collect();
    match random.random_range(0..5) {
        0 => Expression::Union(sets),
        1 => Expression::Intersection(sets),
        2 => Expression::Difference(sets),
        3 => Expression::SymmetricDifference(sets),
        _ => Expression::AtLeast(random.random_range(1..=count), sets),
    }
}

/// An expression as JSON: the number of an operand, or a list of a sign, for `#` a count, and what it is of.
pub(crate) fn json(expression: &Expression) -> String {
    let list = |sign: &str, sets: &[Expression]| {
        let sets: Vec<String> = sets.iter().map(json).collect();
        format!("[{sign},{}]", sets.join(","))
    };
    match expression {
        Expression::Operand(operand) => operand.to_string(),
        Expression::Union(sets) => list("\"+\"", sets),
        Expression::Intersection(sets) => list("\"&\"", sets),
        Expression::Difference(sets) => list("\"-\"", sets),
        Expression::SymmetricDifference(sets) => list("\"^\"", sets),
        Expression::AtLeast(count, sets) => list(&format!("\"#\",{count}"), sets),
        other => unreachable!("no case has {other:?}"),
    }
}

//! Booleans of solids.

mod assemble;
mod crossings;
mod cut;
mod cut_edges;
mod cut_faces;
mod directions;
mod identify;
mod multiplicity;
mod operands;
mod overlap;
mod pair;
mod tidy;
mod winding;
#[cfg(test)]
mod scratch_tests;

use crate::control::Control;
use crate::{Error, Solid};

/// A regularised boolean operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// What is in either.
    Union,
    /// What is in both.
    Intersection,
    /// What is in the first and in none of the others.
    Difference,
    /// What is in exactly one (of two), or in an odd number of them.
    SymmetricDifference,
}

/// Where a triangle of a result came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Origin {
    /// Position of the operand in the argument list.
    pub operand: u32,
    /// Index of the triangle in that operand's mesh.
    pub triangle: u32,
    /// Whether the result's triangle faces the other way.
    pub reversed: bool,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PairOrigin(Origin);

/// The result of a boolean.
#[derive(Clone, Debug)]
pub struct Outcome {
    solid: Solid,
    origins: Vec<Origin>,
}

impl Outcome {
    /// The result; an empty one is a success.
    #[must_use]
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// The result, by value.
    #[must_use]
    pub fn into_solid(self) -> Solid {
        self.solid
    }

    /// For every triangle of the result, where it came from.
    #[must_use]
    pub fn origins(&self) -> &[Origin] {
        &self.origins
    }
}

/// Settings of a boolean. The default has no limits and uses every thread of the current pool.
#[derive(Clone, Debug, Default)]
pub struct Options {
    control: Control,
    threads: Option<usize>,
}

impl Options {
    /// Default settings.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Limits and progress.
    #[must_use]
    pub fn control(mut self, control: Control) -> Self {
        self.control = control;
        self
    }

    /// Exactly this many threads (1: the caller's own, no pool). Without it, the rayon pool the caller is in.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// Runs `operation` over any number of operands (for a difference: the first minus all the others).
    ///
    /// # Errors
    /// Only limits: [`Error::Cancelled`], [`Error::DeadlineExceeded`], [`Error::MemoryLimit`]; and
    /// [`Error::InvalidArgument`] for an empty list.
    pub fn run(&self, operation: Operation, operands: &[&Solid]) -> Result<Outcome, Error> {
        let [a, b] = operands else { return Err(Error::InvalidArgument("two operands for now".into())) };
        let runner = crate::parallel::Runner::new(&self.control, self.threads != Some(1));
        let result = pair::combine(operation, a, b, runner)?;
        Ok(Outcome {
            solid: Solid::try_from(crate::Mesh::new(result.positions, result.triangles))?,
            origins: result.origins.iter().map(|origin| origin.0).collect(),
        })
    }
}

/// `a` and `b` combined by `operation`.
///
/// # Errors
/// None without limits; see [`Options::run`].
pub fn boolean(operation: Operation, a: &Solid, b: &Solid) -> Result<Outcome, Error> {
    Options::new().run(operation, &[a, b])
}

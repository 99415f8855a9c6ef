//! Booleans of closed triangle meshes in exact general position.
//!
//! The algorithm is that of Vyatkin 2019 (steps 1 and 2) with every decision exact. All decisions are signs of one
//! determinant of perturbed input vertices, so the operands are always in general position and there is one kind of event:
//! an edge of one crosses a triangle of the other. The result is a sum of pieces of faces with integer multiplicities
//! (`multiplicity`) whose boundary cancels identically; what perturbation kept apart at the same place is identified
//! afterwards, exactly, and where it cannot decide, faces of one plane are added up in it (`walls`). The pipeline is `pair::combine`, one function per step:
//!
//! 1. `overlap`, `candidates`: pairs of triangles that may meet;
//! 2. `crossings`: which do, and where (`cut_edges`: in which order along each edge, correctly rounded);
//! 3. `winding`: how often each operand winds round the other's vertices;
//! 4. `identify`, `cut`: coincident points become one; kept pieces of cut faces become triangles;
//! 5. `tidy`: what touches separates; triangles without area and needless vertices go;
//! 6. `assemble`: untouched triangles keep their order, and vertices their bits.
//!
//! **Guaranteed** for any closed operands: the result is closed; it is the exact boolean with every new coordinate correctly
//! rounded; operands that touch resolve as regularised set operations do; the same input gives the same bits on any number of
//! threads. **Not guaranteed**: that rounding introduces no crossings of the size of an ulp.

mod arrangement;
mod candidates;
mod classify;
mod complex;
mod cut;
mod many;
mod pair;
mod result;
mod tidy;

pub use complex::origin::Origin;
pub use result::certificate::{Certificate, OperandState};
pub use result::outcome::Outcome;

use crate::control::Control;
use crate::parallel::Runner;
use crate::{Error, Solid};

/// A regularised boolean operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// What is in any operand.
    Union,
    /// What is in all operands.
    Intersection,
    /// What is in the first and in none of the others.
    Difference,
    /// What is in an odd number of operands.
    SymmetricDifference,
}

/// What becomes of operands of a union that touch without overlapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Contact {
    /// Touching faces vanish: the bodies become one. (Bodies that touch in an edge or a vertex alone stay apart.)
    #[default]
    Fuse,
    /// Touching bodies stay apart, each with its own face.
    Separate,
}

/// Settings of a boolean. The default has no limits and uses every thread of the current rayon pool.
#[derive(Clone, Debug)]
pub struct Options {
    control: Control,
    threads: Option<usize>,
    contact: Contact,
    remove_vertices: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { control: Control::new(), threads: None, contact: Contact::Fuse, remove_vertices: true }
    }
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

    /// What becomes of operands of a union that touch. Default: [`Contact::Fuse`].
    #[must_use]
    pub fn contact(mut self, contact: Contact) -> Self {
        self.contact = contact;
        self
    }

    /// Whether vertices that nobody needs are left out where the operation cuts: inside a plane face, and on a straight
    /// crease between two. Default: true. Triangles of one plane face are then cut as one, and what is cut from them has one
    /// of them as its origin. Faces of different groups are never merged.
    #[must_use]
    pub fn remove_vertices(mut self, remove: bool) -> Self {
        self.remove_vertices = remove;
        self
    }

    /// Runs `operation` over any number of operands (for a difference: the first minus all the others).
    ///
    /// An empty result is a success. An operand that crosses itself (see [`Solid::self_crossings`]) gives a closed result
    /// in which regions count as often as they are enclosed; the certificate tells what is known of each operand.
    ///
    /// # Errors
    /// Only limits: [`Error::Cancelled`], [`Error::DeadlineExceeded`], [`Error::MemoryLimit`]; [`Error::TooLarge`] if the
    /// vertices of two operands and of their intersection cannot be numbered with 32 bits; and [`Error::InvalidArgument`]
    /// for an empty list of operands, or where a pool of `threads` threads cannot be made.
    pub fn run(&self, operation: Operation, operands: &[&Solid]) -> Result<Outcome, Error> {
        self.control.check()?;
        if operands.is_empty() {
            return Err(Error::InvalidArgument("a boolean needs at least one operand".into()));
        }
        match self.threads {
            None => many::run(self, operation, operands, Runner::new(&self.control, true)),
            Some(0 | 1) => many::run(self, operation, operands, Runner::new(&self.control, false)),
            Some(threads) => self.run_in_pool(operation, operands, threads),
        }
    }

    #[cfg(feature = "parallel")]
    fn run_in_pool(
        &self,
        operation: Operation,
        operands: &[&Solid],
        threads: usize,
    ) -> Result<Outcome, Error> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| Error::InvalidArgument(format!("cannot make {threads} threads: {error}")))?;
        pool.install(|| many::run(self, operation, operands, Runner::new(&self.control, true)))
    }

    #[cfg(not(feature = "parallel"))]
    fn run_in_pool(
        &self,
        operation: Operation,
        operands: &[&Solid],
        _threads: usize,
    ) -> Result<Outcome, Error> {
        many::run(self, operation, operands, Runner::new(&self.control, false))
    }
}

/// `a` and `b` combined by `operation`, with default [`Options`].
///
/// # Errors
/// [`Error::TooLarge`] if the vertices cannot be numbered with 32 bits.
pub fn boolean(operation: Operation, a: &Solid, b: &Solid) -> Result<Outcome, Error> {
    Options::new().run(operation, &[a, b])
}

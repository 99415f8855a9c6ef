//! Settings of a boolean.

use super::{Policy, run};
use crate::boolean::complex::operation::{Contact, Operation};
use crate::boolean::result::outcome::Outcome;
use crate::control::Control;
use crate::parallel::Runner;
#[cfg(feature = "parallel")]
use crate::parallel::run_in_pool;
use crate::{Error, Solid};

/// Settings of a boolean. The default has no limits and uses every thread of the current rayon pool.
#[derive(Clone, Debug)]
pub struct BooleanOptions {
    control: Control,
    threads: Option<usize>,
    policy: Policy,
}

impl Default for BooleanOptions {
    fn default() -> Self {
        Self {
            control: Control::new(),
            threads: None,
            policy: Policy { contact: Contact::Fuse, remove_vertices: true },
        }
    }
}

impl BooleanOptions {
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

    /// Exactly this many threads, [`most_threads`](crate::control::most_threads) at most (1: the caller's own, no pool).
    /// Without it, the rayon pool the caller is in. Pools are kept from call to call; calls at the same time share one.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// What becomes of operands of a union that touch. Default: [`Contact::Fuse`].
    #[must_use]
    pub fn contact(mut self, contact: Contact) -> Self {
        self.policy.contact = contact;
        self
    }

    /// Whether vertices that nobody needs are left out where the operation cuts: inside a plane face, and on a straight
    /// crease between two. Default: true. Triangles of one plane face are then cut as one, and what is cut from them has one
    /// of them as its origin. Faces of different groups are never merged.
    #[must_use]
    pub fn remove_vertices(mut self, remove: bool) -> Self {
        self.policy.remove_vertices = remove;
        self
    }

    /// Runs `operation` over any number of operands (for a difference: the first minus all the others).
    ///
    /// ```
    /// use trisect::{BooleanOptions, Operation, Solid, primitives};
    ///
    /// let mut cubes = Vec::new();
    /// for i in 0..4 {
    ///     let low = [0.5 * f64::from(i), 0.0, 0.0];
    ///     cubes.push(Solid::try_from(primitives::cuboid(low, low.map(|x| x + 1.0))?)?);
    /// }
    /// let united = BooleanOptions::new().threads(2).run(Operation::Union, &cubes)?;
    /// assert_eq!(united.solid().volume(), 2.5);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// An empty result is a success. An operand that crosses itself (see [`Solid::self_crossings`]) gives a closed result
    /// in which regions count as often as they are enclosed; the certificate tells what is known of each operand.
    ///
    /// # Errors
    /// Limits ([`Error::Limit`]); [`Error::TooLarge`] if the vertices of two operands and of their intersection, or their
    /// triangles, cannot be numbered with 32 bits; and [`Error::InvalidArgument`] for an empty list of operands, or where a
    /// pool of `threads` threads cannot be made.
    pub fn run<'a>(
        &self,
        operation: Operation,
        operands: impl IntoIterator<Item = &'a Solid>,
    ) -> Result<Outcome, Error> {
        let operands: Vec<&Solid> = operands.into_iter().collect();
        self.run_all(operation, &operands)
    }

    fn run_all(&self, operation: Operation, operands: &[&Solid]) -> Result<Outcome, Error> {
        self.control.check()?;
        if operands.is_empty() {
            return Err(Error::InvalidArgument("a boolean needs at least one operand".into()));
        }
        match self.threads {
            None => run(self.policy, operation, operands, Runner::new(&self.control, true)),
            Some(0 | 1) => run(self.policy, operation, operands, Runner::new(&self.control, false)),
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
        let run = || run(self.policy, operation, operands, Runner::new(&self.control, true));
        run_in_pool(threads, run)
            .map_err(|error| Error::InvalidArgument(format!("cannot make {threads} threads: {error}")))?
    }

    #[cfg(not(feature = "parallel"))]
    fn run_in_pool(
        &self,
        operation: Operation,
        operands: &[&Solid],
        _threads: usize,
    ) -> Result<Outcome, Error> {
        run(self.policy, operation, operands, Runner::new(&self.control, false))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn any_number_of_threads_may_be_asked_for() {
        let ball = |x: f64| {
            let ball = primitives::geodesic_sphere(1.0, 24).unwrap().translated([x, 0.1, 0.0]);
            Solid::try_from(ball).unwrap()
        };
        let operands = [ball(0.0), ball(0.7)];
        let united =
            |threads| BooleanOptions::new().threads(threads).run(Operation::Union, &operands).unwrap();
        let alone = united(1);
        assert_eq!(united(100_000).solid(), alone.solid());
        assert_eq!(united(usize::MAX).solid(), alone.solid());
    }
}

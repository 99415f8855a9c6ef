//! Settings of a boolean.

use super::expressions::{self, Wanted};
use super::policy::{Embed, Policy};
use super::{run, snapped};
use crate::boolean::complex::operation::{Contact, Operation};
use crate::boolean::expression::Expression;
use crate::boolean::expression::rule::Rule;
use crate::boolean::result::cut_faces::CutFaces;
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
    /// What is inside operands; of those past its end what is inside by the default rule.
    rules: Vec<Rule>,
    cut_faces: CutFaces,
}

impl Default for BooleanOptions {
    fn default() -> Self {
        Self {
            control: Control::new(),
            threads: None,
            policy: Policy {
                contact: Contact::Fuse,
                remove_vertices: true,
                assume_clean: false,
                rule: Rule::Positive,
                embed: Embed::default(),
                snap: None,
            },
            rules: Vec::new(),
            cut_faces: CutFaces::default(),
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

    /// What counts as the inside of operands that cross themselves. Default: [`Rule::Positive`].
    #[must_use]
    pub fn rule(mut self, rule: Rule) -> Self {
        self.policy.rule = rule;
        self
    }

    /// The same operand by operand, in their order; those past the end of the list follow [`rule`](Self::rule).
    #[must_use]
    pub fn rules(mut self, rules: impl IntoIterator<Item = Rule>) -> Self {
        self.rules = rules.into_iter().collect();
        self
    }

    /// Whether operands are taken not to cross or touch themselves, unless they are known to. Default: false; each is looked
    /// through once (some tenths of a microsecond a triangle) and remembers what was found, and results of operations need not be
    /// looked through. Where the assumption is wrong the result is closed all the same, but regions count as often as they are
    /// enclosed.
    #[must_use]
    pub fn assume_clean(mut self, assume: bool) -> Self {
        self.policy.assume_clean = assume;
        self
    }

    /// What becomes of crossings that rounding makes. Default: [`Embed::Never`].
    #[must_use]
    pub fn embed(mut self, embed: Embed) -> Self {
        self.policy.embed = embed;
        self
    }

    /// What the faces show that tools have cut. Default: [`CutFaces::tool`].
    #[must_use]
    pub fn cut_faces(mut self, faces: CutFaces) -> Self {
        self.cut_faces = faces;
        self
    }

    /// Welds the operands to each other before the exact operation: vertices, edges and faces that are no further apart than
    /// `distance`, in units of the coordinates, are made the same, also within one operand. Openings a little short of the other
    /// side then go through, and bodies that were flush before they were turned are flush. What that moved is in
    /// [`Certificate::snapping`](crate::Certificate::snapping). Default: none; nothing is ever snapped unasked.
    ///
    /// ```
    /// use trisect::{BooleanOptions, Operation, Solid, primitives};
    ///
    /// // 0.1 + 0.2 is not 0.3.
    /// let a = Solid::try_from(primitives::cuboid([0.0; 3], [1.0, 1.0, 0.1 + 0.2])?)?;
    /// let b = Solid::try_from(primitives::cuboid([0.0, 0.0, 0.3], [1.0, 1.0, 1.0])?)?;
    /// let c = Solid::try_from(primitives::cuboid([0.0, 0.0, 1.0 + 1e-12], [1.0, 1.0, 2.0])?)?;
    /// let exact = BooleanOptions::new().run(Operation::Union, [&a, &b, &c])?;
    /// assert_eq!(exact.solid().components(), 2);
    /// let snapped = BooleanOptions::new().snap(1e-9).run(Operation::Union, [&a, &b, &c])?;
    /// assert_eq!((snapped.solid().components(), snapped.solid().mesh().triangles.len()), (1, 12));
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn snap(mut self, distance: f64) -> Self {
        self.policy.snap = Some(distance);
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
    /// An empty result is a success. An operand that crosses or touches itself (see [`Solid::self_crossings`]) stands for what
    /// its surface winds around by its [`rule`](Self::rule); then all operands are evaluated at once, in one arrangement.
    ///
    /// # Errors
    /// Limits ([`Error::Limit`]); [`Error::TooLarge`] if the vertices of two operands and of their intersection, or their
    /// triangles, cannot be numbered with 32 bits; and [`Error::InvalidArgument`] for an empty list of operands, where a
    /// pool of `threads` threads cannot be made, or if a number of [`cut_faces`](Self::cut_faces) is not positive.
    pub fn run<'a>(
        &self,
        operation: Operation,
        operands: impl IntoIterator<Item = &'a Solid>,
    ) -> Result<Outcome, Error> {
        let operands: Vec<&Solid> = operands.into_iter().collect();
        self.run_all(operation, &operands)
    }

    /// The volume of what is in both solids, without attributes, groups and clean-up of faces, which do not change it.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn overlap_volume(&self, a: &Solid, b: &Solid) -> Result<f64, Error> {
        // Boxes that have no inside in common tell at once.
        let apart = |(a, b): (crate::mesh::Bounds, crate::mesh::Bounds)| {
            (0..3).any(|k| a.high[k] <= b.low[k] || b.high[k] <= a.low[k])
        };
        if a.bounds().zip(b.bounds()).is_none_or(apart) {
            return Ok(0.0);
        }
        let options = self.clone().remove_vertices(false);
        Ok(options.run(Operation::Intersection, [a, b])?.solid().volume())
    }

    fn run_all(&self, operation: Operation, operands: &[&Solid]) -> Result<Outcome, Error> {
        self.control.check()?;
        if operands.is_empty() {
            return Err(Error::InvalidArgument("a boolean needs at least one operand".into()));
        }
        self.check_numbers()?;
        let mut outcomes = self.on_threads(|runner| {
            let run = |operands: &[&Solid]| run(self.policy, &self.rules, operation, operands, runner);
            snapped(self.policy, operands, runner, |operands| Ok(vec![run(operands)?]))
        })?;
        Ok(outcomes.swap_remove(0).with_cut_faces(&self.cut_faces))
    }

    /// What cut faces are to show, once their numbers are known to be sound.
    pub(in crate::boolean) fn checked_cut_faces(&self) -> Result<&CutFaces, Error> {
        self.check_numbers()?;
        Ok(&self.cut_faces)
    }

    fn check_numbers(&self) -> Result<(), Error> {
        match self.cut_faces.fault() {
            None => Ok(()),
            Some(number) => Err(Error::InvalidArgument(format!(
                "texture coordinates of cut faces need a positive number of them to a unit of length, not {number}"
            ))),
        }
    }

    /// Evaluates an expression of operands, all of them at once: nothing is rounded in between.
    ///
    /// ```
    /// use trisect::{BooleanOptions, Expression, Solid, primitives};
    ///
    /// let mut operands = Vec::new();
    /// for [low, high] in [[0.0, 3.0], [1.0, 2.0], [2.5, 4.0]] {
    ///     operands.push(Solid::try_from(primitives::cuboid([low; 3], [high; 3])?)?);
    /// }
    /// let expression: Expression = "a - (b + c)".parse().expect("a, b and c are operands");
    /// let left = BooleanOptions::new().evaluate(&expression, &operands)?;
    /// assert_eq!(left.solid().volume(), 27.0 - 1.0 - 0.125);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`run`](Self::run), and [`Error::InvalidArgument`] where the expression has more operands than there are.
    pub fn evaluate<'a>(
        &self,
        expression: &Expression,
        operands: impl IntoIterator<Item = &'a Solid>,
    ) -> Result<Outcome, Error> {
        let operands: Vec<&Solid> = operands.into_iter().collect();
        // One operation on operands that do not cross themselves is faster by itself.
        if let Some((operation, places)) = expression.as_operation()
            && places.iter().copied().eq(0..operands.len())
        {
            return self.run_all(operation, &operands);
        }
        let mut outcomes = self.evaluate_all(std::slice::from_ref(expression), operands)?;
        Ok(outcomes.swap_remove(0))
    }

    /// Evaluates several expressions of the same operands in one arrangement: where their results meet they share vertices,
    /// bit for bit.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn evaluate_all<'a>(
        &self,
        expressions: &[Expression],
        operands: impl IntoIterator<Item = &'a Solid>,
    ) -> Result<Vec<Outcome>, Error> {
        let operands: Vec<&Solid> = operands.into_iter().collect();
        self.control.check()?;
        let wanted = Wanted { expressions, rules: &self.rules, policy: self.policy };
        self.check_numbers()?;
        let outcomes = self.on_threads(|runner| {
            snapped(self.policy, &operands, runner, |operands| expressions::run(&wanted, operands, runner))
        })?;
        Ok(outcomes.into_iter().map(|outcome| outcome.with_cut_faces(&self.cut_faces)).collect())
    }

    /// What an operand stands for by its [`rule`](Self::rule), as a surface that crosses itself no deeper than rounding.
    ///
    /// ```
    /// use trisect::{BooleanOptions, Mesh, Solid, primitives};
    ///
    /// let mut both = primitives::cuboid([0.0; 3], [1.0; 3])?;
    /// let other = primitives::cuboid([0.5; 3], [1.5; 3])?;
    /// both.triangles.extend(other.triangles.iter().map(|corners| corners.map(|v| v + 8)));
    /// both.positions.extend(other.positions);
    /// let overlapping = Solid::try_from(both)?;
    /// assert_eq!(overlapping.volume(), 2.0);
    /// assert_eq!(BooleanOptions::new().resolve(&overlapping)?.solid().volume(), 1.875);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn resolve(&self, operand: &Solid) -> Result<Outcome, Error> {
        let mut outcomes = self.evaluate_all(&[Expression::Operand(0)], [operand])?;
        Ok(outcomes.swap_remove(0))
    }

    /// What is inside an operand.
    pub(in crate::boolean) fn rule_of(&self, operand: usize) -> Rule {
        self.rules.get(operand).copied().unwrap_or(self.policy.rule)
    }

    /// Other work under these settings, on the threads that were asked for.
    pub(in crate::boolean) fn work<T: Send>(
        &self,
        work: impl FnOnce(Policy, Runner<'_>) -> Result<T, Error> + Send,
    ) -> Result<T, Error> {
        self.control.check()?;
        self.on_threads(|runner| work(self.policy, runner))
    }

    /// Runs on the threads that were asked for.
    fn on_threads<T: Send>(
        &self,
        run: impl FnOnce(Runner<'_>) -> Result<T, Error> + Send,
    ) -> Result<T, Error> {
        match self.threads {
            None => run(Runner::new(&self.control, true)),
            Some(0 | 1) => run(Runner::new(&self.control, false)),
            Some(threads) => self.in_pool(run, threads),
        }
    }

    #[cfg(feature = "parallel")]
    fn in_pool<T: Send>(
        &self,
        run: impl FnOnce(Runner<'_>) -> Result<T, Error> + Send,
        threads: usize,
    ) -> Result<T, Error> {
        run_in_pool(threads, || run(Runner::new(&self.control, true)))
            .map_err(|error| Error::InvalidArgument(format!("cannot make {threads} threads: {error}")))?
    }

    #[cfg(not(feature = "parallel"))]
    fn in_pool<T: Send>(
        &self,
        run: impl FnOnce(Runner<'_>) -> Result<T, Error> + Send,
        _threads: usize,
    ) -> Result<T, Error> {
        run(Runner::new(&self.control, false))
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

//! Half-spaces taken out of an expression: what they cut becomes operands.

use std::sync::Arc;

use super::{Leaf, unbounded};
use crate::boolean::expression::Expression;
use crate::boolean::expression::filled::{Dependence, Filled};
use crate::boolean::expression::rule::Rule;
use crate::boolean::many::options::BooleanOptions;
use crate::boolean::parting::plane::PlaneCut;
use crate::boolean::result::certificate::{Notes, OperandState};
use crate::boolean::result::origins::Origins;
use crate::boolean::result::outcome::Outcome;
use crate::{Error, Solid};

/// A solid that was given, one for a half-space, or one that was made, and where its triangles come from.
#[derive(Clone)]
pub(super) enum Held<'a> {
    Given(&'a Solid, Arc<Origins>),
    Box(Arc<Solid>, Arc<Origins>),
    Made(Arc<Outcome>),
}

/// An operand of what is left of the expression.
#[derive(Clone)]
pub(super) struct Part<'a> {
    pub(super) solid: Held<'a>,
    pub(super) rule: Rule,
}

impl Part<'_> {
    fn solid(&self) -> &Solid {
        match &self.solid {
            Held::Given(solid, _) => solid,
            Held::Box(solid, _) => solid,
            Held::Made(outcome) => outcome.solid(),
        }
    }

    fn origins(&self) -> &Origins {
        match &self.solid {
            Held::Given(_, origins) | Held::Box(_, origins) => origins,
            Held::Made(outcome) => outcome.runs(),
        }
    }
}

/// What a plane makes of a set.
struct Sides {
    /// The operand that the half-space is.
    plane: usize,
    /// What is kept inside the half-space alone.
    inside: Option<Expression>,
    /// What is kept outside it alone.
    outside: Option<Expression>,
    /// What is kept on both sides.
    both: Option<Expression>,
}

/// Where something is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    Inside,
    Outside,
    Both,
}

/// An evaluation.
pub(super) struct Work<'a, 'o> {
    options: &'o BooleanOptions,
    leaves: &'o [Leaf<'a>],
    /// The leaves, all of space, and what was made.
    parts: Vec<Part<'a>>,
    /// What is known of each leaf that is a solid.
    states: Vec<Option<OperandState>>,
    /// Added up over all that was done.
    notes: Notes,
    /// How many sets were cut.
    sets: usize,
}

impl<'a, 'o> Work<'a, 'o> {
    /// `parts` are the leaves, and all of space.
    pub(super) fn new(options: &'o BooleanOptions, leaves: &'o [Leaf<'a>], parts: Vec<Part<'a>>) -> Self {
        let states = leaves.iter().map(|leaf| leaf.solid().map(OperandState::of)).collect();
        Self { options, leaves, parts, states, notes: Notes::default(), sets: 0 }
    }

    /// The result, with all that was noted on the way.
    pub(super) fn result(mut self, expression: &Expression) -> Result<Outcome, Error> {
        // 1. What is cut; if only the whole has an end, that.
        let rest = self.without_planes(expression)?;
        let rest = if self.is_askew(&rest) { self.cut(&rest)? } else { Some(rest) };
        // 2. The rest.
        let mut outcome = self.whole(&rest.unwrap_or(Expression::Union(Vec::new())))?;
        let notes = outcome.notes_mut();
        notes.contacts = self.notes.contacts;
        notes.clean_up_stopped = self.notes.clean_up_stopped;
        notes.inverted = self.notes.inverted;
        notes.three_face_points = self.notes.three_face_points;
        notes.walls_left = self.notes.walls_left;
        notes.operands = self.states.into_iter().flatten().collect();
        Ok(outcome)
    }

    fn is_half_space(&self, operand: usize) -> bool {
        self.leaves.get(operand).is_some_and(|leaf| leaf.half_space().is_some())
    }

    fn is_plane_askew(&self, operand: usize) -> bool {
        self.leaves.get(operand).is_some_and(Leaf::is_askew)
    }

    fn is_askew(&self, expression: &Expression) -> bool {
        expression.any_operand(&|operand| self.is_plane_askew(operand))
    }

    /// The expression with the smallest sets cut that planes askew are in and that have an end.
    fn without_planes(&mut self, expression: &Expression) -> Result<Expression, Error> {
        if !self.is_askew(expression) {
            return Ok(expression.clone());
        }
        let has_end = expression.is_bounded(&|operand| self.is_half_space(operand));
        let rest = expression.of_others(|set| self.without_planes(set))?;
        if !(has_end && self.is_askew(&rest)) {
            return Ok(rest);
        }
        // (What is nothing is a union of nothing.)
        Ok(self.cut(&rest)?.unwrap_or(Expression::Union(Vec::new())))
    }

    /// A set that has an end without its planes askew: what was cut as an operand. `None` if it is nothing.
    fn cut(&mut self, set: &Expression) -> Result<Option<Expression>, Error> {
        self.count(set)?;
        self.cut_all(set)
    }

    /// Refuses a set of which planes make too many, before there is any work.
    fn count(&mut self, set: &Expression) -> Result<(), Error> {
        /// Sets of one expression at most: each plane may double what there is.
        const MOST: usize = 4_096;
        self.sets += 1;
        if self.sets > MOST {
            let what =
                "half-spaces make too many sets of this expression: intersect bodies with them one by one";
            return Err(Error::InvalidArgument(what.into()));
        }
        let Some(Sides { inside, outside, both, .. }) = self.sides(set)? else { return Ok(()) };
        [inside, outside, both].iter().flatten().try_for_each(|set| self.count(set))
    }

    /// What the last plane makes of a set, in which those before it cut first; `None` if there is no plane in it.
    fn sides(&self, set: &Expression) -> Result<Option<Sides>, Error> {
        let askew = set.operands().into_iter().rev().find(|&operand| self.is_plane_askew(operand));
        let Some(plane) = askew else { return Ok(None) };
        let fill = |is_everything: bool| match set.filled(plane, is_everything, self.leaves.len()) {
            Filled::Nothing => Ok(None),
            Filled::Everything => Err(unbounded()),
            Filled::Set(set) => Ok(Some(set)),
        };
        let (inside, outside) = (fill(true)?, fill(false)?);
        // What is on both sides is not cut.
        let (inside, outside, both) = match (set.dependence(plane), inside, outside) {
            (Dependence::None, inside, _) => (None, None, inside),
            (Dependence::Grows, inside, outside) => (inside, None, outside),
            (Dependence::Shrinks, inside, outside) => (None, outside, inside),
            (Dependence::Both, Some(inside), Some(outside)) => {
                let both = Expression::Intersection(vec![inside.clone(), outside.clone()]);
                (Some(inside), Some(outside), Some(both))
            }
            (Dependence::Both, inside, outside) => (inside, outside, None),
        };
        Ok(Some(Sides { plane, inside, outside, both }))
    }

    fn cut_all(&mut self, set: &Expression) -> Result<Option<Expression>, Error> {
        let Some(Sides { plane, inside, outside, both }) = self.sides(set)? else {
            return Ok(Some(set.clone()));
        };
        // 1. What is to be kept where, without the planes before this one.
        let (mut sets, mut kept) = (Vec::new(), Vec::new());
        for (set, of) in [(inside, Kept::Inside), (outside, Kept::Outside), (both, Kept::Both)] {
            let Some(set) = set else { continue };
            if let Some(set) = self.cut_all(&set)? {
                sets.push(set);
                kept.push(of);
            }
        }
        if kept == [Kept::Both] {
            return Ok(sets.pop());
        }
        // 2. Each cut, as far as there is anything.
        let mut pieces = Vec::new();
        for (part, of) in self.as_parts(&sets)?.into_iter().zip(kept) {
            let piece = match of {
                Kept::Both => part,
                Kept::Inside => self.half(part, plane, true)?,
                Kept::Outside => self.half(part, plane, false)?,
            };
            if !self.parts[piece].solid().is_empty() {
                pieces.push(Expression::Operand(piece));
            }
        }
        // 3. Put together.
        Ok(if pieces.len() > 1 { Some(Expression::Union(pieces)) } else { pieces.pop() })
    }

    /// Sets as parts, all of one arrangement: where they are the same, they have the same points.
    fn as_parts(&mut self, sets: &[Expression]) -> Result<Vec<usize>, Error> {
        let is_part = |set: &&Expression| matches!(set, Expression::Operand(_));
        let others: Vec<Expression> = sets.iter().filter(|set| !is_part(set)).cloned().collect();
        let mut outcomes = self.evaluate(&others)?.into_iter();
        let mut parts = Vec::new();
        for set in sets {
            if let Expression::Operand(part) = set {
                parts.push(*part);
            } else if let Some(outcome) = outcomes.next() {
                self.parts.push(made(outcome));
                parts.push(self.parts.len() - 1);
            }
        }
        Ok(parts)
    }

    /// What of a part is in a half-space, or outside it, as a part.
    fn half(&mut self, part: usize, plane: usize, is_inside: bool) -> Result<usize, Error> {
        let Some((at, is_above)) = self.leaves[plane].half_space() else { return Err(unbounded()) };
        let Part { rule, .. } = self.parts[part];
        let cut = PlaneCut::new(at).options(self.options.clone().rules([rule]));
        let solid = self.parts[part].solid();
        let outcome = if is_above == is_inside { cut.above(solid)? } else { cut.below(solid)? };
        self.note(&outcome, &[part]);
        let of_plane = Origins::of_operand(plane as u32, 1);
        let outcome = outcome.of_sources(&[self.parts[part].origins(), &of_plane]);
        self.parts.push(made(outcome));
        Ok(self.parts.len() - 1)
    }

    /// The result of what is left of the expression: nothing is done again where that is one thing that was made.
    fn whole(&mut self, rest: &Expression) -> Result<Outcome, Error> {
        let made = match rest {
            Expression::Operand(operand) => match &self.parts[*operand].solid {
                Held::Made(outcome) => Some(Arc::clone(outcome)),
                Held::Given(..) | Held::Box(..) => None,
            },
            _ => None,
        };
        let Some(made) = made else {
            let mut outcomes = self.evaluate(std::slice::from_ref(rest))?;
            return Ok(outcomes.swap_remove(0));
        };
        self.parts.clear();
        Ok(Arc::try_unwrap(made).unwrap_or_else(|made| (*made).clone()))
    }

    /// Expressions of the parts, told of the leaves.
    fn evaluate(&mut self, expressions: &[Expression]) -> Result<Vec<Outcome>, Error> {
        // 1. Of those parts alone that they name.
        let mut used: Vec<usize> = expressions.iter().flat_map(Expression::operands).collect();
        used.sort_unstable();
        used.dedup();
        if used.is_empty() {
            // (Nothing of an operand is nothing.)
            used.push(0);
        }
        let place = |operand: usize| used.binary_search(&operand).unwrap_or_default();
        let renumbered: Vec<Expression> =
            expressions.iter().map(|expression| renumbered(expression, &place)).collect();
        let parts: Vec<Part<'a>> = used.iter().map(|&operand| self.parts[operand].clone()).collect();
        // 2. Evaluated.
        let options = self.options.clone().rules(parts.iter().map(|part| part.rule));
        let solids = parts.iter().map(Part::solid);
        let outcomes = match renumbered.as_slice() {
            [] => Vec::new(),
            [one] => vec![options.evaluate(one, solids)?],
            several => options.evaluate_all(several, solids)?,
        };
        if let Some(first) = outcomes.first() {
            self.note(first, &used);
        }
        // 3. Their origins.
        let sources: Vec<&Origins> = parts.iter().map(Part::origins).collect();
        Ok(outcomes.into_iter().map(|outcome| outcome.of_sources(&sources)).collect())
    }

    /// Notes what making something of operands met.
    fn note(&mut self, outcome: &Outcome, operands: &[usize]) {
        let notes = outcome.notes();
        self.notes.contacts += notes.contacts;
        self.notes.clean_up_stopped += notes.clean_up_stopped;
        self.notes.inverted += notes.inverted;
        self.notes.three_face_points += notes.three_face_points;
        self.notes.walls_left += notes.walls_left;
        for (&operand, state) in operands.iter().zip(&notes.operands) {
            if let Some(known) = self.states.get_mut(operand)
                && known.is_some()
            {
                *known = Some(*state);
            }
        }
    }
}

/// What was made, as an operand.
fn made<'a>(outcome: Outcome) -> Part<'a> {
    Part { solid: Held::Made(Arc::new(outcome)), rule: Rule::Positive }
}

fn renumbered(expression: &Expression, place: &dyn Fn(usize) -> usize) -> Expression {
    match expression {
        Expression::Operand(operand) => Expression::Operand(place(*operand)),
        other => {
            let Ok(other) = other.of_others(|set| Ok::<_, std::convert::Infallible>(renumbered(set, place)));
            other
        }
    }
}

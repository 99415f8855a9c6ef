//! Expressions in which an operand is all of space, or nothing.

use super::Expression;

/// A set made of operands, or one that needs none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::boolean) enum Filled {
    Nothing,
    /// All of space.
    Everything,
    Set(Expression),
}

/// How a set depends on an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::boolean) enum Dependence {
    /// Not at all.
    None,
    /// It grows with it.
    Grows,
    /// It shrinks as the operand grows.
    Shrinks,
    /// Both, at different places.
    Both,
}

impl Dependence {
    fn opposite(self) -> Self {
        match self {
            Self::Grows => Self::Shrinks,
            Self::Shrinks => Self::Grows,
            other => other,
        }
    }

    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::None, known) | (known, Self::None) => known,
            (one, other) if one == other => one,
            _ => Self::Both,
        }
    }
}

impl Expression {
    /// The sets that this one is made of.
    fn sets(&self) -> &[Self] {
        match self {
            Self::Operand(_) => &[],
            Self::Union(sets)
            | Self::Intersection(sets)
            | Self::Difference(sets)
            | Self::SymmetricDifference(sets)
            | Self::AtLeast(_, sets) => sets,
        }
    }

    /// The same operation on other sets.
    pub(in crate::boolean) fn of_others<E>(
        &self,
        mut other: impl FnMut(&Self) -> Result<Self, E>,
    ) -> Result<Self, E> {
        let sets = self.sets().iter().map(&mut other).collect::<Result<Vec<Self>, E>>()?;
        Ok(match self {
            Self::Operand(operand) => Self::Operand(*operand),
            Self::Union(_) => Self::Union(sets),
            Self::Intersection(_) => Self::Intersection(sets),
            Self::Difference(_) => Self::Difference(sets),
            Self::SymmetricDifference(_) => Self::SymmetricDifference(sets),
            Self::AtLeast(count, _) => Self::AtLeast(*count, sets),
        })
    }

    /// Whether some operand occurs that is as asked.
    pub(in crate::boolean) fn any_operand(&self, is_so: &dyn Fn(usize) -> bool) -> bool {
        match self {
            Self::Operand(operand) => is_so(*operand),
            _ => self.sets().iter().any(|set| set.any_operand(is_so)),
        }
    }

    /// Whether the set has an end, by its form alone, if some operands have none. True only where it has one.
    pub(in crate::boolean) fn is_bounded(&self, is_unbounded: &dyn Fn(usize) -> bool) -> bool {
        let bounded = |set: &Self| set.is_bounded(is_unbounded);
        match self {
            Self::Operand(operand) => !is_unbounded(*operand),
            Self::Union(sets) | Self::SymmetricDifference(sets) => sets.iter().all(bounded),
            Self::Intersection(sets) => sets.is_empty() || sets.iter().any(bounded),
            Self::Difference(sets) => sets.first().is_none_or(bounded),
            Self::AtLeast(count, sets) => sets.iter().filter(|set| !bounded(set)).count() < (*count).max(1),
        }
    }

    /// How the set depends on an operand, by its form alone.
    pub(in crate::boolean) fn dependence(&self, of: usize) -> Dependence {
        let all =
            |sets: &[Self]| sets.iter().fold(Dependence::None, |known, set| known.and(set.dependence(of)));
        match self {
            Self::Operand(operand) if *operand == of => Dependence::Grows,
            Self::Operand(_) => Dependence::None,
            Self::Union(sets) | Self::Intersection(sets) | Self::AtLeast(_, sets) => all(sets),
            Self::Difference(sets) => match sets.split_first() {
                Some((first, others)) => first.dependence(of).and(all(others).opposite()),
                None => Dependence::None,
            },
            Self::SymmetricDifference(sets) => match all(sets) {
                Dependence::None => Dependence::None,
                _ => Dependence::Both,
            },
        }
    }

    /// The set with all of space, or nothing, for an operand. Where something is taken off all of space, `space` is an operand that
    /// stands for it.
    pub(in crate::boolean) fn filled(&self, operand: usize, is_everything: bool, space: usize) -> Filled {
        let fill = |set: &Self| set.filled(operand, is_everything, space);
        match self {
            Self::Operand(own) if *own != operand => Filled::Set(self.clone()),
            Self::Operand(_) if is_everything => Filled::Everything,
            Self::Operand(_) => Filled::Nothing,
            Self::Union(sets) => united(sets.iter().map(fill)),
            Self::Intersection(sets) if sets.is_empty() => Filled::Nothing,
            Self::Intersection(sets) => {
                let Some(left) = kept(sets.iter().map(fill), &Filled::Nothing) else {
                    return Filled::Nothing;
                };
                several(left, Self::Intersection).unwrap_or(Filled::Everything)
            }
            Self::Difference(sets) => match sets.split_first() {
                Some((first, others)) => less(fill(first), united(others.iter().map(fill)), space),
                None => Filled::Nothing,
            },
            Self::SymmetricDifference(sets) => {
                let mut is_turned = false;
                let mut left = Vec::new();
                for set in sets.iter().map(fill) {
                    match set {
                        Filled::Nothing => {}
                        Filled::Everything => is_turned = !is_turned,
                        Filled::Set(set) => left.push(set),
                    }
                }
                let set = several(left, Self::SymmetricDifference).unwrap_or(Filled::Nothing);
                if is_turned { less(Filled::Everything, set, space) } else { set }
            }
            Self::AtLeast(count, sets) => {
                let mut count = (*count).max(1);
                let mut left = Vec::new();
                for set in sets.iter().map(fill) {
                    match set {
                        Filled::Nothing => {}
                        Filled::Everything => count = count.saturating_sub(1),
                        Filled::Set(set) => left.push(set),
                    }
                }
                match count {
                    0 => Filled::Everything,
                    _ if count > left.len() => Filled::Nothing,
                    1 => several(left, Self::Union).unwrap_or(Filled::Nothing),
                    _ => Filled::Set(Self::AtLeast(count, left)),
                }
            }
        }
    }
}

/// The sets that are neither everything nor nothing; `None` if one is `decisive`, which tells what all are.
fn kept(sets: impl Iterator<Item = Filled>, decisive: &Filled) -> Option<Vec<Expression>> {
    let mut left = Vec::new();
    for set in sets {
        match set {
            Filled::Set(set) => left.push(set),
            other if other == *decisive => return None,
            _ => {}
        }
    }
    Some(left)
}

/// An operation on sets, or the only one; `None` if there is none.
fn several(mut sets: Vec<Expression>, operation: fn(Vec<Expression>) -> Expression) -> Option<Filled> {
    match sets.len() {
        0 => None,
        1 => sets.pop().map(Filled::Set),
        _ => Some(Filled::Set(operation(sets))),
    }
}

fn united(sets: impl Iterator<Item = Filled>) -> Filled {
    match kept(sets, &Filled::Everything) {
        None => Filled::Everything,
        Some(left) => several(left, Expression::Union).unwrap_or(Filled::Nothing),
    }
}

fn less(first: Filled, others: Filled, space: usize) -> Filled {
    match (first, others) {
        (Filled::Nothing, _) | (_, Filled::Everything) => Filled::Nothing,
        (first, Filled::Nothing) => first,
        (Filled::Everything, Filled::Set(others)) => {
            Filled::Set(Expression::Difference(vec![Expression::Operand(space), others]))
        }
        (Filled::Set(first), Filled::Set(others)) => Filled::Set(Expression::Difference(vec![first, others])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// The operands of random expressions, and the one that stands for all of space.
    const OPERANDS: usize = 4;
    const SPACE: usize = OPERANDS;

    fn random(rng: &mut ChaCha8Rng, depth: usize) -> Expression {
        if depth == 0 || rng.random_bool(0.2) {
            return Expression::Operand(rng.random_range(0..OPERANDS));
        }
        let sets = (0..rng.random_range(0..4)).map(|_| random(rng, depth - 1)).collect();
        match rng.random_range(0..5) {
            0 => Expression::Union(sets),
            1 => Expression::Intersection(sets),
            2 => Expression::Difference(sets),
            3 => Expression::SymmetricDifference(sets),
            _ => Expression::AtLeast(rng.random_range(0..4), sets),
        }
    }

    #[test]
    fn filled_sets_are_the_sets_where_the_operand_is_so() {
        let mut rng = ChaCha8Rng::seed_from_u64(31);
        for round in 0..3_000 {
            let expression = random(&mut rng, 4);
            let operand = rng.random_range(0..OPERANDS);
            for is_everything in [false, true] {
                let filled = expression.filled(operand, is_everything, SPACE);
                for set in 0..1u32 << OPERANDS {
                    let is_in = |i: usize| i == SPACE || set >> i & 1 == 1;
                    let expected =
                        expression.contains(&|i| if i == operand { is_everything } else { is_in(i) });
                    let found = match &filled {
                        Filled::Nothing => false,
                        Filled::Everything => true,
                        Filled::Set(set) => {
                            assert!(!set.any_operand(&|i| i == operand), "round {round}");
                            set.contains(&is_in)
                        }
                    };
                    assert_eq!(found, expected, "round {round}: {expression:?}");
                }
            }
        }
    }

    #[test]
    fn what_forms_tell_is_true() {
        let mut rng = ChaCha8Rng::seed_from_u64(32);
        let (mut bounded, mut known) = (0, 0);
        for round in 0..3_000 {
            let expression = random(&mut rng, 4);
            let has = |set: u32| expression.contains(&|i| set >> i & 1 == 1);
            // Far away one is in no operand but the last two, if in those.
            if expression.is_bounded(&|i| i >= 2) {
                bounded += 1;
                assert!((0..4).all(|far: u32| !has(far << 2)), "round {round}: {expression:?}");
            }
            for operand in 0..OPERANDS {
                let dependence = expression.dependence(operand);
                for without in (0..1u32 << OPERANDS).filter(|set| set >> operand & 1 == 0) {
                    let (before, after) = (has(without), has(without | 1 << operand));
                    let is_so = match dependence {
                        Dependence::None => before == after,
                        Dependence::Grows => before <= after,
                        Dependence::Shrinks => before >= after,
                        Dependence::Both => true,
                    };
                    assert!(is_so, "round {round}: {dependence:?} of {operand} in {expression:?}");
                }
                known += usize::from(dependence != Dependence::Both);
            }
        }
        assert!(bounded > 100 && known > 1_000);
    }
}

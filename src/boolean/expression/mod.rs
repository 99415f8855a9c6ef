//! Expressions: sets made of operands.
//!
//! - `text`: how they are written;
//! - `rule`: what is inside an operand that crosses itself;
//! - `filled`: what they are where an operand is everything, or nothing.

pub(super) mod filled;
pub(super) mod rule;
pub(super) mod text;

use crate::boolean::complex::operation::Operation;

/// A set made of operands. An operand may occur any number of times.
///
/// In text operands are letters or names, `+` is a union, `&` an intersection, `-` a difference and `^` a symmetric difference;
/// see [`Expression::parse`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Expression {
    /// An operand, by its place in the list of operands.
    Operand(usize),
    /// What is in any of some sets; nothing for none.
    Union(Vec<Self>),
    /// What is in all of some sets; nothing for none.
    Intersection(Vec<Self>),
    /// What is in the first of some sets and in none of the others; nothing for none.
    Difference(Vec<Self>),
    /// What is in an odd number of some sets.
    SymmetricDifference(Vec<Self>),
    /// What is in at least so many of some sets. 0 counts as 1: nothing bounded is everywhere.
    AtLeast(usize, Vec<Self>),
}

impl Expression {
    /// Whether a point is in the set, of which is asked what operands it is in.
    pub fn contains(&self, is_in: &dyn Fn(usize) -> bool) -> bool {
        match self {
            Self::Operand(operand) => is_in(*operand),
            Self::Union(sets) => sets.iter().any(|set| set.contains(is_in)),
            Self::Intersection(sets) => !sets.is_empty() && sets.iter().all(|set| set.contains(is_in)),
            Self::Difference(sets) => match sets.split_first() {
                Some((first, others)) => {
                    first.contains(is_in) && !others.iter().any(|set| set.contains(is_in))
                }
                None => false,
            },
            Self::SymmetricDifference(sets) => sets.iter().filter(|set| set.contains(is_in)).count() % 2 == 1,
            Self::AtLeast(count, sets) => {
                sets.iter().filter(|set| set.contains(is_in)).count() >= (*count).max(1)
            }
        }
    }

    /// The same set as one operation on operands, each once, if it is one: nested unions are opened, and so is a union of what
    /// is taken off.
    pub(crate) fn as_operation(&self) -> Option<(Operation, Vec<usize>)> {
        let mut list = Vec::new();
        let operation = match self {
            Self::Operand(_) | Self::Union(_) => Operation::Union,
            Self::Intersection(_) => Operation::Intersection,
            Self::Difference(_) => Operation::Difference,
            Self::SymmetricDifference(_) => Operation::SymmetricDifference,
            Self::AtLeast(..) => return None,
        };
        let is_flat = match self {
            Self::Difference(sets) => {
                let (first, others) = sets.split_first()?;
                matches!(first, Self::Operand(_))
                    && first.add_united(&mut list)
                    && others.iter().all(|set| set.add_united(&mut list))
            }
            Self::Intersection(sets) | Self::SymmetricDifference(sets) => {
                sets.iter().all(|set| matches!(set, Self::Operand(_)) && set.add_united(&mut list))
            }
            _ => self.add_united(&mut list),
        };
        let mut distinct = list.clone();
        distinct.sort_unstable();
        distinct.dedup();
        (is_flat && distinct.len() == list.len()).then_some((operation, list))
    }

    /// Adds the operands of a union of unions; false if there is anything else.
    fn add_united(&self, list: &mut Vec<usize>) -> bool {
        match self {
            Self::Operand(operand) => {
                list.push(*operand);
                true
            }
            Self::Union(sets) => sets.iter().all(|set| set.add_united(list)),
            _ => false,
        }
    }

    /// The operands that occur, by their places.
    #[must_use]
    pub fn operands(&self) -> std::collections::BTreeSet<usize> {
        match self {
            Self::Operand(operand) => std::iter::once(*operand).collect(),
            Self::Union(sets)
            | Self::Intersection(sets)
            | Self::Difference(sets)
            | Self::SymmetricDifference(sets)
            | Self::AtLeast(_, sets) => sets.iter().flat_map(Self::operands).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_unions_are_one_operation() {
        let operation = |text: &str| text.parse::<Expression>().unwrap().as_operation();
        assert_eq!(operation("a + (b + c)"), Some((Operation::Union, vec![0, 1, 2])));
        assert_eq!(operation("a - (b + (c + d)) - e"), Some((Operation::Difference, vec![0, 1, 2, 3, 4])));
        assert_eq!(operation("b & a"), Some((Operation::Intersection, vec![1, 0])));
        assert_eq!(operation("a - (b - c)"), None);
        assert_eq!(operation("a - a"), None);
        assert_eq!(operation("(a + b) - c"), None);
        assert_eq!(operation("atleast(1, a, b)"), None);
    }
}

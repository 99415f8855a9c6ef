//! Expressions: sets made of operands, and what is inside an operand.

use std::fmt;
use std::str::FromStr;

use super::complex::operation::UnknownName;

/// What counts as the inside of an operand, by how often its surface winds around a point.
///
/// For a surface that does not cross itself all rules are the same. In text `positive`, `nonzero` or `even-odd`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Rule {
    /// What is wound around more often outwards than inwards: overlapping bodies become one, inverted ones are no material.
    #[default]
    Positive,
    /// What is wound around at all.
    NonZero,
    /// What is wound around an odd number of times: overlaps are no material.
    EvenOdd,
}

impl Rule {
    /// All rules.
    pub const ALL: [Self; 3] = [Self::Positive, Self::NonZero, Self::EvenOdd];

    /// The name in text.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Positive => "positive",
            Self::NonZero => "nonzero",
            Self::EvenOdd => "even-odd",
        }
    }

    /// Whether a point is inside that is wound around so many times.
    #[must_use]
    pub const fn is_inside(self, winding: i32) -> bool {
        match self {
            Self::Positive => winding > 0,
            Self::NonZero => winding != 0,
            Self::EvenOdd => winding % 2 != 0,
        }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Rule {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        let found = Self::ALL.into_iter().find(|rule| rule.name() == text);
        found.ok_or_else(|| UnknownName::new(text, "rule", &["positive", "nonzero", "even-odd"]))
    }
}

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

    /// One more than the largest place of an operand that occurs.
    #[must_use]
    pub fn operand_count(&self) -> usize {
        match self {
            Self::Operand(operand) => operand + 1,
            Self::Union(sets)
            | Self::Intersection(sets)
            | Self::Difference(sets)
            | Self::SymmetricDifference(sets)
            | Self::AtLeast(_, sets) => sets.iter().map(Self::operand_count).max().unwrap_or(0),
        }
    }
}

//! What is inside an operand, by its winding numbers.

use std::fmt;
use std::str::FromStr;

use crate::boolean::complex::operation::UnknownName;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_those_of_winding_numbers() {
        let inside = |rule: Rule| [-2, -1, 0, 1, 2].map(|winding| rule.is_inside(winding));
        assert_eq!(inside(Rule::Positive), [false, false, false, true, true]);
        assert_eq!(inside(Rule::NonZero), [true, true, false, true, true]);
        assert_eq!(inside(Rule::EvenOdd), [false, true, false, true, false]);
        for rule in Rule::ALL {
            assert_eq!(rule.to_string().parse(), Ok(rule));
        }
    }
}

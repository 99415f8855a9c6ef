//! Which boolean, and what becomes of touching operands; with the names they have in text.

use std::fmt;
use std::str::FromStr;

/// A regularised boolean operation.
///
/// In text it is `union`, `intersection`, `difference` or `xor`, as in model files and in the program.
///
/// ```
/// use trisect::Operation;
///
/// assert_eq!("xor".parse(), Ok(Operation::SymmetricDifference));
/// assert_eq!(Operation::Union.to_string(), "union");
/// assert!("merge".parse::<Operation>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Operation {
    /// What is in any operand.
    Union,
    /// What is in all operands.
    Intersection,
    /// What is in the first and in none of the others.
    Difference,
    /// What is in an odd number of operands.
    #[cfg_attr(feature = "serde", serde(rename = "xor"))]
    SymmetricDifference,
}

/// What becomes of operands of a union that touch without overlapping. In text `fuse` or `separate`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Contact {
    /// Touching faces vanish: the bodies become one. (Bodies that touch in an edge or a vertex alone stay apart.)
    #[default]
    Fuse,
    /// Touching bodies stay apart, each with its own face.
    Separate,
}

impl Operation {
    /// All operations.
    pub const ALL: [Self; 4] = [Self::Union, Self::Intersection, Self::Difference, Self::SymmetricDifference];

    /// The name in text.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
            Self::SymmetricDifference => "xor",
        }
    }
}

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Operation {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        let found = Self::ALL.into_iter().find(|operation| operation.name() == text);
        const NAMES: [&str; Operation::ALL.len()] = {
            let mut names = [""; Operation::ALL.len()];
            let mut i = 0;
            while i < names.len() {
                names[i] = Operation::ALL[i].name();
                i += 1;
            }
            names
        };
        found.ok_or_else(|| UnknownName::new(text, "operation", &NAMES))
    }
}

impl Contact {
    /// The name in text.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fuse => "fuse",
            Self::Separate => "separate",
        }
    }
}

impl fmt::Display for Contact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Contact {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        let found = [Self::Fuse, Self::Separate].into_iter().find(|contact| contact.name() == text);
        found.ok_or_else(|| UnknownName::new(text, "contact", &["fuse", "separate"]))
    }
}

/// A text that names none of a few known things.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {kind} '{given}': known are {}", known.join(", "))]
#[non_exhaustive]
pub struct UnknownName {
    /// The text given.
    pub given: String,
    /// What it should have named: "operation", "contact".
    pub kind: &'static str,
    /// The names there are.
    pub known: &'static [&'static str],
}

impl UnknownName {
    pub(crate) fn new(given: &str, kind: &'static str, known: &'static [&'static str]) -> Self {
        Self { given: given.to_owned(), kind, known }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for operation in Operation::ALL {
            assert_eq!(operation.to_string().parse(), Ok(operation));
        }
        for contact in [Contact::Fuse, Contact::Separate] {
            assert_eq!(contact.to_string().parse(), Ok(contact));
        }
        let error = "Union".parse::<Operation>().expect_err("names are in lower case");
        assert_eq!(
            error.to_string(),
            "unknown operation 'Union': known are union, intersection, difference, xor"
        );
        assert_eq!(format!("{:>6}", Operation::Union), " union");
    }
}

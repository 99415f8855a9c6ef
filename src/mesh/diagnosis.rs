//! What is wrong with a mesh: counts and a few places each.

use std::fmt;

/// Faults found in a mesh: how many of each, and where a few of them are.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Diagnosis {}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no faults")
    }
}

//! What a result is to be like.

use crate::Error;
use crate::boolean::complex::operation::Contact;
use crate::boolean::expression::rule::Rule;
use crate::boolean::general::embed::Grid;

/// What becomes of crossings that rounding makes. Every new point is rounded once, so that parts of a result that are closer to
/// each other than rounding may cross by as much.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Embed {
    /// They stay: every new coordinate is the exact one, rounded to nearest.
    #[default]
    Never,
    /// They are looked for where new triangles are no higher than rounding, and resolved.
    WhereNeeded,
    /// They are looked for where the operation made triangles, and resolved if there are any. What operands bring with them elsewhere
    /// stays as it is. Some tens of nanoseconds a triangle of the result. What the program does by itself.
    NearCut,
    /// All coordinates are numbers of a grid, and what crosses on it is resolved: the result does not cross itself when it is
    /// written in a format with such numbers. Always looked for, in some tenths of a microsecond a triangle.
    OnGrid(Grid),
}

/// What a result is to be like.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Policy {
    /// What becomes of operands that touch.
    pub(crate) contact: Contact,
    /// Whether vertices that nobody needs are left out where the operation cuts.
    pub(crate) remove_vertices: bool,
    /// Whether operands of which it is not known are taken not to cross themselves.
    pub(crate) assume_clean: bool,
    /// What is inside an operand, unless it has a rule of its own.
    pub(crate) rule: Rule,
    /// What becomes of crossings that rounding makes.
    pub(crate) embed: Embed,
    /// The distance within which operands are welded to each other before.
    pub(crate) snap: Option<f64>,
}

impl Policy {
    /// Whether what lies in one plane but for rounding becomes one face: not where every point is to stay as it was rounded.
    pub(crate) fn flattens(&self) -> bool {
        self.remove_vertices && (self.embed != Embed::Never || self.snap.is_some())
    }
}

/// The error of a call without operands.
pub(super) fn no_operands() -> Error {
    Error::InvalidArgument("a boolean needs at least one operand".into())
}

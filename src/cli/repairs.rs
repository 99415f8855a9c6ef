//! What is mended in an input, as the command line asks for it.

use trisect::mesh::{Gate, Welding};

/// What is done with an input to make it an operand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Repairs {
    pub(crate) weld: Welding,
    pub(crate) orient: bool,
    pub(crate) closed_parts: bool,
    pub(crate) as_is: bool,
}

impl Repairs {
    /// These, and those that are asked for all inputs.
    pub(crate) fn with(self, all: Self) -> Self {
        Self {
            weld: if self.weld == Welding::Rounding { all.weld } else { self.weld },
            orient: self.orient || all.orient,
            closed_parts: self.closed_parts || all.closed_parts,
            as_is: self.as_is || all.as_is,
        }
    }

    /// The gate that does this.
    pub(crate) fn gate(self) -> Gate {
        Gate::new()
            .weld(self.weld)
            .orient(self.orient)
            .closed_parts(self.closed_parts)
            .as_is(self.as_is)
            .single_shells(!self.as_is)
    }

    /// Which two of these contradict each other.
    pub(crate) fn contradiction(self) -> Option<&'static str> {
        let other = if self.weld != Welding::Rounding { "--weld" } else { "--closed-parts" };
        (self.as_is && (self.closed_parts || self.weld != Welding::Rounding)).then_some(other)
    }
}

//! What is mended in an input, as the command line asks for it.

use trisect::mesh::{Gate, Welding};

/// What is done with an input to make it an operand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Repairs {
    pub(crate) weld: Welding,
    pub(crate) orient: bool,
    pub(crate) closed_parts: bool,
    pub(crate) as_is: bool,
    /// Holes with up to so many edges are filled.
    pub(crate) fill_holes: Option<usize>,
    /// What fills them is refined.
    pub(crate) refine_holes: bool,
}

impl Repairs {
    /// These, and those that are asked for all inputs.
    pub(crate) fn with(self, all: Self) -> Self {
        Self {
            weld: if self.weld == Welding::Rounding { all.weld } else { self.weld },
            orient: self.orient || all.orient,
            closed_parts: self.closed_parts || all.closed_parts,
            as_is: self.as_is || all.as_is,
            fill_holes: self.fill_holes.or(all.fill_holes),
            refine_holes: self.refine_holes || all.refine_holes,
        }
    }

    /// The gate that does this.
    pub(crate) fn gate(self) -> Gate {
        let gate = match self.fill_holes {
            Some(most) => Gate::new().fill_holes(most),
            None if self.refine_holes => Gate::new().fill_holes(usize::MAX),
            None => Gate::new(),
        };
        gate.refine_holes(self.refine_holes)
            .weld(self.weld)
            .orient(self.orient)
            .closed_parts(self.closed_parts)
            .as_is(self.as_is)
            .single_shells(!self.as_is)
    }

    /// Which two of these contradict each other.
    pub(crate) fn contradiction(self) -> Option<&'static str> {
        let contradictions = [
            (self.weld != Welding::Rounding, "--weld"),
            (self.closed_parts, "--closed-parts"),
            (self.fill_holes.is_some(), "--fill-holes"),
            (self.refine_holes, "--refine-holes"),
        ];
        contradictions.into_iter().find(|&(is_asked, _)| self.as_is && is_asked).map(|(_, name)| name)
    }
}

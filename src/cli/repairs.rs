//! What is mended in an input: what the command line asks for, and which options would make a refused one usable.

use trisect::mesh::{Gate, Welding};
use trisect::{Control, Error, Mesh, MeshError};

use super::operands;

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

/// Options that make a refused input usable. They have been tried.
#[derive(Clone, Debug)]
pub(crate) struct Remedy {
    /// The options to add, as on the command line; empty if one is to be left out.
    pub(crate) options: String,
    /// What they do to this input.
    effect: String,
}

impl Remedy {
    /// What to do, as the end of a sentence.
    pub(crate) fn text(&self) -> String {
        match self.options.as_str() {
            "" => format!("usable without --as-is ({})", self.effect),
            options => format!("usable with {options} ({})", self.effect),
        }
    }
}

/// The first of few sets of options that makes `mesh` usable, which was refused with `error` under `repairs`: as small a
/// set as there is. Each set is tried in full, the check for self-crossings included.
pub(crate) fn remedy(
    mesh: &Mesh,
    error: &Error,
    repairs: Repairs,
    assume_clean: bool,
    control: &Control,
) -> Option<Remedy> {
    let inwards = matches!(error, Error::Mesh(MeshError::InsideOut { .. } | MeshError::InsideOutShells(_)));
    if !inwards && !matches!(error, Error::Mesh(MeshError::NotClosed(_))) {
        return None;
    }
    let mut sets = Vec::new();
    if repairs.as_is {
        sets.push((String::new(), Repairs { as_is: false, ..repairs }));
    }
    let (weld, orient, parts) = ("--weld auto", "--orient", "--closed-parts");
    for names in [
        &[weld][..],
        &[orient],
        &[parts],
        &[weld, orient],
        &[weld, parts],
        &[orient, parts],
        &[weld, orient, parts],
    ] {
        let has = |name: &str| names.contains(&name);
        let set_already = (has(weld) && repairs.weld != Welding::Rounding)
            || (has(orient) && repairs.orient)
            || (has(parts) && repairs.closed_parts);
        if set_already || (inwards && names != [orient]) {
            continue;
        }
        let tried = Repairs {
            weld: if has(weld) { Welding::Closing } else { repairs.weld },
            orient: repairs.orient || has(orient),
            closed_parts: repairs.closed_parts || has(parts),
            as_is: false,
        };
        sets.push((names.join(" "), tried));
    }
    let mut crossing = None;
    for (options, tried) in sets {
        let Ok(usable) = operands::tried(mesh.clone(), tried, assume_clean, control) else { continue };
        if usable.solid.is_empty() {
            continue;
        }
        let remedy = Remedy { options, effect: operands::effect(usable.solid.mending()) };
        // What crosses itself afterwards is usable as well, but the second choice.
        if usable.crossings.is_none_or(|crossings| crossings.count == 0) {
            return Some(remedy);
        }
        crossing.get_or_insert(remedy);
    }
    crossing
}

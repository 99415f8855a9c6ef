//! Options that would make a refused input usable, in words.

/// Options that make a refused input usable. They have been tried.
#[derive(Clone, Debug)]
pub(crate) struct Remedy {
    /// The options to add, as on the command line; empty if one is to be left out.
    pub(crate) options: String,
    /// What they do to this input.
    pub(crate) effect: String,
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

//! Smoothing groups, which are told where they are lost.

/// The smoothing groups of a chunk: whether there are several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Smoothing<'a> {
    #[default]
    None,
    One(&'a [u8]),
    Several,
}

impl<'a> Smoothing<'a> {
    /// One more; "off" and 0 are none.
    pub(super) fn add(&mut self, name: &'a [u8]) {
        if matches!(name, b"off" | b"0" | b"") {
            return;
        }
        *self = match *self {
            Self::None => Self::One(name),
            Self::One(known) if known == name => Self::One(known),
            _ => Self::Several,
        };
    }
}

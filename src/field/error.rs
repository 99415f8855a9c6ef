//! What can be wrong with a field that is to be evaluated or meshed.

/// A field that cannot be evaluated or meshed as asked.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// The solid may go on for ever.
    #[error(
        "cannot tell where the solid ends along {axis}: it may be unbounded; give it bounds, or cut it off with another \
         shape"
    )]
    Unbounded {
        /// The axis along which it may: x, y or z.
        axis: char,
    },
    /// The solid goes on outside the box it is meshed in.
    #[error(
        "the solid does not end inside the box: it reaches ({:.6}, {:.6}, {:.6}) on its boundary; give larger bounds, or \
         clip the solid to the box", place[0], place[1], place[2]
    )]
    LeavesBox {
        /// A point of the solid on the boundary of the box.
        place: [f64; 3],
    },
    /// The field has no value somewhere.
    #[error(
        "the field is not a number at ({}, {}, {}): a root or logarithm of a negative number, or 0/0; restrict the formula \
         to where it is defined", place[0], place[1], place[2]
    )]
    NotANumber {
        /// Where.
        place: [f64; 3],
    },
    /// There is no solid at all where one is needed.
    #[error("the field is positive nowhere")]
    Nowhere,
}

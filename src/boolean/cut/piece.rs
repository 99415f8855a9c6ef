//! What cutting makes.

use crate::boolean::complex::ids::PointId;
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::rounding::Rounding;

/// A triangle cut out of a face, or made from such triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) corners: [PointId; 3],
    pub(crate) origin: Origin,
    /// Whether the corners lay on one line before they were rounded.
    pub(crate) flat: bool,
}

/// Whether some of the pieces is no higher than rounding.
pub(crate) fn has_low<'p>(
    pieces: &[Piece],
    rounding: Rounding,
    position: impl Fn(PointId) -> &'p [f64; 3],
) -> bool {
    pieces.iter().any(|piece| {
        let [a, b, c] = piece.corners;
        rounding.is_low([position(a), position(b), position(c)])
    })
}

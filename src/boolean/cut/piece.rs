//! What cutting makes.

use crate::boolean::complex::ids::PointId;
use crate::boolean::complex::origin::Origin;

/// A triangle cut out of a face, or made from such triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) corners: [PointId; 3],
    pub(crate) origin: Origin,
    /// Whether the corners lay on one line before they were rounded.
    pub(crate) flat: bool,
}

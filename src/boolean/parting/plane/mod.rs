//! A solid cut in two by a plane, in one pass over it.
//!
//! The steps are fewer than those for two solids, because a plane has no size, no edges and no inside to find:
//!
//! 1. `split`: on which side of the plane each vertex lies, exactly, and what that makes of each triangle. A vertex on the plane
//!    belongs to both sides: the surface of each half runs to it, and nothing is thinner than it was given.
//! 2. `nodes`: where edges pass through, each point once for both halves. Where the edge lies between two triangles of one plane
//!    of the solid the seam runs straight on, and there is no point.
//! 3. `pieces`: what is left of each cut triangle, or of several in one plane, on either side.
//! 4. `cap`: the seam is the negative boundary of what is kept, so it is closed whatever its shape; both halves share it, and one
//!    triangulation of what it winds around.
//! 5. `separate`: what touches itself in the plane comes apart.
//! 6. `assemble`: the arrays of each half.
//!
//! `sections` (with `rings`, where there is nothing to decide) does the first, second and fourth for many parallel planes at once, and keeps the outlines: each is a `section`.

mod assemble;
mod cap;
mod cut;
mod nodes;
mod pieces;
mod rings;
mod section;
mod sections;
mod separate;
mod split;

pub use cut::PlaneCut;
pub use section::Section;
pub use sections::{SectionSide, Sections};

use crate::exact::Plane;
use crate::{Error, Outcome, Solid};

/// Here and not with [`Solid`], which lies below the booleans, because users look for it at the solid.
impl Solid {
    /// What is above the plane, and what is below it, each closed by a cap. Where they meet they have the same vertices, bit for
    /// bit, and the same triangles, turned over. O(n), and O(k log k) for the k triangles that are cut.
    ///
    /// In [`Outcome::origins`] the solid is operand 0 and the plane operand 1. [`PlaneCut`] has more to choose.
    ///
    /// ```
    /// use trisect::exact::Plane;
    /// use trisect::{Solid, primitives};
    ///
    /// let block = Solid::try_from(primitives::cuboid([0.0; 3], [2.0, 2.0, 3.0])?)?;
    /// let (above, below) = block.cut(&Plane::across(2, 1.0)?)?;
    /// assert_eq!([above.solid().volume(), below.solid().volume()], [8.0, 4.0]);
    /// assert_eq!(below.solid().mesh().triangles.len(), 12);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::TooLarge`] if the points cannot be numbered with 32 bits.
    pub fn cut(&self, plane: &Plane) -> Result<(Outcome, Outcome), Error> {
        PlaneCut::new(*plane).halves(self)
    }
}

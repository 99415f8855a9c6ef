//! Booleans of closed triangle meshes in exact general position.
//!
//! The algorithm is that of Vyatkin 2019 (steps 1 and 2) with every decision exact. All decisions are signs of one
//! determinant of perturbed input vertices, so the operands are always in general position and there is one kind of event:
//! an edge of one crosses a face of the other. The result is a sum of pieces of faces with integer multiplicities
//! (`classify::multiplicity`) whose boundary cancels identically; what perturbation kept apart at the same place is
//! identified afterwards, exactly, and where it cannot decide, faces of one plane are added up in it (`cut::plane_sums`).
//!
//! One room a step, each standing on those before it; `pair::combine` calls them in the order of `docs/algorithm.md`:
//!
//! - `complex`: the operands under one numbering, perturbed, and the one predicate;
//! - `candidates`: pairs of triangles that may meet (step 1);
//! - `arrangement`: crossings, their order, and the points they are (steps 3, 4 and 6);
//! - `classify`: winding numbers, and what is kept (step 5);
//! - `cut`: kept pieces of cut faces become triangles (step 7);
//! - `tidy`: what touches separates; triangles without area and needless vertices go (step 8);
//! - `result`: untouched triangles keep their order, and vertices their bits (step 9);
//! - `snapping`: before all that, and only where it is asked for, what is nearer than a distance is made the same;
//! - `pair`: all steps for two operands; `many`: which pairs are combined in which order;
//! - `general`: the same for any number of surfaces that may cross and touch themselves, and any `expression` of them, in one
//!   arrangement;
//! - `parting`: solids parted by planes and surfaces; `solidify`: solids of what encloses something only roughly.
//!
//! **Guaranteed** for any closed operands: the result is closed; it is the exact boolean with every new coordinate correctly
//! rounded; operands that touch resolve as regularised set operations do; the same input gives the same bits on any number of
//! threads. **Not guaranteed**: that rounding introduces no crossings of the size of an ulp.

mod arrangement;
mod candidates;
mod classify;
mod complex;
mod cut;
mod expression;
mod general;
mod many;
mod pair;
mod parting;
mod result;
mod snapping;
mod solidify;
mod tidy;

#[cfg(feature = "field")]
pub(crate) use arrangement::self_crossings::crossing_pairs;
pub use complex::operation::{Contact, Operation, UnknownName};
pub use complex::origin::Origin;
pub use expression::Expression;
pub use expression::rule::Rule;
pub use expression::text::ExpressionError;
pub use general::embed::{Embedding, Grid};
pub use many::options::BooleanOptions;
pub use many::policy::Embed;
pub use many::trim::{TrimSide, Trimmed};
pub use parting::{Cell, Imprinted, Leaf, PlaneCut, Section, SectionSide, Sections};
pub use result::attributes::CornerOrigin;
pub use result::certificate::{Certificate, OperandState};
#[cfg(feature = "subdivision")]
pub(crate) use result::chains::{Chain, chains};
pub use result::cut_faces::CutFaces;
pub use result::near_contacts::{NearContact, NearContacts};
pub use result::outcome::Outcome;
pub use snapping::report::Snapping;
pub use solidify::{Solidified, Solidify, SolidifyReport};
pub use tidy::Flattening;

use crate::{Error, Solid};

/// `a` and `b` combined by `operation`, with default [`BooleanOptions`].
///
/// # Errors
/// [`Error::TooLarge`] if the vertices cannot be numbered with 32 bits.
pub fn boolean(operation: Operation, a: &Solid, b: &Solid) -> Result<Outcome, Error> {
    BooleanOptions::new().run(operation, [a, b])
}

/// Here and not with [`Solid`], which lies below the booleans, because users look for them at the solid.
impl Solid {
    /// What is in either, with default [`BooleanOptions`].
    ///
    /// ```
    /// use trisect::{Solid, primitives};
    ///
    /// let a = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?;
    /// let b = Solid::try_from(primitives::cuboid([0.5; 3], [1.5; 3])?)?;
    /// assert_eq!(a.union(&b)?.solid().volume(), 1.875);
    /// assert_eq!(a.intersection(&b)?.solid().volume(), 0.125);
    /// assert_eq!(a.difference(&b)?.solid().volume(), 0.875);
    /// assert_eq!(a.symmetric_difference(&b)?.solid().volume(), 1.75);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`boolean`].
    pub fn union(&self, other: &Self) -> Result<Outcome, Error> {
        boolean(Operation::Union, self, other)
    }

    /// What is in both, with default [`BooleanOptions`].
    ///
    /// # Errors
    /// As [`boolean`].
    pub fn intersection(&self, other: &Self) -> Result<Outcome, Error> {
        boolean(Operation::Intersection, self, other)
    }

    /// What is in this and not in `other`, with default [`BooleanOptions`].
    ///
    /// # Errors
    /// As [`boolean`].
    pub fn difference(&self, other: &Self) -> Result<Outcome, Error> {
        boolean(Operation::Difference, self, other)
    }

    /// What is in one of the two, with default [`BooleanOptions`].
    ///
    /// # Errors
    /// As [`boolean`].
    pub fn symmetric_difference(&self, other: &Self) -> Result<Outcome, Error> {
        boolean(Operation::SymmetricDifference, self, other)
    }

    /// The volume of what is in both: zero where they do not overlap, and where they only touch. As
    /// [`BooleanOptions::overlap_volume`] with default options.
    ///
    /// ```
    /// use trisect::{Solid, primitives};
    ///
    /// let a = Solid::try_from(primitives::cuboid([0.0; 3], [1.0; 3])?)?;
    /// let b = Solid::try_from(primitives::cuboid([0.5; 3], [1.5; 3])?)?;
    /// assert_eq!(a.overlap_volume(&b)?, 0.125);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`boolean`].
    pub fn overlap_volume(&self, other: &Self) -> Result<f64, Error> {
        BooleanOptions::new().overlap_volume(self, other)
    }
}

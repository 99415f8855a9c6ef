//! Attributes of a mesh whose triangles are triangles of other meshes, or pieces of them.
//!
//! A corner that a source triangle has too keeps its value; every other one gets what the source triangle has at its place.
//! That is a function of the source triangle and the place alone, and on an edge of the edge and the place: what a cut has
//! parted still agrees, to the bit.

use super::Attribute;
use super::descent::Descent;
use super::plan::Plan;
use super::table;
use crate::control::Limit;
use crate::parallel::Runner;

/// The attributes of the new mesh: all that some source has. O(n), a few nanoseconds for each corner that stays, and about a
/// microsecond for each that is new.
///
/// # Errors
/// Only limits.
pub(crate) fn carry(descent: &Descent<'_>, runner: Runner<'_>) -> Result<Vec<Attribute>, Limit> {
    if descent.sources.iter().all(|mesh| mesh.attributes.is_empty()) {
        return Ok(Vec::new());
    }
    let plan = Plan::new(descent, runner)?;
    table::attributes(&plan, runner)
}

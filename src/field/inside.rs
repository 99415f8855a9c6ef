//! By which rule the inside of a mesh is told where the caller leaves it open.

use super::SignRule;
use super::pseudonormal::PseudoNormals;
use crate::{Control, Mesh, Solid};

/// The rule that is right for a surface, the fastest of them: pseudonormals for a closed surface that meets itself nowhere,
/// the exact winding number along a ray for other closed ones (pseudonormals of walls inside overlapping bodies point
/// outwards of one body and into the other), the fast winding number for open ones (a ray may leave through a hole).
///
/// Takes some tenths of a microsecond a triangle, for the search for crossings. Where a limit of `control` stops that search, the
/// ray decides: slower, and right for every closed surface.
pub(super) fn automatic(mesh: &Mesh, normals: &PseudoNormals, control: &Control) -> SignRule {
    if let Some(rule) = without_search(normals) {
        return rule;
    }
    match Solid::try_from(mesh.clone()) {
        Ok(solid) => of_solid(&solid, normals, control),
        // The gate refuses a closed mesh that is inside out as a whole: its inside is what is outside.
        Err(_) => SignRule::PseudoNormal,
    }
}

/// The same, for a solid, whose crossings are found once and remembered.
pub(super) fn of_solid(solid: &Solid, normals: &PseudoNormals, control: &Control) -> SignRule {
    if let Some(rule) = without_search(normals) {
        return rule;
    }
    // What an operation made is known to be clean.
    let searched = || solid.self_crossings(control).map_or(true, |found| !found.is_clean());
    let crosses = !solid.is_known_clean() && searched();
    match crosses || !solid.inside_out_shells().is_none() {
        true => SignRule::Winding,
        false => SignRule::PseudoNormal,
    }
}

/// The rule where the edges alone decide.
fn without_search(normals: &PseudoNormals) -> Option<SignRule> {
    if !normals.is_closed() {
        Some(SignRule::FastWinding)
    } else if !normals.is_regular() {
        Some(SignRule::Winding)
    } else {
        None
    }
}

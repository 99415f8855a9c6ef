//! `EXT_mesh_manifold`: which vertices of primitives are one, so that a mesh is closed without a look at positions.

use gltf_json::mesh::TRIANGLES;

use super::accessor::Accessors;
use super::budget::Budget;
use super::document::MeshObject;
use crate::Error;

/// The indices of all primitives of a mesh, one after the other, as those of a closed surface.
pub(super) struct Merged {
    pub(super) indices: Vec<u32>,
}

impl Merged {
    /// Reads what a mesh says; `Ok(Err(reason))` if it is not as the extension wants it.
    pub(super) fn read(
        object: &MeshObject<'_>,
        positions: &[[f64; 3]],
        accessors: &Accessors<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<Result<Self, &'static str>, Error> {
        let manifold = object.extensions.as_ref().and_then(|extensions| extensions.manifold.as_ref());
        let Some(manifold) = manifold else { return Ok(Err("it is not there")) };
        // 1. The indices of the primitives in their order.
        let mut indices = Vec::new();
        for primitive in &object.primitives {
            let (Some(list), TRIANGLES) = (primitive.indices, primitive.mode.unwrap_or(TRIANGLES)) else {
                return Ok(Err("a primitive has no indices or no triangles"));
            };
            let count = accessors.get(list, gltf_json::accessor::Type::Scalar, "/meshes")?.count;
            budget.charge(count.saturating_mul(8))?;
            indices.extend(accessors.indices(list, "/meshes")?);
        }
        // 2. What is merged. The places of both must be one: the surface must not move.
        if let (Some(places), Some(values)) = (manifold.merge_indices, manifold.merge_values) {
            let pointer = "/meshes/extensions/EXT_mesh_manifold";
            for accessor in [places, values] {
                let count = accessors.get(accessor, gltf_json::accessor::Type::Scalar, pointer)?.count;
                budget.charge(count.saturating_mul(4))?;
            }
            let (places, values) = (accessors.indices(places, pointer)?, accessors.indices(values, pointer)?);
            if places.len() != values.len() {
                return Ok(Err("mergeIndices and mergeValues have different counts"));
            }
            for (&place, &value) in places.iter().zip(&values) {
                let Some(index) = indices.get_mut(place as usize) else {
                    return Ok(Err("mergeIndices names a corner that is not there"));
                };
                match (positions.get(*index as usize), positions.get(value as usize)) {
                    (Some(before), Some(after)) if before == after => *index = value,
                    _ => return Ok(Err("vertices that it merges are at different places")),
                }
            }
        }
        Ok(Ok(Self { indices }))
    }
}

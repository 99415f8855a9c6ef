//! Cages beside their limit surfaces in glTF files: `extras.trisect_cage` of a mesh. Other programs see the surface.

use serde_json::Value;

use super::cage::Cage;
use super::error::CageError;
use super::json;
use crate::Error;

/// The key in a mesh's extras.
pub(crate) const KEY: &str = "trisect_cage";

/// Reads the first cage of a GLB file or a glTF file.
pub(crate) fn read(bytes: &[u8]) -> Result<Cage, Error> {
    let wrong = |what: &str| CageError::File { place: "the whole".into(), what: what.into() };
    let document: Value =
        serde_json::from_slice(document(bytes)).map_err(|_| wrong("it is neither GLB nor glTF"))?;
    let meshes = document["meshes"].as_array().map_or(&[][..], Vec::as_slice);
    let cage = meshes.iter().find_map(|mesh| mesh["extras"].get(KEY)).ok_or_else(|| {
        wrong(
            "no mesh of it has a cage (extras.trisect_cage), as `subdivide` and `freeform` write it; `convert` makes an OBJ of its \
             triangles",
        )
    })?;
    json::from_value(cage)
}

/// The JSON of a GLB file; the bytes themselves if they are none.
fn document(bytes: &[u8]) -> &[u8] {
    let Some(rest) = bytes.strip_prefix(b"glTF") else { return bytes };
    let length = rest.get(8..12).and_then(|length| length.try_into().ok()).map_or(0, u32::from_le_bytes);
    // After 16 bytes of header and chunk: the chunk's type, and its bytes.
    rest.get(16..16 + length as usize).unwrap_or_default()
}

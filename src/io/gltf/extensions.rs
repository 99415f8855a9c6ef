//! Extensions that a file requires.

use super::super::{Format, unsupported};
use crate::Error;

/// Extensions that change geometry and are understood.
const UNDERSTOOD: &[&str] = &[
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_manifold",
    #[cfg(feature = "draco")]
    "KHR_draco_mesh_compression",
];

/// Beginnings of the names of extensions that do not change geometry: materials, textures, lights, metadata.
const HARMLESS: [&str; 14] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_animation_",
    "KHR_interactivity",
    "KHR_audio",
    "KHR_techniques_webgl",
    "EXT_texture_",
    "EXT_lights_",
    "EXT_structural_metadata",
    "EXT_mesh_features",
    "MSFT_texture_",
    "MSFT_lod",
];

/// Refuses a file that cannot be read right without an extension that is not known here.
pub(super) fn check(required: &[String], format: Format) -> Result<(), Error> {
    let unknown = required.iter().find(|name| {
        !UNDERSTOOD.contains(&name.as_str()) && !HARMLESS.iter().any(|beginning| name.starts_with(beginning))
    });
    match unknown {
        None => Ok(()),
        Some(name) => Err(unsupported(
            format,
            format!(
                "the file requires the extension {}, which is not known here{}",
                shown(name),
                advice(name)
            ),
        )),
    }
}

/// How to write the file without an extension.
pub(super) fn advice(name: &str) -> &'static str {
    match name {
        "KHR_draco_mesh_compression" => DRACO_ADVICE,
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => MESHOPT_ADVICE,
        _ => "; export the model without it",
    }
}

/// The advice for Draco.
pub(super) const DRACO_ADVICE: &str = "; decompress the file with \"gltf-transform copy in.glb out.glb\" or export it without Draco compression";

/// The advice for meshopt.
const MESHOPT_ADVICE: &str = "; decompress the file with \"gltf-transform copy in.glb out.glb\" or \"gltfpack -noq -i in.glb -o out.glb\"";

fn shown(name: &str) -> String {
    name.chars().filter(|character| !character.is_control()).take(80).collect()
}

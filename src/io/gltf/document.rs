//! The parts of a glTF document that matter for its geometry. Everything else in the file is skipped.
//!
//! Where the types of the crate [`gltf_json`] hold what is read, they are used: the asset, types of accessors and
//! of their components, modes of primitives, materials. What they cannot hold has structures here:
//!
//! - nodes: transforms are single precision there, and an empty node takes two hundred bytes, seventy times its text;
//! - the document, scenes and buffers: `Root` holds every list of the file at once (cameras, animations, textures),
//!   `Scene` refuses a scene without nodes, which the standard allows, `Buffer` copies its data URI, and takes eighty
//!   bytes for `{}`;
//! - accessors: `min` and `max` become trees of values, up to a hundred times their text, and a component type that
//!   does not exist loses its number, which the error tells;
//! - buffer views and sparse values: an index there is cut to its lowest 32 bits, so that 2^32 would read as 0;
//! - primitives: an extension that the crate does not know (Draco) is either lost or a tree of values;
//! - materials stay as text until a primitive shows them: an empty one would take a hundred times its text.
//!
//! So a file of nothing but `{},{},{}` does not grow in memory; `tests/format_memory.rs` measures it.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use gltf_json::Asset;
use gltf_json::accessor::Type;
use gltf_json::validation::Checked;
use serde::de::{IgnoredAny, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document<'a> {
    pub(super) asset: Asset,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    pub(super) scene: Option<u32>,
    #[serde(default)]
    pub(super) scenes: Vec<Scene>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default, borrow)]
    pub(super) meshes: Vec<MeshObject<'a>>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<View>,
    #[serde(default, borrow)]
    pub(super) buffers: Vec<Buffer<'a>>,
    #[serde(default, borrow)]
    pub(super) materials: Vec<&'a RawValue>,
    #[serde(default, borrow)]
    pub(super) textures: Vec<&'a RawValue>,
    #[serde(default, borrow)]
    pub(super) images: Vec<&'a RawValue>,
    #[serde(default, borrow)]
    pub(super) samplers: Vec<&'a RawValue>,
    #[serde(default, borrow)]
    pub(super) animations: Vec<&'a RawValue>,
    #[serde(default)]
    pub(super) cameras: Count,
    pub(super) extras: Option<IgnoredAny>,
    pub(super) extensions: Option<DocumentExtensions>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Box<[u32]>,
    pub(super) extras: Option<IgnoredAny>,
}

/// A node; `None` if it shows no mesh and has neither children nor extras.
#[derive(Debug)]
pub(super) struct Node(pub(super) Option<Box<NodeFields>>);

#[derive(Debug, Deserialize)]
pub(super) struct NodeFields {
    pub(super) name: Option<Box<str>>,
    pub(super) mesh: Option<u32>,
    #[serde(default)]
    pub(super) children: Box<[u32]>,
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<Box<[f64; 3]>>,
    pub(super) rotation: Option<Box<[f64; 4]>>,
    pub(super) scale: Option<Box<[f64; 3]>>,
    pub(super) skin: Option<u32>,
    pub(super) weights: Option<Box<[f64]>>,
    pub(super) extras: Option<IgnoredAny>,
    pub(super) extensions: Option<Box<NodeExtensions>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Instancing {
    pub(super) attributes: InstancingAttributes,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) struct InstancingAttributes {
    pub(super) translation: Option<u32>,
    pub(super) rotation: Option<u32>,
    pub(super) scale: Option<u32>,
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let fields = NodeFields::deserialize(deserializer)?;
        let empty = fields.mesh.is_none() && fields.children.is_empty() && fields.extras.is_none();
        Ok(Self((!empty).then(|| Box::new(fields))))
    }
}

#[derive(Debug, Deserialize)]
pub(super) struct MeshObject<'a> {
    pub(super) name: Option<Box<str>>,
    #[serde(borrow)]
    pub(super) primitives: Box<[Primitive<'a>]>,
    pub(super) weights: Option<Box<[f64]>>,
    pub(super) extras: Option<IgnoredAny>,
    pub(super) extensions: Option<Box<MeshExtensions>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct MeshExtensions {
    #[serde(rename = "EXT_mesh_manifold")]
    pub(super) manifold: Option<Manifold>,
}

/// Which indices of the primitives, one after the other, become which so that the surface is closed.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Manifold {
    pub(super) merge_indices: Option<u32>,
    pub(super) merge_values: Option<u32>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive<'a> {
    /// Names and accessors, as text until the primitive is shown.
    #[serde(borrow)]
    pub(super) attributes: &'a RawValue,
    pub(super) indices: Option<u32>,
    pub(super) material: Option<u32>,
    /// One of [`gltf_json::mesh::VALID_MODES`], if the file is right.
    pub(super) mode: Option<u32>,
    /// Morph targets, as text until the primitive is shown.
    #[serde(borrow)]
    pub(super) targets: Option<&'a RawValue>,
    #[serde(borrow)]
    pub(super) extras: Option<&'a RawValue>,
    pub(super) extensions: Option<Box<PrimitiveExtensions>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<Draco>,
}

/// Where the compressed form of a primitive is, and which of its attributes have which numbers there.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(not(feature = "draco"), expect(dead_code, reason = "Draco is left out"))]
pub(super) struct Draco {
    #[serde(default)]
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) attributes: BTreeMap<String, u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<u32>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    /// One of [`gltf_json::accessor::VALID_COMPONENT_TYPES`], if the file is right.
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: Checked<Type>,
    pub(super) sparse: Option<Box<Sparse>>,
}

/// What replaces some items of an accessor.
#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer<'a> {
    pub(super) byte_length: u64,
    #[serde(default, borrow)]
    pub(super) uri: Option<Cow<'a, str>>,
}

/// What is kept of a material that the crate's type refuses, for a value of another kind or one that is null.
#[derive(Debug, Default, Deserialize)]
pub(super) struct PlainMaterial {
    #[serde(rename = "pbrMetallicRoughness")]
    pub(super) surface: Option<PlainSurface>,
}

#[derive(Debug, Deserialize)]
pub(super) struct PlainSurface {
    #[serde(rename = "baseColorFactor")]
    pub(super) base_color: Option<[f32; 4]>,
}

#[derive(Debug, Deserialize)]
pub(super) struct DocumentExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) lights: Option<Lights>,
    #[serde(rename = "KHR_materials_variants")]
    pub(super) variants: Option<Variants>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Lights {
    #[serde(default)]
    pub(super) lights: Count,
}

#[derive(Debug, Deserialize)]
pub(super) struct Variants {
    #[serde(default)]
    pub(super) variants: Count,
}

/// What has a name.
#[derive(Debug, Default, Deserialize)]
pub(super) struct Named {
    pub(super) name: Option<String>,
}

/// A list of which nothing but the length is kept.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Count(pub(super) usize);

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Counter;
        impl<'de> Visitor<'de> for Counter {
            type Value = Count;
            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a list")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Count, A::Error> {
                let mut count = 0;
                while list.next_element::<IgnoredAny>()?.is_some() {
                    count += 1;
                }
                Ok(Count(count))
            }
        }
        deserializer.deserialize_seq(Counter)
    }
}

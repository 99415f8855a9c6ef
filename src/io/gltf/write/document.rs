//! The JSON of a file.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use gltf_json::accessor::ComponentType;
use serde_json::{Map, Value, json};

use super::super::super::WriteOptions;
use super::super::super::pictures::PictureFile;
use super::frame::Frame;
use super::layout::{Layout, Part, Section};
use super::materials::{Known, Lists, MaterialList};
use crate::mesh::{MaterialText, is_two_manifold};
use crate::{Error, Material, Mesh};

const ARRAY_BUFFER: u32 = 34_962;
const ELEMENT_ARRAY_BUFFER: u32 = 34_963;
/// The mode of primitives.
const TRIANGLES: u32 = 4;

/// What a document has of a mesh.
pub(in crate::io::gltf) struct Fragment<'a> {
    pub(in crate::io::gltf) layout: Layout<'a>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    lists: Lists,
    used: Vec<String>,
}

/// What is added to a document, its numbers counted on from those there.
pub(in crate::io::gltf) struct Additions {
    pub(in crate::io::gltf) mesh: Option<Value>,
    pub(in crate::io::gltf) lists: Vec<(&'static str, Vec<Value>)>,
    pub(in crate::io::gltf) used: Vec<String>,
    pub(in crate::io::gltf) required: Vec<String>,
}

/// The numbers of materials so far: groups mostly share them, and their text is parsed once.
#[derive(Default)]
struct MaterialNumbers<'a>(HashMap<(*const MaterialText, &'a str), Vec<(&'a Material, u32)>>);

impl<'a> MaterialNumbers<'a> {
    fn of(&mut self, material: &'a Material, list: &mut MaterialList<'_>) -> u32 {
        let text = material.text.as_ref().map_or(std::ptr::null(), Arc::as_ptr);
        let known = self.0.entry((text, &material.name)).or_default();
        if let Some(&(_, number)) = known.iter().find(|(other, _)| *other == material) {
            return number;
        }
        let number = list.add(material);
        known.push((material, number));
        number
    }
}

impl<'a> Fragment<'a> {
    /// The mesh as one of a scene that is there already, in the coordinates of its node.
    pub(in crate::io::gltf) fn in_node(
        mesh: &'a Mesh,
        known: Known,
        skinned: bool,
        options: &WriteOptions,
        warnings: &mut Vec<String>,
    ) -> Result<Self, Error> {
        let layout = Layout::new(mesh, Frame::plain(mesh), skinned, warnings);
        if !mesh.positions.as_flattened().iter().all(|&x| (x as f32).is_finite()) {
            return Err(Error::InvalidArgument(
                "coordinates are beyond single precision in the node's scene".into(),
            ));
        }
        let manifold = options.manifold && is_two_manifold(mesh);
        if options.manifold && !manifold {
            warnings.push(NOT_MANIFOLD.to_string());
        }
        Ok(Self::new(layout, None, known, manifold, true, warnings))
    }

    /// The parts of a document; `one` says whether all groups are in one mesh.
    fn new(
        mut layout: Layout<'a>,
        pictures: Option<&'a [PictureFile]>,
        known: Known,
        manifold: bool,
        one: bool,
        warnings: &mut Vec<String>,
    ) -> Self {
        if manifold {
            layout.find_merges();
        }
        // 1. Materials first: their pictures are the last sections of the buffer.
        let mut materials = MaterialList::new(pictures, known);
        let groups = &layout.mesh.groups.list;
        let mut numbers = MaterialNumbers::default();
        let of_group: Vec<Option<u32>> = groups
            .iter()
            .map(|group| group.material.as_ref().map(|material| numbers.of(material, &mut materials)))
            .collect();
        layout.images = materials.embedded();
        // 2. Accessors and meshes.
        let mut objects = Objects::new(&layout);
        for part in &layout.parts {
            objects.add(&layout, part, &of_group, one);
        }
        if manifold {
            objects.add_manifold(&layout);
        }
        let Objects { accessors, meshes, .. } = objects;
        let mut lists = materials.finish(layout.view(Section::Image(0)), warnings);
        let mut used = std::mem::take(&mut lists.extensions_used);
        if manifold && !meshes.is_empty() {
            used.push("EXT_mesh_manifold".to_string());
            used.sort();
        }
        Self { layout, accessors, meshes, lists, used }
    }

    /// The additions to a document with so many buffer views and accessors and so many bytes.
    pub(in crate::io::gltf) fn shifted(&self, views: u64, accessors: u64, start: u64) -> Additions {
        if self.layout.mesh.triangles.is_empty() {
            return Additions { mesh: None, lists: Vec::new(), used: Vec::new(), required: Vec::new() };
        }
        let add = |value: &mut Value, key: &str, by: u64| {
            if let Some(number) = value.get(key).and_then(Value::as_u64) {
                value[key] = (number + by).into();
            }
        };
        let mut own_views = self::views(&self.layout);
        own_views.iter_mut().for_each(|view| add(view, "byteOffset", start));
        let mut own_accessors = self.accessors.clone();
        for accessor in &mut own_accessors {
            add(accessor, "bufferView", views);
            for part in ["indices", "values"] {
                if let Some(part) = accessor.pointer_mut(&format!("/sparse/{part}")) {
                    add(part, "bufferView", views);
                }
            }
        }
        let mut images = self.lists.images.clone();
        images.iter_mut().for_each(|image| add(image, "bufferView", views));
        let mut mesh = self.meshes.first().cloned();
        if let Some(mesh) = &mut mesh {
            let shift = |primitive: &mut Value| {
                add(primitive, "indices", accessors);
                if let Some(Value::Object(attributes)) = primitive.get_mut("attributes") {
                    for accessor in attributes.values_mut() {
                        *accessor = (accessor.as_u64().unwrap_or(0) + accessors).into();
                    }
                }
            };
            mesh["primitives"].as_array_mut().into_iter().flatten().for_each(shift);
            if let Some(extension) = mesh.pointer_mut("/extensions/EXT_mesh_manifold") {
                add(extension, "mergeIndices", accessors);
                add(extension, "mergeValues", accessors);
                extension.get_mut("manifoldPrimitive").into_iter().for_each(shift);
            }
        }
        let Lists { materials, textures, samplers, .. } = &self.lists;
        let lists = vec![
            ("bufferViews", own_views),
            ("accessors", own_accessors),
            ("materials", materials.clone()),
            ("textures", textures.clone()),
            ("samplers", samplers.clone()),
            ("images", images),
        ];
        Additions { mesh, lists, used: self.used.clone(), required: self.lists.extensions_required.clone() }
    }
}

/// The document without its buffer, and what is in that. Pictures are in the buffer unless they have files. `manifold` says
/// whether `EXT_mesh_manifold` is written, which takes a closed surface.
pub(super) fn document<'a>(
    mesh: &'a Mesh,
    pictures: Option<&'a [PictureFile]>,
    manifold: bool,
    warnings: &mut Vec<String>,
) -> (Layout<'a>, Map<String, Value>) {
    let layout = Layout::new(mesh, Frame::of(mesh), false, warnings);
    let fragment = Fragment::new(layout, pictures, Known::default(), manifold, manifold, warnings);
    let Fragment { layout, accessors, meshes, lists, used } = fragment;
    let nodes = nodes(&layout, &meshes);
    let mut document = Map::new();
    let mut set = |key: &str, value: Value| {
        if value.as_array().is_none_or(|list| !list.is_empty()) {
            document.insert(key.to_string(), value);
        }
    };
    set("asset", asset());
    set("scene", json!(0));
    set("scenes", json!([{"nodes": nodes.roots}]));
    set("nodes", nodes.list.into());
    set("meshes", meshes.into());
    set("accessors", accessors.into());
    set("bufferViews", views(&layout).into());
    set("extensionsUsed", used.into());
    set("extensionsRequired", lists.extensions_required.into());
    set("materials", lists.materials.into());
    set("textures", lists.textures.into());
    set("samplers", lists.samplers.into());
    set("images", lists.images.into());
    (layout, document)
}

/// What is said where `EXT_mesh_manifold` cannot hold the mesh.
pub(super) const NOT_MANIFOLD: &str =
    "EXT_mesh_manifold not written: there are edges with other than two triangles, one for each direction";

pub(super) fn asset() -> Value {
    json!({"version": "2.0", "generator": concat!("trisect ", env!("CARGO_PKG_VERSION"))})
}

/// Nodes, and which of them are roots.
struct Nodes {
    list: Vec<Value>,
    roots: Vec<usize>,
}

/// A node for each mesh, under one more if they are placed and several.
fn nodes(layout: &Layout<'_>, meshes: &[Value]) -> Nodes {
    let node = |(index, mesh): (usize, &Value)| match mesh.get("name") {
        Some(name) => json!({"mesh": index, "name": name}),
        None => json!({"mesh": index}),
    };
    let mut list: Vec<Value> = meshes.iter().enumerate().map(node).collect();
    let mut roots: Vec<usize> = (0..list.len()).collect();
    let frame = &layout.frame;
    if frame.offset != DVec3::ZERO || frame.scale != 1.0 {
        if list.len() > 1 {
            list.push(json!({"children": roots}));
            roots = vec![list.len() - 1];
        }
        // In double precision, which JSON has: in single precision the model would move.
        let root = &mut list[roots[0]];
        root["translation"] = json!(frame.offset.to_array());
        if frame.scale != 1.0 {
            root["scale"] = json!([frame.scale, frame.scale, frame.scale]);
        }
    }
    Nodes { list, roots }
}

fn views(layout: &Layout<'_>) -> Vec<Value> {
    let view = |(section, start, length): (Section, u64, u64)| {
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": length});
        match section {
            Section::Positions => view["target"] = ARRAY_BUFFER.into(),
            Section::Column(index) => {
                view["target"] = ARRAY_BUFFER.into();
                view["byteStride"] = layout.columns[index].stride().into();
            }
            Section::Indices => view["target"] = ELEMENT_ARRAY_BUFFER.into(),
            Section::MergePlaces | Section::MergeVertices | Section::Image(_) => {}
        }
        view
    };
    layout.sections().into_iter().map(view).collect()
}

/// Accessors and meshes, part by part.
struct Objects<'a> {
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    known: HashMap<&'a str, usize>,
    /// Indices so far.
    before: u64,
}

impl<'a> Objects<'a> {
    /// The accessors of vertices alone.
    fn new(layout: &Layout<'a>) -> Self {
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        for vertex in 0..layout.vertices.len() as u32 {
            let local = layout.frame.local(layout.mesh.positions[layout.vertices.source(vertex) as usize]);
            for axis in 0..3 {
                low[axis] = low[axis].min(local[axis]);
                high[axis] = high[axis].max(local[axis]);
            }
        }
        let count = layout.vertices.len();
        let mut positions = json!({
            "bufferView": 0, "componentType": ComponentType::F32.as_gl_enum(), "count": count, "type": "VEC3"
        });
        (positions["min"], positions["max"]) = (json!(low.map(f64::from)), json!(high.map(f64::from)));
        let mut accessors = vec![positions];
        for (index, column) in layout.columns.iter().enumerate() {
            let (component, normalized) = column.number.component_type();
            let shape = ["SCALAR", "VEC2", "VEC3", "VEC4"][column.components().clamp(1, 4) - 1];
            let mut accessor = json!({
                "bufferView": layout.view(Section::Column(index)), "componentType": component.as_gl_enum(),
                "count": count, "type": shape
            });
            if normalized {
                accessor["normalized"] = true.into();
            }
            accessors.push(accessor);
        }
        Self { accessors, meshes: Vec::new(), known: HashMap::new(), before: 0 }
    }

    /// A primitive for a part; in the mesh of its group's name, or in one for all.
    fn add(&mut self, layout: &Layout<'a>, part: &Part, materials: &[Option<u32>], one: bool) {
        let count = 3 * part.triangles.len() as u64;
        let mut indices = indices(layout, Section::Indices, count);
        indices["byteOffset"] = (layout.index_size() * self.before).into();
        self.before += count;
        let group = part.group.and_then(|group| layout.mesh.groups.list.get(group));
        let name = group.map_or("", |group| &*group.name);
        let mut primitive = json!({
            "attributes": attributes(layout, part), "indices": self.accessors.len(), "mode": TRIANGLES
        });
        self.accessors.push(indices);
        if let Some(material) = part.group.and_then(|group| materials.get(group).copied().flatten()) {
            primitive["material"] = material.into();
        }
        if one && !name.is_empty() {
            primitive["extras"] = json!({"group": name});
        }
        let key = if one { "" } else { name };
        let mesh = *self.known.entry(key).or_insert_with(|| {
            self.meshes.push(if key.is_empty() {
                json!({"primitives": []})
            } else {
                json!({"name": key, "primitives": []})
            });
            self.meshes.len() - 1
        });
        if let Some(list) = self.meshes[mesh]["primitives"].as_array_mut() {
            list.push(primitive);
        }
    }

    /// The closed surface: all indices, with those of seams replaced.
    fn add_manifold(&mut self, layout: &Layout<'_>) {
        let Some(mesh) = self.meshes.first_mut() else { return };
        let mut all = indices(layout, Section::Indices, 3 * layout.mesh.triangles.len() as u64);
        let mut extension = Map::new();
        let count = layout.merges.len();
        let mut further = Vec::new();
        if count > 0 {
            let wide = ComponentType::U32.as_gl_enum();
            let (places, values) = (layout.view(Section::MergePlaces), layout.view(Section::MergeVertices));
            all["sparse"] = json!({
                "count": count, "indices": {"bufferView": places, "componentType": wide}, "values": {"bufferView": values}
            });
            further
                .push(json!({"bufferView": places, "componentType": wide, "count": count, "type": "SCALAR"}));
            further.push(indices(layout, Section::MergeVertices, count as u64));
            extension.insert("mergeIndices".into(), (self.accessors.len() + 1).into());
            extension.insert("mergeValues".into(), (self.accessors.len() + 2).into());
        }
        let primitive =
            json!({"attributes": {"POSITION": 0}, "indices": self.accessors.len(), "mode": TRIANGLES});
        extension.insert("manifoldPrimitive".into(), primitive);
        mesh["extensions"] = json!({"EXT_mesh_manifold": extension});
        self.accessors.push(all);
        self.accessors.append(&mut further);
    }
}

/// An accessor of vertex numbers.
fn indices(layout: &Layout<'_>, section: Section, count: u64) -> Value {
    let component = if layout.is_wide() { ComponentType::U32 } else { ComponentType::U16 };
    json!({
        "bufferView": layout.view(section), "componentType": component.as_gl_enum(), "count": count, "type": "SCALAR"
    })
}

/// The attributes of a part. A set of texture coordinates or colours is there only with those before it, so the file has
/// `TEXCOORD_0`, if filled up, wherever it has `TEXCOORD_1`.
fn attributes(layout: &Layout<'_>, part: &Part) -> Map<String, Value> {
    let mut attributes = Map::new();
    attributes.insert("POSITION".to_string(), 0.into());
    let has = |index: usize| part.columns >> index & 1 == 1;
    for (index, column) in layout.columns.iter().enumerate() {
        let name = &column.attribute.name;
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let later = |(other, column): (usize, &super::columns::Column<'_>)| {
            stem.ends_with('_') && !stem.starts_with('_') && has(other) && {
                let other = &column.attribute.name;
                other.starts_with(stem) && (other.len(), other) > (name.len(), name)
            }
        };
        if has(index) || layout.columns.iter().enumerate().any(later) {
            attributes.insert(name.clone(), (1 + index).into());
        }
    }
    attributes
}

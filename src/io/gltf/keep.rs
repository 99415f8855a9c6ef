//! A scene in which one node gets another mesh, and all else stays as it is.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::super::notes::Notes;
use super::super::rounding::{Measure, Written, examined};
use super::super::text::write_all;
use super::super::{Format, FormatError, ReadOptions, WriteOptions, file, malformed};
use super::Reader;
use super::budget::Budget;
use super::buffers::Buffers;
use super::container;
use super::document::{Document, Node, NodeFields};
use super::joints;
use super::materials::Materials;
use super::place::{Place, find, in_node};
use super::write::{Fragment, Known, write_container};
use crate::{Error, Material, Mesh};

/// A glTF scene of which one node gets another mesh when it is written
/// ([`WriteOptions::in_scene`](super::super::WriteOptions::in_scene)). Its other nodes, cameras, lights and animations stay.
#[derive(Clone, Debug)]
pub struct KeptScene {
    bytes: Arc<[u8]>,
    format: Format,
    folder: PathBuf,
    node: String,
}

impl KeptScene {
    /// The scene of a file's bytes; files that it names are not found.
    #[cfg(test)]
    pub(super) fn of_bytes(bytes: Vec<u8>, format: Format, node: &str) -> Self {
        Self { bytes: bytes.into(), format, folder: PathBuf::from("no such folder"), node: node.to_owned() }
    }

    /// The scene of a file, and the node in it: by its name, or "PARENT/NAME".
    ///
    /// # Errors
    /// [`Error::File`], [`FormatError::Unknown`], and [`FormatError::Unsupported`] if it is no glTF file. Whether the node is
    /// there is found when the scene is written.
    pub fn load(path: impl AsRef<Path>, node: impl Into<String>) -> Result<Self, Error> {
        let path = path.as_ref();
        let bytes = file::bytes(path)?;
        let format = Format::detect(Some(path), &bytes)?.format;
        if !matches!(format, Format::Gltf | Format::Glb) {
            return Err(
                FormatError::Unsupported { format, what: "only glTF files have scenes".into() }.into()
            );
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new(".")).to_path_buf();
        Ok(Self { bytes: bytes.into(), format, folder, node: node.into() })
    }

    /// Whether the node is there, be it without any mesh: a place for one.
    ///
    /// # Errors
    /// What is wrong with the document, and [`Error::InvalidArgument`] if several nodes have the name.
    pub fn has_node(&self) -> Result<bool, Error> {
        let mut notes = Notes::default();
        let container = container::open(&self.bytes, self.format, &mut notes)?;
        let broken = |error: serde_json::Error| malformed(self.format, "JSON", error.to_string());
        let mut document: Document<'_> = serde_json::from_slice(container.json).map_err(broken)?;
        take_all_nodes(&mut document, container.json).map_err(broken)?;
        let reader = Reader { document: &document, format: self.format };
        reader.check()?;
        match find(&reader, &self.node) {
            Ok(_) => Ok(true),
            Err(Error::Format(FormatError::NoSuchPart { .. })) => Ok(false),
            Err(error) => Err(error),
        }
    }
}

/// Reads the nodes again, with those that show nothing: one of them may be the place for the mesh.
fn take_all_nodes(document: &mut Document<'_>, json: &[u8]) -> Result<(), serde_json::Error> {
    #[derive(Deserialize)]
    struct Nodes {
        #[serde(default)]
        nodes: Vec<NodeFields>,
    }
    let all: Nodes = serde_json::from_slice(json)?;
    document.nodes = all.nodes.into_iter().map(|fields| Node(Some(Box::new(fields)))).collect();
    Ok(())
}

/// Writes the scene with the mesh, given in the coordinates of the scene, at its node.
pub(in crate::io) fn write(
    mesh: &Mesh,
    kept: &KeptScene,
    format: Format,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let mut notes = Notes::default();
    let read_options = ReadOptions::new().folder(&kept.folder).control(options.control.clone());
    let container = container::open(&kept.bytes, kept.format, &mut notes)?;
    let broken = |error: serde_json::Error| malformed(kept.format, "JSON", error.to_string());
    let mut document: Document<'_> = serde_json::from_slice(container.json).map_err(broken)?;
    take_all_nodes(&mut document, container.json).map_err(broken)?;
    let reader = Reader { document: &document, format: kept.format };
    reader.check()?;
    let buffers = Buffers::new(&reader, container.binary, &read_options);
    // 1. The mesh in the coordinates of its node.
    let place = find(&reader, &kept.node)?;
    let mut local = in_node(mesh, &place.world)?;
    let has_skin = document.nodes[place.node].0.as_ref().is_some_and(|node| node.skin.is_some());
    if has_skin {
        joints::spread(&mut local);
    }
    // 2. Materials of the file are recognised.
    let mut budget = Budget::new(&buffers, &read_options, kept.bytes.len() as u64);
    let mut materials = Materials::new(&reader, &buffers);
    let known: Vec<Material> = (0..document.materials.len() as u32)
        .map(|index| materials.get(index, "/materials", &mut budget, &mut notes))
        .collect::<Result<_, _>>()?;
    // 3. The document, with what the mesh adds to it.
    let mut scene = Scene::new(serde_json::from_slice(container.json).map_err(broken)?);
    scene.join_buffers(&buffers, document.buffers.len())?;
    scene.take_pictures(&buffers)?;
    let counts = ["textures", "samplers", "images"].map(|key| scene.list(key).len() as u32);
    let known = Known { materials: known, textures: counts[0], samplers: counts[1], images: counts[2] };
    let mut warnings = Vec::new();
    let fragment = Fragment::in_node(&local, known, has_skin, options, &mut warnings)?;
    scene.replace(&place, &fragment);
    warnings.append(&mut scene.warnings);
    let (json, bytes) = scene.finish();
    // 4. The file.
    let total = bytes.len() as u64 + fragment.layout.bytes();
    write_container(json, total, format, output, |output| {
        write_all(output, &bytes)?;
        fragment.layout.write(output, options)
    })?;
    let mut written = Written::default();
    if !fragment.layout.frame.exact {
        written = examined(&local, format, Measure::PLAIN, options)?;
    }
    written.warnings.splice(0..0, warnings);
    Ok(written)
}

/// The document as it changes, and the one buffer that it gets.
struct Scene {
    rest: Map<String, Value>,
    lists: BTreeMap<&'static str, Vec<Value>>,
    bytes: Vec<u8>,
    warnings: Vec<String>,
}

/// The lists of a document that change.
const LISTS: [&str; 11] = [
    "accessors",
    "animations",
    "bufferViews",
    "extensionsRequired",
    "extensionsUsed",
    "images",
    "materials",
    "meshes",
    "nodes",
    "samplers",
    "textures",
];

impl Scene {
    fn new(mut rest: Map<String, Value>) -> Self {
        let mut lists = BTreeMap::new();
        for key in LISTS {
            if let Some(Value::Array(list)) = rest.remove(key) {
                lists.insert(key, list);
            }
        }
        Self { rest, lists, bytes: Vec::new(), warnings: Vec::new() }
    }

    /// A list of the document.
    fn list(&mut self, key: &'static str) -> &mut Vec<Value> {
        self.lists.entry(key).or_default()
    }

    /// The document, in which no list is empty, and its buffer.
    fn finish(self) -> (Map<String, Value>, Vec<u8>) {
        let mut json = self.rest;
        let lists = self.lists.into_iter().filter(|(_, list)| !list.is_empty());
        json.extend(lists.map(|(key, list)| (key.to_string(), list.into())));
        (json, self.bytes)
    }

    fn align(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    /// All buffers one after the other, so that one file can hold them.
    fn join_buffers(&mut self, buffers: &Buffers<'_>, count: usize) -> Result<(), Error> {
        let mut starts = Vec::with_capacity(count);
        for index in 0..count {
            self.align();
            starts.push(self.bytes.len() as u64);
            self.bytes.extend_from_slice(buffers.whole(index)?.as_slice());
        }
        self.align();
        for view in self.list("bufferViews") {
            let buffer = view.get("buffer").and_then(Value::as_u64).unwrap_or(0) as usize;
            let offset = view.get("byteOffset").and_then(Value::as_u64).unwrap_or(0);
            set(view, "byteOffset", offset + starts.get(buffer).copied().unwrap_or(0));
            set(view, "buffer", 0);
        }
        self.rest.remove("buffers");
        Ok(())
    }

    /// Pictures in files of their own come into the buffer: the scene may be written into another folder.
    fn take_pictures(&mut self, buffers: &Buffers<'_>) -> Result<(), Error> {
        for index in 0..self.list("images").len() {
            let uri = self.list("images")[index].get("uri").and_then(Value::as_str).map(str::to_owned);
            let Some(uri) = uri.filter(|uri| !uri.starts_with("data:")) else { continue };
            let pointer = format!("/images/{index}");
            let read = buffers.file_name(&uri, &pointer).and_then(|name| buffers.read_file(&name, &pointer));
            match read {
                Ok(bytes) => {
                    self.align();
                    let start = self.bytes.len();
                    let kind = crate::mesh::Image::mime_type_of(&bytes).unwrap_or("image/png");
                    self.bytes.extend_from_slice(&bytes);
                    self.align();
                    let views = self.list("bufferViews");
                    views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": bytes.len()}));
                    let view = views.len() - 1;
                    let image = &mut self.list("images")[index];
                    if image.get("mimeType").is_none() {
                        set(image, "mimeType", kind);
                    }
                    set(image, "bufferView", view);
                    if let Some(image) = image.as_object_mut() {
                        image.remove("uri");
                    }
                }
                Err(error) => self.warnings.push(format!(
                    "picture {uri:?} could not be read, the file refers to it as it did: {error}"
                )),
            }
        }
        Ok(())
    }

    /// Puts the new mesh at its node.
    fn replace(&mut self, place: &Place, fragment: &Fragment<'_>) {
        // 1. What the mesh needs, its numbers counted on from those of the document.
        let (views, accessors) = (self.list("bufferViews").len() as u64, self.list("accessors").len() as u64);
        let start = self.bytes.len() as u64;
        let additions = fragment.shifted(views, accessors, start);
        for (key, list) in additions.lists {
            if !list.is_empty() {
                self.list(key).extend(list);
            }
        }
        for (key, names) in [("extensionsUsed", additions.used), ("extensionsRequired", additions.required)] {
            for name in names {
                if !self.list(key).iter().any(|known| known.as_str() == Some(&name)) {
                    self.list(key).push(name.into());
                }
            }
        }
        // 2. The mesh.
        if self.list("nodes").len() <= place.node {
            return;
        }
        let new = additions.mesh.map(|mesh| self.put_mesh(place.node, mesh));
        // 3. The node, and those below.
        let clear = |node: &mut Value, keys: &[&str]| {
            if let Some(node) = node.as_object_mut() {
                for key in keys {
                    node.remove(*key);
                }
            }
        };
        let nodes = self.list("nodes");
        clear(&mut nodes[place.node], &["mesh", "weights"]);
        for &changed in place.below.iter().chain([&place.node]) {
            let extensions = nodes.get_mut(changed).and_then(|node| node.get_mut("extensions"));
            if let Some(Value::Object(extensions)) = extensions {
                extensions.remove("EXT_mesh_gpu_instancing");
            }
        }
        match new {
            Some(new) => set(&mut nodes[place.node], "mesh", new),
            None => clear(&mut nodes[place.node], &["skin"]),
        }
        for &below in &place.below {
            if let Some(node) = nodes.get_mut(below) {
                clear(node, &["mesh", "weights", "skin"]);
            }
        }
        self.drop_weights(place);
    }

    /// Puts a mesh into the list, in the place of the one of the node if no other node shows that; and gives its number.
    fn put_mesh(&mut self, node: usize, mut mesh: Value) -> u64 {
        let old = self.list("nodes")[node].get("mesh").and_then(Value::as_u64);
        let users =
            self.list("nodes").iter().filter(|node| node.get("mesh").and_then(Value::as_u64) == old).count();
        let meshes = self.list("meshes");
        let own = old.filter(|&old| users == 1 && (old as usize) < meshes.len());
        let before = old.and_then(|old| meshes.get(old as usize));
        if let Some(name) = before.and_then(|before| before.get("name")) {
            set(&mut mesh, "name", name.clone());
        }
        if let Some(extras) = before.and_then(|before| before.get("extras")) {
            let mut extras = extras.clone();
            // The names of morph targets, which are no more.
            extras.as_object_mut().map(|extras| extras.remove("targetNames"));
            set(&mut mesh, "extras", extras);
        }
        if before.is_some_and(has_variants) {
            self.warnings.push("the material variants of the node's mesh are not kept".into());
        }
        let meshes = self.list("meshes");
        match own {
            Some(own) => {
                meshes[own as usize] = mesh;
                own
            }
            None => {
                meshes.push(mesh);
                meshes.len() as u64 - 1
            }
        }
    }

    /// Takes out what moves morph targets that are no more.
    fn drop_weights(&mut self, place: &Place) {
        let mut changed = Vec::new();
        let is_gone = |channel: &Value| {
            let target = channel.get("target");
            let node = target.and_then(|target| target.get("node")).and_then(Value::as_u64);
            let path = target.and_then(|target| target.get("path")).and_then(Value::as_str);
            path == Some("weights")
                && node
                    .is_some_and(|node| node == place.node as u64 || place.below.contains(&(node as usize)))
        };
        let mut number = 0;
        self.list("animations").retain_mut(|animation| {
            let name =
                animation.get("name").and_then(Value::as_str).map_or(number.to_string(), str::to_owned);
            number += 1;
            let Some(Value::Array(channels)) = animation.get_mut("channels") else { return true };
            let before = channels.len();
            channels.retain(|channel| !is_gone(channel));
            if channels.len() < before {
                changed.push(name);
            }
            before == 0 || !channels.is_empty()
        });
        if !changed.is_empty() {
            self.warnings.push(format!(
                "animations of morph targets that are no more left out: {}",
                changed.join(", ")
            ));
        }
    }
}

/// Whether a mesh has other materials in other variants of the scene.
fn has_variants(mesh: &Value) -> bool {
    let primitives = mesh.get("primitives").and_then(Value::as_array);
    primitives.into_iter().flatten().any(|primitive| {
        primitive
            .get("extensions")
            .is_some_and(|extensions| extensions.get("KHR_materials_variants").is_some())
    })
}

/// Sets a key of an object; what is none stays as it is.
fn set(value: &mut Value, key: &str, new: impl Into<Value>) {
    if let Some(object) = value.as_object_mut() {
        object.insert(key.to_string(), new.into());
    }
}

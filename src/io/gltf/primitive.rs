//! From the primitives of a mesh to triangles.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};
use gltf_json::accessor::Type;
use gltf_json::mesh::{LINE_STRIP, POINTS, TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES};

use super::super::ReadOptions;
use super::super::mirror::is_mirrored;
use super::super::notes::Notes;
use super::super::outline::{NOWHERE, Outline};
use super::Reader;
use super::accessor::Accessors;
use super::budget::Budget;
use super::buffers::Buffers;
use super::corners::{Corners, Names, Shown};
use super::document::{Accessor, MeshObject, Primitive};
use super::manifold::Merged;
use super::materials::Materials;
use super::morph::Morph;
use crate::{Error, FaceGroup, FaceGroups, Mesh};

/// What tells groups apart: their node, their material, and whatever else is a part of the key.
type Appearance = (Option<u32>, u32, Option<u32>, Option<String>);

/// Gathers the triangles of a scene.
pub(super) struct Builder<'a> {
    reader: &'a Reader<'a>,
    pub(super) accessors: Accessors<'a>,
    pub(super) notes: &'a mut Notes,
    budget: Budget<'a>,
    pub(super) mesh: Mesh,
    corners: Corners,
    groups: FaceGroups,
    /// The first vertex of an accessor under a transform: primitives share their vertices.
    placed: HashMap<(u32, [u64; 12]), u32>,
    /// The group of a node and a material.
    known: HashMap<Appearance, u32>,
    materials: Materials<'a>,
    /// Nodes shown with a skeleton, and with morph targets.
    pub(super) skinned: usize,
    pub(super) morphed: usize,
    /// The names of nodes, if they are wanted.
    pub(super) outline: Option<Outline>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(
        reader: &'a Reader<'a>,
        buffers: &'a Buffers<'a>,
        file_bytes: u64,
        options: &'a ReadOptions,
        notes: &'a mut Notes,
    ) -> Self {
        Self {
            reader,
            accessors: Accessors { reader, buffers, decoded: HashMap::new() },
            notes,
            budget: Budget::new(buffers, options, file_bytes),
            mesh: Mesh::default(),
            corners: Corners::default(),
            groups: FaceGroups::default(),
            placed: HashMap::new(),
            known: HashMap::new(),
            materials: Materials::new(reader, buffers),
            skinned: 0,
            morphed: 0,
            outline: None,
        }
    }

    /// Accounts for memory about to be used.
    pub(super) fn charge(&mut self, bytes: u64) -> Result<(), Error> {
        self.budget.charge(bytes)
    }

    /// Notes a name for what stands under `parent`, and gives its entry of the outline; the parent's, if there is no name.
    pub(super) fn enter(&mut self, name: Option<&str>, parent: Option<u32>) -> Result<Option<u32>, Error> {
        let Some(name) = name.filter(|name| !name.is_empty() && self.outline.is_some()) else {
            return Ok(parent);
        };
        self.charge(64 + name.len() as u64)?;
        Ok(self.outline.as_mut().map(|outline| outline.add(name, parent)))
    }

    /// Adds a mesh under a transform, as the given node shows it, under an entry of the outline.
    pub(super) fn add(
        &mut self,
        mesh: u32,
        node: Option<u32>,
        world: &DAffine3,
        entry: Option<u32>,
    ) -> Result<(), Error> {
        let pointer = node.map_or("/meshes".to_string(), |node| format!("/nodes/{node}/mesh"));
        let object = self.reader.get(&self.reader.document.meshes, "meshes", mesh as usize, &pointer)?;
        // A node without a name is called by that of its mesh.
        let nameless = node.and_then(|node| self.node_name(node)).is_none();
        let entry = if nameless { self.enter(object.name.as_deref(), entry)? } else { entry };
        let weights = node
            .and_then(|node| self.reader.document.nodes.get(node as usize)?.0.as_ref()?.weights.as_deref());
        let weights = weights.or(object.weights.as_deref()).unwrap_or_default();
        let merged = self.merged(object)?;
        let mut taken = 0;
        let mut morphed = false;
        for (i, primitive) in object.primitives.iter().enumerate() {
            let pointer = format!("/meshes/{mesh}/primitives/{i}");
            let before = self.mesh.triangles.len();
            let merged = merged.as_ref().map(|merged| &merged.indices[taken..]);
            let (indices, has_targets) = self.primitive(primitive, world, weights, merged, &pointer)?;
            taken += indices;
            morphed |= has_targets;
            let added = self.mesh.triangles.len() - before;
            if added > 0 {
                let group = self.group(node, mesh, primitive, &pointer)?;
                self.groups.of_triangle.resize(before + added, group);
                if self.outline.is_some() {
                    self.charge(4 * added as u64)?;
                }
                if let Some(outline) = &mut self.outline {
                    outline.of_triangle.resize(before + added, entry.unwrap_or(NOWHERE));
                }
            }
        }
        self.morphed += usize::from(morphed);
        Ok(())
    }

    /// The indices of a mesh as those of a closed surface, if it has the extension that says so.
    fn merged(&mut self, object: &MeshObject<'_>) -> Result<Option<Merged>, Error> {
        if object.extensions.as_ref().is_none_or(|extensions| extensions.manifold.is_none()) {
            return Ok(None);
        }
        let mut first = None;
        for primitive in &object.primitives {
            let position = self.names(primitive, "/meshes")?.get("POSITION").copied();
            if position.is_none() || first.is_some_and(|first| first != position) {
                self.notes.add(
                    "EXT_mesh_manifold ignored: the primitives of a mesh have no positions in common",
                    1,
                );
                return Ok(None);
            }
            first = Some(position);
        }
        let Some(Some(position)) = first else { return Ok(None) };
        let count = self.accessors.get(position, Type::Vec3, "/meshes")?.count;
        self.charge(count.saturating_mul(24))?;
        let positions = self.accessors.numbers::<3>(position, "/meshes")?;
        match Merged::read(object, &positions, &self.accessors, &mut self.budget)? {
            Ok(merged) => Ok(Some(merged)),
            Err(reason) => {
                self.notes.add(format!("EXT_mesh_manifold ignored: {reason}"), 1);
                Ok(None)
            }
        }
    }

    /// The attributes of a primitive: names and accessors.
    fn names<'b>(&self, primitive: &'b Primitive<'_>, pointer: &str) -> Result<Names<'b>, Error> {
        serde_json::from_str(primitive.attributes.get())
            .map_err(|error| self.reader.error(format!("{pointer}/attributes"), error.to_string()))
    }

    /// Adds a primitive; how many indices it has, and whether it has morph targets. `merged` begins with its indices as those
    /// of a closed surface.
    fn primitive(
        &mut self,
        primitive: &Primitive<'_>,
        world: &DAffine3,
        weights: &[f64],
        merged: Option<&[u32]>,
        pointer: &str,
    ) -> Result<(usize, bool), Error> {
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        match mode {
            POINTS..=LINE_STRIP => {
                self.notes.add("primitive of points or lines ignored", 1);
                return Ok((0, false));
            }
            TRIANGLES | TRIANGLE_STRIP | TRIANGLE_FAN => {}
            _ => {
                return Err(self
                    .reader
                    .error(format!("{pointer}/mode"), format!("{mode} is no mode of glTF")));
            }
        }
        let names = self.names(primitive, pointer)?;
        let Some(&position) = names.get("POSITION") else {
            self.notes.add("primitive without positions ignored", 1);
            return Ok((0, false));
        };
        let (morph, has_targets) = Morph::new(primitive.targets, weights, pointer, &self.accessors)?;
        let here = format!("{pointer}/attributes/POSITION");
        let accessor = self.accessors.get(position, Type::Vec3, &here)?;
        self.decompress(primitive, &names, pointer)?;
        let vertices = accessor.count;
        let first = self.place(position, vertices, world, &morph, &here)?;
        let indices = self.indices(primitive, mode, vertices, &format!("{pointer}/indices"))?;
        let merged = merged.and_then(|merged| merged.get(..indices.len()));
        let (before, mirrored) = (self.mesh.triangles.len(), is_mirrored(&world.matrix3));
        let mut corners = Vec::new();
        self.triangles(mode, &indices, first, mirrored, merged, &mut corners, pointer);
        if names.len() > 1 {
            if merged.is_none() {
                self.budget.charge(12 * (self.mesh.triangles.len() - before) as u64)?;
                let of_primitive = |triangle: &[u32; 3]| triangle.map(|corner| corner - first);
                corners = self.mesh.triangles[before..].iter().map(of_primitive).collect();
            }
            let corners = &corners;
            let shown = Shown { pointer, world, mirrored, vertices, morph: &morph, before, corners };
            self.corners.add(&names, &shown, &self.accessors, &mut self.budget, self.notes)?;
        }
        Ok((indices.len(), has_targets))
    }

    /// Decodes what is there in compressed form only.
    fn decompress(
        &mut self,
        primitive: &Primitive<'_>,
        names: &Names<'_>,
        pointer: &str,
    ) -> Result<(), Error> {
        let draco = primitive.extensions.as_ref().and_then(|extensions| extensions.draco.as_ref());
        let position = names.get("POSITION").copied().unwrap_or(u32::MAX);
        let accessor = self.reader.document.accessors.get(position as usize);
        let is_there = |accessor: &Accessor| accessor.buffer_view.is_some() || accessor.sparse.is_some();
        let Some(draco) = draco.filter(|_| accessor.is_some_and(|accessor| !is_there(accessor))) else {
            return Ok(());
        };
        #[cfg(feature = "draco")]
        if [Some(position), primitive.indices]
            .into_iter()
            .flatten()
            .all(|accessor| self.accessors.decoded.contains_key(&accessor))
        {
            return Ok(());
        }
        #[cfg(feature = "draco")]
        return super::draco::decode(primitive, draco, names, pointer, &mut self.accessors, &mut self.budget);
        #[cfg(not(feature = "draco"))]
        {
            let _ = draco;
            Err(super::super::unsupported(
                self.reader.format,
                format!(
                    "{pointer} is compressed with KHR_draco_mesh_compression{}",
                    super::extensions::DRACO_ADVICE
                ),
            ))
        }
    }

    /// The indices of a primitive of `vertices` vertices, all of them of vertices there are; without any in the file,
    /// each vertex in turn. There is room for their triangles.
    fn indices(
        &mut self,
        primitive: &Primitive<'_>,
        mode: u32,
        vertices: u64,
        pointer: &str,
    ) -> Result<Vec<u32>, Error> {
        let count = match primitive.indices {
            Some(indices) => self.accessors.get(indices, Type::Scalar, pointer)?.count,
            None => vertices,
        };
        // Indices, triangles and their groups, for at most as many triangles as indices.
        let triangles = if mode == TRIANGLES { count / 3 } else { count };
        self.charge(triangles.saturating_mul(16).saturating_add(count.saturating_mul(4)))?;
        let indices = match primitive.indices {
            Some(indices) => self.accessors.indices(indices, pointer)?,
            // The vertices were placed, so there are no more than 32 bits can count.
            None => (0..vertices as u32).collect(),
        };
        if let Some(&index) = indices.iter().max().filter(|&&index| u64::from(index) >= vertices) {
            return Err(self.reader.error(
                pointer,
                format!(
                    "a triangle names vertex {index}, but the primitive has {vertices}; the file is corrupt"
                ),
            ));
        }
        let reached = self.mesh.triangles.len() as u64 + triangles;
        if reached > u64::from(u32::MAX) {
            return Err(Error::TooLarge { what: format!("the scene has {reached} triangles or more") });
        }
        Ok(indices)
    }

    /// The first of an accessor's vertices under a transform, which are added if they are new.
    fn place(
        &mut self,
        accessor: u32,
        count: u64,
        world: &DAffine3,
        morph: &Morph<'_>,
        pointer: &str,
    ) -> Result<u32, Error> {
        let key = (accessor, world.to_cols_array().map(f64::to_bits));
        if let Some(&first) = self.placed.get(&key).filter(|_| morph.is_none()) {
            return Ok(first);
        }
        let first = self.mesh.positions.len();
        if (first as u64).saturating_add(count) > u64::from(u32::MAX) {
            return Err(Error::TooLarge {
                what: format!("the scene has {} vertices or more", (first as u64).saturating_add(count)),
            });
        }
        // Once decoded, once in the mesh.
        self.charge(count.saturating_mul(48))?;
        let mut positions = self.accessors.numbers::<3>(accessor, pointer)?;
        morph.move_points(&mut positions, &self.accessors, &mut self.budget)?;
        if *world != DAffine3::IDENTITY {
            for position in &mut positions {
                *position = world.transform_point3(DVec3::from_array(*position)).to_array();
            }
        }
        if first == 0 {
            self.mesh.positions = positions;
        } else {
            self.mesh.positions.append(&mut positions);
        }
        if morph.is_none() {
            self.placed.insert(key, first as u32);
        }
        Ok(first as u32)
    }

    fn group(
        &mut self,
        node: Option<u32>,
        mesh: u32,
        primitive: &Primitive<'_>,
        pointer: &str,
    ) -> Result<u32, Error> {
        // A mesh that holds all groups of a closed surface tells their names there.
        let own = primitive.extras.and_then(|extras| serde_json::from_str::<GroupName>(extras.get()).ok());
        let own = own.and_then(|own| own.group);
        let key = (node, mesh, primitive.material, own);
        if let Some(&group) = self.known.get(&key) {
            return Ok(group);
        }
        let document = self.reader.document;
        let name = key.3.as_deref().or_else(|| node.and_then(|node| self.node_name(node)));
        let name = name.or_else(|| document.meshes.get(mesh as usize).and_then(|mesh| mesh.name.as_deref()));
        let name = name.unwrap_or_default().to_string();
        let material = match primitive.material {
            None => None,
            Some(index) => {
                let pointer = format!("{pointer}/material");
                Some(self.materials.get(index, &pointer, &mut self.budget, self.notes)?)
            }
        };
        let name_bytes = name.len() + material.as_ref().map_or(0, |material| material.name.len());
        self.charge(200 + name_bytes as u64)?;
        let group = self.groups.list.len() as u32;
        self.groups.list.push(FaceGroup { name, material });
        self.known.insert(key, group);
        Ok(group)
    }

    /// The name of a node.
    fn node_name(&self, node: u32) -> Option<&'a str> {
        self.reader.document.nodes.get(node as usize)?.0.as_ref()?.name.as_deref()
    }

    /// The mesh, and the outline if it was wanted.
    pub(super) fn finish(mut self) -> (Mesh, Outline) {
        if self.groups.list.iter().any(|group| *group != FaceGroup::default()) {
            self.mesh.groups = self.groups;
        }
        self.mesh.attributes = self.corners.finish(self.mesh.triangles.len());
        (self.mesh, self.outline.unwrap_or_default())
    }
}

/// What the extras of a primitive may say.
#[derive(serde::Deserialize)]
struct GroupName {
    group: Option<String>,
}

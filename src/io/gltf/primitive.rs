//! From the primitives of a mesh to triangles.

use std::collections::HashMap;

use glam::{DAffine3, DVec3};
use gltf::json;
use gltf::json::accessor::Type;
use gltf::json::mesh::{LINE_STRIP, POINTS, TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES};

use super::super::notes::Notes;
use super::super::outline::{NOWHERE, Outline};
use super::super::{ReadOptions, unsupported};
use super::accessor::Accessors;
use super::buffers::Buffers;
use super::document::{Accessor, PlainMaterial, Primitive};
use super::extensions::DRACO_ADVICE;
use super::{Reader, SMALLEST_LIMIT};
use crate::control::Reservation;
use crate::{Error, FaceGroup, FaceGroups, Material, Mesh};

/// Gathers the triangles of a scene.
pub(super) struct Builder<'a> {
    reader: &'a Reader<'a>,
    buffers: &'a Buffers<'a>,
    pub(super) accessors: Accessors<'a>,
    options: &'a ReadOptions,
    pub(super) notes: &'a mut Notes,
    file_bytes: u64,
    charged: u64,
    reserved: u64,
    reservations: Vec<Reservation>,
    mesh: Mesh,
    groups: FaceGroups,
    /// The first vertex of an accessor under a transform: primitives share their vertices.
    placed: HashMap<(u32, [u64; 12]), u32>,
    /// The group of a node and a material.
    known: HashMap<(Option<u32>, u32, Option<u32>), u32>,
    /// The materials shown so far, each read once.
    materials: HashMap<u32, Material>,
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
            buffers,
            accessors: Accessors { reader, buffers },
            options,
            notes,
            file_bytes,
            charged: 0,
            reserved: 0,
            reservations: Vec::new(),
            mesh: Mesh::default(),
            groups: FaceGroups::default(),
            placed: HashMap::new(),
            known: HashMap::new(),
            materials: HashMap::new(),
            outline: None,
        }
    }

    /// Accounts for memory about to be used. Counts in accessors and instances of meshes may ask for far more than
    /// the file has; this is where that ends.
    pub(super) fn charge(&mut self, bytes: u64) -> Result<(), Error> {
        self.charged = self.charged.saturating_add(bytes);
        let whole = self.file_bytes.saturating_add(self.buffers.external_bytes());
        let limit = whole.saturating_mul(self.options.expansion).max(SMALLEST_LIMIT);
        if self.charged > limit {
            return Err(Error::TooLarge {
                what: format!(
                    "the flattened scene needs more than {limit} bytes, {} times its file, the most that was \
                     allowed",
                    limit / whole.max(1)
                ),
            });
        }
        // Instances can make the mesh larger than the file, so this memory is accounted for as it is needed.
        if self.charged > 2 * whole + self.reserved {
            let more = self.charged - 2 * whole - self.reserved;
            self.reservations.push(self.options.control.reserve(more.max(1 << 20))?);
            self.reserved += more.max(1 << 20);
        }
        Ok(self.options.control.check()?)
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
        for (i, primitive) in object.primitives.iter().enumerate() {
            let pointer = format!("/meshes/{mesh}/primitives/{i}");
            let before = self.mesh.triangles.len();
            self.primitive(primitive, world, &pointer)?;
            let added = self.mesh.triangles.len() - before;
            if added > 0 {
                let group = self.group(node, mesh, primitive.material, &pointer)?;
                self.groups.of_triangle.resize(before + added, group);
                if self.outline.is_some() {
                    self.charge(4 * added as u64)?;
                }
                if let Some(outline) = &mut self.outline {
                    outline.of_triangle.resize(before + added, entry.unwrap_or(NOWHERE));
                }
            }
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive, world: &DAffine3, pointer: &str) -> Result<(), Error> {
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        match mode {
            POINTS..=LINE_STRIP => {
                self.notes.add("primitive of points or lines ignored", 1);
                return Ok(());
            }
            TRIANGLES | TRIANGLE_STRIP | TRIANGLE_FAN => {}
            _ => {
                return Err(self
                    .reader
                    .error(format!("{pointer}/mode"), format!("{mode} is no mode of glTF")));
            }
        }
        let Some(position) = primitive.attributes.position else {
            self.notes.add("primitive without positions ignored", 1);
            return Ok(());
        };
        if primitive.morphs {
            self.notes.add("mesh with morph targets read in its basic shape", 1);
        }
        let here = format!("{pointer}/attributes/POSITION");
        let accessor = self.accessors.get(position, Type::Vec3, &here)?;
        self.refuse_compressed(primitive, accessor, pointer)?;
        let vertices = accessor.count;
        let first = self.place(position, vertices, world, &here)?;
        let indices = self.indices(primitive, mode, vertices, &format!("{pointer}/indices"))?;
        self.triangles(mode, &indices, first, is_mirrored(world), pointer);
        Ok(())
    }

    /// Refuses positions that are there in compressed form only.
    fn refuse_compressed(
        &self,
        primitive: &Primitive,
        accessor: &Accessor,
        pointer: &str,
    ) -> Result<(), Error> {
        let compressed = primitive.extensions.as_ref().is_some_and(|extensions| extensions.draco.is_some());
        if compressed && accessor.buffer_view.is_none() && accessor.sparse.is_none() {
            return Err(unsupported(
                self.reader.format,
                format!("{pointer} is compressed with KHR_draco_mesh_compression{DRACO_ADVICE}"),
            ));
        }
        Ok(())
    }

    /// The indices of a primitive of `vertices` vertices, all of them of vertices there are; without any in the file,
    /// each vertex in turn. There is room for their triangles.
    fn indices(
        &mut self,
        primitive: &Primitive,
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

    /// Adds the triangles that indices make in a mode, the first vertex being `first` of the mesh.
    fn triangles(&mut self, mode: u32, indices: &[u32], first: u32, mirrored: bool, pointer: &str) {
        let mut dropped = 0;
        let mut push = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|corner| corner + first);
            if a == b || b == c || c == a {
                dropped += 1;
            } else {
                self.mesh.triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
            }
        };
        match mode {
            TRIANGLES => {
                let (whole, rest) = indices.as_chunks::<3>();
                whole.iter().for_each(|&corners| push(corners));
                if !rest.is_empty() {
                    self.notes
                        .say(format!("{pointer}: {} indices after the last triangle ignored", rest.len()));
                }
            }
            TRIANGLE_STRIP => {
                for (i, window) in indices.windows(3).enumerate() {
                    let [a, b, c] = [window[0], window[1], window[2]];
                    push(if i % 2 == 0 { [a, b, c] } else { [a, c, b] });
                }
                // Triangles without area link the parts of a strip.
                dropped = 0;
            }
            _ => {
                for pair in indices.get(1..).unwrap_or_default().windows(2) {
                    push([indices[0], pair[0], pair[1]]);
                }
            }
        }
        self.notes.add("triangle with a repeated corner dropped", dropped);
    }

    /// The first of an accessor's vertices under a transform, which are added if they are new.
    fn place(&mut self, accessor: u32, count: u64, world: &DAffine3, pointer: &str) -> Result<u32, Error> {
        let key = (accessor, world.to_cols_array().map(f64::to_bits));
        if let Some(&first) = self.placed.get(&key) {
            return Ok(first);
        }
        let first = self.mesh.positions.len();
        if first as u64 + count > u64::from(u32::MAX) {
            return Err(Error::TooLarge {
                what: format!("the scene has {} vertices or more", first as u64 + count),
            });
        }
        // Once decoded, once in the mesh.
        self.charge(count.saturating_mul(48))?;
        let mut positions = self.accessors.numbers::<3>(accessor, pointer)?;
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
        self.placed.insert(key, first as u32);
        Ok(first as u32)
    }

    fn group(
        &mut self,
        node: Option<u32>,
        mesh: u32,
        material: Option<u32>,
        pointer: &str,
    ) -> Result<u32, Error> {
        let key = (node, mesh, material);
        if let Some(&group) = self.known.get(&key) {
            return Ok(group);
        }
        let document = self.reader.document;
        let name = node.and_then(|node| self.node_name(node));
        let name = name.or_else(|| document.meshes.get(mesh as usize).and_then(|mesh| mesh.name.as_deref()));
        let name = name.unwrap_or_default().to_string();
        let material = match material {
            None => None,
            Some(index) => Some(self.material(index, &format!("{pointer}/material"))?),
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

    /// The material at an index found at `pointer`.
    fn material(&mut self, index: u32, pointer: &str) -> Result<Material, Error> {
        if let Some(known) = self.materials.get(&index) {
            return Ok(known.clone());
        }
        let text = self.reader.get(&self.reader.document.materials, "materials", index as usize, pointer)?;
        let material = match serde_json::from_str::<json::Material>(text.get()) {
            Ok(material) => Material::plain(
                material.name.unwrap_or_default(),
                material.pbr_metallic_roughness.base_color_factor.0,
            ),
            Err(error) => {
                self.notes
                    .say(format!("of /materials/{index} only the name and the colour are read: {error}"));
                let plain: PlainMaterial = serde_json::from_str(text.get()).unwrap_or_default();
                Material::plain(
                    plain.name.unwrap_or_default(),
                    plain.surface.and_then(|surface| surface.base_color).unwrap_or([1.0; 4]),
                )
            }
        };
        self.charge(200 + material.name.len() as u64)?;
        self.materials.insert(index, material.clone());
        Ok(material)
    }

    /// The mesh, and the outline if it was wanted.
    pub(super) fn finish(mut self) -> (Mesh, Outline) {
        if self.groups.list.iter().any(|group| *group != FaceGroup::default()) {
            self.mesh.groups = self.groups;
        }
        (self.mesh, self.outline.unwrap_or_default())
    }
}

/// Whether a transform turns left hands into right ones.
fn is_mirrored(world: &DAffine3) -> bool {
    let matrix = world.matrix3;
    let largest = matrix.to_cols_array().into_iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    largest > 0.0 && (matrix * largest.recip()).determinant() < 0.0
}

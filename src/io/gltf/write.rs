//! Writing glTF and GLB.
//!
//! One buffer: the positions in single precision, shared by all primitives so that the surface stays closed across
//! groups, then the indices, group by group. Each group name becomes a node with a mesh, each group a primitive.

use std::collections::{BTreeMap, HashMap};
use std::io::Write;
use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Target, View};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked::Valid;
use gltf::json::{Accessor, Asset, Extras, Index, Node, Root, Scene};
use serde_json::{Map, Value, json};

use super::super::rounding::{Measure, Written, examined};
use super::super::text::{write_all, write_blocks};
use super::super::{Format, WriteOptions, unsupported};
use crate::{Error, FaceGroup, Mesh};

/// Writes a `.gltf` file with its buffer inside, or a `.glb` file.
pub(in crate::io) fn write(
    mesh: &Mesh,
    format: Format,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    if mesh.triangles.is_empty() {
        // Neither a buffer without bytes nor a mesh without triangles is allowed, and some readers want a node.
        let document =
            json!({"asset": asset(), "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{}]}).to_string();
        match format {
            Format::Glb => write_glb_header(output, &document, None)?,
            _ => write_all(output, document.as_bytes())?,
        }
        return Ok(Written::default());
    }
    let frame = Frame::of(mesh);
    let members = members(mesh);
    let bytes = 12 * (mesh.positions.len() as u64 + mesh.triangles.len() as u64);
    let document = document(mesh, &frame, &members)?;
    match format {
        Format::Glb => {
            let mut document = document;
            document.insert("buffers".to_string(), json!([{"byteLength": bytes}]));
            write_glb_header(output, &Value::Object(document).to_string(), Some(bytes))?;
            write_buffer(mesh, &frame, &members, output, options, |block, out| out.extend_from_slice(block))?;
        }
        _ => {
            let rest = Value::Object(document).to_string();
            let start = format!(
                "{{\"buffers\":[{{\"byteLength\":{bytes},\"uri\":\"data:application/octet-stream;base64,"
            );
            write_all(output, start.as_bytes())?;
            write_buffer(mesh, &frame, &members, output, options, |block, out| {
                // Blocks are made of items of twelve bytes: three bytes make four letters, and none are left over.
                let start = out.len();
                out.resize(start + block.len() / 3 * 4, 0);
                let written = STANDARD.encode_slice(block, &mut out[start..]);
                debug_assert_eq!(written, Ok(block.len() / 3 * 4));
            })?;
            write_all(output, b"\"}],")?;
            write_all(output, &rest.as_bytes()[1..])?;
        }
    }
    if frame.exact {
        return Ok(Written::default());
    }
    examined(mesh, format, Measure { offset: frame.offset.to_array(), scale: frame.scale }, options)
}

/// The header of a GLB file, its JSON chunk, and the header of a binary chunk.
fn write_glb_header(output: &mut dyn Write, document: &str, binary: Option<u64>) -> Result<(), Error> {
    let padded = document.len().next_multiple_of(4);
    let total = 20 + padded as u64 + binary.map_or(0, |bytes| 8 + bytes);
    let Ok(total) = u32::try_from(total) else {
        return Err(Error::TooLarge {
            what: format!("a GLB file of {total} bytes, where 4 GiB is the limit; write PLY"),
        });
    };
    let mut header = b"glTF\x02\0\0\0".to_vec();
    header.extend(total.to_le_bytes());
    header.extend((padded as u32).to_le_bytes());
    header.extend(b"JSON");
    header.extend(document.as_bytes());
    header.resize(20 + padded, b' ');
    if let Some(bytes) = binary {
        header.extend((bytes as u32).to_le_bytes());
        header.extend(b"BIN\0");
    }
    write_all(output, &header)
}

/// Where the coordinates of the file are measured from, and in which unit.
struct Frame {
    offset: DVec3,
    scale: f64,
    /// One over the scale, exactly: both are powers of two.
    unit: f64,
    /// Whether single precision holds all coordinates exactly.
    exact: bool,
}

impl Frame {
    /// The origin and the model's own unit, if single precision holds all coordinates exactly; else axis by axis the
    /// middle of the model, where that is farther from the origin than twice the model's width, and a power of two as
    /// the unit where coordinates are beyond the range of single precision.
    fn of(mesh: &Mesh) -> Self {
        let mut frame = Self { offset: DVec3::ZERO, scale: 1.0, unit: 1.0, exact: true };
        if mesh.positions.as_flattened().iter().all(|&coordinate| f64::from(coordinate as f32) == coordinate)
        {
            return frame;
        }
        frame.exact = false;
        let points = || mesh.positions.iter().copied().map(DVec3::from_array);
        let low = points().fold(DVec3::INFINITY, DVec3::min);
        let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
        for axis in 0..3 {
            let middle = low[axis] * 0.5 + high[axis] * 0.5;
            let rounded = f64::from(middle as f32);
            if rounded.is_finite() && middle.abs() * 0.5 > high[axis] - low[axis] {
                frame.offset[axis] = rounded;
            }
        }
        let size = points().fold(0.0_f64, |size, point| size.max((point - frame.offset).abs().max_element()));
        if size > 0.0 && !(1e-30..1e30).contains(&size) {
            // The power of two at or below the size, in the range whose reciprocal is exact.
            frame.scale = f64::from_bits(size.clamp(1e-300, 1e300).to_bits() & (0x7ff << 52));
            frame.unit = frame.scale.recip();
        }
        frame
    }

    /// A point as the file holds it.
    fn local(&self, point: [f64; 3]) -> [f32; 3] {
        let local = (DVec3::from_array(point) - self.offset) * self.unit;
        [local.x as f32, local.y as f32, local.z as f32]
    }
}

/// The triangles of each group in their order; one list of all without groups.
fn members(mesh: &Mesh) -> Vec<Vec<u32>> {
    let groups = &mesh.groups;
    if groups.list.is_empty() {
        return vec![(0..mesh.triangles.len() as u32).collect()];
    }
    let mut members = vec![Vec::new(); groups.list.len()];
    for (triangle, &group) in groups.of_triangle.iter().enumerate() {
        members[group as usize].push(triangle as u32);
    }
    members
}

fn asset() -> Asset {
    Asset { generator: Some(concat!("trisect ", env!("CARGO_PKG_VERSION")).to_string()), ..Asset::default() }
}

/// The document without its buffers.
///
/// Materials and the place of the model are put into its JSON by hand: the crate's types hold the place in single
/// precision, which would move the model, and write every default of a material.
fn document(mesh: &Mesh, frame: &Frame, members: &[Vec<u32>]) -> Result<Map<String, Value>, Error> {
    let mut parts = Parts::new(mesh, frame);
    for (group, triangles) in members.iter().enumerate().filter(|(_, triangles)| !triangles.is_empty()) {
        parts.add(mesh.groups.list.get(group), triangles.len());
    }
    let Parts { accessors, materials, meshes, .. } = parts;
    let mut nodes: Vec<Node> = (0..)
        .zip(&meshes)
        .map(|(i, mesh)| Node { mesh: Some(Index::new(i)), name: mesh.name.clone(), ..Node::default() })
        .collect();
    let placed = frame.offset != DVec3::ZERO || frame.scale != 1.0;
    let mut roots: Vec<Index<Node>> = (0..nodes.len() as u32).map(Index::new).collect();
    if placed && nodes.len() > 1 {
        let all = Node { children: Some(roots), ..Node::default() };
        roots = vec![Index::push(&mut nodes, all)];
    }
    let root = roots[0].value();
    let (vertices, triangles) = (12 * mesh.positions.len() as u64, 12 * mesh.triangles.len() as u64);
    let scene = Scene { extensions: None, extras: Extras::default(), name: None, nodes: roots };
    let document = Root {
        asset: asset(),
        scene: Some(Index::new(0)),
        scenes: vec![scene],
        nodes,
        meshes,
        accessors,
        buffer_views: vec![
            view(0, vertices, Target::ArrayBuffer),
            view(vertices, triangles, Target::ElementArrayBuffer),
        ],
        ..Root::default()
    };
    let mut document =
        document.to_value().map_err(|error| unsupported(Format::Gltf, format!("no JSON: {error}")))?;
    if placed {
        let root = &mut document["nodes"][root];
        root["translation"] = json!(frame.offset.to_array());
        if frame.scale != 1.0 {
            root["scale"] = json!([frame.scale, frame.scale, frame.scale]);
        }
    }
    if !materials.is_empty() {
        document["materials"] = materials.into();
    }
    match document {
        Value::Object(document) => Ok(document),
        _ => Err(unsupported(Format::Gltf, "a document that is no JSON object")),
    }
}

/// The parts of a document that grow group by group.
struct Parts<'a> {
    accessors: Vec<Accessor>,
    materials: Vec<Value>,
    meshes: Vec<gltf::json::Mesh>,
    known_materials: HashMap<String, u32>,
    known_meshes: HashMap<&'a str, usize>,
    /// Triangles so far.
    before: u64,
}

impl<'a> Parts<'a> {
    /// The positions alone.
    fn new(mesh: &Mesh, frame: &Frame) -> Self {
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        for &position in &mesh.positions {
            let local = frame.local(position);
            for axis in 0..3 {
                low[axis] = low[axis].min(local[axis]);
                high[axis] = high[axis].max(local[axis]);
            }
        }
        let mut positions = accessor(0, ComponentType::F32, Type::Vec3, mesh.positions.len() as u64);
        (positions.min, positions.max) = (Some(json!(low.map(f64::from))), Some(json!(high.map(f64::from))));
        Self {
            accessors: vec![positions],
            materials: Vec::new(),
            meshes: Vec::new(),
            known_materials: HashMap::new(),
            known_meshes: HashMap::new(),
            before: 0,
        }
    }

    /// A primitive for the next `triangles` triangles, those of a group.
    fn add(&mut self, group: Option<&'a FaceGroup>, triangles: usize) {
        let mut indices = accessor(1, ComponentType::U32, Type::Scalar, 3 * triangles as u64);
        indices.byte_offset = Some((12 * self.before).into());
        self.before += triangles as u64;
        let material = group.and_then(|group| group.material.as_ref()).map(|material| {
            let material = material_object(&material.name, material.base_color);
            *self.known_materials.entry(material.to_string()).or_insert_with(|| {
                self.materials.push(material);
                self.materials.len() as u32 - 1
            })
        });
        let primitive = Primitive {
            attributes: BTreeMap::from([(Valid(Semantic::Positions), Index::new(0))]),
            extensions: None,
            extras: Extras::default(),
            indices: Some(Index::push(&mut self.accessors, indices)),
            material: material.map(Index::new),
            mode: Valid(Mode::Triangles),
            targets: None,
        };
        let name = group.map_or("", |group| &group.name);
        let mesh = *self.known_meshes.entry(name).or_insert_with(|| {
            self.meshes.push(gltf::json::Mesh {
                extensions: None,
                extras: Extras::default(),
                name: (!name.is_empty()).then(|| name.to_string()),
                primitives: Vec::new(),
                weights: None,
            });
            self.meshes.len() - 1
        });
        self.meshes[mesh].primitives.push(primitive);
    }
}

/// An accessor from the beginning of a buffer view.
fn accessor(view: u32, component: ComponentType, shape: Type, count: u64) -> Accessor {
    Accessor {
        buffer_view: Some(Index::new(view)),
        byte_offset: None,
        count: count.into(),
        component_type: Valid(GenericComponentType(component)),
        extensions: None,
        extras: Extras::default(),
        type_: Valid(shape),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

/// A view of the one buffer.
fn view(offset: u64, length: u64, target: Target) -> View {
    View {
        buffer: Index::new(0),
        byte_length: length.into(),
        byte_offset: Some(offset.into()),
        byte_stride: None,
        name: None,
        target: Some(Valid(target)),
        extensions: None,
        extras: Extras::default(),
    }
}

fn material_object(name: &str, color: [f32; 4]) -> Value {
    // The shortest digits of the single-precision number, which JSON would write as a double.
    let channel = |value: f32| {
        let value = if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
        value.to_string().parse::<f64>().unwrap_or(1.0)
    };
    let mut material = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": color.map(channel), "metallicFactor": 0, "roughnessFactor": 1
        }
    });
    if !name.is_empty() {
        material["name"] = json!(name);
    }
    if color[3] < 1.0 {
        material["alphaMode"] = json!("BLEND");
    }
    material
}

/// Writes the positions and indices, block by block through `encode`.
fn write_buffer(
    mesh: &Mesh,
    frame: &Frame,
    members: &[Vec<u32>],
    output: &mut dyn Write,
    options: &WriteOptions,
    encode: impl Fn(&[u8], &mut Vec<u8>) + Sync + Send,
) -> Result<(), Error> {
    write_blocks(output, mesh.positions.len(), &options.control, |range, out| {
        let mut block = vec![0; 12 * range.len()];
        for (bytes, &position) in block.as_chunks_mut::<12>().0.iter_mut().zip(&mesh.positions[range]) {
            let [x, y, z] = frame.local(position).map(f32::to_le_bytes);
            bytes[..4].copy_from_slice(&x);
            bytes[4..8].copy_from_slice(&y);
            bytes[8..].copy_from_slice(&z);
        }
        encode(&block, out);
    })?;
    for triangles in members {
        write_blocks(output, triangles.len(), &options.control, |range: Range<usize>, out| {
            let mut block = vec![0; 12 * range.len()];
            for (bytes, &triangle) in block.as_chunks_mut::<12>().0.iter_mut().zip(&triangles[range]) {
                let [a, b, c] = mesh.triangles[triangle as usize].map(u32::to_le_bytes);
                bytes[..4].copy_from_slice(&a);
                bytes[4..8].copy_from_slice(&b);
                bytes[8..].copy_from_slice(&c);
            }
            encode(&block, out);
        })?;
    }
    Ok(())
}

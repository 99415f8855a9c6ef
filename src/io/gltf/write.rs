//! Writing glTF and GLB.
//!
//! One buffer: the positions in single precision, shared by all primitives so that the surface stays closed across
//! groups, then the indices, group by group. Each group name becomes a node with a mesh, each group a primitive.

use std::collections::HashMap;
use std::io::Write;
use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde_json::{Map, Value, json};

use super::super::precision::collapsed;
use super::super::text::{write_all, write_blocks};
use super::super::{Format, WriteOptions};
use crate::{Error, FaceGroup, Mesh};

/// Writes a `.gltf` file with its buffer inside, or a `.glb` file.
pub(in crate::io) fn write(
    mesh: &Mesh,
    format: Format,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Vec<String>, Error> {
    if mesh.triangles.is_empty() {
        // Neither a buffer without bytes nor a mesh without triangles is allowed, and some readers want a node.
        let document =
            json!({"asset": asset(), "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{}]}).to_string();
        match format {
            Format::Glb => write_glb_header(output, &document, None)?,
            _ => write_all(output, document.as_bytes())?,
        }
        return Ok(Vec::new());
    }
    let frame = Frame::of(mesh);
    let members = members(mesh);
    let bytes = 12 * (mesh.positions.len() as u64 + mesh.triangles.len() as u64);
    let document = document(mesh, &frame, &members);
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
    let lost = if frame.exact { 0 } else { collapsed(mesh, |point| frame.local(point)) };
    Ok(match lost {
        0 => Vec::new(),
        _ => vec![format!("rounding to single precision makes two corners of {lost} triangles equal")],
    })
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

fn asset() -> Value {
    json!({"version": "2.0", "generator": concat!("trisect ", env!("CARGO_PKG_VERSION"))})
}

/// The document without its buffers.
fn document(mesh: &Mesh, frame: &Frame, members: &[Vec<u32>]) -> Map<String, Value> {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    let mut low = [f32::INFINITY; 3];
    let mut high = [f32::NEG_INFINITY; 3];
    for &position in &mesh.positions {
        let local = frame.local(position);
        for axis in 0..3 {
            low[axis] = low[axis].min(local[axis]);
            high[axis] = high[axis].max(local[axis]);
        }
    }
    let mut accessors = vec![json!({
        "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3",
        "min": low.map(f64::from), "max": high.map(f64::from),
    })];
    let mut materials: Vec<Value> = Vec::new();
    let mut meshes: Vec<(&str, Vec<Value>)> = Vec::new();
    let (mut known_materials, mut known_meshes) = (HashMap::new(), HashMap::new());
    let unnamed = FaceGroup::default();
    let mut before = 0;
    for (group, triangles) in members.iter().enumerate().filter(|(_, triangles)| !triangles.is_empty()) {
        let group = mesh.groups.list.get(group).unwrap_or(&unnamed);
        let mut primitive = json!({"attributes": {"POSITION": 0}, "indices": accessors.len()});
        accessors.push(json!({
            "bufferView": 1, "byteOffset": 12 * before, "componentType": 5125, "count": 3 * triangles.len(),
            "type": "SCALAR",
        }));
        before += triangles.len();
        if let Some(material) = &group.material {
            let material = material_object(&material.name, material.base_color);
            let index = *known_materials.entry(material.to_string()).or_insert_with(|| {
                materials.push(material);
                materials.len() - 1
            });
            primitive["material"] = json!(index);
        }
        let index = *known_meshes.entry(&group.name).or_insert_with(|| {
            meshes.push((&group.name, Vec::new()));
            meshes.len() - 1
        });
        meshes[index].1.push(primitive);
    }

    let named = |mut object: Value, name: &str| {
        if !name.is_empty() {
            object["name"] = json!(name);
        }
        object
    };
    let mut nodes: Vec<Value> =
        meshes.iter().enumerate().map(|(i, (name, _))| named(json!({"mesh": i}), name)).collect();
    let placed = frame.offset != DVec3::ZERO || frame.scale != 1.0;
    let mut roots: Vec<usize> = (0..nodes.len()).collect();
    if placed {
        if nodes.len() > 1 {
            nodes.push(json!({"children": roots}));
            roots = vec![nodes.len() - 1];
        }
        let root = &mut nodes[roots[0]];
        root["translation"] = json!(frame.offset.to_array());
        if frame.scale != 1.0 {
            root["scale"] = json!([frame.scale, frame.scale, frame.scale]);
        }
    }
    let mut document = Map::new();
    let mut put = |key: &str, value: Value| document.insert(key.to_string(), value);
    put("asset", asset());
    put("scene", json!(0));
    put("scenes", json!([{"nodes": roots}]));
    put("nodes", json!(nodes));
    put(
        "meshes",
        meshes.into_iter().map(|(name, primitives)| named(json!({"primitives": primitives}), name)).collect(),
    );
    put("accessors", json!(accessors));
    put(
        "bufferViews",
        json!([
            {"buffer": 0, "byteOffset": 0, "byteLength": 12 * vertices, "target": 34962},
            {"buffer": 0, "byteOffset": 12 * vertices, "byteLength": 12 * triangles, "target": 34963},
        ]),
    );
    if !materials.is_empty() {
        put("materials", json!(materials));
    }
    document
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

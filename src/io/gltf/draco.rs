//! `KHR_draco_mesh_compression`: primitives whose indices and attributes are in compressed form, decoded by the crate `draco-core`,
//! which is pure Rust without `unsafe`, fuzzed, and keeps to limits that it is given.

use std::rc::Rc;

use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex};
use gltf_json::accessor::{BYTE, FLOAT, SHORT, Type, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use gltf_json::mesh::TRIANGLES;
use gltf_json::validation::Checked;

use super::accessor::Accessors;
use super::budget::Budget;
use super::corners::Names;
use super::document::{Accessor, Draco, Primitive};
use crate::Error;

/// Bytes that the decoder holds for a point and a face beside what it decodes, at most: its tables of corners.
const PER_POINT: u64 = 32;
const PER_FACE: u64 = 160;

/// Decodes a primitive, whose accessors then have their items from it.
pub(super) fn decode(
    primitive: &Primitive<'_>,
    draco: &Draco,
    names: &Names<'_>,
    pointer: &str,
    accessors: &mut Accessors<'_>,
    budget: &mut Budget<'_>,
) -> Result<(), Error> {
    let reader = accessors.reader;
    let pointer = format!("{pointer}/extensions/KHR_draco_mesh_compression");
    let fail = |what: String| reader.error(&*pointer, what);
    let Some(indices) = primitive.indices.filter(|_| primitive.mode.unwrap_or(TRIANGLES) == TRIANGLES) else {
        return Err(fail("is read for lists of triangles with indices only".into()));
    };
    // 1. What the accessors announce is what there may be.
    let faces = accessors.get(indices, Type::Scalar, &pointer)?.count / 3;
    let mut points = 0;
    let mut wanted: Vec<(u32, &Accessor, u32)> = Vec::new();
    for (name, &id) in &draco.attributes {
        let Some(&index) = names.get(name.as_str()) else { continue };
        let accessor = reader.get(&reader.document.accessors, "accessors", index as usize, &pointer)?;
        points = accessor.count.max(points);
        wanted.push((index, accessor, id));
    }
    let decoded = (wanted.iter())
        .map(|(_, accessor, _)| accessor.count.saturating_mul(item_size(accessor)))
        .fold(0, u64::saturating_add);
    let tables = points.saturating_mul(PER_POINT).saturating_add(faces.saturating_mul(PER_FACE));
    budget.charge(decoded.saturating_mul(2).saturating_add(tables))?;
    // 2. The mesh. (Attributes that nobody asks for may be as large again.)
    let view = accessors.buffers.view(draco.buffer_view as usize)?;
    let limits = DecodeLimits::default()
        .with_max_points(points)
        .with_max_faces(faces)
        .with_max_decoded_bytes(decoded.saturating_mul(4).max(1 << 20));
    let mut buffer = DecoderBuffer::new(view.as_slice()).with_limits(limits);
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut buffer, &mut mesh)
        .map_err(|error| fail(format!("cannot be decoded: {error}; the file is damaged")))?;
    if mesh.num_points() as u64 != points || mesh.num_faces() as u64 != faces {
        let (found_points, found_faces) = (mesh.num_points(), mesh.num_faces());
        return Err(fail(format!(
            "holds {found_points} vertices and {found_faces} triangles, but the accessors have {points} and {faces}"
        )));
    }
    // 3. Items as the accessors describe them.
    for (index, accessor, id) in wanted {
        let Some(attribute) = mesh.attribute_by_unique_id(id) else {
            return Err(fail(format!("has no attribute {id}")));
        };
        let bytes = items(attribute, accessor, mesh.num_points())
            .ok_or_else(|| fail(format!("attribute {id} is of another type than its accessor {index}")))?;
        accessors.decoded.insert(index, Rc::new(bytes));
    }
    let kind = accessors.get(indices, Type::Scalar, &pointer)?.component_type;
    accessors.decoded.insert(indices, Rc::new(corners(&mesh, kind)));
    Ok(())
}

/// The bytes of an item of an accessor.
fn item_size(accessor: &Accessor) -> u64 {
    let Checked::Valid(shape) = accessor.shape else { return 64 };
    4 * shape.multiplicity() as u64
}

/// The items of an attribute, one for each point; nothing if they are not what the accessor says.
fn items(attribute: &PointAttribute, accessor: &Accessor, points: usize) -> Option<Vec<u8>> {
    let (kind, size) = match attribute.data_type() {
        DataType::Int8 => (BYTE, 1),
        DataType::Uint8 => (UNSIGNED_BYTE, 1),
        DataType::Int16 => (SHORT, 2),
        DataType::Uint16 => (UNSIGNED_SHORT, 2),
        DataType::Uint32 => (UNSIGNED_INT, 4),
        DataType::Float32 => (FLOAT, 4),
        _ => return None,
    };
    let Checked::Valid(shape) = accessor.shape else { return None };
    let width = usize::from(attribute.num_components());
    if kind != accessor.component_type || width != shape.multiplicity() || accessor.count != points as u64 {
        return None;
    }
    let (size, stride) = (size * width, usize::try_from(attribute.byte_stride()).ok()?);
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(points * size);
    for point in 0..points as u32 {
        let start = (attribute.mapped_index(PointIndex(point)).0 as usize).checked_mul(stride)?;
        bytes.extend_from_slice(data.get(start..start.checked_add(size)?)?);
    }
    Some(bytes)
}

/// The corners of all triangles as indices of a type.
fn corners(mesh: &Mesh, kind: u32) -> Vec<u8> {
    let corners = || mesh.faces().iter().flatten().map(|point| point.0);
    match kind {
        // The accessor's type holds the numbers of its points, or else the file is wrong and they are wrong too.
        UNSIGNED_BYTE => corners().map(|corner| corner as u8).collect(),
        UNSIGNED_SHORT => corners().flat_map(|corner| (corner as u16).to_le_bytes()).collect(),
        _ => corners().flat_map(u32::to_le_bytes).collect(),
    }
}

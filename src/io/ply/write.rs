//! Writing PLY.

use std::io::Write;

use super::super::labels::from_below;
use super::super::rounding::{self, Written};
use super::super::text::{NumberWriter, write_all, write_blocks, write_lines};
use super::super::{Encoding, Format, Precision, WriteOptions};
use super::channels::{Channels, push_single};
use crate::mesh::{Attribute, Faces};
use crate::{Error, Mesh};
use smallvec::SmallVec;

/// Writes vertices and triangles, binary little-endian in double precision unless the options say otherwise.
pub(in crate::io) fn write(
    mesh: &Mesh,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let mut written = rounding::of_precision(mesh, Format::Ply, options)?;
    let double = options.precision == Precision::Double;
    // Nobody looks for names of groups in PLY.
    if mesh.groups.list.iter().any(|group| group.material.is_some()) {
        written
            .warnings
            .insert(0, "PLY is written without materials: names, colours and pictures are not kept".into());
    }
    let channels = Channels::of(mesh, options.precision);
    // Lists have counts of one byte; that of texture coordinates has two numbers a corner.
    let most = if channels.texture.is_some() { 127 } else { 255 };
    let faces = Faces::of(mesh, most, |a, b| channels.are_one(a, b));
    let coding = match options.encoding {
        Encoding::Ascii => "ascii",
        Encoding::Binary => "binary_little_endian",
        Encoding::BinaryBigEndian => "binary_big_endian",
    };
    let number = if double { "double" } else { "float" };
    // Signed indices are the usual ones.
    let index = if mesh.positions.len() <= i32::MAX as usize { "int" } else { "uint" };
    let header = format!(
        "ply\nformat {coding} 1.0\nelement vertex {}\nproperty {number} x\nproperty {number} y\nproperty {number} z\n\
         {}element face {}\nproperty list uchar {index} vertex_indices\n{}{}end_header\n",
        mesh.positions.len(),
        Channels::header(&channels.of_vertices),
        faces.len(),
        if channels.texture.is_some() { "property list uchar float texcoord\n" } else { "" },
        Channels::header(&channels.of_faces),
    );
    write_all(output, header.as_bytes())?;
    written.warnings.splice(0..0, channels.warnings.iter().cloned());
    if !channels.is_empty() || !faces.are_triangles() && options.encoding != Encoding::Ascii {
        write_records(mesh, &faces, &channels, output, options)?;
        return Ok(written);
    }
    match (options.encoding, double) {
        (Encoding::Ascii, _) => write_lines(mesh, &faces, output, options)?,
        (Encoding::Binary, true) => write_binary(mesh, output, options, f64::to_le_bytes, u32::to_le_bytes)?,
        (Encoding::Binary, false) => {
            write_binary(mesh, output, options, |x| (x as f32).to_le_bytes(), u32::to_le_bytes)?;
        }
        (Encoding::BinaryBigEndian, true) => {
            write_binary(mesh, output, options, f64::to_be_bytes, u32::to_be_bytes)?;
        }
        (Encoding::BinaryBigEndian, false) => {
            write_binary(mesh, output, options, |x| (x as f32).to_be_bytes(), u32::to_be_bytes)?;
        }
    }
    Ok(written)
}

/// Writes vertices and triangles with their properties.
fn write_records(
    mesh: &Mesh,
    faces: &Faces,
    channels: &Channels<'_>,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<(), Error> {
    let encoding = options.encoding;
    let is_text = encoding == Encoding::Ascii;
    write_blocks(output, mesh.positions.len(), &options.control, |range, out| {
        let mut numbers = NumberWriter::new(options.precision);
        for vertex in range {
            let position = mesh.positions[vertex];
            match (is_text, options.precision) {
                (true, _) => numbers.point(out, position),
                (false, Precision::Single) => position.iter().for_each(|&x| push_single(x, encoding, out)),
                (false, Precision::Double) => {
                    let big = encoding == Encoding::BinaryBigEndian;
                    let bytes = |x: f64| if big { x.to_be_bytes() } else { x.to_le_bytes() };
                    position.iter().for_each(|&x| out.extend_from_slice(&bytes(x)));
                }
            }
            channels.of_vertices.iter().for_each(|channel| channel.write(vertex, encoding, out));
            if is_text {
                out.push(b'\n');
            }
        }
    })?;
    write_blocks(output, faces.len(), &options.control, |range, out| {
        let mut numbers = NumberWriter::new(options.precision);
        for face in range {
            let corners: SmallVec<[u32; 8]> = faces.corners(face).collect();
            write_face(mesh, &corners, encoding, &mut numbers, out);
            if let Some(texture) = channels.texture {
                write_texture(texture, &corners, encoding, &mut numbers, out);
            }
            let triangle = corners.first().map_or(0, |&corner| corner as usize / 3);
            channels.of_faces.iter().for_each(|channel| channel.write(triangle, encoding, out));
            if is_text {
                out.push(b'\n');
            }
        }
    })
}

fn write_face(
    mesh: &Mesh,
    corners: &[u32],
    encoding: Encoding,
    numbers: &mut NumberWriter,
    out: &mut Vec<u8>,
) {
    if encoding == Encoding::Ascii {
        numbers.integer(out, corners.len() as u64);
    } else {
        out.push(corners.len() as u8);
    }
    for corner in corners.iter().map(|&corner| mesh.triangles[corner as usize / 3][corner as usize % 3]) {
        match encoding {
            Encoding::Ascii => {
                out.push(b' ');
                numbers.integer(out, u64::from(corner));
            }
            Encoding::Binary => out.extend_from_slice(&corner.to_le_bytes()),
            Encoding::BinaryBigEndian => out.extend_from_slice(&corner.to_be_bytes()),
        }
    }
}

/// The texture coordinates of a face's corners; an empty list if one has none.
fn write_texture(
    texture: &Attribute,
    corners: &[u32],
    encoding: Encoding,
    numbers: &mut NumberWriter,
    out: &mut Vec<u8>,
) {
    let values = corners.iter().map(|&corner| texture.at(corner as usize / 3, corner as usize % 3));
    let values: SmallVec<[Option<&[f64]>; 8]> = values.collect();
    let is_text = encoding == Encoding::Ascii;
    let count = if values.contains(&None) { 0 } else { 2 * values.len() };
    if is_text {
        out.push(b' ');
        numbers.integer(out, count as u64);
    } else {
        out.push(count as u8);
    }
    if count == 0 {
        return;
    }
    for value in values.into_iter().flatten() {
        let (&[u, v] | &[u, v, ..]) = value else { continue };
        for number in [u, from_below(v)] {
            if is_text {
                out.push(b' ');
                numbers.float(out, f64::from(number as f32));
            } else {
                push_single(number, encoding, out);
            }
        }
    }
}

fn write_binary<const SIZE: usize>(
    mesh: &Mesh,
    output: &mut dyn Write,
    options: &WriteOptions,
    number: impl Fn(f64) -> [u8; SIZE] + Sync + Send,
    index: impl Fn(u32) -> [u8; 4] + Sync + Send,
) -> Result<(), Error> {
    write_blocks(output, mesh.positions.len(), &options.control, |range, bytes| {
        let positions = &mesh.positions[range];
        let start = bytes.len();
        bytes.resize(start + 3 * SIZE * positions.len(), 0);
        let (numbers, _) = bytes[start..].as_chunks_mut::<SIZE>();
        for (bytes, &coordinate) in numbers.iter_mut().zip(positions.as_flattened()) {
            *bytes = number(coordinate);
        }
    })?;
    write_blocks(output, mesh.triangles.len(), &options.control, |range, bytes| {
        let triangles = &mesh.triangles[range];
        let start = bytes.len();
        bytes.resize(start + 13 * triangles.len(), 3);
        let (faces, _) = bytes[start..].as_chunks_mut::<13>();
        for (face, triangle) in faces.iter_mut().zip(triangles) {
            face[0] = 3;
            face[1..5].copy_from_slice(&index(triangle[0]));
            face[5..9].copy_from_slice(&index(triangle[1]));
            face[9..13].copy_from_slice(&index(triangle[2]));
        }
    })
}

//! Writing PLY.

use std::io::Write;

use super::super::rounding::{self, Written};
use super::super::text::{write_all, write_blocks, write_lines};
use super::super::{Encoding, Format, Precision, WriteOptions};
use crate::{Error, Mesh};

/// Writes vertices and triangles, binary little-endian in double precision unless the options say otherwise.
pub(in crate::io) fn write(
    mesh: &Mesh,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let mut written = Written::default();
    let double = options.precision == Precision::Double;
    if !double {
        written = rounding::of_single(mesh, Format::Ply, options)?;
    }
    // Nobody looks for names in PLY; colours it could have.
    if mesh.groups.list.iter().any(|group| group.material.is_some()) {
        written.warnings.insert(0, "PLY is written without materials: names and colours are not kept".into());
    }
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
         element face {}\nproperty list uchar {index} vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    );
    write_all(output, header.as_bytes())?;
    match (options.encoding, double) {
        (Encoding::Ascii, _) => write_lines(mesh, output, options)?,
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

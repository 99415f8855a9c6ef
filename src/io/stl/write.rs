//! Writing STL.

use std::io::Write;

use super::super::rounding::{self, Written};
use super::super::text::{NumberWriter, line_name, write_all, write_blocks};
use super::super::{Encoding, Format, Precision, WriteOptions};
use crate::{Error, Mesh};
use glam::DVec3;

/// Writes binary or ASCII STL, as the options say.
pub(in crate::io) fn write(
    mesh: &Mesh,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let ascii = options.encoding == Encoding::Ascii;
    let mut written = Written::default();
    if !ascii || options.precision == Precision::Single {
        written = rounding::of_single(mesh, Format::Stl, options)?;
    }
    if ascii {
        write_ascii(mesh, output, options)?;
    } else {
        write_binary(mesh, output, options)?;
    }
    Ok(written)
}

/// The unit normal of a triangle, or zero if it has none.
fn normal(corners: [[f64; 3]; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(DVec3::from_array);
    let (u, v) = (b - a, c - a);
    let size = u.abs().max_element().max(v.abs().max_element());
    (u / size).cross(v / size).normalize_or_zero().to_array()
}

fn write_binary(mesh: &Mesh, output: &mut dyn Write, options: &WriteOptions) -> Result<(), Error> {
    // The header must not begin with "solid", which readers take for ASCII.
    let mut header = [b' '; 80];
    let text = b"binary STL";
    header[..text.len()].copy_from_slice(text);
    write_all(output, &header)?;
    write_all(output, &(mesh.triangles.len() as u32).to_le_bytes())?;
    write_blocks(output, mesh.triangles.len(), &options.control, |range, bytes| {
        let start = bytes.len();
        bytes.resize(start + 50 * range.len(), 0);
        let (facets, _) = bytes[start..].as_chunks_mut::<50>();
        for (triangle, facet) in mesh.triangles[range].iter().zip(facets) {
            let corners = triangle.map(|corner| mesh.positions[corner as usize]);
            let numbers = [normal(corners), corners[0], corners[1], corners[2]];
            for (bytes, number) in facet.as_chunks_mut::<4>().0.iter_mut().zip(numbers.as_flattened()) {
                *bytes = (*number as f32).to_le_bytes();
            }
        }
    })
}

fn write_ascii(mesh: &Mesh, output: &mut dyn Write, options: &WriteOptions) -> Result<(), Error> {
    let groups = &mesh.groups;
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); groups.list.len().max(1)];
    for triangle in 0..mesh.triangles.len() {
        members[groups.of_triangle.get(triangle).map_or(0, |&group| group as usize)].push(triangle as u32);
    }
    for (i, triangles) in members.iter().enumerate() {
        let name = groups.list.get(i).map_or(String::new(), |group| line_name(&group.name));
        write_all(output, format!("solid {name}").trim_end().as_bytes())?;
        write_all(output, b"\n")?;
        write_blocks(output, triangles.len(), &options.control, |range, text| {
            let mut numbers = NumberWriter::new(options.precision);
            let mut normals = NumberWriter::new(Precision::Single);
            for &triangle in &triangles[range] {
                let corners = mesh.triangles[triangle as usize].map(|corner| mesh.positions[corner as usize]);
                text.extend_from_slice(b"facet normal ");
                normals.point(text, normal(corners));
                text.extend_from_slice(b"\n outer loop\n");
                for corner in corners {
                    text.extend_from_slice(b"  vertex ");
                    numbers.point(text, corner);
                    text.push(b'\n');
                }
                text.extend_from_slice(b" endloop\nendfacet\n");
            }
        })?;
        write_all(output, format!("endsolid {name}").trim_end().as_bytes())?;
        write_all(output, b"\n")?;
    }
    Ok(())
}

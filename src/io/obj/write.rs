//! Writing OBJ.

use std::io::Write;

use super::super::rounding::{self, Written};
use super::super::text::{NumberWriter, line_name, write_all, write_blocks};
use super::super::{Format, WriteOptions};
use super::groups::NO_MATERIAL;
use super::labels::Labels;
use super::mtl::MaterialNames;
use super::unsaid::unsaid;
use crate::mesh::Faces;
use crate::{Error, Mesh};

/// Writes vertices, then faces with `g` and `usemtl` where they change.
pub(in crate::io) fn write(
    mesh: &Mesh,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let mut written = rounding::of_precision(mesh, Format::Obj, options)?;
    let names = MaterialNames::of(mesh);
    let mut header = format!("# {} vertices, {} triangles\n", mesh.positions.len(), mesh.triangles.len());
    if let Some(library) = options.material_library.as_ref().filter(|_| !names.list.is_empty()) {
        header.push_str(&format!("mtllib {}\n", line_name(library)));
    }
    write_all(output, header.as_bytes())?;

    let labels = Labels::of(mesh);
    write_blocks(output, mesh.positions.len(), &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        for vertex in range {
            text.extend_from_slice(b"v ");
            numbers.point(text, mesh.positions[vertex]);
            if let Some(color) = labels.color(vertex) {
                text.push(b' ');
                numbers.point(text, color);
            }
            text.push(b'\n');
        }
    })?;
    labels.write_tables(output, options)?;

    write_faces(mesh, &names, &labels, output, options)?;
    let of_materials = match options.material_library {
        Some(_) => unsaid(mesh),
        None if names.list.is_empty() => None,
        None => Some(
            "OBJ is written without a material library: materials are named, colours and pictures not kept"
                .into(),
        ),
    };
    written.warnings.splice(0..0, labels.lost().into_iter().chain(of_materials));
    Ok(written)
}

/// Writes the faces, with the statements that change group and material.
fn write_faces(
    mesh: &Mesh,
    names: &MaterialNames<'_>,
    labels: &Labels<'_>,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<(), Error> {
    let groups = &mesh.groups;
    let group_names: Vec<String> = groups.list.iter().map(|group| line_name(&group.name)).collect();
    // Statements that turn the state of one group into that of another; the state before the first is unnamed.
    let change = |text: &mut Vec<u8>, from: Option<usize>, to: usize| {
        let name_before = from.map_or("", |group| &group_names[group]);
        if name_before != group_names[to] {
            text.extend_from_slice(format!("g {}", group_names[to]).trim_end().as_bytes());
            text.push(b'\n');
        }
        let material_before = from.and_then(|group| names.of_group[group].as_deref());
        let material = names.of_group[to].as_deref();
        if material != material_before {
            text.extend_from_slice(format!("usemtl {}\n", material.unwrap_or(NO_MATERIAL)).as_bytes());
        }
    };
    let group_of = |corner: u32| groups.of_triangle.get(corner as usize / 3).copied();
    let faces = Faces::of(mesh, usize::MAX, |a, b| group_of(a) == group_of(b) && labels.are_one(a, b));
    write_blocks(output, faces.len(), &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        let mut before =
            range.start.checked_sub(1).and_then(|before| group_of(faces.corners(before).next()?));
        for face in range {
            let corners = faces.corners(face);
            if let Some(group) = faces.corners(face).next().and_then(group_of) {
                if before != Some(group) {
                    change(text, before.map(|group| group as usize), group as usize);
                }
                before = Some(group);
            }
            text.push(b'f');
            for corner in corners {
                text.push(b' ');
                let vertex = mesh.triangles[corner as usize / 3][corner as usize % 3];
                numbers.integer(text, u64::from(vertex) + 1);
                labels.write_corner(corner as usize, &mut numbers, text);
            }
            text.push(b'\n');
        }
    })
}

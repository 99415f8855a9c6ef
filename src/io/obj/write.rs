//! Writing OBJ, and the material library beside it.

use std::collections::HashMap;
use std::io::Write;

use super::super::rounding::{self, Written};
use super::super::text::{NumberWriter, line_name, write_all, write_blocks};
use super::super::{Format, Precision, WriteOptions};
use super::groups::NO_MATERIAL;
use crate::{Error, Material, Mesh};

/// Writes vertices, then faces with `g` and `usemtl` where they change.
pub(in crate::io) fn write(
    mesh: &Mesh,
    output: &mut dyn Write,
    options: &WriteOptions,
) -> Result<Written, Error> {
    let mut written = Written::default();
    if options.precision == Precision::Single {
        written = rounding::of_single(mesh, Format::Obj, options)?;
    }
    let names = MaterialNames::of(mesh);
    let mut header = format!("# {} vertices, {} triangles\n", mesh.positions.len(), mesh.triangles.len());
    if let Some(library) = options.material_library.as_ref().filter(|_| !names.list.is_empty()) {
        header.push_str(&format!("mtllib {}\n", line_name(library)));
    }
    write_all(output, header.as_bytes())?;

    write_blocks(output, mesh.positions.len(), &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        for &position in &mesh.positions[range] {
            text.extend_from_slice(b"v ");
            numbers.point(text, position);
            text.push(b'\n');
        }
    })?;

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
    write_blocks(output, mesh.triangles.len(), &options.control, |range, text| {
        let mut numbers = NumberWriter::new(options.precision);
        for triangle in range {
            if let Some(&group) = groups.of_triangle.get(triangle) {
                let before = triangle.checked_sub(1).map(|before| groups.of_triangle[before] as usize);
                if before != Some(group as usize) {
                    change(text, before, group as usize);
                }
            }
            text.push(b'f');
            for corner in mesh.triangles[triangle] {
                text.push(b' ');
                numbers.integer(text, u64::from(corner) + 1);
            }
            text.push(b'\n');
        }
    })?;
    Ok(written)
}

/// The material library of a mesh, if it has any materials.
pub(in crate::io) fn library(mesh: &Mesh) -> Option<Vec<u8>> {
    let names = MaterialNames::of(mesh);
    if names.list.is_empty() {
        return None;
    }
    let mut text = Vec::new();
    let mut numbers = NumberWriter::new(Precision::Single);
    for (name, color) in &names.list {
        text.extend_from_slice(format!("newmtl {name}\nKd ").as_bytes());
        numbers.point(&mut text, [color[0], color[1], color[2]].map(f64::from));
        text.extend_from_slice(b"\nd ");
        numbers.float(&mut text, f64::from(color[3]));
        text.push(b'\n');
    }
    Some(text)
}

/// Names for the materials of a mesh: different for different materials, though their own names may be equal.
struct MaterialNames {
    list: Vec<(String, [f32; 4])>,
    of_group: Vec<Option<String>>,
}

impl MaterialNames {
    fn of(mesh: &Mesh) -> Self {
        let mut names = Self { list: Vec::new(), of_group: Vec::new() };
        let mut known: HashMap<(&str, [u32; 4]), String> = HashMap::new();
        let mut taken: HashMap<String, usize> = HashMap::new();
        for group in &mesh.groups.list {
            let Some(Material { name, base_color, .. }) = &group.material else {
                names.of_group.push(None);
                continue;
            };
            let color = base_color.map(|channel| if channel.is_finite() { channel } else { 1.0 });
            let unique = known.entry((name, color.map(f32::to_bits))).or_insert_with(|| {
                let mut base = line_name(name);
                if base.is_empty() || base == NO_MATERIAL {
                    base = "material".to_string();
                }
                let mut unique = base.clone();
                while taken.contains_key(&unique) {
                    let number = taken.entry(base.clone()).or_insert(1);
                    *number += 1;
                    unique = format!("{base}.{number}");
                }
                taken.insert(unique.clone(), 1);
                names.list.push((unique.clone(), color));
                unique
            });
            names.of_group.push(Some(unique.clone()));
        }
        names
    }
}

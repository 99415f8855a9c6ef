//! The same files read by other crates.

use std::f64::consts::{PI, TAU};

use trisect::Mesh;
use trisect::io::{Format, ReadOptions, WriteOptions, read};

use super::common::*;

/// A closed sphere, open at the poles but for a fan of triangles.
pub(crate) fn sphere(around: u32, rings: u32) -> Mesh {
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut triangles = Vec::new();
    let vertex = |ring: u32, step: u32| match ring {
        0 => 0,
        _ if ring == rings => 1,
        _ => 2 + (ring - 1) * around + step % around,
    };
    for ring in 0..rings {
        for step in 0..around {
            if ring > 0 {
                let (radius, height) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
                let (sin, cos) = (TAU * f64::from(step) / f64::from(around)).sin_cos();
                positions.push([radius * cos, radius * sin, height]);
                triangles.push([vertex(ring, step), vertex(ring + 1, step), vertex(ring, step + 1)]);
            }
            if ring + 1 < rings {
                triangles.push([vertex(ring, step + 1), vertex(ring + 1, step), vertex(ring + 1, step + 1)]);
            }
        }
    }
    Mesh::new(positions, triangles)
}

/// The corners of all triangles in `tobj`'s reading, which splits vertices by group.
fn tobj_corners(bytes: &[u8]) -> Vec<[u64; 3]> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &options, |_| Ok(Default::default())).unwrap();
    models
        .iter()
        .flat_map(|model| {
            let point = |&index: &u32| {
                let at = 3 * index as usize;
                [0, 1, 2].map(|axis| model.mesh.positions[at + axis].to_bits())
            };
            model.mesh.indices.iter().map(point).collect::<Vec<_>>()
        })
        .collect()
}

fn corners(mesh: &Mesh) -> Vec<[u64; 3]> {
    let point = |&corner: &u32| mesh.positions[corner as usize].map(f64::to_bits);
    mesh.triangles.as_flattened().iter().map(point).collect()
}

#[test]
fn tobj_reads_the_same_corners() {
    for mesh in [sphere(200, 300), scattered(3), grouped_box()] {
        let bytes = to_bytes(&mesh, Format::Obj, &WriteOptions::new());
        assert_eq!(tobj_corners(&bytes), corners(&mesh));
    }
    for name in [
        "box_without_lineending.obj",
        "cube_usemtl.obj",
        "issue-138.obj",
        "joined_tetrahedra.obj",
        "nancolor.obj",
        "negative_indices.obj",
    ] {
        let bytes = std::fs::read(fixture(name)).unwrap();
        let mesh = read(&bytes, Format::Obj, &ReadOptions::new()).unwrap().mesh;
        assert_eq!(tobj_corners(&bytes), corners(&mesh), "{name}");
    }
}

#[test]
fn gltf_reads_what_is_written() {
    for mesh in [sphere(20, 30), grouped_box()] {
        let bytes = to_bytes(&mesh, Format::Glb, &WriteOptions::new());
        // Parsing validates.
        let file = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = file.blob.as_deref().unwrap();
        let mut found = Vec::new();
        for node in file.nodes() {
            assert!(matches!(
                node.transform(),
                gltf::scene::Transform::Decomposed { translation: [0.0, 0.0, 0.0], .. }
            ));
            for primitive in node.mesh().unwrap().primitives() {
                let reader = primitive.reader(|_| Some(blob));
                let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
                let indices = reader.read_indices().unwrap().into_u32();
                found.extend(indices.map(|index| positions[index as usize]));
            }
        }
        let rounded = |&corner: &u32| mesh.positions[corner as usize].map(|x| x as f32);
        let wanted: Vec<[f32; 3]> = mesh.triangles.as_flattened().iter().map(rounded).collect();
        assert_eq!(found, wanted);
    }
    for mesh in [grouped_box(), Mesh::default()] {
        let bytes = to_bytes(&mesh, Format::Gltf, &WriteOptions::new());
        gltf::Gltf::from_slice(&bytes).unwrap();
    }
}

#[test]
fn gltf_reads_the_same_from_files_of_others() {
    for name in ["nested.glb", "BoxInterleaved.glb"] {
        let bytes = std::fs::read(fixture(name)).unwrap();
        let file = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = file.blob.as_deref().unwrap();
        let mut count = 0;
        for mesh in file.meshes() {
            for primitive in mesh.primitives() {
                count += primitive.reader(|_| Some(blob)).read_indices().unwrap().into_u32().count();
            }
        }
        let mesh = read(&bytes, Format::Glb, &ReadOptions::new()).unwrap().mesh;
        assert_eq!(3 * mesh.triangles.len(), count, "{name}");
    }
}

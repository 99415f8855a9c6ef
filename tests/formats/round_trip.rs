//! What is written reads back as it was.

use trisect::io::{Encoding, Format, Precision, WriteOptions, write};
use trisect::{Error, Mesh};

use super::common::*;

fn bits(mesh: &Mesh) -> Vec<[u64; 3]> {
    mesh.positions.iter().map(|position| position.map(f64::to_bits)).collect()
}

#[test]
fn double_precision_keeps_every_bit() {
    for seed in 0..200 {
        let mut mesh = scattered(seed);
        mesh.positions[0] = [-0.0, 5e-324, f64::MAX];
        for (format, options) in ways() {
            if matches!(format, Format::Obj | Format::Ply | Format::Off) {
                let back = from_bytes(&to_bytes(&mesh, format, &options), format);
                assert_eq!(bits(&back), bits(&mesh), "{format} {options:?} seed {seed}");
                assert_eq!(back.triangles, mesh.triangles);
            }
        }
        // ASCII STL too, but for vertex order and negative zero.
        mesh.positions[0][0] = 0.0;
        let options = WriteOptions::new().encoding(Encoding::Ascii);
        let back = from_bytes(&to_bytes(&mesh, Format::Stl, &options), Format::Stl);
        let corners = |mesh: &Mesh| {
            let corner = |&corner: &u32| mesh.positions[corner as usize].map(f64::to_bits);
            mesh.triangles.as_flattened().iter().map(corner).collect::<Vec<_>>()
        };
        assert_eq!(corners(&back), corners(&mesh), "seed {seed}");
        assert_eq!(back.positions.len(), 8);
    }
}

#[test]
fn single_precision_rounds_once() {
    let mut mesh = grouped_box();
    mesh.groups = Default::default();
    for (i, coordinate) in mesh.positions.as_flattened_mut().iter_mut().enumerate() {
        *coordinate = (*coordinate + 0.1) * (1.0 + i as f64 / 7.0);
    }
    let mut rounded = mesh.clone();
    rounded.positions.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
    for (format, options) in ways() {
        let options = single(&options);
        let back = from_bytes(&to_bytes(&mesh, format, &options), format);
        match format {
            Format::Stl => {
                let mut found = back.positions.clone();
                let mut wanted = rounded.positions.clone();
                if options_are_ascii(&options) {
                    // Text holds the digits of the rounded number, which stand for another double.
                    found.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
                }
                found.sort_by(|a, b| a.partial_cmp(b).unwrap());
                wanted.sort_by(|a, b| a.partial_cmp(b).unwrap());
                assert_eq!(found, wanted);
            }
            _ if matches!(format.extension(), "obj" | "off" | "ply" | "3mf") => {
                let found: Vec<f32> = back.positions.as_flattened().iter().map(|&x| x as f32).collect();
                let wanted: Vec<f32> = rounded.positions.as_flattened().iter().map(|&x| x as f32).collect();
                assert_eq!(found, wanted, "{format}");
            }
            // Measured from the middle of the model, so not the same roundings.
            _ => {
                for (found, wanted) in back.positions.as_flattened().iter().zip(mesh.positions.as_flattened())
                {
                    assert!((found - wanted).abs() < 2.0 * f64::from(f32::EPSILON), "{format}");
                }
            }
        }
        assert_eq!(points_and_closedness(&back), (8, true), "{format}");
    }
}

fn options_are_ascii(options: &WriteOptions) -> bool {
    format!("{options:?}").contains("Ascii")
}

#[test]
fn groups_and_materials_survive_where_the_format_has_them() {
    let mesh = grouped_box();
    for format in [Format::Gltf, Format::Glb] {
        assert_eq!(from_bytes(&to_bytes(&mesh, format, &WriteOptions::new()), format), mesh, "{format}");
    }
    // Without its library an OBJ has the names of the materials.
    let mut white = mesh.clone();
    for group in &mut white.groups.list {
        group.material.iter_mut().for_each(|material| material.base_color = [1.0; 4]);
    }
    assert_eq!(from_bytes(&to_bytes(&mesh, Format::Obj, &WriteOptions::new()), Format::Obj), white);
    // STL has one solid for each name, and no materials.
    let options = WriteOptions::new().encoding(Encoding::Ascii);
    let back = from_bytes(&to_bytes(&mesh, Format::Stl, &options), Format::Stl);
    let names: Vec<&str> = back.groups.list.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["bottom & top", "Stra\u{df}e #2"]);
    assert_eq!(back.groups.of_triangle, [0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
}

#[test]
fn groups_in_any_order_of_triangles() {
    let mut mesh = grouped_box();
    mesh.groups.of_triangle = (0..12).map(|i| i * 7 % 3).collect();
    let of = |mesh: &Mesh| {
        let name = |(triangle, &group): (&[u32; 3], &u32)| {
            let group = &mesh.groups.list[group as usize];
            (*triangle, group.name.clone(), group.material.as_ref().map(|material| material.name.clone()))
        };
        let mut list: Vec<_> = mesh.triangles.iter().zip(&mesh.groups.of_triangle).map(name).collect();
        list.sort();
        list
    };
    for format in [Format::Obj, Format::Gltf, Format::Glb] {
        let back = from_bytes(&to_bytes(&mesh, format, &WriteOptions::new()), format);
        assert_eq!(of(&back), of(&mesh), "{format}");
    }
}

#[test]
fn large_coordinates_keep_their_digits_in_gltf() {
    // A metre-sized box at coordinates of a map.
    let mut mesh = grouped_box();
    for position in &mut mesh.positions {
        *position =
            [position[0] / 3.0 + 500_000.0, position[1] / 3.0 + 4_649_776.0, position[2] / 3.0 + 120.0];
    }
    let volume_at_origin = |mesh: &Mesh| {
        let mut moved = mesh.clone();
        let first = mesh.positions[0];
        moved.positions.iter_mut().for_each(|p| (0..3).for_each(|axis| p[axis] -= first[axis]));
        volume(&moved)
    };
    for format in [Format::Gltf, Format::Glb] {
        let back = from_bytes(&to_bytes(&mesh, format, &WriteOptions::new()), format);
        for (found, wanted) in back.positions.as_flattened().iter().zip(mesh.positions.as_flattened()) {
            assert!((found - wanted).abs() < 1e-7, "{found} {wanted}");
        }
        assert!((volume_at_origin(&back) - 1.0 / 27.0).abs() < 1e-7);
        assert_eq!(back.triangles, mesh.triangles);
    }
}

#[test]
fn sizes_beyond_single_precision() {
    for scale in [1e-320, 1e-200, 1e-45, 1e45, 1e200, 1e307] {
        let mut mesh = grouped_box();
        mesh.groups = Default::default();
        mesh.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        for format in [Format::Gltf, Format::Glb] {
            let back = from_bytes(&to_bytes(&mesh, format, &WriteOptions::new()), format);
            for (found, wanted) in back.positions.as_flattened().iter().zip(mesh.positions.as_flattened()) {
                assert!((found - wanted).abs() <= 1e-7 * scale, "{found:e} {wanted:e}");
            }
        }
        if scale > 1e40 {
            for (format, options) in [
                (Format::Stl, WriteOptions::new()),
                (Format::Ply, WriteOptions::new().precision(Precision::Single)),
                (Format::Obj, WriteOptions::new().precision(Precision::Single)),
                (Format::Off, WriteOptions::new().precision(Precision::Single)),
            ] {
                let error = write(&mesh, format, &mut Vec::new(), &options).unwrap_err();
                assert!(
                    matches!(error, Error::Format(trisect::io::FormatError::Unsupported { .. })),
                    "{error}"
                );
            }
        }
    }
}

#[test]
fn triangles_that_rounding_collapses_are_told() {
    let mut mesh = grouped_box();
    mesh.groups = Default::default();
    // Two corners that differ in double precision only, far from the origin.
    mesh.positions[7] = [1.0, 1.0, 1e-12];
    mesh.positions.push([1e5, 1e5, 1e5]);
    for (format, options) in [
        (Format::Stl, WriteOptions::new()),
        (Format::Ply, WriteOptions::new().precision(Precision::Single)),
        (Format::Glb, WriteOptions::new()),
    ] {
        let mut mesh = mesh.clone();
        mesh.positions.iter_mut().take(8).for_each(|p| p[2] += 7.0);
        let mut bytes = Vec::new();
        let warnings = write(&mesh, format, &mut bytes, &options).unwrap();
        assert!(
            warnings.iter().any(|warning| warning.contains("of 2 triangles equal")),
            "{format}: {warnings:?}"
        );
        if format != Format::Stl {
            // The index structure stays closed.
            assert_eq!(from_bytes(&bytes, format).triangles, mesh.triangles, "{format}");
        }
    }
    assert!(write(&grouped_box(), Format::Glb, &mut Vec::new(), &WriteOptions::new()).unwrap().is_empty());
}

#[test]
fn empty_meshes() {
    for (format, options) in ways() {
        let bytes = to_bytes(&Mesh::default(), format, &options);
        assert_eq!(from_bytes(&bytes, format), Mesh::default(), "{format}");
    }
}

#[test]
fn what_is_written_is_recognised() {
    for (format, options) in ways() {
        for mesh in [grouped_box(), scattered(1)] {
            if format == Format::Stl && mesh.groups.list.is_empty() {
                continue; // Beyond single precision.
            }
            let bytes = to_bytes(&mesh, format, &options);
            assert_eq!(Format::from_content(&bytes), Some(format), "{options:?}");
        }
    }
}

#[test]
fn equal_bytes_for_any_number_of_threads() {
    #[cfg(feature = "parallel")]
    for (format, options) in ways() {
        let mesh = oracle_mesh();
        let runs: Vec<(Vec<u8>, Mesh)> = [1, 2, 8]
            .into_iter()
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let bytes = to_bytes(&mesh, format, &options);
                    let back = from_bytes(&bytes, format);
                    (bytes, back)
                })
            })
            .collect();
        assert!(runs.iter().all(|run| *run == runs[0]), "{format} {options:?}");
    }
}

#[cfg(feature = "parallel")]
fn oracle_mesh() -> Mesh {
    super::oracle::sphere(300, 400)
}

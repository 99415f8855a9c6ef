//! Files written by others: what they hold was measured with other programs.

use trisect::io::{ReadOptions, load};

use super::common::*;

/// File, points (equal ones counted once), triangles, closed, volume.
const GOOD: &[(&str, usize, usize, bool, f64)] = &[
    ("BoxInterleaved.glb", 8, 12, true, 1.0),
    ("P.off", 26, 52, true, 9.25),
    ("beam-inside-out.off", 8, 12, true, -0.576),
    ("box_without_lineending.obj", 8, 12, true, 1.0),
    ("comments.off", 8, 12, true, 12.316808225085273),
    ("cube-vertex-w-component.obj", 8, 12, true, 8.0),
    ("cube_binary_header_with_RN_newline.ply", 8, 12, true, 1.0),
    ("cube_usemtl.obj", 8, 12, true, 1.0),
    ("cubes.off", 14, 24, true, 2.0),
    ("issue-138.obj", 8, 12, true, 1.0),
    ("issue-295-trianguation-failure.obj", 16, 28, true, 3.0),
    ("joined_tetrahedra.obj", 5, 8, true, 0.8660254),
    ("nancolor.obj", 8, 12, true, 1.0),
    ("negative_indices.obj", 8, 12, true, 8.0),
    ("nested.glb", 24, 36, true, 0.8987790543021935),
    ("platonic_shelf.obj", 50, 80, true, 9.761050974976133),
    ("rgb_cube_with_primitives.gltf", 8, 12, true, 8.0),
    ("sphere_binary_solid_header.stl", 682, 1360, true, 4129.374215444379),
    ("spheres_intersecting.off", 324, 640, true, 1.0119042836990186),
    ("three_cubes.stl", 24, 36, true, 24.000008344651928),
    ("two_objects_mixed_case_names.stl", 16, 24, true, 2.0),
    ("wallhole.obj", 35, 66, true, 1066.6666666666667),
    // Two cubes of side 2, one of them scaled by 0.9999999403953552 along two axes.
    ("02_shared_mesh.gltf", 16, 24, true, 8.0 + 8.0 * 0.999_999_940_395_355_2 * 0.999_999_940_395_355_2),
    // Coordinates of 14 bits.
    ("nested-quantized.glb", 24, 36, true, 0.8987790543021935),
    // Coordinates of 14 bits, too.
    #[cfg(feature = "draco")]
    ("nested-draco.glb", 24, 36, true, 0.8987790543021935),
    #[cfg(feature = "threemf")]
    ("vertex-colours.3mf", 4, 4, true, 1000.0 / 3.0),
];

#[test]
fn every_good_file_is_read_as_it_was_measured() {
    for &(name, points, triangles, closed, expected) in GOOD {
        let mesh =
            load(fixture(name), &ReadOptions::new()).unwrap_or_else(|error| panic!("{name}: {error}")).mesh;
        assert_valid(&mesh);
        assert_eq!(mesh.triangles.len(), triangles, "{name}");
        assert_eq!(points_and_closedness(&mesh), (points, closed), "{name}");
        let tolerance =
            if matches!(name, "nested-quantized.glb" | "nested-draco.glb") { 1e-3 } else { 1e-12 };
        let found = volume(&mesh);
        assert!((found - expected).abs() <= tolerance * expected.abs(), "{name}: {found} {expected}");
    }
}

#[test]
fn every_bad_file_is_refused_with_its_place() {
    for (name, words) in [
        ("malformed.obj", ["line 28", "counts vertices from 1"]),
        ("issue-140-zero-face-idx.obj", ["line 16", "counts vertices from 1"]),
        ("invalid.off", ["line 7", "the file has vertices 0 to 2"]),
        ("invalid-buffer-view-index.gltf", ["/bufferViews/0", "\"buffers\""]),
        #[cfg(not(feature = "draco"))]
        ("nested-draco.glb", ["KHR_draco_mesh_compression", "gltf-transform copy"]),
        ("nested-meshopt.glb", ["EXT_meshopt_compression", "gltfpack"]),
    ] {
        let error = load(fixture(name), &ReadOptions::new()).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{name}: {error}");
    }
}

#[test]
fn what_is_odd_about_a_file_is_said() {
    for (name, word) in [
        ("wallhole.obj", "00.mtl"),
        ("nancolor.obj", "not a number"),
        ("cube_usemtl.obj", "\"mtl3\""),
        ("cube-vertex-w-component.obj", "weight"),
    ] {
        let warnings = load(fixture(name), &ReadOptions::new()).unwrap().warnings;
        assert!(warnings.iter().any(|warning| warning.contains(word)), "{name}: {warnings:?}");
    }
}

#[test]
fn names_and_colours_are_kept() {
    let groups = |name: &str| {
        let mesh = load(fixture(name), &ReadOptions::new()).unwrap().mesh;
        let describe = |group: trisect::FaceGroup| match group.material {
            Some(material) => format!("{}|{}|{:?}", group.name, material.name, material.base_color),
            None => group.name,
        };
        mesh.groups.list.into_iter().map(describe).collect::<Vec<_>>()
    };
    assert_eq!(
        groups("rgb_cube_with_primitives.gltf"),
        [
            "Cube|Green|[0.0, 1.0, 0.0, 1.0]",
            "Cube|Blue|[0.0, 0.0, 1.0, 1.0]",
            "Cube|Red|[1.0, 0.0, 0.0, 1.0]"
        ]
    );
    assert_eq!(
        groups("issue-138.obj"),
        ["test1|test1|[0.5, 0.2, 0.2, 1.0]", "test2|test2|[0.2, 0.5, 0.2, 1.0]"]
    );
    assert_eq!(
        groups("two_objects_mixed_case_names.stl"),
        ["CubeExportedFromCAD", "TranslatedCubeExportedFromCAD"]
    );
}

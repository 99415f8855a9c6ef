//! Parts of files as inputs: `scene.glb#base`.

use base64::Engine as _;
use trisect::{FaceGroup, Mesh, primitives};

use crate::common::program::Folder;

/// A bar of 4 x 1 x 1 with three drills along z, an empty node, and a group of two balls under a name of their own.
fn scene() -> Folder {
    let folder = Folder::new();
    let named = |mut mesh: Mesh, name: &str| {
        mesh.groups.list = vec![FaceGroup { name: name.into(), material: None }];
        mesh.groups.of_triangle = vec![0; mesh.triangles.len()];
        mesh
    };
    let cuboid = |low, high| primitives::cuboid(low, high).expect("a box");
    let drill = |x: f64| cuboid([x, 0.25, -1.0], [x + 0.5, 0.75, 2.0]);
    let all = [
        named(cuboid([0.0; 3], [4.0, 1.0, 1.0]), "base"),
        named(drill(0.5), "cut_0"),
        named(drill(1.5), "cut_1"),
        named(drill(2.5), "cut_2"),
    ];
    let all = Mesh::merged(&all).expect("small");
    for name in ["scene.glb", "scene.gltf", "scene.obj"] {
        all.save(folder.path(name)).expect("written");
    }
    trisect::io::save(
        &all,
        folder.path("scene.stl"),
        &trisect::io::WriteOptions::new().encoding(trisect::io::Encoding::Ascii),
    )
    .expect("written");
    folder
}

#[test]
fn the_parts_of_one_file_are_operands() {
    let folder = scene();
    for file in ["scene.glb", "scene.gltf", "scene.obj", "scene.stl"] {
        let line = format!("difference {file}#base {file}#cut_* --json --strict");
        let report = folder.run(&line).exits(0).json();
        assert_eq!(report["result"]["volume"], 4.0 - 3.0 * 0.25, "{file}");
        let names: Vec<String> = report["operands"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|operand| operand["file"].as_str().expect("a name").to_owned())
            .collect();
        assert_eq!(names, ["base", "cut_0", "cut_1", "cut_2"].map(|part| format!("{file}#{part}")));
    }
    // One by one, each with its own transform; a pattern's transform moves all of its parts.
    let line = "difference scene.glb#base scene.glb#cut_0 --translate 9,0,0 scene.glb#cut_? --translate 0,0.5,0 --json";
    let report = folder.run(line).exits(0).json();
    assert_eq!(report["result"]["volume"], 4.0 - 3.0 * 0.125);
    assert_eq!(report["operands"][4]["transforms"][0], "translate 0,0.5,0");
    folder.run("union scene.obj#* --json").exits(0).says("scene.obj#cut_2");
}

#[test]
fn what_is_not_there_is_told_with_what_is() {
    let folder = scene();
    folder.run("difference scene.glb#bsae scene.glb#cut_*").exits(1).says("nowhere to put the result");
    let line = "difference scene.glb#bsae scene.glb#cut_* -o x.glb";
    folder
        .run(line)
        .exits(3)
        .says("operand 1 (scene.glb#bsae)")
        .says("no part is named \"bsae\"")
        .says("\"base\"");
    folder.run("union scene.glb#drill* -o x.glb").exits(3).says("no part is named \"drill*\"");
    folder
        .run("difference scene.glb#cut_* scene.glb#base -o x.glb")
        .exits(3)
        .says("3 parts")
        .says("unite them");
    folder.run("union missing.glb#base -o x.glb").exits(2).says("missing.glb");
    folder.run("convert scene.obj -o plain.ply").exits(0);
    folder.run("check plain.ply#base").exits(3).says("has no names of parts");
    assert!(!folder.exists("x.glb"));
}

#[test]
fn other_verbs_take_parts_too() {
    let folder = scene();
    // Taken together where a verb takes one input.
    let report = folder.run("convert scene.glb#cut_* cuts.stl --json").exits(0).json();
    assert_eq!(
        (&report["input"]["triangles"], &report["input"]["file"]),
        (&36.into(), &"scene.glb#cut_*".into())
    );
    let report = folder.run("check scene.obj#cut_* --json").exits(0).json();
    assert_eq!(report["files"].as_array().map(Vec::len), Some(3));
    let report = folder.run("info scene.glb#cut_1 --json").exits(0).json();
    assert_eq!(
        (&report["files"][0]["volume"], &report["files"][0]["groups"][0]["name"]),
        (&0.75.into(), &"cut_1".into())
    );
    folder.run("grid scene.glb#base --spacing 0.5 -o g.raw --strict").exits(0);
    folder.run("slice scene.glb#base -o s.png --width 40 --strict").exits(0);
}

#[test]
fn expressions_take_the_parts_of_an_input_together() {
    let folder = scene();
    let line = "combine a=scene.glb#base b=scene.glb#cut_* --expr a-b --json";
    assert_eq!(folder.run(line).exits(0).json()["result"]["volume"], 3.25);
    // What the drills and the bar have in common is counted once.
    let report = folder.run("resolve scene.obj#* --json").exits(0).json();
    assert_eq!(report["result"]["volume"], 4.0 + 3.0 * 0.5);
}

#[test]
fn a_file_with_a_hash_in_its_name_is_that_file() {
    let folder = scene();
    std::fs::copy(folder.path("scene.obj"), folder.path("scene.glb#base")).expect("copied");
    let report = folder.run("info scene.glb#base scene.glb#cut_0 --json").exits(0).json();
    assert_eq!(
        (&report["files"][0]["triangles"], &report["files"][1]["triangles"]),
        (&48.into(), &12.into())
    );
}

/// A node without a mesh stands for all below it.
#[test]
fn nodes_stand_for_what_is_under_them() {
    let folder = Folder::new();
    let corners: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let indices: [u16; 12] = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
    bytes.extend(indices.iter().flat_map(|index| index.to_le_bytes()));
    let uri = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let document = serde_json::json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0, 3, 4] }],
        "nodes": [
            { "name": "wheels", "children": [1, 2], "translation": [10, 0, 0] },
            { "name": "wheel", "mesh": 0 },
            { "name": "wheel", "mesh": 0, "translation": [2, 0, 0] },
            { "name": "wheel", "mesh": 0 },
            { "name": "lamp", "children": [5] },
            {},
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1] },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 24 },
        ],
        "buffers": [{ "byteLength": 72, "uri": format!("data:application/octet-stream;base64,{uri}") }],
    });
    folder.write("car.gltf", document.to_string());
    let counts = |name: &str| -> Vec<u64> {
        let report = folder.run(&format!("check car.gltf#{name} --json")).exits(0).json();
        let files = report["files"].as_array().expect("a list");
        files.iter().map(|file| file["triangles"].as_u64().expect("a count")).collect()
    };
    // Both under the one node together; three of the one name; those of the name under the other.
    assert_eq!(counts("wheels"), [8]);
    assert_eq!(counts("wheel"), [4, 4, 4]);
    assert_eq!(counts("wheels/wheel"), [4, 4]);
    assert_eq!(counts("whee*"), [8, 4]);
    folder.run("check car.gltf#lamp").exits(3).says("what is named \"lamp\" has no triangles");
    let report = folder.run("info car.gltf#wheels --json").exits(0).json();
    assert_eq!(report["files"][0]["bounds"], serde_json::json!([[10.0, 0.0, 0.0], [13.0, 1.0, 1.0]]));
    let listed = folder.run("info car.gltf").exits(0);
    assert!(
        listed.out.contains("parts      5\n    wheels: 8 triangles\n      wheel: 4 triangles\n"),
        "{listed:?}"
    );
    let parts = folder.run("info car.gltf --json").exits(0).json()["files"][0]["parts"].clone();
    assert_eq!(parts[1], serde_json::json!({ "name": "wheel", "depth": 1, "triangles": 4 }));
}

//! Scenes in which one node gets another mesh.

use serde_json::{Value, json};

use super::super::{ReadOptions, WriteOptions};
use super::*;
use crate::primitives;

/// A scene of two cubes, one of them turned and moved, a camera below it, and an animation.
fn scene() -> Value {
    let cube = primitives::cuboid([-1.0; 3], [1.0; 3]).unwrap();
    let mut bytes = Vec::new();
    write(&cube, Format::Gltf, &mut bytes, &WriteOptions::new(), None).unwrap();
    let mut document: Value = serde_json::from_slice(&bytes).unwrap();
    document["nodes"] = json!([
        {"name": "room", "children": [1, 2, 4]},
        {"name": "wall", "mesh": 0, "translation": [5, 0, 0], "rotation": [0, 0, 0.6, 0.8], "scale": [1, 2, 1], "children": [3]},
        {"name": "lamp", "mesh": 0},
        {"name": "eye", "camera": 0},
        {"name": "twin", "children": [5]},
        {"name": "lamp", "mesh": 0, "translation": [0, 9, 0]}
    ]);
    document["scenes"][0]["nodes"] = json!([0]);
    document["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    document["materials"] = json!([{"name": "paint"}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document["extras"] = json!({"price": 7});
    document
}

fn kept(document: &Value, node: &str) -> KeptScene {
    KeptScene::of_bytes(document.to_string().into_bytes(), Format::Gltf, node)
}

fn read_back(bytes: &[u8], format: Format) -> SceneRead {
    read(bytes, format, &ReadOptions::new(), true).unwrap()
}

#[test]
fn one_node_changes_and_all_else_stays() {
    let document = scene();
    let text = document.to_string();
    let before = read_back(text.as_bytes(), Format::Gltf);
    for (node, mesh, triangles) in [
        ("wall", primitives::icosphere(1.0, 1).unwrap().translated([5.0, 0.0, 0.0]), 80),
        ("room/lamp", primitives::icosphere(1.0, 1).unwrap(), 80),
        ("wall", Mesh::default(), 0),
    ] {
        for format in [Format::Gltf, Format::Glb] {
            let mut bytes = Vec::new();
            write_kept(&mesh, &kept(&document, node), format, &mut bytes, &WriteOptions::new()).unwrap();
            let after = read_back(&bytes, format);
            assert!(after.warnings.is_empty(), "{:?}", after.warnings);
            assert_eq!(after.mesh.triangles.len(), 24 + triangles, "{node}");
            assert_eq!(after.contents, before.contents);
            // It is where it was, in single precision.
            let is_there = |p: &[f64; 3]| {
                after.mesh.positions.iter().any(|q| (0..3).all(|k| (p[k] - q[k]).abs() < 1e-5))
            };
            assert!(mesh.positions.iter().all(is_there), "{node}");
        }
    }
}

#[test]
fn a_node_must_be_one() {
    for (node, words) in [("lamp", "2 nodes"), ("nobody", "nobody"), ("twin/wall", "twin/wall")] {
        let error = write_kept(
            &Mesh::default(),
            &kept(&scene(), node),
            Format::Glb,
            &mut Vec::new(),
            &WriteOptions::new(),
        );
        assert!(error.unwrap_err().to_string().contains(words), "{node}");
    }
    let mut flat = scene();
    flat["nodes"][1]["scale"] = json!([1, 0, 1]);
    let cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    assert!(
        write_kept(&cube, &kept(&flat, "wall"), Format::Glb, &mut Vec::new(), &WriteOptions::new()).is_err()
    );
}

#[test]
fn odd_documents_are_no_danger() {
    let cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    for (pointer, value) in [
        ("/bufferViews/0", json!([0, 0, 12, null])),
        ("/nodes/1/extensions", json!(7)),
        ("/nodes/1", json!(["wall", 0, [3]])),
        ("/images", json!([3, {"uri": 7}, {"uri": "../a.png"}])),
        ("/animations", json!([3, {"channels": 4}, {"channels": [5, {"target": 6}]}])),
        ("/meshes", json!({})),
        ("/extensionsUsed", json!(3)),
        ("/textures", json!("x")),
    ] {
        let mut document = scene();
        match document.pointer_mut(pointer) {
            Some(place) => *place = value,
            None => drop(document.as_object_mut().unwrap().insert(pointer[1..].to_string(), value)),
        }
        // An error or a file, never a panic.
        let mut bytes = Vec::new();
        if write_kept(&cube, &kept(&document, "wall"), Format::Glb, &mut bytes, &WriteOptions::new()).is_ok()
        {
            let _ = read(&bytes, Format::Glb, &ReadOptions::new(), false);
        }
    }
}

//! Scenes and polygons, from files into files; what is not kept is told.

use std::collections::HashSet;
use std::f64::consts::TAU;

use serde_json::{Value, json};

use super::attributes::{assert_crate, described, loaded, materials, valued, workshop};
use crate::common::program::{Folder, cube, sphere};

/// A scene: a turned crate below a room, a twin of it, a camera, and what readers do not keep.
fn scene(folder: &Folder) {
    folder.run("convert crate.obj scene.gltf").exits(0);
    let mut document: Value = serde_json::from_str(&folder.read("scene.gltf")).expect("JSON");
    document["nodes"] = json!([
        {"name": "room", "children": [1, 2, 3]},
        {"name": "body", "mesh": 0, "translation": [5, 0, 0], "extras": {"price": 7}},
        {"name": "twin", "mesh": 0, "translation": [0, 9, 0]},
        {"name": "eye", "camera": 0, "extras": {"lens": "old"}}
    ]);
    document["scenes"] = json!([{"nodes": [0], "extras": {"by": "me"}}]);
    document["scene"] = json!(0);
    document["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    document["extensionsUsed"] = json!(["KHR_materials_variants"]);
    document["extensions"] =
        json!({"KHR_materials_variants": {"variants": [{"name": "day"}, {"name": "night"}]}});
    folder.write("scene.gltf", document.to_string());
    folder.write("bit.obj", cube([5.75, 0.75, 0.75], [6.5, 1.5, 1.5]));
}

#[test]
fn a_node_without_a_mesh_is_a_place_for_one() {
    let folder = workshop();
    scene(&folder);
    let mut document: Value = serde_json::from_str(&folder.read("scene.gltf")).expect("JSON");
    let nodes = document["nodes"].as_array_mut().unwrap();
    nodes.push(json!({"name": "socket", "translation": [0, 0, 20]}));
    nodes[0]["children"] = json!([1, 2, 3, 4]);
    folder.write("scene.gltf", document.to_string());
    folder.run("union scene.gltf bit.obj --node socket --scene keep -o put.gltf").exits(0);
    let said = described(&folder, "put.gltf#socket");
    assert!((said["volume"].as_f64().expect("closed") - 0.75_f64.powi(3)).abs() < 1e-6, "{said}");
    // Where nothing is to stay, a node without a mesh is no input, and one that is not there never is.
    folder.run("union scene.gltf#socket bit.obj -o put.gltf").exits(3).says("no part is named");
    folder.run("union scene.gltf bit.obj --node sockets --scene keep -o put.gltf").exits(3).says("sockets");
    folder
        .run("union bit.obj scene.gltf#socket --scene keep --node bit -o put.gltf")
        .exits(2)
        .says("only glTF files have scenes");
}

#[test]
fn a_scene_stays_around_the_node_that_is_cut() {
    let folder = workshop();
    scene(&folder);
    for line in
        ["scene.gltf --node body bit.obj", "scene.gltf#body bit.obj", "scene.gltf --node room/body bit.obj"]
    {
        folder.run(&format!("difference {line} -o cut.gltf --scene keep --strict")).exits(0);
        let document: Value = serde_json::from_str(&folder.read("cut.gltf")).expect("JSON");
        let names: Vec<&str> =
            document["nodes"].as_array().unwrap().iter().filter_map(|node| node["name"].as_str()).collect();
        assert_eq!(names, ["room", "body", "twin", "eye"], "{line}");
        assert_eq!(
            (&document["nodes"][1]["extras"]["price"], &document["nodes"][3]["camera"]),
            (&json!(7), &json!(0))
        );
        assert_eq!(document["scenes"][0]["extras"]["by"], "me");
        let volume =
            |part: &str| described(&folder, &format!("cut.gltf#{part}"))["volume"].as_f64().expect("closed");
        assert!((volume("body") - (1.0 - 0.25_f64.powi(3))).abs() < 1e-6, "{line}");
        assert!((volume("twin") - 1.0).abs() < 1e-6, "{line}");
        let said = described(&folder, "cut.gltf");
        assert_eq!(
            (&said["contents"]["cameras"], said["pictures"].as_array().map(Vec::len)),
            (&json!(1), Some(1)),
            "{said}"
        );
    }
    // Formats without scenes have the node alone.
    let ran = folder.run("difference scene.gltf#body bit.obj -o cut.ply --scene keep --strict").exits(5);
    ran.says("PLY has no scenes");
    // Alone, the node leaves the rest behind, which is said.
    let said = folder.run("difference scene.gltf --node body bit.obj -o alone.glb --strict").exits(5);
    let said = said
        .says("1 camera not kept")
        .says("extras of 3 nodes and scenes not kept")
        .says("2 material variants not kept");
    assert!(said.err.contains("scene.gltf"), "{said:?}");
    folder.write("model.json", json!({"kind": "mesh", "file": "scene.gltf"}).to_string());
    folder.run("eval model.json -o alone.glb --strict").exits(5).says("scene.gltf: 1 camera not kept");
    let said = described(&folder, "scene.gltf");
    assert_eq!(
        (&said["contents"]["extras"], &said["contents"]["variants"]),
        (&json!(3), &json!(2)),
        "{said}"
    );
}

#[test]
fn cuts_splits_and_trims_keep_the_scene_too() {
    let folder = workshop();
    scene(&folder);
    for (line, output) in [
        ("cut scene.gltf#body --plane x=5.5 --keep below -o cut.gltf", "cut.gltf"),
        ("split scene.gltf --node body -o part.gltf", "part-1.gltf"),
        ("trim scene.gltf --node body bit.obj --outside -o trimmed.gltf", "trimmed.gltf"),
    ] {
        folder.run(&format!("{line} --scene keep --strict")).exits(0);
        let document: Value = serde_json::from_str(&folder.read(output)).expect("JSON");
        let nodes = document["nodes"].as_array().expect("nodes");
        assert_eq!((nodes.len(), &nodes[3]["camera"]), (4, &json!(0)), "{line}");
        folder.run(line).exits(0).says("1 camera not kept");
    }
}

#[test]
fn what_the_mesh_of_a_node_says_goes_to_the_new_one() {
    let folder = workshop();
    scene(&folder);
    let mut document: Value = serde_json::from_str(&folder.read("scene.gltf")).expect("JSON");
    let mesh = &mut document["meshes"][0];
    mesh["name"] = json!("box");
    mesh["extras"] = json!({"mass": 3, "targetNames": ["wide"]});
    mesh["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"variants": [1], "material": 0}]}});
    folder.write("scene.gltf", document.to_string());
    let ran = folder.run("difference scene.gltf#body bit.obj -o cut.gltf --scene keep --strict").exits(5);
    ran.says("the material variants of the node's mesh are not kept");
    let cut: Value = serde_json::from_str(&folder.read("cut.gltf")).expect("JSON");
    let place = cut["nodes"][1]["mesh"].as_u64().expect("a mesh") as usize;
    assert_eq!(
        (&cut["meshes"][place]["name"], &cut["meshes"][place]["extras"]),
        (&json!("box"), &json!({"mass": 3}))
    );
    // The twin has all that it had.
    let twin = cut["nodes"][2]["mesh"].as_u64().expect("a mesh") as usize;
    assert_eq!(
        cut["meshes"][twin]["primitives"][0]["extensions"],
        document["meshes"][0]["primitives"][0]["extensions"]
    );
    assert_eq!(cut["extensions"], document["extensions"]);
}

/// A torus of quads as OBJ.
fn quad_torus(around: usize, tube: usize) -> String {
    let mut text = String::new();
    for i in 0..around {
        for k in 0..tube {
            let (a, b) = (TAU * i as f64 / around as f64, TAU * k as f64 / tube as f64);
            let ring = 1.0 + 0.375 * b.cos();
            text.push_str(&format!("v {} {} {}\n", ring * a.cos(), ring * a.sin(), 0.375 * b.sin()));
        }
    }
    let at = |i: usize, k: usize| 1 + i % around * tube + k % tube;
    for i in 0..around {
        for k in 0..tube {
            text.push_str(&format!(
                "f {} {} {} {}\n",
                at(i, k),
                at(i + 1, k),
                at(i + 1, k + 1),
                at(i, k + 1)
            ));
        }
    }
    text
}

/// The polygons of more than three corners of an OBJ: the places of their corners, sorted, as bits.
fn polygons(obj: &str) -> HashSet<Vec<[u64; 3]>> {
    let points = crate::common::program::vertices(obj);
    let corner = |word: &str| {
        let vertex: usize = word.split('/').next().and_then(|word| word.parse().ok()).expect("an index");
        points[vertex - 1].map(f64::to_bits)
    };
    let faces = obj.lines().filter_map(|line| line.strip_prefix("f "));
    let faces = faces.map(|line| {
        let mut corners: Vec<[u64; 3]> = line.split_whitespace().map(corner).collect();
        corners.sort_unstable();
        corners
    });
    faces.filter(|corners| corners.len() > 3).collect()
}

#[test]
fn quads_that_nothing_touched_stay_quads() {
    let folder = Folder::new();
    let (low, high) = ([0.9, -0.3, -0.15], [1.6, 0.3, 0.15]);
    folder.write("torus.obj", quad_torus(48, 24));
    folder.write("bit.obj", cube(low, high));
    folder.run("difference torus.obj bit.obj -o cut.obj -o cut.ply -o cut.off").exits(0);
    let (before, after) = (polygons(&folder.read("torus.obj")), polygons(&folder.read("cut.obj")));
    assert_eq!(before.len(), 1152);
    // 1. What is left are quads of the torus, and all that are clear of the box are left.
    assert!(after.iter().all(|quad| before.contains(quad)));
    let is_clear = |quad: &&Vec<[u64; 3]>| {
        (0..3).any(|axis| {
            let along = || quad.iter().map(|corner| f64::from_bits(corner[axis]));
            along().all(|x| x > high[axis]) || along().all(|x| x < low[axis])
        })
    };
    assert!(before.iter().filter(is_clear).all(|quad| after.contains(quad)));
    assert_eq!((after.len(), before.iter().filter(is_clear).count()), (1136, 1136));
    // 2. In the other formats too.
    for file in ["cut.obj", "cut.ply", "cut.off"] {
        assert_eq!(loaded(&folder, file).polygons.triangles, vec![2; after.len()], "{file}");
    }
    let fours = folder.read("cut.off").lines().filter(|line| line.starts_with("4 ")).count();
    assert_eq!(fours, after.len());
}

#[test]
fn options_say_what_they_take() {
    let folder = workshop();
    scene(&folder);
    for (options, said) in [
        ("--normals smooth", "keep, flat, none, or an angle from 0 to 180 degrees"),
        ("--normals 181", "keep, flat, none, or an angle from 0 to 180 degrees"),
        ("--cut-uv sphere", "planar or box"),
        ("--cut-uv box:0", "box:0.5"),
        ("--scene stay", "drop, keep"),
        ("--scene keep", "--node NODE"),
    ] {
        folder.run(&format!("difference crate.obj tool.obj -o out.glb {options}")).exits(1).says(said);
    }
    let arguments = ["difference", "crate.obj", "tool.obj", "-o", "out.glb", "--cut-material", ""];
    folder.run_args(&arguments).exits(1).says("keep, body, or the name of a material");
    folder.run("difference scene.gltf#body bit.obj -o out.glb --node twin").exits(1).says("leave one out");
    folder.run("slice crate.obj --levels 0.5 -o out.svg --node body").exits(1);
    let ran = folder.run("difference scene.gltf bit.obj -o out.glb --scene keep --node bodi");
    assert!(ran.code != 0 && ran.err.contains("body"), "{ran:?}");
    assert!(!folder.exists("out.glb"));
}

#[test]
fn snapping_keeps_what_faces_have() {
    let folder = workshop();
    // Flush but for a hair, on the side x = 1.
    let low = 1.0 + 1e-10;
    folder.write("next.obj", cube([low, 0.25, 0.25], [2.0, 0.75, 0.75]));
    folder.run("union crate.obj next.obj --snap 1e-9 -o one.obj -o one.glb").exits(0);
    let said = described(&folder, "one.obj");
    assert_eq!(said["shells"], 1, "{said}");
    let mesh = loaded(&folder, "one.obj");
    // 1. Texture coordinates.
    assert!(assert_crate(&mesh, 1e-9) > 10);
    // 2. Groups and materials.
    let crates = materials(&folder, "one.obj");
    assert_eq!(
        crates.iter().find(|(name, _)| name == "wood").map(|known| known.1),
        Some(valued(&mesh, "TEXCOORD_0").len() as u64)
    );
    // 3. Quads: the five sides of the crate that the other cube does not touch.
    assert_eq!(mesh.polygons.triangles, [2; 5]);
}

#[test]
fn what_off_and_mtl_do_not_hold_is_told() {
    let folder = workshop();
    let off = sphere(6, 1.0, [0.0; 3]);
    let colored: Vec<String> = off
        .lines()
        .enumerate()
        .map(|(i, line)| match i {
            0 => "COFF".into(),
            1 => line.into(),
            _ => format!("{line} 255 0 0 255"),
        })
        .collect();
    folder.write("plain.off", &off);
    folder.write("colored.off", colored.join("\n"));
    folder.run("convert plain.off out.ply --strict").exits(0);
    let ran = folder.run("convert colored.off out.ply --strict").exits(5);
    ran.says("colours of vertices are not read").says("colours of faces are not read");

    folder.run("convert crate.obj crate.gltf").exits(0);
    let mut document: Value = serde_json::from_str(&folder.read("crate.gltf")).expect("JSON");
    folder.run("convert crate.gltf plain.obj --strict").exits(0);
    let material = &mut document["materials"][0];
    material["occlusionTexture"] = json!({"index": 0});
    material["alphaMode"] = json!("MASK");
    material["extensions"] = json!({"KHR_materials_clearcoat": {"clearcoatFactor": 1}});
    material["extras"] = json!({"by": "me"});
    document["extensionsUsed"] = json!(["KHR_materials_clearcoat"]);
    folder.write("rich.gltf", document.to_string());
    folder.run("convert rich.gltf same.glb --strict").exits(0);
    // A stream has no place for a library.
    folder
        .run("convert crate.obj - --output-format obj --strict")
        .exits(5)
        .says("without a material library");
    let ran = folder.run("convert rich.gltf rich.obj --strict").exits(5);
    ran.says("MTL has no word for")
        .says("occlusionTexture")
        .says("KHR_materials_clearcoat")
        .says("alphaMode")
        .says("extras");
}

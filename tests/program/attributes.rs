//! Texture coordinates, normals, materials and pictures, from files into files.

use std::collections::HashSet;
use std::fs;

use serde_json::{Value, json};
use trisect::Mesh;

use crate::common::program::{Folder, cube, sphere};

/// A picture to whoever does not decode it.
pub(super) const PICTURE: &[u8] = b"\x89PNG\r\n\x1a\nnot to be decoded";

/// A cube of quads with texture coordinates: on each face the two coordinates along it.
pub(super) fn crate_obj(low: f64, high: f64, material: &str) -> String {
    let mut text = format!("mtllib crate.mtl\no crate\nusemtl {material}\n");
    let at = |corner: usize, axis: usize| corner >> axis & 1;
    for corner in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| if at(corner, axis) == 0 { low } else { high });
        text.push_str(&format!("v {x} {y} {z}\n"));
    }
    text.push_str("vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n");
    let quads = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]];
    for (side, quad) in quads.into_iter().enumerate() {
        let along = [[0, 1], [0, 2], [1, 2]][side / 2];
        let label = |vertex: usize| 1 + at(vertex - 1, along[0]) + 2 * at(vertex - 1, along[1]);
        let corners = quad.map(|vertex| format!(" {vertex}/{}", label(vertex)));
        text.push_str(&format!("f{}\n", corners.concat()));
    }
    text
}

/// A textured crate, a tool that takes a corner of it away, and one that is elsewhere.
pub(super) fn workshop() -> Folder {
    let folder = Folder::new();
    folder.write("crate.obj", crate_obj(0.0, 1.0, "wood"));
    folder.write(
        "crate.mtl",
        "newmtl wood\nKd 0.8 0.6 0.4\nNs 10\nmap_Kd wood.png\n\nnewmtl steel\nKd 0.1 0.2 0.3\n",
    );
    folder.write("wood.png", PICTURE);
    folder.write("tool.obj", cube([0.75; 3], [1.5; 3]));
    folder.write(
        "steel.obj",
        format!(
            "mtllib crate.mtl\n{}",
            cube([0.75; 3], [1.5; 3]).replacen("f ", "g bit\nusemtl steel\nf ", 1)
        ),
    );
    folder.write("elsewhere.obj", cube([3.0; 3], [4.0; 3]));
    folder
}

pub(super) fn described(folder: &Folder, file: &str) -> Value {
    folder.run_args(&["info", file, "--json"]).exits(0).json()["files"][0].clone()
}

pub(super) fn loaded(folder: &Folder, file: &str) -> Mesh {
    Mesh::load(folder.path(file)).expect("a mesh file")
}

/// The corners of a triangle: their places, and their values of an attribute.
type Corners = ([[f64; 3]; 3], [Vec<f64>; 3]);

/// The triangles all of whose corners have a value of an attribute.
pub(super) fn valued(mesh: &Mesh, name: &str) -> Vec<Corners> {
    let Some(attribute) = mesh.attribute(name) else { return Vec::new() };
    let of_triangle = |(triangle, corners): (usize, &[u32; 3])| {
        let value = |k: usize| Some(attribute.value(attribute.of_corner[3 * triangle + k])?.to_vec());
        Some((corners.map(|v| mesh.positions[v as usize]), [value(0)?, value(1)?, value(2)?]))
    };
    mesh.triangles.iter().enumerate().filter_map(of_triangle).collect()
}

/// Asserts that the faces that are left of the crate show what they showed, and how many triangles show something.
#[track_caller]
pub(super) fn assert_crate(mesh: &Mesh, tolerance: f64) -> usize {
    let triangles = valued(mesh, "TEXCOORD_0");
    for (corners, values) in &triangles {
        let is_side = |&axis: &usize| {
            let level = corners[0][axis];
            (level == 0.0 || level == 1.0) && corners.iter().all(|corner| corner[axis] == level)
        };
        let axis = (0..3).find(is_side).expect("a triangle on a side of the crate");
        let along = [[1, 2], [0, 2], [0, 1]][axis];
        for (corner, value) in corners.iter().zip(values) {
            // Meshes count from the upper edge of pictures.
            let wanted = [corner[along[0]], 1.0 - corner[along[1]]];
            let is_near = (0..2).all(|k| (value[k] - wanted[k]).abs() <= tolerance);
            assert!(is_near, "{corner:?} shows {value:?}, not {wanted:?}");
        }
    }
    triangles.len()
}

/// The materials of a mesh by name, with how many triangles have each.
pub(super) fn materials(folder: &Folder, file: &str) -> Vec<(String, u64)> {
    let mut list: Vec<(String, u64)> = Vec::new();
    for group in described(folder, file)["groups"].as_array().expect("a list") {
        let (name, count) = (group["material"].as_str().unwrap_or("none"), group["triangles"].as_u64());
        match list.iter_mut().find(|known| known.0 == name) {
            Some(known) => known.1 += count.unwrap_or(0),
            None => list.push((name.to_owned(), count.unwrap_or(0))),
        }
    }
    list.retain(|(_, count)| *count > 0);
    list.sort();
    list
}

#[test]
fn a_textured_obj_stays_textured() {
    let folder = workshop();
    fs::create_dir(folder.path("sub")).expect("a folder");
    for (file, tolerance) in
        [("cut.obj", 1e-12), ("cut.glb", 1e-6), ("cut.gltf", 1e-6), ("sub/cut.obj", 1e-12)]
    {
        folder.run(&format!("difference crate.obj tool.obj -o {file}")).exits(0);
        let said = described(&folder, file);
        assert_eq!(said["attributes"][0]["name"], "TEXCOORD_0", "{file}: {said}");
        let wood = said["materials"].as_array().unwrap().iter().find(|material| material["name"] == "wood");
        assert_eq!(wood.unwrap()["textures"], 1, "{file}: {said}");
        assert_eq!(
            (&said["pictures"][0]["mime_type"], &said["pictures"][0]["bytes"]),
            (&json!("image/png"), &json!(PICTURE.len()))
        );
        let mesh = loaded(&folder, file);
        assert!(assert_crate(&mesh, tolerance) >= 12, "{file}");
        // The six triangles that the tool has cut show nothing: it has no texture coordinates.
        assert!(valued(&mesh, "TEXCOORD_0").len() + 6 <= mesh.triangles.len());
    }
    // The picture that stood there is named; elsewhere there is a copy.
    assert!(folder.read("cut.mtl").contains("map_Kd wood.png") && folder.read("cut.mtl").contains("Ns 10"));
    assert_eq!(fs::read(folder.path("sub/wood.png")).expect("a copy"), PICTURE);
}

#[test]
fn a_textured_glb_stays_textured_through_a_chain_of_cuts() {
    let folder = workshop();
    folder.run("convert crate.obj body.glb").exits(0);
    for step in 0..10 {
        let at = 0.05 + 0.09 * f64::from(step);
        folder.write("bit.obj", cube([at, 0.9, 0.9], [at + 0.05, 1.5, 1.5]));
        folder.run("difference body.glb bit.obj -o body.glb").exits(0);
    }
    let mesh = loaded(&folder, "body.glb");
    assert!(assert_crate(&mesh, 1e-6) > 40);
    let said = described(&folder, "body.glb");
    assert_eq!(
        (&said["pictures"][0]["bytes"], &said["closed"]),
        (&json!(PICTURE.len()), &json!(true)),
        "{said}"
    );
    // A tool that touches nothing changes no value.
    folder.run("difference body.glb elsewhere.obj -o same.glb").exits(0);
    assert_eq!(valued(&loaded(&folder, "same.glb"), "TEXCOORD_0"), valued(&mesh, "TEXCOORD_0"));
}

#[test]
fn cut_faces_have_the_material_asked_for() {
    let folder = workshop();
    let cut = |option: &str| {
        folder.run(&format!("difference crate.obj steel.obj -o cut.obj {option}")).exits(0);
        materials(&folder, "cut.obj")
    };
    let names = |list: &[(String, u64)]| list.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    let usual = cut("");
    assert_eq!(names(&usual), ["steel", "wood"]);
    assert_eq!(usual[0].1, 6);
    assert_eq!(cut("--cut-material keep"), usual);
    let total = usual[0].1 + usual[1].1;
    assert_eq!(cut("--cut-material body"), [("wood".to_string(), total)]);
    let new = cut("--cut-material plaster");
    assert_eq!((names(&new), new[0].1), (vec!["plaster".to_string(), "wood".to_string()], 6));
    assert!(folder.read("cut.mtl").contains("newmtl plaster"));
    // A name that an operand has means that material.
    folder.run("difference crate.obj tool.obj -o cut.glb --cut-material wood").exits(0);
    assert_eq!(names(&materials(&folder, "cut.glb")), ["wood"]);
    assert_eq!(described(&folder, "cut.glb")["pictures"].as_array().map(Vec::len), Some(1));
}

#[test]
fn cut_faces_get_texture_coordinates() {
    let folder = workshop();
    folder.write("lid.obj", cube([-1.0, -1.0, 0.75], [2.0; 3]));
    // A plane lies on all cut faces of a lid, and askew on those of a corner.
    for (kind, density, tool, faces) in [
        ("box:0.5", 0.5, "tool", 6),
        ("box", 1.0, "tool", 6),
        ("box:3", 3.0, "lid", 2),
        ("planar:2", 2.0, "lid", 2),
    ] {
        folder.run(&format!("difference crate.obj {tool}.obj -o cut.obj --cut-uv {kind}")).exits(0);
        let mesh = loaded(&folder, "cut.obj");
        let all = valued(&mesh, "TEXCOORD_0");
        assert_eq!(all.len(), mesh.triangles.len(), "{kind}");
        let is_cut =
            |corners: &[[f64; 3]; 3]| (0..3).any(|axis| corners.iter().all(|corner| corner[axis] == 0.75));
        let mut cut = 0;
        for (corners, values) in all.iter().filter(|(corners, _)| is_cut(corners)) {
            for (k, l) in [(0, 1), (1, 2), (2, 0)] {
                let apart: f64 = (0..3).map(|axis| (corners[k][axis] - corners[l][axis]).powi(2)).sum();
                let shown: f64 = (0..2).map(|axis| (values[k][axis] - values[l][axis]).powi(2)).sum();
                assert!(
                    (shown.sqrt() - density * apart.sqrt()).abs() < 1e-12,
                    "{kind}: {corners:?} {values:?}"
                );
            }
            cut += 1;
        }
        assert_eq!(cut, faces, "{kind}");
    }
}

/// The normal of a triangle.
fn normal([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|end| [0, 1, 2].map(|k| end[k] - a[k]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    n.map(|x| x / length)
}

fn cosine(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn normals_are_as_asked_for() {
    let folder = workshop();
    folder.write("ball.off", sphere(12, 1.0, [0.0; 3]));
    let write = |option: &str| {
        folder.run(&format!("difference ball.off tool.obj -o out.glb --normals {option}")).exits(0);
        loaded(&folder, "out.glb")
    };
    for option in ["keep", "none"] {
        assert!(write(option).attribute("NORMAL").is_none(), "{option}");
    }
    let flat = write("flat");
    let all = valued(&flat, "NORMAL");
    assert_eq!(all.len(), flat.triangles.len());
    for (corners, values) in &all {
        let face = normal(corners);
        assert!(values.iter().all(|value| cosine(value, &face) > 1.0 - 1e-5), "{corners:?}: {values:?}");
    }
    for option in ["30", "angle:30"] {
        let smooth = write(option);
        let all = valued(&smooth, "NORMAL");
        assert_eq!(all.len(), smooth.triangles.len(), "{option}");
        let on_ball = |corner: &[f64; 3]| (cosine(corner, corner) - 1.0).abs() < 1e-6;
        let mut rounded = 0;
        for (corners, values) in all.iter().filter(|(corners, _)| corners.iter().all(on_ball)) {
            for (corner, value) in corners.iter().zip(values) {
                assert!(cosine(corner, value) > 0.97, "{corner:?}: {value:?}");
                rounded += usize::from(cosine(&normal(corners), value) < 0.999);
            }
        }
        assert!(rounded > 100, "{option}: {rounded}");
    }
    // Kept ones outlive a cut, and go when nobody wants them.
    folder.run("convert ball.off smooth.ply --normals 30").exits(0);
    folder.run("difference smooth.ply tool.obj -o kept.ply").exits(0);
    let kept = loaded(&folder, "kept.ply");
    for (corners, values) in valued(&kept, "NORMAL") {
        for (corner, value) in corners.iter().zip(&values) {
            assert!(
                cosine(corner, value) > 0.9 && (cosine(value, value) - 1.0).abs() < 1e-6,
                "{corner:?}: {value:?}"
            );
        }
    }
    assert!(!valued(&kept, "NORMAL").is_empty());
    folder.run("convert kept.ply bare.ply --normals none").exits(0);
    assert!(loaded(&folder, "bare.ply").attributes.is_empty());
}

#[test]
fn buffers_and_pictures_stand_beside() {
    let folder = workshop();
    fs::create_dir(folder.path("sub")).expect("a folder");
    folder.run("difference crate.obj tool.obj -o sub/cut.gltf --separate").exits(0);
    folder.run("difference crate.obj tool.obj -o cut.glb").exits(0);
    let mut names: Vec<String> = fs::read_dir(folder.path("sub"))
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, ["cut.bin", "cut.gltf", "wood.png"]);
    let text = folder.read("sub/cut.gltf");
    assert!(text.contains("\"cut.bin\"") && text.contains("\"wood.png\"") && !text.contains("base64"));
    assert_eq!(fs::read(folder.path("sub/wood.png")).expect("the picture"), PICTURE);
    let (apart, whole) = (loaded(&folder, "sub/cut.gltf"), loaded(&folder, "cut.glb"));
    assert_eq!((apart.positions, apart.triangles), (whole.positions, whole.triangles));
    assert_eq!(apart.attributes, whole.attributes);
}

#[test]
fn seams_are_told_in_the_file() {
    let folder = workshop();
    folder.run("difference crate.obj steel.obj -o cut.obj -o cut.glb -o cut.gltf --manifold").exits(0);
    let text = folder.read("cut.gltf");
    assert!(text.contains("EXT_mesh_manifold"));
    let (obj, glb) = (loaded(&folder, "cut.obj"), loaded(&folder, "cut.glb"));
    let used = |mesh: &Mesh| mesh.indices().iter().collect::<HashSet<_>>().len();
    assert_eq!((used(&glb), glb.triangles.len()), (used(&obj), obj.triangles.len()));
    folder.run("convert cut.obj plain.glb").exits(0);
    assert!(used(&loaded(&folder, "plain.glb")) > used(&obj), "seams are apart without it");
    let said = described(&folder, "cut.glb");
    assert_eq!(said["closed"], true, "{said}");
    assert_eq!(assert_crate(&glb, 1e-6), assert_crate(&obj, 1e-12));
    assert_eq!(materials(&folder, "cut.glb"), materials(&folder, "cut.obj"));
    // Two cubes that share an edge: four triangles meet there, and each cube has the edge to itself.
    folder.write("a.obj", cube([0.0; 3], [1.0; 3]));
    folder.write("b.obj", cube([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    folder.run("union a.obj b.obj -o edge.glb --manifold --strict").exits(0);
    assert_eq!(used(&loaded(&folder, "edge.glb")), 16);
    assert_eq!(described(&folder, "edge.glb")["manifold"], true);
    folder.run("convert a.obj plain.gltf --strict").exits(0);
    assert!(!folder.read("plain.gltf").contains("EXT_mesh_manifold"));
}

//! Attributes, materials with pictures, morphs and `EXT_mesh_manifold`: read, and written and read again.

use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::super::WriteOptions;
use super::*;
use crate::mesh::{Attribute, Image, Material, MaterialLanguage, MaterialText, TextureUse, Wrap};
use crate::primitives;

/// A PNG of one pixel is not needed: pictures are never decoded here.
const PICTURE: &[u8] = b"\x89PNG\r\n\x1a\nnot a picture at all";

/// A document of one triangle with texture coordinates, normals, colours in bytes, a custom number and a morph target.
fn triangle() -> Value {
    let mut bytes: Vec<u8> = Vec::new();
    let floats = |bytes: &mut Vec<u8>, list: &[f32]| bytes.extend(list.iter().flat_map(|x| x.to_le_bytes()));
    floats(&mut bytes, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]); // 0: positions, 36 bytes
    floats(&mut bytes, &[0.0, 0.0, 1.0, 0.25, 0.1, 1.0]); // 36: texture coordinates, 24
    floats(&mut bytes, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]); // 60: normals, 36
    bytes.extend([255, 0, 51, 255, 7, 8, 9, 255, 1, 2, 3, 0]); // 96: colours, 12
    floats(&mut bytes, &[20.5, 21.5, 22.5]); // 108: custom, 12
    floats(&mut bytes, &[0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0]); // 120: morph target, 36
    let accessor = |view: u32, kind: u32, shape: &str| json!({"bufferView": view, "componentType": kind, "count": 3, "type": shape});
    let mut colors = accessor(3, 5121, "VEC4");
    colors["normalized"] = true.into();
    let view = |offset: u32, length: u32| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0, "name": "plate"}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "TEXCOORD_0": 1, "NORMAL": 2, "COLOR_0": 3, "_HEAT": 4, "ODD": 4},
            "material": 0, "targets": [{"POSITION": 5}]
        }], "weights": [0.0]}],
        "materials": [{
            "name": "paint", "extras": {"price": 7, "fooTexture": {"index": 12}}, "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {
                "index": 1, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "scale": [2, 2]}}
            }},
            "extensions": {"KHR_materials_sheen": {"sheenColorTexture": {"index": 0, "texCoord": 0}}}
        }],
        "textures": [{"source": 0}, {"source": 0, "sampler": 0, "name": "wood"}],
        "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}],
        "images": [{"uri": uri("image/png", PICTURE), "name": "grain"}],
        "animations": [{"name": "spin", "channels": [], "samplers": []}, {}],
        "cameras": [{}],
        "accessors": [
            accessor(0, 5126, "VEC3"), accessor(1, 5126, "VEC2"), accessor(2, 5126, "VEC3"), colors,
            accessor(4, 5126, "SCALAR"), accessor(5, 5126, "VEC3")
        ],
        "bufferViews": [view(0, 36), view(36, 24), view(60, 36), view(96, 12), view(108, 12), view(120, 36)],
        "buffers": [{"byteLength": bytes.len(), "uri": uri("application/octet-stream", &bytes)}]
    })
}

fn uri(kind: &str, bytes: &[u8]) -> String {
    format!("data:{kind};base64,{}", STANDARD.encode(bytes))
}

fn read_value(document: &Value) -> Result<SceneRead, Error> {
    read(document.to_string().as_bytes(), Format::Gltf, &ReadOptions::new(), false)
}

fn written(mesh: &Mesh, format: Format, options: &WriteOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    let told = write(mesh, format, &mut bytes, options, None).unwrap();
    assert!(told.warnings.is_empty(), "{:?}", told.warnings);
    bytes
}

fn attribute<'a>(mesh: &'a Mesh, name: &str) -> &'a Attribute {
    mesh.attributes.iter().find(|attribute| attribute.name == name).unwrap()
}

#[test]
fn attributes_are_read_to_the_bit() {
    let scene = read_value(&triangle()).unwrap();
    let mesh = &scene.mesh;
    let uv = attribute(mesh, "TEXCOORD_0");
    assert_eq!((uv.components, uv.of_corner.as_slice()), (2, &[0, 1, 2][..]));
    assert_eq!(uv.at(0, 2), Some(&[f64::from(0.1_f32), 1.0][..]));
    assert_eq!(attribute(mesh, "COLOR_0").at(0, 0), Some(&[1.0, 0.0, 0.2, 1.0][..]));
    assert_eq!(attribute(mesh, "_HEAT").at(0, 1), Some(&[21.5][..]));
    assert_eq!(mesh.attributes.len(), 4);
    assert!(scene.warnings.iter().any(|warning| warning.contains("whose name glTF does not have")));
    assert_eq!(scene.contents.animations, ["spin", "1"]);
    assert_eq!((scene.contents.cameras, scene.contents.morphed), (1, 1));
}

#[test]
fn materials_keep_all_that_is_said() {
    let scene = read_value(&triangle()).unwrap();
    let material = scene.mesh.groups.list[0].material.clone().unwrap();
    assert_eq!((&*material.name, material.base_color), ("paint", [0.5, 1.0, 1.0, 1.0]));
    assert_eq!(material.base_color_image(), Some(("image/png", PICTURE)));
    let texture = material.base_color_texture.as_ref().unwrap();
    assert_eq!((texture.wrap, texture.nearest), ([Wrap::Clamp, Wrap::Mirror], true));
    assert_eq!(texture.transform, [[2.0, 0.0, 0.5], [0.0, 2.0, 0.0]]);
    let text = material.text.as_ref().unwrap();
    assert_eq!((text.language, text.textures.len()), (MaterialLanguage::Gltf, 2));
    assert!(
        text.text.contains(r#""fooTexture":{"index":12}"#),
        "extras are nobody's business: {}",
        text.text
    );
    for format in [Format::Gltf, Format::Glb] {
        let bytes = written(&scene.mesh, format, &WriteOptions::new());
        let again = read(&bytes, format, &ReadOptions::new(), false).unwrap();
        assert!(again.warnings.is_empty(), "{:?}", again.warnings);
        assert_eq!(again.mesh, scene.mesh, "{format}");
        let again = written(&again.mesh, format, &WriteOptions::new());
        assert_eq!(again, bytes, "{format}");
    }
}

#[test]
fn a_mirrored_node_turns_directions() {
    let mut document = triangle();
    document["nodes"][0]["scale"] = json!([1, 1, -2]);
    let mesh = read_value(&document).unwrap().mesh;
    assert_eq!(mesh.triangles, [[0, 2, 1]]);
    assert_eq!(attribute(&mesh, "NORMAL").at(0, 0), Some(&[0.0, 0.0, -1.0][..]));
    assert_eq!(attribute(&mesh, "_HEAT").at(0, 1), Some(&[22.5][..]));
}

#[test]
fn morphs_are_read_in_the_shape_of_their_weights() {
    let mut document = triangle();
    document["meshes"][0]["weights"] = json!([0.5]);
    let mesh = read_value(&document).unwrap().mesh;
    assert_eq!(mesh.positions.map_z(), [0.5, 1.0, 2.0]);
    document["nodes"][0]["weights"] = json!([0.25]);
    assert_eq!(read_value(&document).unwrap().mesh.positions.map_z(), [0.25, 0.5, 1.0]);
    document["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 5, "_HEAT": 4}]);
    let scene = read_value(&document).unwrap();
    assert_eq!(attribute(&scene.mesh, "_HEAT").at(0, 0), Some(&[20.5 * 1.25][..]), "{:?}", scene.warnings);
    document["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 1}]);
    assert!(read_value(&document).is_err(), "a target of pairs");
    document["meshes"][0]["primitives"][0]["targets"] = json!(7);
    assert!(read_value(&document).is_err());
}

trait Heights {
    fn map_z(&self) -> Vec<f64>;
}

impl Heights for Vec<[f64; 3]> {
    fn map_z(&self) -> Vec<f64> {
        self.iter().map(|position| position[2]).collect()
    }
}

#[test]
fn what_is_wrong_with_an_attribute_costs_it_alone() {
    for (pointer, value, words) in [
        ("/accessors/1/count", json!(2), "TEXCOORD_0 left out"),
        ("/accessors/1/type", json!("VEC3"), "TEXCOORD_0 left out"),
        ("/accessors/1/componentType", json!(1), "TEXCOORD_0 left out"),
        ("/accessors/4/type", json!("MAT4"), "_HEAT left out"),
        ("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(77), "TEXCOORD_0 left out"),
    ] {
        let mut document = triangle();
        *document.pointer_mut(pointer).unwrap() = value;
        let scene = read_value(&document).unwrap();
        assert_eq!(scene.mesh.attributes.len(), 3, "{pointer}");
        assert!(
            scene.warnings.iter().any(|warning| warning.contains(words)),
            "{pointer}: {:?}",
            scene.warnings
        );
    }
}

#[test]
fn values_are_shared_by_primitives_of_as_many_vertices_only() {
    let mut document = triangle();
    let mut second = document["meshes"][0]["primitives"][0].clone();
    let six = json!({"bufferView": 6, "componentType": 5126, "count": 6, "type": "VEC3"});
    document["accessors"].as_array_mut().unwrap().push(six);
    document["bufferViews"].as_array_mut().unwrap().push(json!({"buffer": 0, "byteLength": 72}));
    second["attributes"]["POSITION"] = json!(6);
    second["targets"].take();
    document["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    let scene = read_value(&document).unwrap();
    let uv = attribute(&scene.mesh, "TEXCOORD_0");
    assert_eq!(uv.fault(scene.mesh.triangles.len()), None);
    assert!((1..3).all(|triangle| uv.at(triangle, 0).is_none()), "{:?}", uv.of_corner);
    assert!(scene.warnings.iter().any(|warning| warning.contains("3 values for 6 vertices")));
}

#[test]
fn what_is_wrong_with_a_material_costs_its_part_alone() {
    for (pointer, value, words) in [
        ("/materials/0/pbrMetallicRoughness/baseColorTexture/index", json!(9), "texture 9"),
        ("/textures/1", json!(3), "texture 1"),
        ("/textures/1/sampler", json!(3), "sampler 3"),
        ("/textures/1/source", json!(u64::MAX), "picture"),
        ("/textures/1/extensions", json!({"EXT_texture_webp": {"source": 9}}), "picture 9"),
        ("/images/0", json!([]), "picture"),
        ("/images/0/uri", json!("../../secret.png"), "picture not read"),
        ("/images/0/uri", json!("/etc/passwd"), "picture not read"),
        ("/images/0/uri", json!("https://example.org/a.png"), "picture not read"),
        ("/images/0/uri", json!("data:image/png;base64,???"), "picture not read"),
        ("/materials/0", json!({"name": "paint", "pbrMetallicRoughness": 3}), ""),
    ] {
        let mut document = triangle();
        match document.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => document["textures"][1]["extensions"] = value.clone(),
        }
        let options = ReadOptions::new().folder("nowhere");
        let scene = read(document.to_string().as_bytes(), Format::Gltf, &options, false).unwrap();
        assert!(
            scene.warnings.iter().any(|warning| warning.contains(words)),
            "{pointer}: {:?}",
            scene.warnings
        );
        assert_eq!(scene.mesh.groups.list[0].material.as_ref().unwrap().name, "paint");
        // It can be written, whatever was missing.
        let mut bytes = Vec::new();
        write(&scene.mesh, Format::Gltf, &mut bytes, &WriteOptions::new(), None).unwrap();
        read(&bytes, Format::Gltf, &ReadOptions::new(), false).unwrap();
        let document: Value = serde_json::from_slice(&bytes).unwrap();
        assert!(!document["textures"].to_string().contains("4294967295"), "{pointer}");
        if value.as_str().is_some_and(|uri| uri.contains("//")) {
            assert_eq!(document["images"][0]["uri"], value, "the file refers to it as it did");
        }
    }
}

/// A cube with a normal for each face, and two groups.
fn cube() -> Mesh {
    let mut mesh = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let mut normals = Attribute::new("NORMAL", 3);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|corner| glam::DVec3::from(mesh.positions[corner as usize]));
        normals.values.extend((b - a).cross(c - a).normalize().to_array());
        normals.of_corner.extend([t as u32; 3]);
    }
    mesh.attributes = vec![normals];
    mesh.groups.list =
        ["left", "right"].map(|name| crate::FaceGroup { name: name.into(), material: None }).into();
    mesh.groups.of_triangle = (0..12).map(|t| u32::from(t >= 6)).collect();
    mesh
}

#[test]
fn a_closed_surface_comes_back_without_a_look_at_positions() {
    let mesh = cube();
    let bytes = written(&mesh, Format::Glb, &WriteOptions::new().manifold(true));
    let scene = read(&bytes, Format::Glb, &ReadOptions::new(), false).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.mesh.positions.len(), 24);
    assert!(crate::mesh::is_two_manifold(&scene.mesh));
    assert_eq!(scene.mesh.groups.list, mesh.groups.list);
    for triangle in 0..12 {
        assert_eq!(attribute(&scene.mesh, "NORMAL").at(triangle, 0), mesh.attributes[0].at(triangle, 0));
    }
    // Without the extension, by equal positions.
    let bytes = written(&mesh, Format::Glb, &WriteOptions::new());
    let scene = read(&bytes, Format::Glb, &ReadOptions::new(), false).unwrap();
    assert!(!crate::mesh::is_two_manifold(&scene.mesh));
    assert_eq!(crate::Solid::try_from(scene.mesh).unwrap().volume(), 1.0);
}

#[test]
fn an_open_surface_is_no_manifold() {
    let mut mesh = cube();
    mesh.triangles.pop();
    mesh.groups.of_triangle.pop();
    mesh.attributes[0].of_corner.truncate(33);
    let options = WriteOptions::new().manifold(true);
    let told = write(&mesh, Format::Glb, &mut Vec::new(), &options, None).unwrap();
    assert!(told.warnings[0].contains("EXT_mesh_manifold not written"), "{:?}", told.warnings);
}

#[test]
fn a_manifold_that_lies_is_ignored() {
    let bytes = written(&cube(), Format::Gltf, &WriteOptions::new().manifold(true));
    let document: Value = serde_json::from_slice(&bytes).unwrap();
    let merges = &document["meshes"][0]["extensions"]["EXT_mesh_manifold"];
    let (places, values) =
        (merges["mergeIndices"].as_u64().unwrap(), merges["mergeValues"].as_u64().unwrap());
    for (accessor, offset) in [(values, 2), (places, 4)] {
        let mut lying = document.clone();
        lying["accessors"][accessor as usize]["byteOffset"] = json!(offset);
        let count = lying["accessors"][accessor as usize]["count"].as_u64().unwrap();
        lying["accessors"][accessor as usize]["count"] = json!(count - 1);
        let scene = read_value(&lying).unwrap();
        assert!(scene.warnings.iter().any(|warning| warning.contains("EXT_mesh_manifold ignored")));
        assert_eq!(scene.mesh.triangles.len(), 12);
    }
}

#[test]
fn colours_and_coordinates_of_bytes_stay_bytes() {
    let mut mesh = cube();
    let values: Vec<f64> = (0..12).map(|i| f64::from(i) / 255.0).collect();
    mesh.attributes.push(Attribute {
        name: "COLOR_0".into(),
        components: 3,
        values,
        of_corner: (0..36).map(|corner| corner % 4).collect(),
    });
    let bytes = written(&mesh, Format::Gltf, &WriteOptions::new());
    let document: Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(
        (&document["accessors"][2]["componentType"], &document["accessors"][2]["normalized"]),
        (&json!(5121), &json!(true))
    );
    let again = read_value(&document).unwrap().mesh;
    for corner in 0..36 {
        let value = |mesh: &Mesh| attribute(mesh, "COLOR_0").at(corner / 3, corner % 3).unwrap().to_vec();
        assert_eq!(value(&again), value(&mesh));
    }
}

#[test]
fn corners_without_values_are_those_of_primitives_without_the_attribute() {
    let mut mesh = cube();
    mesh.attributes[0].of_corner[18..].fill(Attribute::NONE);
    let bytes = written(&mesh, Format::Glb, &WriteOptions::new());
    let again = read(&bytes, Format::Glb, &ReadOptions::new(), false).unwrap().mesh;
    let normals = attribute(&again, "NORMAL");
    assert!((0..12).all(|triangle| normals.at(triangle, 0).is_some() == (triangle < 6)));
}

#[test]
fn materials_of_obj_are_translated() {
    let image = Arc::new(Image {
        file: "wood.png".into(),
        mime_type: "image/png".into(),
        bytes: PICTURE.into(),
        text: String::new(),
    });
    let mut material = Material::plain("wood", [0.5, 0.5, 0.5, 1.0]);
    material.base_color_texture = Some(TextureUse {
        image: Arc::clone(&image),
        coordinates: 0,
        wrap: [Wrap::Repeat; 2],
        nearest: false,
        transform: TextureUse::UNMOVED,
    });
    let textures = vec![Arc::new(crate::mesh::Texture { text: "wood.png".into(), images: vec![image] })];
    let text = "Kd 0.5 0.5 0.5\nPr 0.25\nKe 1 0 0\nmap_Kd wood.png\nmap_refl x\n".to_string();
    material.text = Some(Arc::new(MaterialText { language: MaterialLanguage::Mtl, text, textures }));
    let mut mesh = cube();
    mesh.groups.list[0].material = Some(material);
    let mut bytes = Vec::new();
    let told = write(&mesh, Format::Gltf, &mut bytes, &WriteOptions::new(), None).unwrap();
    assert!(told.warnings.iter().any(|warning| warning.contains("map_refl")), "{:?}", told.warnings);
    let document: Value = serde_json::from_slice(&bytes).unwrap();
    let written = &document["materials"][0];
    assert_eq!(written["pbrMetallicRoughness"]["roughnessFactor"], json!(0.25));
    assert_eq!(written["emissiveFactor"], json!([1.0, 0.0, 0.0]));
    assert_eq!(written["pbrMetallicRoughness"]["baseColorTexture"]["index"], json!(0));
}

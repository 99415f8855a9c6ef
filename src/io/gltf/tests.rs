use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::*;

/// The mesh and the warnings.
fn read(bytes: &[u8], format: Format, options: &ReadOptions) -> Result<(Mesh, Vec<String>), Error> {
    super::read(bytes, format, options, false).map(|scene| (scene.mesh, scene.warnings))
}

/// A document with one buffer that holds four corners of a square in single precision (48 bytes), six indices of one
/// byte, and two bytes of padding.
fn square() -> Value {
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0, 2, 3, 0, 0]);
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "plate"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 6}
        ],
        "buffers": [{"byteLength": 56, "uri": data_uri(&bytes)}]
    })
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

fn read_json(document: &Value) -> Result<(Mesh, Vec<String>), Error> {
    read(document.to_string().as_bytes(), Format::Gltf, &ReadOptions::new())
}

/// `square` with changes at JSON pointers; `null` removes.
fn changed(changes: &[(&str, Value)]) -> Value {
    let mut document = square();
    for (pointer, value) in changes {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        match document.pointer_mut(parent).unwrap() {
            Value::Array(list) if key == "-" => list.push(value.clone()),
            Value::Array(list) => list[key.parse::<usize>().unwrap()] = value.clone(),
            Value::Object(object) if value.is_null() => {
                object.remove(key);
            }
            Value::Object(object) => {
                object.insert(key.to_string(), value.clone());
            }
            _ => panic!("nothing at {pointer}"),
        }
    }
    document
}

const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

#[test]
fn plain_square() {
    let (mesh, warnings) = read_json(&square()).unwrap();
    assert_eq!(mesh.triangles, TRIANGLES);
    assert_eq!(mesh.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(mesh.groups.list.len(), 1);
    assert_eq!(mesh.groups.list[0].name, "plate");
    assert!(warnings.is_empty());
}

#[test]
fn modes_and_missing_indices() {
    let indices = "/meshes/0/primitives/0/indices";
    let mode = "/meshes/0/primitives/0/mode";
    let with = |more: &[(&str, Value)]| read_json(&changed(more)).unwrap().0.triangles;
    assert_eq!(with(&[(indices, Value::Null)]), [[0, 1, 2]]);
    assert_eq!(with(&[(indices, Value::Null), (mode, json!(5))]), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(with(&[(indices, Value::Null), (mode, json!(6))]), [[0, 1, 2], [0, 2, 3]]);
    // 0 1 2 0 2 3 as a strip: 0 1 2, 1 0 2, 2 0 2 (no area), 0 3 2.
    assert_eq!(with(&[(mode, json!(5))]), [[0, 1, 2], [1, 0, 2], [0, 3, 2]]);
    for points_or_lines in 0..4 {
        let (mesh, warnings) = read_json(&changed(&[(mode, json!(points_or_lines))])).unwrap();
        assert!(mesh.is_empty());
        assert_eq!(warnings, ["primitive of points or lines ignored (1 in all)"]);
    }
}

#[test]
fn transforms_are_flattened_and_mirrors_turn_triangles() {
    let mirror = changed(&[
        ("/nodes/0", json!({"children": [1], "scale": [2, 1, 1], "translation": [1e9, 0, 0]})),
        ("/nodes/-", json!({"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.125, 0, 0, 1]})),
    ]);
    let (mesh, _) = read_json(&mirror).unwrap();
    assert_eq!(mesh.positions[1], [1e9 + 0.25 - 2.0, 0.0, 0.0]);
    assert_eq!(mesh.triangles, [[0, 2, 1], [0, 3, 2]]);
    let half = std::f64::consts::FRAC_1_SQRT_2 as f32;
    let turned = changed(&[("/nodes/0/rotation", json!([0, 0, half, half]))]);
    let (mesh, _) = read_json(&turned).unwrap();
    assert!((mesh.positions[1][1] - 1.0).abs() < 1e-15 && mesh.positions[1][0].abs() < 1e-15, "{mesh:?}");
    assert_eq!(mesh.triangles, TRIANGLES);
}

#[test]
fn instances_and_shared_vertices() {
    let two_nodes = changed(&[
        ("/scenes/0/nodes", json!([0, 1])),
        ("/nodes/-", json!({"mesh": 0, "translation": [0, 0, 1]})),
    ]);
    let (mesh, _) = read_json(&two_nodes).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len(), mesh.groups.list.len()), (8, 4, 2));
    // Two primitives of one mesh share their vertices, so that the surface stays connected.
    let two_primitives = changed(&[
        ("/meshes/0/primitives/-", json!({"attributes": {"POSITION": 0}, "indices": 1, "material": 0})),
        ("/materials", json!([{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}}])),
    ]);
    let (mesh, _) = read_json(&two_primitives).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (4, 4));
    assert_eq!(mesh.groups.of_triangle, [0, 0, 1, 1]);
    assert_eq!(mesh.groups.list[1].material.as_ref().unwrap().base_color, [1.0, 0.0, 0.0, 0.5]);
    // The translations of the extension are the corners of the square.
    let instanced = changed(&[(
        "/nodes/0/extensions",
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}),
    )]);
    let (mesh, _) = read_json(&instanced).unwrap();
    assert_eq!(mesh.triangles.len(), 8);
    assert_eq!(mesh.positions[10], [2.0, 2.0, 0.0]);
}

#[test]
fn scenes_without_a_default_and_documents_without_scenes() {
    let mesh = read_json(&square()).unwrap().0;
    for document in
        [changed(&[("/scene", Value::Null)]), changed(&[("/scene", Value::Null), ("/scenes", Value::Null)])]
    {
        assert_eq!(read_json(&document).unwrap().0, mesh);
    }
    let bare = changed(&[("/scene", Value::Null), ("/scenes", Value::Null), ("/nodes", Value::Null)]);
    assert_eq!(read_json(&bare).unwrap().0.triangles, mesh.triangles);
    let empty = json!({"asset": {"version": "2.0"}});
    assert!(read_json(&empty).unwrap().0.is_empty());
}

#[test]
fn integer_positions_sparse_values_and_strides() {
    // Bytes 0..=127 normalised: one corner per four bytes.
    let bytes: Vec<u8> = vec![0, 0, 0, 9, 127, 0, 0, 9, 127, 127, 0, 9, 0, 129, 0, 9];
    let quantized = changed(&[
        ("/extensionsRequired", json!(["KHR_mesh_quantization", "KHR_materials_unlit"])),
        ("/buffers/0", json!({"byteLength": 16, "uri": data_uri(&bytes)})),
        ("/bufferViews", json!([{"buffer": 0, "byteLength": 16, "byteStride": 4}])),
        (
            "/accessors",
            json!([{"bufferView": 0, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3"}]),
        ),
        ("/meshes/0/primitives/0", json!({"attributes": {"POSITION": 0}, "mode": 6})),
    ]);
    let (mesh, _) = read_json(&quantized).unwrap();
    assert_eq!(mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, -1.0, 0.0]]);

    // Item 2 of the indices (byte 2 of view 1, value 2) names the corner that item 0 of the positions replaces.
    let sparse = json!({
        "count": 1,
        "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5121},
        "values": {"bufferView": 0, "byteOffset": 12}
    });
    let (mesh, _) = read_json(&changed(&[("/accessors/0/sparse", sparse.clone())])).unwrap();
    assert_eq!(mesh.positions[2], [1.0, 0.0, 0.0]);
    let without_view = changed(&[("/accessors/0/sparse", sparse), ("/accessors/0/bufferView", Value::Null)]);
    let (mesh, _) = read_json(&without_view).unwrap();
    assert_eq!(mesh.positions, [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0; 3]]);
}

/// A changed document is refused as damaged, with a place and a word.
fn assert_fault(changes: &[(&str, Value)], place: &str, word: &str) {
    let error = read_json(&changed(changes)).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, Error::Format(crate::io::FormatError::Malformed { .. })), "{changes:?}: {text}");
    assert!(text.contains(place) && text.contains(word), "{changes:?}: {text}");
}

#[test]
fn faults_of_buffers_and_accessors_have_their_place() {
    for (changes, place, word) in [
        (vec![("/bufferViews/0/buffer", json!(1))], "/bufferViews/0", "\"buffers\""),
        (vec![("/bufferViews/0/byteLength", json!(57))], "/bufferViews/0", "has 56"),
        (vec![("/bufferViews/1/byteOffset", json!(u64::MAX))], "/bufferViews/1", "has 56"),
        (vec![("/buffers/0/byteLength", json!(57))], "/buffers/0", "cut off"),
        (vec![("/buffers/0/uri", json!("data:;base64,AA"))], "/buffers/0", "cut off"),
        (vec![("/buffers/0/uri", json!("data:;base64,?"))], "/buffers/0", "base64"),
        (vec![("/buffers/0/uri", json!("data:text,AA"))], "/buffers/0", "base64"),
        (vec![("/buffers/0/uri", json!("square.bin"))], "/buffers/0", "use a GLB"),
        (vec![("/buffers/0/uri", json!("%FF"))], "/buffers/0", "percent"),
        (vec![("/buffers/0/uri", Value::Null)], "/buffers/0", "no data"),
        (vec![("/accessors/0/bufferView", json!(2))], "/accessors/0", "\"bufferViews\""),
        (vec![("/accessors/0/count", json!(5))], "/accessors/0", "needs 60 bytes"),
        (vec![("/accessors/0/byteOffset", json!(4))], "/accessors/0", "needs 48 bytes from byte 4"),
        (vec![("/accessors/0/type", json!("VEC2"))], "/accessors/0", "Vec2"),
        (vec![("/accessors/0/componentType", json!(5130))], "/accessors/0", "5130"),
        (vec![("/accessors/1/componentType", json!(5126))], "/accessors/1", "unsigned"),
        (vec![("/bufferViews/0/byteStride", json!(8))], "/bufferViews/0", "byteStride of 8"),
        (vec![("/bufferViews/0/byteStride", json!(252))], "/accessors/0", "needs 768 bytes"),
    ] {
        assert_fault(&changes, place, word);
    }
}

#[test]
fn faults_of_meshes_and_nodes_have_their_place() {
    let cycle = json!([{"children": [1]}, {"children": [0], "mesh": 0}]);
    for (changes, place, word) in [
        (
            vec![("/meshes/0/primitives/0/attributes/POSITION", json!(7))],
            "/meshes/0/primitives/0",
            "\"accessors\"",
        ),
        (vec![("/meshes/0/primitives/0/mode", json!(7))], "/meshes/0/primitives/0/mode", "no mode"),
        (
            vec![("/meshes/0/primitives/0/material", json!(0))],
            "/meshes/0/primitives/0/material",
            "\"materials\"",
        ),
        (vec![("/bufferViews/1/byteOffset", json!(12))], "/meshes/0/primitives/0/indices", "names vertex"),
        (vec![("/nodes/0/mesh", json!(3))], "/nodes/0/mesh", "\"meshes\""),
        (
            vec![("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))],
            "/nodes/0/matrix",
            "last row",
        ),
        (vec![("/nodes/0/rotation", json!([0, 0, 0, 0]))], "/nodes/0/rotation", "unit"),
        (vec![("/scene", json!(4))], "/scene", "\"scenes\""),
        (vec![("/scenes/0/nodes", json!([9]))], "/nodes/9", "\"nodes\""),
        (vec![("/nodes", cycle)], "/nodes/0", "tree"),
        (vec![("/scenes/0/nodes", json!([0, 0]))], "/nodes/0", "tree"),
        (
            vec![("/nodes/0/translation", json!([1e308, 0, 0])), ("/nodes/0/scale", json!([1e308, 1, 1]))],
            "vertex 1",
            "",
        ),
        (
            vec![("/extras", serde_json::from_str("1").unwrap()), ("/nodes/0/mesh", json!(-1))],
            "JSON line 1",
            "",
        ),
    ] {
        assert_fault(&changes, place, word);
    }
}

#[test]
fn deep_nesting_is_no_danger() {
    let deep = format!("{}1{}", "[".repeat(200_000), "]".repeat(200_000));
    let unused = square().to_string().replacen('{', &format!("{{\"extras\":{deep},"), 1);
    assert_eq!(read(unused.as_bytes(), Format::Gltf, &ReadOptions::new()).unwrap().0.triangles, TRIANGLES);
    let used = square().to_string().replacen("\"scene\":0", &format!("\"scene\":{deep}"), 1);
    assert!(read(used.as_bytes(), Format::Gltf, &ReadOptions::new()).is_err());
    let chain: Vec<Value> = (1..100_000).map(|child| json!({"children": [child]})).collect();
    let mut long = changed(&[("/nodes", json!(chain))]);
    long["nodes"].as_array_mut().unwrap().push(json!({"mesh": 0}));
    assert_eq!(read_json(&long).unwrap().0.triangles, TRIANGLES);
}

#[test]
fn extensions_and_versions_that_cannot_be_read_are_named_with_the_way_out() {
    for (changes, word) in [
        (vec![("/extensionsRequired", json!(["EXT_meshopt_compression"]))], "gltfpack -noq"),
        (vec![("/extensionsRequired", json!(["ACME_shapes"]))], "ACME_shapes"),
        (vec![("/asset/version", json!("1.0"))], "gltf-pipeline"),
        (vec![("/asset/minVersion", json!("2.1"))], "2.1"),
    ] {
        let error = read_json(&changed(&changes)).unwrap_err();
        assert!(matches!(error, Error::Format(crate::io::FormatError::Unsupported { .. })), "{error}");
        assert!(error.to_string().contains(word), "{error}");
    }
}

#[test]
fn compressed_primitives_are_decoded_or_refused() {
    let compressed = changed(&[
        ("/extensionsRequired", json!(["KHR_draco_mesh_compression"])),
        ("/accessors/0/bufferView", Value::Null),
        (
            "/meshes/0/primitives/0/extensions",
            json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}),
        ),
    ]);
    let error = read_json(&compressed).unwrap_err().to_string();
    // Here the bytes are those of positions, no stream of Draco.
    let word = if cfg!(feature = "draco") { "cannot be decoded" } else { "gltf-transform copy" };
    assert!(error.contains(word), "{error}");
    // Where all is there uncompressed too, that is read.
    let both = changed(&[(
        "/meshes/0/primitives/0/extensions",
        json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}),
    )]);
    assert_eq!(read_json(&both).unwrap().0.triangles, TRIANGLES);
    // More than can be counted, twice.
    let countless = changed(&[
        ("/accessors/0", json!({"componentType": 5126, "count": u64::MAX, "type": "VEC3"})),
        ("/meshes/0/primitives/0/attributes", json!({"POSITION": 0, "NORMAL": 0})),
        (
            "/meshes/0/primitives/0/extensions",
            json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0, "NORMAL": 1}}}),
        ),
    ]);
    let error = read_json(&countless).unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }) || !cfg!(feature = "draco"), "{error}");
}

#[test]
fn a_small_file_cannot_ask_for_much_memory() {
    let huge = changed(&[(
        "/accessors/0",
        json!({"componentType": 5126, "count": 4_000_000_000_u32, "type": "VEC3"}),
    )]);
    assert!(matches!(read_json(&huge), Err(Error::TooLarge { .. })));
    let instances: Vec<Value> = (0..200_000).map(|i| json!({"mesh": 0, "translation": [i, 0, 0]})).collect();
    let roots: Vec<usize> = (0..instances.len()).collect();
    let many = changed(&[("/nodes", json!(instances)), ("/scenes/0/nodes", json!(roots))]);
    let bytes = many.to_string();
    let result = read(bytes.as_bytes(), Format::Gltf, &ReadOptions::new().expansion(1));
    assert!(matches!(result, Err(Error::TooLarge { .. })));
    assert_eq!(read(bytes.as_bytes(), Format::Gltf, &ReadOptions::new()).unwrap().0.triangles.len(), 400_000);
}

#[test]
fn binary_containers() {
    let mut glb = Vec::new();
    let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    write(&mesh, Format::Glb, &mut glb, &crate::io::WriteOptions::new(), None).unwrap();
    let read_glb = |bytes: &[u8]| read(bytes, Format::Glb, &ReadOptions::new());
    assert_eq!(read_glb(&glb).unwrap().0, mesh);
    for length in 4..glb.len() {
        let error = read_glb(&glb[..length]).unwrap_err().to_string();
        assert!(error.contains("cut off"), "{length}: {error}");
    }
    let mut longer = glb.clone();
    longer.extend(b"surplus");
    assert!(read_glb(&longer).unwrap().1[0].contains("7 bytes after"));
    for (at, byte, word) in
        [(4, 1, "version 1"), (16, 0, "must be its JSON"), (12, 0xff, "a chunk of"), (0, 0, "begins with")]
    {
        let mut wrong = glb.clone();
        wrong[at] = byte;
        let error = read_glb(&wrong).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn chunks_without_padding_are_read_with_a_warning() {
    let mut document = square();
    let buffer = STANDARD.decode(&document["buffers"][0]["uri"].as_str().unwrap()[37..]).unwrap();
    document["buffers"][0] = json!({"byteLength": buffer.len()});
    let mut text = document.to_string();
    while text.len() % 4 != 2 {
        text.push(' ');
    }
    let glb = |padding: &str| {
        let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(text.as_bytes());
        bytes.extend(padding.as_bytes());
        bytes.extend((buffer.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(&buffer);
        let length = bytes.len() as u32;
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        read(&bytes, Format::Glb, &ReadOptions::new())
    };
    let (mesh, warnings) = glb("").unwrap();
    assert_eq!(mesh, read_json(&square()).unwrap().0);
    assert_eq!(warnings, ["chunk whose length is not a multiple of four (byte 20)"]);
    // Padding that the length does not count was always read.
    assert_eq!(glb("  ").unwrap(), (mesh, Vec::new()));
}

#[test]
fn of_a_material_that_is_not_as_it_should_be_name_and_colour_are_read() {
    let materials = json!([
        {"name": "odd", "alphaMode": 3, "pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 1.0]}},
        {"name": "bare", "pbrMetallicRoughness": null}
    ]);
    let colors = [[0.25, 0.5, 0.75, 1.0], [1.0; 4]];
    for (index, (name, color)) in ["odd", "bare"].into_iter().zip(colors).enumerate() {
        let document =
            changed(&[("/materials", materials.clone()), ("/meshes/0/primitives/0/material", json!(index))]);
        let (mesh, warnings) = read_json(&document).unwrap();
        let material = mesh.groups.list[0].material.as_ref().unwrap();
        assert_eq!((material.name.as_str(), material.base_color), (name, color));
        assert!(
            warnings.iter().any(|warning| warning.contains(&format!("/materials/{index}"))),
            "{warnings:?}"
        );
    }
}

#[test]
fn indices_are_not_cut_to_32_bits() {
    for pointer in ["/bufferViews/0/buffer", "/accessors/0/bufferView", "/meshes/0/primitives/0/indices"] {
        assert!(read_json(&changed(&[(pointer, json!(1_u64 << 32))])).is_err(), "{pointer}");
    }
}

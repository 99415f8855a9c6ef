//! How much memory the readers take: never more than a stated multiple of the file's size, whatever the file says.

#[path = "common/counting.rs"]
mod counting;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::Mesh;
use trisect::io::{Encoding, Format, ReadOptions, WriteOptions, load, read, write};

/// The promise of `docs/formats.md`: bytes per byte of the file, its own not counted, and a constant.
const TIMES: usize = 40;
const CONSTANT: usize = 1 << 20;

/// Peak memory while a file is read, in bytes, beyond what was in use before.
fn peak(bytes: &[u8], format: Format) -> usize {
    counting::peak_of(|| read(bytes, format, &ReadOptions::new()))
}

fn repeated(head: &str, line: impl Fn(usize) -> String, count: usize, tail: &str) -> Vec<u8> {
    let mut text = head.to_string();
    (0..count).for_each(|i| text.push_str(&line(i)));
    text.push_str(tail);
    text.into_bytes()
}

/// Files made to take as much memory per byte as possible.
fn hostile_files() -> Vec<(&'static str, Format, Vec<u8>)> {
    const N: usize = 200_000;
    let same = |line: &'static str| move |_: usize| line.to_string();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
    let list = |entry: &'static str| repeated("", same(entry), N, "").split_last().unwrap().1.to_vec();
    let gltf = |key: &str, entry: &'static str| {
        let mut text = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"{key}\":[").into_bytes();
        text.extend(list(entry));
        text.extend(b"]}");
        text
    };
    let ply_head = |vertex: usize, properties: &str, face: usize, list: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertex}\n{properties}element face {face}\n\
             property list {list} vertex_indices\nend_header\n"
        )
    };
    let bytes = "property uchar x\nproperty uchar y\nproperty uchar z\n";
    let mut polygons = ply_head(4, bytes, N / 255, "uchar uchar").into_bytes();
    polygons.extend([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0]);
    (0..N / 255).for_each(|_| {
        polygons.push(255);
        polygons.extend((0..255).map(|i| i % 4));
    });
    let mut empty_faces = ply_head(0, bytes, N, "uchar uchar").into_bytes();
    empty_faces.extend(vec![0; N]);
    let mut points = ply_head(N, bytes, 0, "uchar uchar").into_bytes();
    points.extend(vec![1; 3 * N]);
    let mut stl = vec![0; 80];
    stl.extend((N as u32).to_le_bytes());
    for i in 0..N {
        stl.extend([0; 12]);
        (0..9).for_each(|k| stl.extend(((9 * i + k) as f32).to_le_bytes()));
        stl.extend([0; 2]);
    }
    let mut lies = ply_head(4_000_000_000, bytes, 4_000_000_000, "uchar uchar").into_bytes();
    lies.extend(vec![1; 1000]);
    let mut long_list = ply_head(0, bytes, 1, "uint uchar").into_bytes();
    long_list.extend(u32::MAX.to_le_bytes());
    // One strip, then one face with many properties.
    let properties: String = (0..64).map(|i| format!("property uchar p{i}\n")).collect();
    let mut strips = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\n{bytes}element tristrips 1\n\
         property list uint uchar vertex_indices\nelement face 1\nproperty list uchar uchar vertex_indices\n{properties}end_header\n"
    )
    .into_bytes();
    strips.extend([0, 0, 0, 1, 0, 0, 0, 1, 0]);
    strips.extend((N as u32).to_le_bytes());
    strips.extend((0..N).map(|i| (i % 3) as u8));
    strips.extend([3, 0, 1, 2]);
    strips.extend([1; 64]);
    vec![
        ("OBJ vertices", Format::Obj, repeated("", same("v 0 0 0\n"), N, "")),
        ("OBJ triangles", Format::Obj, repeated(corners, same("f 1 2 3\n"), N, "")),
        ("OBJ quadrilaterals", Format::Obj, repeated(corners, same("f 1 2 4 3\n"), N, "")),
        ("OBJ polygon", Format::Obj, repeated(&format!("{corners}f"), same(" 1 2 4 3"), N, "\n")),
        ("OBJ groups", Format::Obj, repeated(corners, |i| format!("g {i:x}\nf 1 2 3\n"), N, "")),
        ("OBJ objects", Format::Obj, repeated(corners, |i| format!("o {i:x}\nf 1 2 3\n"), N, "")),
        ("OBJ materials", Format::Obj, repeated(corners, |i| format!("usemtl {i:x}\nf 1 2 3\n"), N, "")),
        ("OBJ unused groups", Format::Obj, repeated(corners, |i| format!("g {i:x}\n"), N, "f 1 2 3\n")),
        ("OBJ strange", Format::Obj, repeated("v 0 0 0\n", |i| format!("{i:x}\n"), N, "")),
        ("OBJ small faces", Format::Obj, repeated(corners, same("f\n f 1\n"), N, "")),
        ("OBJ libraries", Format::Obj, repeated(corners, |i| format!("mtllib {i:x}\n"), 2_000, "")),
        ("OFF counts", Format::Off, b"OFF\n4000000000 4000000000 0\n0 0 0\n".to_vec()),
        ("OFF vertices", Format::Off, repeated(&format!("OFF {N} 0\n"), same("0 0 0\n"), N, "")),
        (
            "OFF triangles",
            Format::Off,
            repeated(&format!("OFF 3 {N}\n0 0 0\n1 0 0\n0 1 0\n"), same("3 0 1 2\n"), N, ""),
        ),
        ("OFF empty faces", Format::Off, repeated(&format!("OFF 0 {N}\n"), same("0\n"), N, "")),
        ("OFF long face", Format::Off, b"OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n".to_vec()),
        ("STL points", Format::Stl, stl),
        ("STL count", Format::Stl, [vec![b'x'; 80], vec![0xff, 0xff, 0xff, 0xfe], vec![0; 500]].concat()),
        (
            "STL solids",
            Format::Stl,
            repeated("", |i| format!("solid {i:x}\nendsolid\n"), N, "solid\nendsolid\n"),
        ),
        (
            "STL facets",
            Format::Stl,
            repeated(
                "solid\n",
                |i| {
                    format!(
                        "facet outer loop vertex {i} 0 0 vertex {i} 1 0 vertex {i} 0 1 endloop endfacet\n"
                    )
                },
                N,
                "endsolid\n",
            ),
        ),
        ("PLY polygons", Format::Ply, polygons),
        ("PLY empty faces", Format::Ply, empty_faces),
        ("PLY points", Format::Ply, points),
        ("PLY counts", Format::Ply, lies),
        ("PLY long list", Format::Ply, long_list),
        ("PLY strips", Format::Ply, strips),
        (
            "PLY elements",
            Format::Ply,
            repeated("ply\nformat ascii 1.0\n", |i| format!("element {i:x} 0\n"), N, "end_header\n"),
        ),
        (
            "PLY properties",
            Format::Ply,
            repeated(
                "ply\nformat ascii 1.0\nelement vertex 1\n",
                same("property int a\n"),
                N,
                "end_header\n",
            ),
        ),
        ("glTF nodes", Format::Gltf, gltf("nodes", "{},")),
        ("glTF nodes with extras", Format::Gltf, gltf("nodes", "{\"extras\":0},")),
        ("glTF shown nodes", Format::Gltf, gltf("nodes", "{\"mesh\":0},")),
        (
            "glTF children",
            Format::Gltf,
            repeated(
                "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[",
                same("1,"),
                N,
                "1]},{\"mesh\":0}]}",
            ),
        ),
        (
            "glTF chain",
            Format::Gltf,
            repeated(
                "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[",
                |i| format!("{{\"children\":[{}]}},", i + 1),
                N,
                "{}]}",
            ),
        ),
        ("glTF scenes", Format::Gltf, gltf("scenes", "{},")),
        ("glTF materials", Format::Gltf, gltf("materials", "{},")),
        ("glTF meshes", Format::Gltf, gltf("meshes", "{\"primitives\":[]},")),
        ("glTF buffers", Format::Gltf, gltf("buffers", "{\"byteLength\":1},")),
        ("glTF extensions", Format::Gltf, gltf("extensionsRequired", "\"\",")),
        (
            "glTF primitives",
            Format::Gltf,
            gltf("meshes", "{\"primitives\":[{\"attributes\":{}},{\"attributes\":{}}]},"),
        ),
        (
            "glTF accessors",
            Format::Gltf,
            gltf("accessors", "{\"count\":1,\"type\":\"VEC3\",\"componentType\":5126},"),
        ),
    ]
}

/// Packages of 3MF whose parts are not packed: what is packed may take as much as the scenes of glTF.
#[cfg(feature = "threemf")]
fn hostile_packages() -> Vec<(&'static str, Format, Vec<u8>)> {
    use std::io::{Cursor, Write as _};
    use zip::write::SimpleFileOptions;
    const N: usize = 100_000;
    let stored = SimpleFileOptions::DEFAULT.compression_method(zip::CompressionMethod::Stored);
    let package = |resources: Vec<u8>| {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        zip.start_file("a.model", stored).unwrap();
        zip.write_all(
            b"<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
            xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" \
            xmlns:t=\"http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07\">",
        )
        .unwrap();
        zip.write_all(&resources).unwrap();
        zip.write_all(b"</model>").unwrap();
        zip.finish().unwrap().into_inner()
    };
    let same = |line: &'static str| move |_: usize| line.to_string();
    let object = "<object id=\"1\"><mesh>";
    let end = "</mesh></object><build><item objectid=\"1\"/></build>";
    let three = format!("{object}{}", "<vertex x=\"0\" y=\"0\" z=\"0\"/>".repeat(3));
    let triangle = "<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>";
    let mut entries = zip::ZipWriter::new(Cursor::new(Vec::new()));
    (0..10_000).for_each(|i| entries.start_file(format!("{i:x}"), stored).unwrap());
    vec![
        ("3MF entries", Format::ThreeMf, entries.finish().unwrap().into_inner()),
        ("3MF objects", Format::ThreeMf, package(repeated("", |i| format!("<object id=\"{i}\"/>"), N, ""))),
        (
            "3MF components",
            Format::ThreeMf,
            package(repeated("<object id=\"1\">", same("<component objectid=\"2\"/>"), N, "</object>")),
        ),
        (
            "3MF items",
            Format::ThreeMf,
            package(repeated("<object id=\"1\"/>", same("<item objectid=\"1\"/>"), N, "")),
        ),
        (
            "3MF shown",
            Format::ThreeMf,
            package(repeated(&format!("{three}{triangle}{end}"), same("<item objectid=\"1\"/>"), N, "")),
        ),
        (
            "3MF vertices",
            Format::ThreeMf,
            package(repeated(object, same("<vertex x=\"0\" y=\"0\" z=\"0\"/>"), N, end)),
        ),
        (
            "3MF triangles",
            Format::ThreeMf,
            package(repeated(&three, same("<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>"), N, end)),
        ),
        (
            "3MF labels",
            Format::ThreeMf,
            package(repeated(
                &three,
                same("<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"1\" p1=\"0\"/>"),
                N,
                end,
            )),
        ),
        (
            "3MF colours",
            Format::ThreeMf,
            package(repeated("<m:colorgroup id=\"1\">", same("<m:color/>"), N, "</m:colorgroup>")),
        ),
        (
            "3MF materials",
            Format::ThreeMf,
            package(repeated("<basematerials id=\"1\">", same("<base/>"), N, "</basematerials>")),
        ),
        (
            "3MF lists",
            Format::ThreeMf,
            package(repeated("", |i| format!("<basematerials id=\"{i}\"/>"), N, "")),
        ),
        (
            "3MF sets",
            Format::ThreeMf,
            package(repeated(
                &format!("{three}{triangle}"),
                |i| format!("<t:triangleset name=\"{i}\"/>"),
                N,
                end,
            )),
        ),
        (
            "3MF ranges",
            Format::ThreeMf,
            package(repeated(
                &format!("{three}{triangle}<t:triangleset>"),
                same("<t:ref index=\"0\"/>"),
                N,
                &format!("</t:triangleset>{end}"),
            )),
        ),
        ("3MF prefixes", Format::ThreeMf, package(repeated("", |i| format!("<a xmlns:p{i}=\"\"/>"), N, ""))),
        ("3MF deep", Format::ThreeMf, package(repeated("", same("<a>"), N, "</a>"))),
    ]
}

#[cfg(not(feature = "threemf"))]
fn hostile_packages() -> Vec<(&'static str, Format, Vec<u8>)> {
    Vec::new()
}

/// Sound files with a few of their bytes, or a word of them, replaced.
fn damaged_files() -> Vec<(&'static str, Format, Vec<u8>)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/formats");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut files = Vec::new();
    for name in [
        "negative_indices.obj",
        "P.off",
        "three_cubes.stl",
        "cube_binary_header_with_RN_newline.ply",
        "rgb_cube_with_primitives.gltf",
        "BoxInterleaved.glb",
        "nested-quantized.glb",
        "nested-draco.glb",
        #[cfg(feature = "threemf")]
        "vertex-colours.3mf",
    ] {
        let bytes = std::fs::read(folder.join(name)).expect("a fixture");
        let format = Format::from_content(&bytes).expect("of a known format");
        for _ in 0..500 {
            let mut damaged = bytes.clone();
            for _ in 0..random.random_range(1..4) {
                let at = random.random_range(0..damaged.len() - 4);
                match random.random_range(0..4) {
                    0 => damaged[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes()),
                    1 => damaged[at..at + 4]
                        .copy_from_slice(&(1u32 << random.random_range(8..32)).to_le_bytes()),
                    2 => damaged[at] = b'9',
                    _ => damaged.splice(at..at + 1, *b"4294967295").for_each(drop),
                }
            }
            files.push((name, format, damaged));
        }
    }
    files
}

#[test]
fn peak_memory_is_bounded_by_the_size_of_the_file() {
    let mut worst = (0.0, "");
    for (name, format, bytes) in hostile_files().into_iter().chain(hostile_packages()).chain(damaged_files())
    {
        let peak = peak(&bytes, format);
        let times = peak.saturating_sub(CONSTANT) as f64 / bytes.len() as f64;
        assert!(peak <= TIMES * bytes.len() + CONSTANT, "{name}: {peak} bytes for a file of {}", bytes.len());
        if times > worst.0 {
            worst = (times, name);
        }
        if std::env::var_os("SHOW_MEMORY").is_some() {
            show(&format!("{name:20} {times:6.1} times {} bytes", bytes.len()));
        }
    }
    // The bound is not far from what such files reach.
    assert!(worst.0 > 4.0, "{worst:?}");

    // Instances of one mesh are bounded by a limit of their own.
    let triangle: Vec<u8> =
        [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let accessor = "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}";
    let node = |_: usize| "{\"mesh\":0},".to_string();
    let json = String::from_utf8(repeated(
        &format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},\"buffers\":[{{\"byteLength\":36}}],\"bufferViews\":[{{\"buffer\":0,\
             \"byteLength\":36}}],\"accessors\":[{accessor}],\"meshes\":[{{\"primitives\":[{}]}}],\"nodes\":[",
            ["{\"attributes\":{\"POSITION\":0}}"; 2_000].join(",")
        ),
        node,
        100_000,
        "{\"mesh\":0}]}",
    ))
    .unwrap();
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    let padded = json.len().next_multiple_of(4);
    glb.extend((padded as u32 + 64).to_le_bytes());
    glb.extend((padded as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json.as_bytes());
    glb.resize(20 + padded, b' ');
    glb.extend(36_u32.to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(triangle);
    let peak = peak(&glb, Format::Glb);
    let limit = (64 * glb.len()).max(64 << 20) + TIMES * glb.len() + CONSTANT;
    assert!(peak <= limit, "{peak} bytes for a file of {}", glb.len());

    usual_files();
}

/// Ordinary files take a small multiple.
fn usual_files() {
    let side = 300;
    let vertex = |x: u32, y: u32| y * side + x;
    let positions = (0..side * side).map(|i| [f64::from(i % side), f64::from(i / side), 0.1 * f64::from(i)]);
    let cells = (0..(side - 1) * (side - 1)).map(|i| (i % (side - 1), i / (side - 1)));
    let triangles = cells.flat_map(|(x, y)| {
        [
            [vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1)],
            [vertex(x, y), vertex(x + 1, y + 1), vertex(x, y + 1)],
        ]
    });
    let mesh = Mesh::new(positions.collect(), triangles.collect());
    for (format, encoding) in [
        (Format::Obj, Encoding::Ascii),
        (Format::Gltf, Encoding::Binary),
        (Format::Glb, Encoding::Binary),
        (Format::Stl, Encoding::Binary),
        (Format::Stl, Encoding::Ascii),
        (Format::Ply, Encoding::Binary),
        (Format::Ply, Encoding::Ascii),
        (Format::Off, Encoding::Ascii),
        #[cfg(feature = "threemf")]
        (Format::ThreeMf, Encoding::Binary),
    ] {
        let mut bytes = Vec::new();
        write(&mesh, format, &mut bytes, &WriteOptions::new().encoding(encoding)).unwrap();
        let peak = peak(&bytes, format);
        if std::env::var_os("SHOW_MEMORY").is_some() {
            show(&format!("usual {format} {encoding:?}: {:.2} times", peak as f64 / bytes.len() as f64));
        }
        // A package is packed, its mesh is not.
        let times = if format.extension() == "3mf" { 12 } else { 5 };
        assert!(peak <= times * bytes.len() + CONSTANT, "{format} {encoding:?}: {peak} for {}", bytes.len());
        // Large binary files of the usual layouts are read without all their bytes at once.
        if matches!(format, Format::Stl | Format::Ply) && encoding == Encoding::Binary {
            let name = format!("trisect-memory-{}.{}", std::process::id(), format.extension());
            let path = std::env::temp_dir().join(name);
            std::fs::write(&path, &bytes).unwrap();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let options = ReadOptions::new();
            let from_bytes = pool.install(|| counting::peak_of(|| read(&bytes, format, &options)));
            let from_file = pool.install(|| counting::peak_of(|| load(&path, &options)));
            std::fs::remove_file(&path).unwrap();
            assert!(from_file <= from_bytes + CONSTANT, "{format}: {from_file}, {from_bytes} from bytes");
            assert!(bytes.len() > 4 * CONSTANT);
        }
    }
}

#[expect(clippy::print_stderr, reason = "shown on request, to state the figures in the documentation")]
fn show(line: &str) {
    eprintln!("{line}");
}

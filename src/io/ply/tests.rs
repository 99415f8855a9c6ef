use super::super::Encoding;
use super::*;
use crate::mesh::Attribute;

const ASCII: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\n\
                     property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
                     0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n3 0 1 2\n3 0 2 3\n";

fn read_all(bytes: &[u8]) -> Result<(Mesh, Vec<String>), Error> {
    read(bytes, &ReadOptions::new())
}

#[test]
fn ascii_in_every_dress() {
    let (expected, warnings) = read_all(ASCII.as_bytes()).unwrap();
    assert_eq!(expected.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(expected.positions[3], [0.0, 1.0, 0.1]);
    assert!(warnings.is_empty());
    for text in [
        ASCII.replace('\n', "\r\n"),
        ASCII.replace('\n', "\r"),
        ASCII.replace("vertex_indices", "vertex_index"),
        ASCII.replace("vertex_indices", "corners"),
        ASCII.replace("uchar int", "int8 uint16"),
        ASCII.replace("float", "double"),
        ASCII.replace("1 0 0\n", "1\n0 0\n"),
        // Two triangles as one strip, and as one quadrilateral.
        ASCII.replace("element face 2", "element tristrips 1").replace("3 0 1 2\n3 0 2 3\n", "6 0 1 2 -1 0 2 3\n")
            .replace("6 0", "7 0"),
        ASCII.replace("face 2", "face 1").replace("3 0 1 2\n3 0 2 3\n", "4 0 1 2 3\n"),
        // Further properties and elements, and faces before vertices.
        ASCII
            .replace("property float x", "property list uchar float weights\nproperty float x")
            .replace("\n0 0 0\n1 0 0\n1 1 0\n0 1 0.1", "\n0 0 0 0\n1 9.5 1 0 0\n2 1 2 1 1 0\n0 0 1 0.1"),
        ASCII
            .replace("element face 2", "element camera 1\nproperty float f\nproperty list int int g\nelement face 2")
            .replace("3 0 1 2", "0.5 2 7 8 3 0 1 2"),
        "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\nproperty uchar red\n\
         element vertex 4\nproperty float z\nproperty float x\nproperty uchar red\nproperty float y\nend_header\n\
         3 0 1 2 255 3 0 2 3 255\n0 0 1 0\n0 1 1 0\n0 1 1 1\n0.1 0 1 1\n"
            .to_string(),
    ] {
        let mut mesh = read_all(text.as_bytes()).unwrap().0;
        // Vertices and faces have a property of one name: that of vertices counts.
        assert_eq!(mesh.attributes.len(), usize::from(text.contains("red")));
        mesh.attributes.clear();
        mesh.polygons = Polygons::default();
        assert_eq!(mesh, expected, "{text}");
    }
}

/// Turns a number into little-endian bytes.
type Encode<'a, T> = &'a dyn Fn(T) -> Vec<u8>;

/// The mesh of `ASCII` in a binary file: coordinates of one type, list counts and indices of others.
fn binary(
    big: bool,
    types: [&str; 3],
    coordinate: Encode<'_, f64>,
    length: &[u8],
    index: Encode<'_, u32>,
) -> Vec<u8> {
    let order = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    let [number, count, item] = types;
    let format = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty uchar tag\nproperty {number} x\nproperty {number} y\n\
         property {number} z\nelement face 2\nproperty list {count} {item} vertex_indices\nend_header\n"
    )
    .into_bytes();
    for position in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 2.0]] {
        bytes.push(7);
        position.iter().for_each(|&x| bytes.extend(order(coordinate(x))));
    }
    for face in [[0, 1, 2], [0, 2, 3]] {
        bytes.extend(order(length.to_vec()));
        face.iter().for_each(|&i| bytes.extend(order(index(i))));
    }
    bytes
}

#[test]
fn binary_of_every_type_and_order() {
    let coordinates: [(&str, Encode<'_, f64>); 8] = [
        ("char", &|x| (x as i8).to_le_bytes().to_vec()),
        ("uint8", &|x| (x as u8).to_le_bytes().to_vec()),
        ("short", &|x| (x as i16).to_le_bytes().to_vec()),
        ("uint16", &|x| (x as u16).to_le_bytes().to_vec()),
        ("int", &|x| (x as i32).to_le_bytes().to_vec()),
        ("uint32", &|x| (x as u32).to_le_bytes().to_vec()),
        ("float", &|x| (x as f32).to_le_bytes().to_vec()),
        ("double", &|x| x.to_le_bytes().to_vec()),
    ];
    let integers: [(&str, &[u8], Encode<'_, u32>); 6] = [
        ("int8", &[3], &|i| vec![i as u8]),
        ("uchar", &[3], &|i| vec![i as u8]),
        ("int16", &[3, 0], &|i| (i as u16).to_le_bytes().to_vec()),
        ("ushort", &[3, 0], &|i| (i as u16).to_le_bytes().to_vec()),
        ("int32", &[3, 0, 0, 0], &|i| i.to_le_bytes().to_vec()),
        ("uint", &[3, 0, 0, 0], &|i| i.to_le_bytes().to_vec()),
    ];
    let expected = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 2.0]];
    for big in [false, true] {
        for (number, coordinate) in coordinates {
            for (count, length, _) in integers {
                for (item, _, index) in integers {
                    let bytes = binary(big, [number, count, item], coordinate, length, index);
                    let (mesh, warnings) = read_all(&bytes).unwrap();
                    assert_eq!(mesh.positions, expected, "{big} {number} {count} {item}");
                    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{big} {number} {count} {item}");
                    assert!(warnings.is_empty());
                    for cut in [1, 5, 20, 40] {
                        let error = read_all(&bytes[..bytes.len() - cut]).unwrap_err().to_string();
                        assert!(error.contains("cut off"), "{error}");
                    }
                }
            }
        }
    }
}

#[test]
fn faults_are_told() {
    for (from, to, word) in [
        ("ply\n", "plx\n", "line 1"),
        ("ascii", "binary", "none of ascii"),
        ("format ascii 1.0\n", "", "no line \"format\""),
        ("end_header\n", "", "line 10"),
        ("element vertex 4", "element vertex", "a name and a count"),
        ("element vertex 4", "element vertex -4", "a name and a count"),
        ("element vertex 4", "element vertex 4000000000", "too short"),
        ("element vertex 4", "element vertex 18446744073709551615", "too short"),
        ("face 2", "face 4294967295", "too short"),
        ("face 2", "face 3", "the file ends"),
        ("property float x", "property real x", "number type"),
        ("property float x\n", "", "no property \"x\""),
        ("property float x", "property list uchar float x", "no property \"x\""),
        ("list uchar int", "list float int", "an integer type"),
        ("list uchar int", "list uchar float", "no list of integers"),
        ("element vertex 4\n", "", "before the first element"),
        (
            "element face 2\nproperty list uchar int vertex_indices",
            "element vertex 2\nproperty float x\nproperty float y\nproperty float z",
            "twice",
        ),
        ("3 0 2 3", "3 0 2 4", "face 1: a face names vertex 4"),
        ("3 0 2 3", "3 0 4 4", "names vertex 4"),
        ("3 0 2 3", "3 0 2 -1", "vertex -1"),
        ("3 0 2 3", "-3 0 2 3", "a list has -3"),
        ("3 0 2 3", "3 0 2", "the file ends"),
        ("1 1 0\n", "1 x 0\n", "line 13"),
        ("1 1 0\n", "1 nan 0\n", "vertex 2"),
        ("element face 2", "element face 2\nvertex", "no keyword"),
    ] {
        let text = ASCII.replacen(from, to, 1);
        assert_ne!(text, ASCII);
        let error = read_all(text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(word), "{from:?} {to:?}: {error}");
    }
}

#[test]
fn point_clouds_and_empty_meshes() {
    let text =
        ASCII.split("element face").next().unwrap().to_string() + "end_header\n1 2 3 4 5 6 7 8 9 10 11 12\n";
    assert_eq!(read_all(text.as_bytes()).unwrap().0.positions.len(), 4);
    let empty = "ply\nformat binary_big_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
                 property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
    assert!(read_all(empty.as_bytes()).unwrap().0.is_empty());
}

#[test]
fn properties_become_attributes_and_come_back() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n\
        property uchar blue\nproperty uchar alpha\nproperty float s\nproperty float t\nproperty float quality\n\
        element face 2\nproperty list uchar int vertex_indices\nproperty float flatness\nend_header\n\
        0 0 0 0 0 1 255 0 7 255 0 0.25 1.5\n1 0 0 0 0 1 1 2 3 255 1 0.1 nan\n1 1 0 0 0 1 9 9 9 0 1 1 3\n\
        0 1 0 0 0 1 200 100 50 128 0 1 4\n3 0 1 2 0.5\n3 0 2 3 0.75\n";
    let (mesh, warnings) = read_all(text.as_bytes()).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let names: Vec<&str> = mesh.attributes.iter().map(|attribute| &*attribute.name).collect();
    assert_eq!(names, ["NORMAL", "COLOR_0", "TEXCOORD_0", "_quality", "_flatness"]);
    assert_eq!(mesh.attributes[2].at(0, 0), Some(&[0.0, 0.75][..]));
    assert_eq!(mesh.attributes[1].at(1, 2).unwrap()[3], 128.0 / 255.0);
    assert_eq!((mesh.attributes[3].at(0, 1), mesh.attributes[4].at(1, 0)), (None, Some(&[0.75][..])));
    for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BinaryBigEndian] {
        let mut bytes = Vec::new();
        let options = crate::io::WriteOptions::new().encoding(encoding);
        let written = write(&mesh, &mut bytes, &options).unwrap();
        assert!(written.warnings.is_empty(), "{:?}", written.warnings);
        let (again, warnings) = read_all(&bytes).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(again.positions, mesh.positions);
        for (attribute, before) in again.attributes.iter().zip(&mesh.attributes) {
            assert_eq!(attribute.name, before.name);
            for corner in 0..6 {
                let value = |attribute: &Attribute| attribute.at(corner / 3, corner % 3).map(<[f64]>::to_vec);
                assert_eq!(value(attribute), value(before), "{encoding:?} {}", before.name);
            }
        }
    }
}

#[test]
fn texture_coordinates_of_faces_are_a_list() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
        0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 2 1 6 0.5 0.5 1 1 0.25 0.5\n";
    let (mesh, _) = read_all(text.as_bytes()).unwrap();
    let uv = &mesh.attributes[0];
    assert_eq!((uv.at(0, 0), uv.at(2, 0)), (Some(&[0.0, 1.0][..]), Some(&[0.5, 0.5][..])));
    let mut bytes = Vec::new();
    write(&mesh, &mut bytes, &crate::io::WriteOptions::new()).unwrap();
    let again = read_all(&bytes).unwrap().0;
    for corner in 0..9 {
        assert_eq!(again.attributes[0].at(corner / 3, corner % 3), uv.at(corner / 3, corner % 3));
    }
    // A list that does not fit, or is far longer than a face has corners, is none.
    for list in ["6 0 0 1 0 1 1", "0", "255 ".to_string().as_str()] {
        let list = if list == "255 " { format!("255{}", " 0.5".repeat(255)) } else { list.to_string() };
        let odd = text.replace("8 0 0 1 0 1 1 0 1", &list);
        assert_eq!(read_all(odd.as_bytes()).unwrap().0.attributes[0].at(0, 0), None);
    }
}

#[test]
fn strips_and_faces_stand_side_by_side() {
    let body = |strips_first: bool| {
        let strips = "element tristrips 1\nproperty list uchar int vertex_indices\n";
        let faces = "element face 1\nproperty list uchar int vertex_indices\nproperty float heat\n";
        let (elements, data) = if strips_first {
            (format!("{strips}{faces}"), "3 0 1 2\n3 0 2 3 7.5\n")
        } else {
            (format!("{faces}{strips}"), "3 0 2 3 7.5\n3 0 1 2\n")
        };
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{elements}\
             end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n{data}"
        )
    };
    for (strips_first, place) in [(true, 1), (false, 0)] {
        let (mesh, warnings) = read_all(body(strips_first).as_bytes()).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((mesh.triangles.len(), mesh.triangles[place]), (2, [0, 2, 3]));
        assert_eq!(mesh.attributes[0].at(place, 0), Some(&[7.5][..]));
        assert_eq!(mesh.attributes[0].at(1 - place, 0), None);
    }
}

#[test]
fn properties_that_are_too_many_are_told() {
    let lines: String = (0..70).map(|i| format!("property float p{i}\n")).collect();
    let zeros = " 0".repeat(70);
    let text = ASCII.replace("property float z\n", &format!("property float z\n{lines}")).replace(
        "\n0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n",
        &format!("\n0 0 0{zeros}\n1 0 0{zeros}\n1 1 0{zeros}\n0 1 0.1{zeros}\n"),
    );
    let (_, warnings) = read_all(text.as_bytes()).unwrap();
    assert!(
        warnings.iter().any(|told| told.contains("after the first 64") && told.contains("6 in all")),
        "{warnings:?}"
    );
}

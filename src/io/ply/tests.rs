use super::*;

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
        assert_eq!(read_all(text.as_bytes()).unwrap().0, expected, "{text}");
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

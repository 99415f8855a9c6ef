use super::*;

/// A binary file of these facets.
fn binary(count: u32, facets: &[[f32; 9]]) -> Vec<u8> {
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, 0);
    bytes.extend(count.to_le_bytes());
    for facet in facets {
        bytes.extend([0; 12]);
        bytes.extend(facet.iter().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

const TWO: [[f32; 9]; 2] =
    [[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0], [-0.0, 0.0, -0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.1]];

fn read_all(bytes: &[u8]) -> Result<(Mesh, Vec<String>), Error> {
    read(bytes, &ReadOptions::new())
}

#[test]
fn equal_corners_become_one_vertex() {
    let (mesh, warnings) = read_all(&binary(2, &TWO)).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.positions[3], [0.0, 1.0, f64::from(0.1_f32)]);
    assert_eq!(mesh.positions[0].map(f64::to_bits), [0; 3]);
    assert!(warnings.is_empty());
}

#[test]
fn counts_that_lie() {
    let error = read_all(&binary(3, &TWO)).unwrap_err().to_string();
    assert!(error.contains("announces 3") && error.contains("cut off"), "{error}");
    let error = read_all(&binary(u32::MAX - 1, &TWO)).unwrap_err().to_string();
    assert!(error.contains("cut off"), "{error}");
    for count in [0, u32::MAX] {
        let (mesh, warnings) = read_all(&binary(count, &TWO)).unwrap();
        assert_eq!(mesh.triangles.len(), 2);
        assert!(warnings[0].contains("all 2 were read"), "{warnings:?}");
    }
    let (mesh, warnings) = read_all(&binary(1, &TWO)).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (1, 3));
    assert!(warnings[0].contains("50 bytes after"), "{warnings:?}");
    let whole = binary(2, &TWO);
    for length in 1..whole.len() {
        let error = read_all(&whole[..length]);
        assert!(
            matches!(error, Err(Error::Format(crate::io::FormatError::Malformed { .. }))),
            "{length}: {error:?}"
        );
    }
}

#[test]
fn facets_without_area_or_with_wrong_numbers() {
    let mut facets = TWO;
    facets[1][3..6].fill(0.0);
    let (mesh, warnings) = read_all(&binary(2, &facets)).unwrap();
    assert_eq!(mesh.triangles.len(), 1);
    assert_eq!(warnings, ["facet with two equal corners dropped (1 in all)"]);
    facets[1][4] = f32::NAN;
    let error = read_all(&binary(2, &facets)).unwrap_err().to_string();
    assert!(error.contains("facet 1") && error.contains("byte 134"), "{error}");
}

const ASCII: &str = "solid lid\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 0.1 0\n  \
                     endloop\n endfacet\nendsolid lid\n";

#[test]
fn ascii_in_every_dress() {
    let (expected, warnings) = read_all(ASCII.as_bytes()).unwrap();
    assert_eq!(expected.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.1, 0.0]]);
    assert_eq!(expected.groups.list[0].name, "lid");
    assert!(warnings.is_empty());
    let upper = ASCII.to_uppercase();
    assert_eq!(read_all(upper.as_bytes()).unwrap().0.positions, expected.positions);
    for text in [
        ASCII.replace('\n', "\r\n"),
        ASCII.replace('\n', "\r"),
        format!("\n  {}", ASCII.trim_end()),
        ASCII.replace("normal 0 0 1", "normal nan nan nan"),
        ASCII.replace("0 0 1\n", "0 0 1 "),
        ASCII.replace(" 0 0 1", ""),
    ] {
        assert_eq!(read_all(text.as_bytes()).unwrap().0, expected, "{text}");
    }
}

#[test]
fn several_solids_are_groups() {
    let second = ASCII.replace(" lid", " box").replace("1 0 0", "2 0 0");
    let empty = "solid nothing\nendsolid nothing\n";
    let (mesh, _) = read_all(format!("{ASCII}{empty}{second}{ASCII}").as_bytes()).unwrap();
    let names: Vec<&str> = mesh.groups.list.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["lid", "box"]);
    assert_eq!(mesh.groups.of_triangle, [0, 1, 0]);
    assert_eq!(mesh.positions.len(), 4);
    let unnamed = ASCII.replace(" lid", "");
    assert!(read_all(unnamed.as_bytes()).unwrap().0.groups.list.is_empty());
}

#[test]
fn damaged_text_is_told_with_its_line() {
    for (from, to, line, word) in [
        ("vertex 1 0 0", "vertex 1 0", 6, "coordinate"),
        ("vertex 1 0 0", "vertex 1 0 x", 5, "coordinate"),
        ("vertex 1 0 0", "vertex 1 0 inf", 5, "finite"),
        ("vertex 1 0 0\n", "", 6, "\"vertex\""),
        ("vertex 1 0 0\n", "vertex 1 0 0\nvertex 1 1 0\n", 7, "endloop"),
        ("endsolid lid\n", "", 9, "endsolid"),
        ("endloop\n endfacet\nendsolid lid\n", "", 7, "the file ends"),
    ] {
        let error = read_all(ASCII.replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
        assert!(error.contains(&format!("line {line}:")) && error.contains(word), "{from:?} {to:?}: {error}");
    }
}

#[test]
fn empty_files_of_both_kinds() {
    assert!(read_all(b"solid nothing\nendsolid nothing\n").unwrap().0.is_empty());
    assert!(read_all(&binary(0, &[])).unwrap().0.is_empty());
}

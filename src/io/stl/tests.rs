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

/// A wavy sheet of facets, two to a square: as it lies, or each far from the one before.
fn sheet(along: usize, is_scattered: bool) -> Vec<[f32; 9]> {
    let corner = |i: usize, j: usize| [i as f32, j as f32, ((i * j) % 7) as f32];
    let facet = |t: usize| {
        let (i, j) = (t / 2 / along, t / 2 % along);
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        let corners = if t.is_multiple_of(2) { [a, b, c] } else { [a, c, d] };
        <[f32; 9]>::try_from(corners.as_flattened()).unwrap()
    };
    let count = 2 * along * along;
    // (With no divisor in common, all come once.)
    let step = if is_scattered { 99_991 } else { 1 };
    (0..count).map(|t| facet(t * step % count)).collect()
}

#[test]
fn large_files_are_the_same_in_waves_of_any_size() {
    let along = 400;
    for is_scattered in [false, true] {
        let mut facets = sheet(along, is_scattered);
        // Scattered first and in order later, so that what is found out of the first waves is wrong for the others.
        if is_scattered {
            facets.extend(sheet(along, false));
        }
        let mut known = std::collections::HashMap::new();
        let mut number = |corner: &[f32]| {
            let next = known.len() as u32;
            *known.entry([0, 1, 2].map(|k| corner[k].to_bits())).or_insert(next)
        };
        let triangles: Vec<[u32; 3]> =
            facets.iter().map(|facet| [0, 3, 6].map(|k| number(&facet[k..k + 3]))).collect();
        let mut bytes = binary(facets.len() as u32, &facets);
        let last = facets.len() - 3;
        let pools = [1, 2, 5];
        for threads in pools {
            let (mesh, warnings) =
                crate::parallel::run_in_pool(threads, || read_all(&bytes)).unwrap().unwrap();
            assert!(mesh.triangles == triangles && warnings.is_empty(), "{threads}");
            assert_eq!(mesh.positions.len(), (along + 1).pow(2));
        }
        bytes[84 + 50 * last + 20..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        for threads in pools {
            let error = crate::parallel::run_in_pool(threads, || read_all(&bytes)).unwrap().unwrap_err();
            assert!(error.to_string().contains(&format!("facet {last} has a coordinate")), "{error}");
        }
    }
}

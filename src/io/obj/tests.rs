use super::*;
use crate::FaceGroup;

fn read_text(text: &str) -> (Mesh, Vec<String>) {
    read(text.as_bytes(), &ReadOptions::new()).unwrap()
}

fn error_of(text: &str) -> String {
    read(text.as_bytes(), &ReadOptions::new()).unwrap_err().to_string()
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn index_forms() {
    for face in [
        "f 1 2 3",
        "f 1/1 2/2 3/3",
        "f 1//1 2//2 3//3",
        "f 1/1/1 2/2/2 3/3/3",
        "f -4 -3 -2",
        "f\t1\t-3/5  3/-1/ ",
    ] {
        let (mesh, warnings) = read_text(&format!("{CORNERS}{face}\n"));
        assert_eq!(mesh.triangles, [[0, 1, 2]], "{face}");
        assert_eq!(mesh.positions.len(), 4);
        assert!(warnings.is_empty());
    }
}

#[test]
fn line_ends_comments_and_continuations() {
    let expected = read_text(&format!("{CORNERS}f 1 2 3 4\n")).0;
    assert_eq!(expected.triangles, [[0, 1, 2], [0, 2, 3]]);
    for text in [
        "\u{feff}# c\nv 0 0 0 # origin\nv 1 0 0\n\n  v 1 1 0\nv 0 1 0\nf 1 2 3 4".to_string(),
        format!("{CORNERS}f 1 2 3 4").replace('\n', "\r\n"),
        format!("{CORNERS}f 1 2 3 4").replace('\n', "\r"),
        format!("{CORNERS}f 1 \\\n2 \\\r\n 3\\\n 4\n"),
        format!("# a path: C:\\models\\\n{CORNERS}f 1 2 3 4 # four corners"),
        format!("f 1 2 3 4\n{CORNERS}"),
    ] {
        assert_eq!(read_text(&text).0, expected, "{text:?}");
    }
}

#[test]
fn numbers_keep_their_bits() {
    let (mesh, _) =
        read_text("v 0.1 -1e-310 123456789.123456789\nv +.5 5. -0\nv 1E3 1e+3 4.9e-324\nf 1 2 3\n");
    let bits = mesh.positions.as_flattened().iter().map(|x| x.to_bits());
    let expected = [0.1, -1e-310, 123_456_789.123_456_79, 0.5, 5.0, -0.0, 1e3, 1e3, 5e-324];
    assert!(bits.eq(expected.iter().map(|x: &f64| x.to_bits())));
}

#[test]
fn numbers_after_the_coordinates() {
    let (mesh, warnings) = read_text("v 0 0 0 1 0 0\nv 1 0 0 1\nv 1 1 0 1 nan 0\nv 0 1 0 2.5\nf 1 2 3 4\n");
    assert_eq!(mesh.positions[3], [0.0, 1.0, 0.0]);
    assert_eq!(
        warnings,
        [
            "vertex colour that is not a number ignored (line 3)",
            "vertex weight other than 1 ignored (line 4)"
        ]
    );
}

#[test]
fn other_elements_are_ignored_with_a_warning() {
    let (mesh, warnings) = read_text(&format!(
        "{CORNERS}p 1 2\nl 1 2 3\nf 1 2\nf 1 2 2\nf 1 1 2 2\nvt 0 0\nvn 0 0 1\ns off\nwhat is this\nf 1 2 3\np 4\n"
    ));
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(
        warnings,
        [
            "point element ignored (2 in all, first at line 5)",
            "line element ignored (line 6)",
            "face with fewer than three corners ignored (line 7)",
            "face with fewer than three different corners dropped (2 in all, first at line 8)",
            "statement \"what\" not understood and ignored (line 13)",
        ]
    );
}

#[test]
fn groups_objects_and_materials() {
    let (mesh, warnings) = read_text(&format!(
        "{CORNERS}f 1 2 3\no part\nusemtl red paint\nf 1 2 3\ng lid top\nf 1 2 3\nf 1 2 3 4\nusemtl\nf 2 3 4\n\
         g unused\no other\nf 2 3 4\no part\ng lid top\nusemtl (null)\nf 3 4 1\n"
    ));
    let group = |name: &str, material: Option<&str>| FaceGroup {
        name: name.to_string(),
        material: material.map(|name| crate::Material::plain(name, [1.0; 4])),
    };
    assert_eq!(
        mesh.groups.list,
        [
            group("", None),
            group("part", Some("red paint")),
            group("part/lid top", Some("red paint")),
            group("part/lid top", None),
            group("other", None),
        ]
    );
    assert_eq!(mesh.groups.of_triangle, [0, 1, 2, 2, 2, 3, 4, 3]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn names_that_are_not_utf8_are_latin1() {
    let mut text = format!("{CORNERS}g caf").into_bytes();
    text.extend(b"\xe9\nf 1 2 3\n");
    let (mesh, _) = read(&text, &ReadOptions::new()).unwrap();
    assert_eq!(mesh.groups.list[0].name, "caf\u{e9}");
}

#[test]
fn libraries_that_cannot_be_read_are_warned_of() {
    let text = format!("mtllib no such.mtl\nmtllib ../a.mtl\n{CORNERS}usemtl a\nf 1 2 3\n");
    let (_, warnings) = read_text(&text);
    assert!(warnings[0].contains("folder is not known"), "{warnings:?}");
    let options = ReadOptions::new().folder("fixtures");
    let (mesh, warnings) = read(text.as_bytes(), &options).unwrap();
    assert_eq!(mesh.groups.list[0].material.as_ref().unwrap().name, "a");
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[2].contains("own folder"), "{warnings:?}");
}

#[test]
fn faults_are_told_with_their_line() {
    for (text, line, word) in [
        ("v 0 0 0\nv 1 0\n", 2, "z coordinate"),
        ("v 0 0 0\nv 1,5 0 0\n", 2, "point"),
        ("v 0 0 x\n", 1, "\"x\""),
        ("v 0 0 0\n\nf 0 1 1\n", 3, "counts vertices from 1"),
        ("v 0 0 0\nf 1 1 2\n", 2, "vertices 0 to 0"),
        ("f 1 2 3\n", 1, "no vertices"),
        ("v 0 0 0\nf 1 -2 1\n", 2, "counts back"),
        ("v 0 0 0\nf 1 -0 1\n", 2, "counts back"),
        ("v 0 0 0\nf 1 1 99999999999999999999\n", 2, "32-bit"),
        ("v 0 0 0\nf 1 1 1.5\n", 2, "\".5\""),
        ("v 0 0 0\nf 1 1 a\n", 2, "vertex index"),
        ("v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 3\n", 3, "not a finite point"),
        ("v 0 0 0\nv 1 0 0\nv 0 1e999 0\nf 1 2 3\n", 3, "not a finite point"),
        ("v", 1, "without numbers"),
        ("Hello\nworld\n", 1, "another kind of file"),
    ] {
        let error = error_of(text);
        assert!(error.contains(&format!("line {line}:")) && error.contains(word), "{text:?}: {error}");
    }
}

#[test]
fn empty_meshes_are_meshes() {
    let (mesh, _) = read_text("# 0 vertices, 0 triangles\n");
    assert_eq!(mesh, Mesh::default());
    assert_eq!(read_text("v 1 2 3\n").0.positions, [[1.0, 2.0, 3.0]]);
}

#[test]
fn the_number_of_chunks_does_not_matter() {
    let mut text = String::from("o first\n");
    for i in 0..40 {
        text.push_str(&format!("v {i} 0 0\nv {i} 1 0 \\\n1 0 0\nv {i} 0 1\r\nv {i} 1 1 # end\n"));
        let v = 4 * i + 1;
        match i % 4 {
            0 => text.push_str(&format!("g part {i}\nf {v} {} \\\n{}\n", v + 1, v + 2)),
            1 => text.push_str(&format!("usemtl m{}\nf {v} {} {} {}\np 1\n", i % 3, v + 1, v + 3, v + 2)),
            2 => text.push_str(&format!("f 1 {v} 4\nf 1 {v} 3 {} 2\n", v + 2)),
            _ => text.push_str("o next\n"),
        }
    }
    let relative = format!("{text}f -1 -2 -3\n");
    for text in [&text, &relative] {
        let expected = read_in_chunks(text.as_bytes(), 1, &ReadOptions::new()).unwrap();
        for count in 2..60 {
            assert_eq!(
                read_in_chunks(text.as_bytes(), count, &ReadOptions::new()).unwrap(),
                expected,
                "{count}"
            );
        }
    }
    let wrong = format!("{text}f 1 2 1000\n");
    let errors: Vec<String> = (1..60)
        .map(|count| read_in_chunks(wrong.as_bytes(), count, &ReadOptions::new()).unwrap_err().to_string())
        .collect();
    assert!(errors.iter().all(|error| *error == errors[0]), "{errors:?}");
}

#[test]
fn names_that_would_fill_memory_are_refused() {
    let mut text = format!("{CORNERS}o {}\n", "x".repeat(100_000));
    for i in 0..100 {
        text.push_str(&format!("g {i}\nf 1 2 3\n"));
    }
    assert!(matches!(read(text.as_bytes(), &ReadOptions::new()), Err(Error::TooLarge { .. })));
}

#[test]
fn texture_coordinates_normals_and_colours_are_read_and_written() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0.5 0.25 0\nv 1 1 0 0 1 0\nv 0 1 0\nvt 0.1 0.2\nvt 0.3\nvt 0.5 0.6 0.7\nvn 0 0 1\n\
        vn 0 0 -1\nf 1/1/1 2/2/1 3/3/2 4//2\nf 1 3 2\nf 4/1 3/99 2/-1\nf 1//1 2//1 3//9\n";
    let (mesh, warnings) = read_text(text);
    assert_eq!(warnings, ["texture coordinates or normal that a face names are not there (2 in all)"]);
    let of = |name: &str| mesh.attributes.iter().find(|attribute| attribute.name == name).unwrap();
    let uv = of("TEXCOORD_0");
    assert_eq!(uv.at(0, 0), Some(&[0.1, 0.8][..]));
    assert_eq!(uv.at(0, 1), Some(&[0.3, 1.0][..]));
    // The second triangle of the quadrilateral.
    assert_eq!((uv.at(1, 1), uv.at(1, 2)), (Some(&[0.5, 0.4][..]), None));
    assert_eq!((uv.at(2, 0), uv.at(3, 0), uv.at(3, 1)), (None, Some(&[0.1, 0.8][..]), None));
    assert_eq!((of("NORMAL").at(1, 2), of("NORMAL").at(2, 0)), (Some(&[0.0, 0.0, -1.0][..]), None));
    assert_eq!((of("COLOR_0").at(0, 0), of("COLOR_0").at(1, 2)), (Some(&[1.0, 0.0, 0.0][..]), None));

    let mut bytes = Vec::new();
    let written = write(&mesh, &mut bytes, &crate::io::WriteOptions::new()).unwrap();
    assert!(written.warnings.is_empty(), "{:?}", written.warnings);
    let written = String::from_utf8(bytes).unwrap();
    assert!(written.contains("v 1 0 0 0.5 0.25 0\n") && written.contains("vt 0.1 0.2\n"), "{written}");
    assert!(written.contains("f 1/1/1 2/2/1 3/3/2 4//2\n") && written.contains("f 1 3 2\n"), "{written}");
    let (again, warnings) = read_text(&written);
    assert!(warnings.is_empty(), "{warnings:?}");
    for (attribute, before) in again.attributes.iter().zip(&mesh.attributes) {
        for corner in 0..15 {
            assert_eq!(attribute.at(corner / 3, corner % 3), before.at(corner / 3, corner % 3));
        }
    }
}

#[test]
fn labels_do_not_depend_on_chunks() {
    let mut text = String::new();
    for i in 0..30 {
        let v = 4 * i + 1;
        let color = if i % 5 == 2 { " 0.5 0.5 1" } else { "" };
        text.push_str(&format!(
            "v {i} 0 0\nv {i} 1 0{color}\nv {i} 0 1\nv {i} 1 1\nvt 0.{i} 0.5\nvn 0 {i} 1\n"
        ));
        text.push_str(&match i % 3 {
            0 => format!("f {v}/{} {}/1 {}/1 {}/2\n", i + 1, v + 1, v + 3, v + 2),
            1 => format!("f {v} {} {}\n", v + 1, v + 2),
            _ => format!("f {v}//{} {}/2/1 {}\n", i + 1, v + 1, v + 2),
        });
    }
    let relative = format!("{text}f -1/-1 -2/-2/-3 -3//-1\n");
    for text in [&text, &relative] {
        let expected = read_in_chunks(text.as_bytes(), 1, &ReadOptions::new()).unwrap();
        assert_eq!(expected.0.attributes.len(), 3);
        for count in 2..40 {
            let found = read_in_chunks(text.as_bytes(), count, &ReadOptions::new()).unwrap();
            assert_eq!(found, expected, "{count}");
        }
    }
}

#[test]
fn odd_labels_are_no_danger() {
    for face in [
        "f 1/ 2/ 3/",
        "f 1// 2// 3//",
        "f 1/0 2/0 3/0",
        "f 1/-9 2/-9 3/-9",
        "f 1/4294967296 2/1 3/1",
        "f 1/18446744073709551616 2 3",
    ] {
        let (mesh, _) = read_text(&format!("{CORNERS}vt 0 0\n{face}\n"));
        assert_eq!(mesh.triangles.len(), 1, "{face}");
    }
    let (mesh, warnings) = read_text(&format!("{CORNERS}vt x y\nvn 1\nvt nan inf\nf 1/1/1 2/1/1 3/2/1\n"));
    assert_eq!(mesh.attributes.len(), 2);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
}

use super::*;

fn read_text(text: &str) -> Result<(Mesh, Vec<String>), Error> {
    read(text.as_bytes(), &ReadOptions::new())
}

#[test]
fn headers_counts_comments_and_colours() {
    let expected = read_text("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n").unwrap().0;
    assert_eq!(expected.triangles, [[0, 1, 2], [0, 2, 3]]);
    for text in [
        "OFF 4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3",
        "OFF\r\n# c\r\n4 1\r\n\r\n0 0 0 # origin\r\n1 0 0\r\n# c\r\n1 1 0\r\n0 1 0\r\n4 0 1 2 3 255 0 0\r\n",
        "4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
        "OFF\n4\n1\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
        "COFF\n4 1 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 .5 .5 .5 1\n0 1 0 255 0 0 255\n4 0 1 2 3 0.5 0.5 0.5\n",
        "NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3 7\n",
        "STCNOFF\n4 1 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 x\n1 1 0\n0 1 0\n4 0 1 2 3\n",
        "OFF\n4 1 0\n0 0\n0\n1 0 0\n1 1 0\n0 1 0\n4 0 1\n2 3\nsurplus\n",
    ] {
        let mut mesh = read_text(text).unwrap().0;
        assert_eq!(mesh.polygons.triangles, [2]);
        mesh.polygons = expected.polygons.clone();
        assert_eq!(mesh, expected, "{text}");
    }
}

#[test]
fn what_is_not_read_is_told() {
    let body = "3 1 0\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2 255 0 0 # red\n";
    for (word, said) in [
        ("NOFF", "normals of vertices are not read (3 in all)"),
        ("COFF", "colours of vertices are not read (3 in all)"),
        ("STOFF", "texture coordinates of vertices are not read (3 in all)"),
        ("OFF", "further values of vertices are not read (3 in all, first at line 3)"),
    ] {
        let warnings = read_text(&format!("{word}\n{body}")).unwrap().1;
        assert_eq!(warnings, [said, "colours of faces are not read (line 6)"]);
    }
    let plain = "OFF\n3 1 0\n0 0 0 # a\n1 0 0  \n0 1 0\t\r\n3 0 1 2 # b";
    assert_eq!(read_text(plain).unwrap().1, [""; 0]);
}

#[test]
fn small_faces_are_ignored() {
    let (mesh, warnings) = read_text("OFF\n3 4 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n0\n1 0\n3 0 1 2\n").unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(warnings, ["face with fewer than three corners ignored (3 in all, first at line 6)"]);
}

#[test]
fn faults_are_told_with_their_line() {
    for (text, line, word) in [
        ("OOFF\n", 1, "OFF"),
        ("OFF\n", 2, "number of vertices"),
        ("OFF\n3\n", 3, "number of faces"),
        ("OFF\n4000000000 1 0\n0 0 0\n", 3, "cut off"),
        ("OFF\n1 4000000000 0\n0 0 0\n", 3, "cut off"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6, "vertices 0 to 2"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", 7, "corner of face 0"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 6, "corner of face 0"),
        ("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 7, "face 1 of 2"),
        ("OFF\n3 1 0\n0 0 0\n1 0 a\n0 1 0\n3 0 1 2\n", 4, "vertex 1 of 3"),
    ] {
        let error = read_text(text).unwrap_err().to_string();
        assert!(error.contains(&format!("line {line}:")) && error.contains(word), "{text:?}: {error}");
    }
    let error = read_text("OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n").unwrap_err().to_string();
    assert!(error.contains("vertex 1"), "{error}");
}

#[test]
fn other_dimensions_and_binary_are_refused() {
    for header in ["4OFF", "nOFF", "4nOFF", "OFF BINARY"] {
        let error = read_text(&format!("{header}\n3 1 0\n")).unwrap_err();
        assert!(
            matches!(error, Error::Format(crate::io::FormatError::Unsupported { .. })),
            "{header}: {error}"
        );
    }
}

//! Thin readers for test and benchmark input: OFF, binary PLY without normals, arrays of points.
#![allow(dead_code, reason = "each test uses its own part")]

use trisect::Mesh;

/// Reads OFF (triangles) or little-endian binary PLY with float positions.
pub(crate) fn read(path: &str) -> Mesh {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    if path.ends_with(".ply") { ply(&bytes) } else { off(&String::from_utf8_lossy(&bytes)) }
}

/// A triangle mesh in OFF, corners after the third of a polygon fanned.
pub(crate) fn off(text: &str) -> Mesh {
    let mut words = text.lines().flat_map(|line| {
        line.split('#').next().unwrap_or("").split_whitespace().map(str::to_owned).collect::<Vec<_>>()
    });
    let kind = words.next().expect("header");
    let colours = kind.starts_with('C');
    let mut number = || words.next().expect("number").parse::<f64>().expect("number");
    let (vertices, faces) = (number() as usize, number() as usize);
    number();
    let mut mesh = Mesh::default();
    for _ in 0..vertices {
        mesh.positions.push([number(), number(), number()]);
        for _ in 0..if colours { 4 } else { 0 } {
            number();
        }
    }
    for _ in 0..faces {
        let corners: Vec<u32> = (0..number() as usize).map(|_| number() as u32).collect();
        mesh.triangles.extend((1..corners.len() - 1).map(|k| [corners[0], corners[k], corners[k + 1]]));
    }
    mesh
}

fn ply(bytes: &[u8]) -> Mesh {
    let end = b"end_header\n";
    let body = bytes.windows(end.len()).position(|w| w == end).expect("header") + end.len();
    let header = String::from_utf8_lossy(&bytes[..body]);
    assert!(header.contains("binary_little_endian"), "only little-endian binary");
    let count = |name: &str| {
        let line = header.lines().find(|l| l.starts_with(&format!("element {name}"))).expect("element");
        line.split_whitespace().nth(2).expect("count").parse::<usize>().expect("count")
    };
    let properties = header.lines().filter(|l| l.starts_with("property float")).count();
    let (vertices, faces) = (count("vertex"), count("face"));
    let mut mesh = Mesh::default();
    let float = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")));
    for v in 0..vertices {
        let at = body + v * 4 * properties;
        mesh.positions.push([float(at), float(at + 4), float(at + 8)]);
    }
    let mut at = body + vertices * 4 * properties;
    for _ in 0..faces {
        assert_eq!(bytes[at], 3, "only triangles");
        let index =
            |k: usize| u32::from_le_bytes(bytes[at + 1 + 4 * k..at + 5 + 4 * k].try_into().expect("four"));
        mesh.triangles.push([index(0), index(1), index(2)]);
        at += 13;
    }
    mesh
}

/// An `.npy` array of doubles with three columns.
pub(crate) fn points(path: &str) -> Vec<[f64; 3]> {
    let bytes = std::fs::read(path).expect("points");
    let header = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[header..]
        .chunks_exact(24)
        .map(|row| {
            std::array::from_fn(|k| f64::from_le_bytes(row[8 * k..8 * k + 8].try_into().expect("eight")))
        })
        .collect()
}

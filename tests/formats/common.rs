//! Meshes to write, and what can be said about meshes read.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::io::{Encoding, Format, Precision, ReadOptions, WriteOptions, read, write};
use trisect::{Error, FaceGroup, Material, Mesh};

/// Every way of writing a file.
pub(crate) fn ways() -> Vec<(Format, WriteOptions)> {
    let mut ways: Vec<(Format, WriteOptions)> =
        Format::ALL.into_iter().map(|format| (format, WriteOptions::new())).collect();
    for encoding in [Encoding::Ascii, Encoding::BinaryBigEndian] {
        ways.push((Format::Ply, WriteOptions::new().encoding(encoding)));
    }
    ways.push((Format::Stl, WriteOptions::new().encoding(Encoding::Ascii)));
    ways
}

pub(crate) fn single(options: &WriteOptions) -> WriteOptions {
    options.clone().precision(Precision::Single)
}

pub(crate) fn to_bytes(mesh: &Mesh, format: Format, options: &WriteOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(mesh, format, &mut bytes, options).unwrap();
    bytes
}

pub(crate) fn from_bytes(bytes: &[u8], format: Format) -> Mesh {
    let loaded = read(bytes, format, &ReadOptions::new()).unwrap();
    assert_eq!(loaded.format, format);
    loaded.mesh
}

pub(crate) fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/formats").join(name)
}

/// A box with corners 0 and 1, whose six sides are in three groups.
pub(crate) fn grouped_box() -> Mesh {
    let corner = |i: usize| [(i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64];
    let mut mesh = Mesh::new(
        (0..8).map(corner).collect(),
        vec![
            [0, 2, 3],
            [0, 3, 1],
            [4, 5, 7],
            [4, 7, 6],
            [0, 1, 5],
            [0, 5, 4],
            [2, 6, 7],
            [2, 7, 3],
            [0, 4, 6],
            [0, 6, 2],
            [1, 3, 7],
            [1, 7, 5],
        ],
    );
    let material = |name: &str, base_color| Some(Material::plain(name, base_color));
    mesh.groups.list = vec![
        FaceGroup { name: "bottom & top".to_string(), material: material("red", [1.0, 0.0, 0.25, 1.0]) },
        FaceGroup { name: "Stra\u{df}e #2".to_string(), material: None },
        FaceGroup { name: "Stra\u{df}e #2".to_string(), material: material("glass", [0.1, 0.2, 0.3, 0.5]) },
    ];
    mesh.groups.of_triangle = vec![0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2];
    mesh
}

/// A closed mesh with coordinates of every magnitude, in no group.
pub(crate) fn scattered(seed: u64) -> Mesh {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut mesh = grouped_box();
    mesh.groups = Default::default();
    for coordinate in mesh.positions.as_flattened_mut() {
        let exponent = random.random_range(-300..300);
        *coordinate = random.random_range(-1.0..1.0) * 10.0_f64.powi(exponent);
    }
    mesh
}

pub(crate) fn volume(mesh: &Mesh) -> f64 {
    let volume = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
    };
    mesh.triangles.iter().map(volume).sum()
}

/// How many different points the triangles use, and whether every edge between them is met by its opposite.
pub(crate) fn points_and_closedness(mesh: &Mesh) -> (usize, bool) {
    let mut points = HashMap::new();
    let mut edges: HashMap<(usize, usize), i64> = HashMap::new();
    for triangle in &mesh.triangles {
        let ends = triangle.map(|corner| {
            let count = points.len();
            *points.entry(mesh.positions[corner as usize].map(|x| (x + 0.0).to_bits())).or_insert(count)
        });
        for (a, b) in [(ends[0], ends[1]), (ends[1], ends[2]), (ends[2], ends[0])] {
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    let closed = edges.iter().all(|(edge, &sum)| sum == 0 || edge.0 == edge.1);
    (points.len(), closed)
}

/// What every mesh that a reader returns must be.
pub(crate) fn assert_valid(mesh: &Mesh) {
    let vertices = mesh.positions.len();
    for &[a, b, c] in &mesh.triangles {
        assert!([a, b, c].iter().all(|&corner| (corner as usize) < vertices));
        assert!(a != b && b != c && c != a);
    }
    assert!(mesh.positions.as_flattened().iter().all(|coordinate| coordinate.is_finite()));
    let groups = &mesh.groups;
    let grouped = if groups.list.is_empty() { 0 } else { mesh.triangles.len() };
    assert_eq!(groups.of_triangle.len(), grouped);
    assert!(groups.of_triangle.iter().all(|&group| (group as usize) < groups.list.len()));
}

/// A result of reading is a valid mesh, or an error of a file.
pub(crate) fn assert_error_or_valid(result: Result<trisect::io::Loaded, Error>) -> bool {
    match result {
        Ok(loaded) => {
            assert_valid(&loaded.mesh);
            true
        }
        Err(Error::Format(trisect::io::FormatError::Malformed { place, what, .. })) => {
            assert!(!place.is_empty() && !what.is_empty());
            false
        }
        Err(
            Error::Format(
                trisect::io::FormatError::Unsupported { .. } | trisect::io::FormatError::Unknown { .. },
            )
            | Error::TooLarge { .. },
        ) => false,
        Err(other) => panic!("unexpected error: {other}"),
    }
}

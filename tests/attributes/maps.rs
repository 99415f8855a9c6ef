//! Meshes whose faces have affine maps, and the judge of results.

use trisect::mesh::Attribute;
use trisect::{Mesh, Solid};

/// The affine map of face number `face`: two numbers for a place.
pub(crate) fn map(face: f64, p: [f64; 3]) -> [f64; 2] {
    // Any numbers that differ from face to face.
    let coefficient = |k: f64| ((face + 1.0) * 12.9898 + k * 78.233).sin();
    [0.0, 4.0].map(|row| {
        (0..3).map(|k| coefficient(row + f64::from(k)) * p[k as usize]).sum::<f64>() + coefficient(row + 3.0)
    })
}

/// The mesh with the number of each face as `_FACE`, one value for its three corners, and with its map as texture coordinates.
/// `face` says which number each triangle has.
pub(crate) fn mapped(mut mesh: Mesh, face: impl Fn(usize) -> f64) -> Mesh {
    let mut number = Attribute::new("_FACE", 1);
    let mut uv = Attribute::new("TEXCOORD_0", 2);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        number.of_corner.extend([t as u32; 3]);
        number.values.push(face(t));
        for &vertex in triangle {
            uv.of_corner.push(uv.len() as u32);
            uv.values.extend(map(face(t), mesh.positions[vertex as usize]));
        }
    }
    mesh.attributes.extend([number, uv]);
    mesh
}

/// A solid each of whose triangles has a map of its own, with numbers from `first` on.
pub(crate) fn solid(mesh: Mesh, first: usize) -> Solid {
    crate::common::solid(mapped(mesh, |t| (first + t) as f64))
}

/// Checks every corner of a mesh; returns the largest error.
pub(crate) fn judge(mesh: &Mesh, context: &str) -> f64 {
    if mesh.triangles.is_empty() {
        return 0.0;
    }
    let (number, uv) = (mesh.attribute("_FACE").unwrap(), mesh.attribute("TEXCOORD_0").unwrap());
    let mut worst = 0.0f64;
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let face = number.at(t, 0).unwrap()[0];
        for k in 0..3 {
            assert_eq!(number.at(t, k), Some(&[face][..]), "{context}: triangle {t} lies in two faces");
            let expected = map(face, mesh.positions[triangle[k] as usize]);
            let found = uv.at(t, k).unwrap();
            worst = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(worst, f64::max);
        }
    }
    worst
}

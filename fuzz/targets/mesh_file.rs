//! What every reader of meshes promises: an error of the file, or a valid mesh.

use trisect::io::{Format, FormatError, ReadOptions, read};
use trisect::{Error, Mesh};

/// Reads `bytes` as `format` and checks what comes back.
pub fn check(bytes: &[u8], format: Format) {
    match read(bytes, format, &ReadOptions::new()) {
        Ok(loaded) => assert_valid(&loaded.mesh),
        Err(Error::Format(FormatError::Malformed { place, what, .. })) => {
            assert!(!place.is_empty() && !what.is_empty());
        }
        Err(Error::Format(FormatError::Unsupported { .. } | FormatError::Unknown { .. })) => {}
        Err(Error::TooLarge { .. }) => {}
        Err(other) => panic!("not an error of a file: {other}"),
    }
}

fn assert_valid(mesh: &Mesh) {
    let vertices = mesh.positions.len();
    assert!(mesh.positions.as_flattened().iter().all(|coordinate| coordinate.is_finite()));
    for &[a, b, c] in &mesh.triangles {
        assert!([a, b, c].iter().all(|&corner| (corner as usize) < vertices));
        assert!(a != b && b != c && c != a);
    }
    let groups = &mesh.groups;
    let grouped = if groups.list.is_empty() { 0 } else { mesh.triangles.len() };
    assert_eq!(groups.of_triangle.len(), grouped);
    assert!(groups.of_triangle.iter().all(|&group| (group as usize) < groups.list.len()));
}

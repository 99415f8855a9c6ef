//! Faces with more than three corners as triangles.

use glam::DVec3;

use super::error::CageError;

/// The faces as triangles, and how many had more than three corners. A quad is split along its shorter diagonal, the one from
/// its first corner if both are alike; a larger face from its first corner.
pub(crate) fn triangles(
    positions: &[[f64; 3]],
    faces: &[Vec<u32>],
) -> Result<(Vec<[u32; 3]>, usize), CageError> {
    let mut triangles = Vec::with_capacity(faces.len() * 2);
    let mut split = 0;
    for (f, face) in faces.iter().enumerate() {
        if let Some(&vertex) = face.iter().find(|&&v| v as usize >= positions.len()) {
            return Err(CageError::NoSuchVertex {
                what: format!("face {f}"),
                vertex: u64::from(vertex),
                count: positions.len(),
            });
        }
        split += usize::from(face.len() > 3);
        if let &[a, b, c, d] = &face[..] {
            let length =
                |u: u32, v: u32| DVec3::from(positions[u as usize]).distance(positions[v as usize].into());
            if length(b, d) < length(a, c) {
                triangles.extend([[b, c, d], [b, d, a]]);
            } else {
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        } else {
            triangles.extend(face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]]));
        }
    }
    Ok((triangles, split))
}

/// What is said where faces were split.
pub(crate) fn split_warning(count: usize) -> String {
    format!(
        "{count} faces with more than three corners were split into triangles: the surface is Loop's of the triangles, not the \
         Catmull-Clark surface that the program which wrote the file may have shown"
    )
}

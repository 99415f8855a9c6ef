//! Meshes of polygons.

use super::{Mesh, MeshError, Polygons};
use crate::polygon::FaceTriangulator;

impl Mesh {
    /// A mesh of polygons: their corners one polygon after the other, and how many each has. Polygons are triangulated as those of
    /// files are: every edge is used once, whatever the polygon looks like, so that what closes as polygons closes as triangles.
    /// [`Mesh::polygons`] tells which triangles are of one. Corners repeated one after the other count once, and what then has fewer
    /// than three is left out.
    ///
    /// ```
    /// use trisect::{Mesh, Solid};
    ///
    /// // A pyramid: a square and four triangles.
    /// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
    /// let faces = [0, 3, 2, 1, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4];
    /// let pyramid = Mesh::from_polygons(corners, &faces, &[4, 3, 3, 3, 3])?;
    /// assert_eq!(pyramid.triangles.len(), 6);
    /// assert!((Solid::try_from(pyramid)?.volume() - 1.0 / 3.0).abs() < 1e-15);
    /// # Ok::<(), trisect::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] and [`MeshError::NotFinite`] for corners of polygons, with the polygon's number as that of the
    /// triangle; [`MeshError::UnevenPolygons`] if the sizes do not add up to the corners.
    pub fn from_polygons(
        positions: Vec<[f64; 3]>,
        corners: &[u32],
        sizes: &[u32],
    ) -> Result<Self, MeshError> {
        let listed: u64 = sizes.iter().map(|&size| u64::from(size)).sum();
        if listed != corners.len() as u64 {
            return Err(MeshError::UnevenPolygons { listed, corners: corners.len() });
        }
        let mut triangulator = FaceTriangulator::default();
        let (mut triangles, mut of) = (Vec::with_capacity(corners.len()), Vec::new());
        let (mut rest, mut polygon) = (corners, Vec::new());
        for (number, &size) in sizes.iter().enumerate() {
            let (own, others) = rest.split_at(size as usize);
            rest = others;
            check(&positions, own, number)?;
            polygon.clear();
            polygon.extend_from_slice(own);
            polygon.dedup();
            while polygon.len() > 1 && polygon.first() == polygon.last() {
                polygon.pop();
            }
            triangulator.triangulate(&positions, &polygon, &mut triangles);
            of.resize(triangles.len(), number as u32);
        }
        let polygons = Polygons::of_faces(&of);
        Ok(Self { polygons, ..Self::new(positions, triangles) })
    }
}

/// Whether all corners are there, and finite.
fn check(positions: &[[f64; 3]], corners: &[u32], polygon: usize) -> Result<(), MeshError> {
    for &corner in corners {
        let Some(position) = positions.get(corner as usize) else {
            return Err(MeshError::IndexOutOfRange {
                triangle: polygon,
                index: corner,
                vertices: positions.len(),
            });
        };
        if !position.iter().all(|x| x.is_finite()) {
            return Err(MeshError::NotFinite { vertex: corner as usize, position: *position });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;

    /// The corners of a cube, and its six squares.
    fn cube() -> (Vec<[f64; 3]>, Vec<u32>) {
        let corners = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        (corners, squares.concat())
    }

    #[test]
    fn squares_close_as_triangles() {
        let (positions, corners) = cube();
        let mesh = Mesh::from_polygons(positions, &corners, &[4; 6]).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.polygons.triangles.len()), (12, 6));
        assert_eq!(Solid::try_from(mesh).unwrap().volume(), 1.0);
    }

    #[test]
    fn repeated_corners_count_once() {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::from_polygons(positions, &[0, 0, 1, 1, 2, 0, 0, 1, 0], &[6, 3]).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert!(mesh.polygons.is_empty());
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let (positions, corners) = cube();
        let made = |corners: &[u32], sizes: &[u32]| Mesh::from_polygons(positions.clone(), corners, sizes);
        let off = made(&[0, 1, 2, 9], &[4]).unwrap_err();
        assert_eq!(off, MeshError::IndexOutOfRange { triangle: 0, index: 9, vertices: 8 });
        let uneven = made(&corners, &[4; 5]).unwrap_err();
        assert_eq!(uneven, MeshError::UnevenPolygons { listed: 20, corners: 24 });
        assert!(made(&[], &[u32::MAX, u32::MAX]).is_err());
        let nowhere = Mesh::from_polygons(vec![[f64::NAN; 3]; 3], &[0, 1, 2], &[3]).unwrap_err();
        assert!(matches!(nowhere, MeshError::NotFinite { vertex: 0, .. }));
    }
}

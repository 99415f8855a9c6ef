//! Arrays in and out: flat lists of single-precision numbers, as graphics libraries have them.

use rustc_hash::FxHashMap;

use super::{Attribute, AttributeKind, Mesh, MeshError};

/// A mesh as graphics libraries draw it: every vertex has one position and one value of each attribute. Where a vertex of the mesh
/// has several (a seam, a crease), it is several here.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct VertexBuffers {
    /// Positions, rounded to nearest.
    pub positions: Vec<[f32; 3]>,
    /// Vertices as indices, three for a triangle, in the order of the mesh's triangles.
    pub indices: Vec<u32>,
    /// For each vertex the mesh's vertex that it is.
    pub vertices: Vec<u32>,
    /// The attributes asked for, in that order: for each vertex its numbers, one vertex after the other.
    pub attributes: Vec<Vec<f32>>,
}

impl Mesh {
    /// A mesh of flat arrays: three coordinates for each vertex, three vertices for each triangle.
    ///
    /// ```
    /// use trisect::{Mesh, Solid};
    ///
    /// let positions: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    /// let mesh = Mesh::from_f32(&positions, &[0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3])?;
    /// assert_eq!(Solid::try_from(mesh)?.volume(), 1.0 / 6.0);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::NotInThrees`] if a list does not come out even.
    pub fn from_f32(positions: &[f32], indices: &[u32]) -> Result<Self, MeshError> {
        for (what, numbers) in [("coordinates", positions.len()), ("vertex indices", indices.len())] {
            if !numbers.is_multiple_of(3) {
                return Err(MeshError::NotInThrees { what, numbers });
            }
        }
        let positions = positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]].map(f64::from)).collect();
        Ok(Self::new(positions, indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect()))
    }

    /// The positions in single precision, rounded to nearest.
    #[must_use]
    pub fn positions_f32(&self) -> Vec<[f32; 3]> {
        self.positions.iter().map(|position| position.map(|x| x as f32)).collect()
    }

    /// The triangles as a flat list of vertices, three for each.
    #[must_use]
    pub fn indices(&self) -> &[u32] {
        self.triangles.as_flattened()
    }

    /// Buffers to draw, with the attributes of those names.
    ///
    /// A corner without a value gets one that shows nothing odd: the normal of its face for `NORMAL`, white for `COLOR_n`, zeros
    /// for others, and so for an attribute that the mesh does not have; it has as many numbers then as its name says, or one. O(n).
    ///
    /// ```
    /// use trisect::primitives;
    ///
    /// let mut drum = primitives::cylinder(1.0, 2.0, 64)?;
    /// drum.set_attribute(drum.crease_normals(30.0));
    /// let buffers = drum.vertex_buffers(&["NORMAL", "TEXCOORD_0"]);
    /// assert_eq!(buffers.attributes[0].len(), 3 * buffers.positions.len());
    /// assert_eq!(buffers.attributes[1].len(), 2 * buffers.positions.len());
    /// assert_eq!(buffers.indices.len(), 3 * drum.triangles.len());
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn vertex_buffers(&self, names: &[&str]) -> VertexBuffers {
        let attributes: Vec<Attribute> = names.iter().map(|name| self.whole_attribute(name)).collect();
        // 1. A number for each combination of a vertex and its values, in the order of their first corners.
        let mut of_corner: Vec<u32> = self.triangles.as_flattened().to_vec();
        for attribute in &attributes {
            let mut numbers: FxHashMap<(u32, u32), u32> = FxHashMap::default();
            for (corner, index) in of_corner.iter_mut().zip(&attribute.of_corner) {
                let next = numbers.len() as u32;
                *corner = *numbers.entry((*corner, *index)).or_insert(next);
            }
        }
        if attributes.is_empty() {
            let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
            for corner in &mut of_corner {
                let next = numbers.len() as u32;
                *corner = *numbers.entry(*corner).or_insert(next);
            }
        }
        // 2. The first corner of each.
        let count = of_corner.iter().max().map_or(0, |&last| last as usize + 1);
        let mut first = vec![usize::MAX; count];
        for (corner, &number) in of_corner.iter().enumerate() {
            let first = &mut first[number as usize];
            *first = corner.min(*first);
        }
        // 3. What it has.
        let vertices: Vec<u32> = first.iter().map(|&corner| self.triangles.as_flattened()[corner]).collect();
        let position = |&vertex: &u32| {
            self.positions.get(vertex as usize).map_or([f32::NAN; 3], |position| position.map(|x| x as f32))
        };
        let numbers = |attribute: &Attribute| {
            let value = |&corner: &usize| attribute.value(attribute.of_corner[corner]).unwrap_or_default();
            first.iter().flat_map(value).map(|&x| x as f32).collect()
        };
        VertexBuffers {
            positions: vertices.iter().map(position).collect(),
            attributes: attributes.iter().map(numbers).collect(),
            indices: of_corner,
            vertices,
        }
    }

    /// The attribute of a name with a value at every corner.
    fn whole_attribute(&self, name: &str) -> Attribute {
        let kind = AttributeKind::of(name).unwrap_or(AttributeKind::Plain);
        let components = match kind {
            AttributeKind::Normal | AttributeKind::Colour => 3,
            AttributeKind::Tangent | AttributeKind::Joints | AttributeKind::Weights => 4,
            AttributeKind::Plain if name.starts_with("TEXCOORD_") => 2,
            AttributeKind::Plain => 1,
        };
        let known = self.attribute(name).filter(|known| known.fault(self.triangles.len()).is_none());
        let mut whole = known.cloned().unwrap_or_else(|| Attribute {
            of_corner: vec![Attribute::NONE; 3 * self.triangles.len()],
            ..Attribute::new(name, components)
        });
        if !whole.of_corner.contains(&Attribute::NONE) {
            return whole;
        }
        let start = whole.len() as u32;
        if kind == AttributeKind::Normal {
            let flat = self.flat_normals();
            whole.values.extend(flat.values);
            for (corner, index) in whole.of_corner.iter_mut().enumerate() {
                if *index == Attribute::NONE {
                    *index = start + (corner / 3) as u32;
                }
            }
            return whole;
        }
        let fill = if kind == AttributeKind::Colour { 1.0 } else { 0.0 };
        whole.values.extend(std::iter::repeat_n(fill, whole.components));
        whole
            .of_corner
            .iter_mut()
            .filter(|index| **index == Attribute::NONE)
            .for_each(|index| *index = start);
        whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn arrays_must_come_out_even() {
        let error = Mesh::from_f32(&[0.0; 7], &[]).unwrap_err().to_string();
        assert!(error.contains("7 coordinates"), "{error}");
        assert!(Mesh::from_f32(&[], &[0, 1]).is_err());
        let cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        let flat = cube.positions_f32().into_flattened();
        assert_eq!(Mesh::from_f32(&flat, cube.indices()).unwrap(), cube);
    }

    #[test]
    fn a_vertex_is_split_where_its_values_differ() {
        let mut cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        assert_eq!(cube.vertex_buffers(&[]).positions.len(), 8);
        // Flat normals, made where there are none: two triangles to a side, which are apart here.
        assert_eq!(cube.vertex_buffers(&["NORMAL"]).positions.len(), 36);
        cube.set_attribute(cube.crease_normals(30.0));
        let buffers = cube.vertex_buffers(&["NORMAL", "COLOR_0", "_OWN"]);
        assert_eq!((buffers.positions.len(), buffers.indices.len()), (24, 36));
        assert_eq!(buffers.attributes[1], [1.0; 72]);
        assert_eq!(buffers.attributes[2], [0.0; 24]);
        for (corner, &index) in buffers.indices.iter().enumerate() {
            let vertex = cube.triangles.as_flattened()[corner];
            assert_eq!(buffers.vertices[index as usize], vertex);
            assert_eq!(buffers.positions[index as usize].map(f64::from), cube.positions[vertex as usize]);
            let normal = cube.attributes[0].at(corner / 3, corner % 3).unwrap();
            let found = &buffers.attributes[0][3 * index as usize..][..3];
            assert!((0..3).all(|k| f64::from(found[k]) == normal[k]));
        }
    }
}

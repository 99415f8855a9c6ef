//! Whether the attributes of two triangles of one plane are one affine map: then nothing is lost if an edge between them goes.

use super::{Attribute, Mesh};
use crate::exact::barycentric::weights_in_plane_of;

/// How much values may be off the map that another triangle continues, relative to the largest of them: what single precision
/// loses, four times over, since values in files are rounded to it, and so are the places they are for.
const TOLERANCE: f64 = 4.0 * f32::EPSILON as f64 / 2.0;

/// Whether all attributes of triangle `other` are at its corners what those of `seed` are there, continued over its plane.
/// The two are taken to lie in one plane.
pub(crate) fn continues(mesh: &Mesh, seed: u32, other: u32) -> bool {
    let corners =
        |triangle: u32| mesh.triangles[triangle as usize].map(|vertex| mesh.positions[vertex as usize]);
    let (from, to) = (corners(seed), corners(other));
    let vertices = [seed, other].map(|triangle| mesh.triangles[triangle as usize]);
    // 1. The weights of the seed's corners at each corner of the other.
    let mut weights = [[0.0; 3]; 3];
    for (k, place) in to.iter().enumerate() {
        weights[k] = match vertices[0].iter().position(|&vertex| vertex == vertices[1][k]) {
            Some(shared) => [0, 1, 2].map(|i| f64::from(u8::from(i == shared))),
            None => match weights_in_plane_of(&from, place) {
                Some(weights) => weights,
                None => return false,
            },
        };
    }
    // 2. The values there.
    mesh.attributes.iter().all(|attribute| agree(attribute, seed, other, &weights))
}

fn agree(attribute: &Attribute, seed: u32, other: u32, weights: &[[f64; 3]; 3]) -> bool {
    let indices = |triangle: u32| {
        [0, 1, 2]
            .map(|k| attribute.of_corner.get(3 * triangle as usize + k).copied().unwrap_or(Attribute::NONE))
    };
    let (of_seed, of_other) = (indices(seed), indices(other));
    if of_seed == [Attribute::NONE; 3] && of_other == [Attribute::NONE; 3] {
        return true;
    }
    if of_seed.iter().all(|&index| index == of_seed[0]) && of_seed == of_other {
        return true;
    }
    let rows = |indices: [u32; 3]| {
        let [a, b, c] = indices.map(|index| attribute.value(index));
        Some([a?, b?, c?])
    };
    let (Some(known), Some(found)) = (rows(of_seed), rows(of_other)) else { return false };
    (0..attribute.components).all(|c| {
        let values = known.map(|row| row[c]);
        let most = known.iter().chain(&found).fold(0.0f64, |most, row| most.max(row[c].abs()));
        (0..3).all(|k| {
            let [_, w1, w2] = weights[k];
            let continued = values[0] + w1 * (values[1] - values[0]) + w2 * (values[2] - values[0]);
            (continued - found[k][c]).abs() <= TOLERANCE * most
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of the square, with values at four corners, the last two for the second alone.
    fn square(values: [f64; 6]) -> Mesh {
        let positions = vec![[0.0, 0.0, 5.0], [2.0, 0.0, 5.0], [2.0, 2.0, 5.0], [0.0, 2.0, 5.0]];
        let mut mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]);
        let of_corner = (0..6).collect();
        mesh.attributes =
            vec![Attribute { name: "_X".into(), components: 1, values: values.to_vec(), of_corner }];
        mesh
    }

    #[test]
    fn one_map_goes_on_over_the_diagonal_and_two_do_not() {
        // 3 x + 5 y, at the corners of both.
        let affine = [0.0, 6.0, 16.0, 0.0, 16.0, 10.0];
        assert!(continues(&square(affine), 0, 1) && continues(&square(affine), 1, 0));
        for corner in 3..6 {
            let mut other = affine;
            other[corner] += 1e-4;
            assert!(!continues(&square(other), 0, 1), "{corner}");
            other[corner] = affine[corner] + 1e-7;
            assert!(continues(&square(other), 0, 1), "{corner}");
        }
    }

    #[test]
    fn a_face_without_values_is_not_continued_by_one_with_them() {
        let mut mesh = square([1.0; 6]);
        assert!(continues(&mesh, 0, 1));
        mesh.attributes[0].of_corner[4] = Attribute::NONE;
        assert!(!continues(&mesh, 0, 1) && !continues(&mesh, 1, 0));
        mesh.attributes[0].of_corner = vec![Attribute::NONE; 6];
        assert!(continues(&mesh, 0, 1));
    }
}

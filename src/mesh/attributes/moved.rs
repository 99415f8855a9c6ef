//! Directions of a mesh that is moved: normals by the inverse transpose, tangents by the linear part.

use super::{Attribute, AttributeKind};

/// The linear part of a transform, row by row.
pub(crate) type Linear = [[f64; 3]; 3];

/// How much a length may be off before it is set right: what a few roundings do, so that quarter turns keep every bit.
const LENGTH_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Moves the normals and tangents of `attributes`. `mirrored` says whether the determinant of `linear` is negative; triangles
/// are then turned round by whoever asks, with [`turn_corners`].
pub(crate) fn moved(attributes: &mut [Attribute], linear: &Linear, mirrored: bool) {
    let cofactors = cofactors(&scaled(linear));
    // The cofactors are the inverse transpose times the determinant, whose sign has to go.
    let sign = if mirrored { -1.0 } else { 1.0 };
    for attribute in attributes {
        let (matrix, components) = match attribute.kind() {
            AttributeKind::Normal => (cofactors.map(|row| row.map(|x| sign * x)), 3),
            AttributeKind::Tangent => (scaled(linear), 4),
            _ => continue,
        };
        for value in attribute.values.chunks_exact_mut(components) {
            let &mut [x, y, z, ..] = value else { continue };
            let direction = matrix.map(|row| row[0] * x + row[1] * y + row[2] * z);
            let direction = with_length(direction, length([x, y, z]));
            value[..3].copy_from_slice(&direction);
            if mirrored && let Some(hand) = value.get_mut(3) {
                *hand = -*hand;
            }
        }
    }
}

/// The last two corners of every triangle change places, and nothing else does: a mirror has moved the directions already.
pub(in crate::mesh) fn turn_corners(attributes: &mut [Attribute]) {
    for attribute in attributes {
        attribute.of_corner.chunks_exact_mut(3).for_each(|corners| corners.swap(1, 2));
    }
}

/// The matrix divided by its largest number, so that products neither under- nor overflow.
fn scaled(linear: &Linear) -> Linear {
    let largest = linear.as_flattened().iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    if largest > 0.0 { linear.map(|row| row.map(|x| x / largest)) } else { *linear }
}

fn cofactors(m: &Linear) -> Linear {
    let minor = |i: usize, j: usize| {
        let [a, b, c, d] = [(i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3];
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(i, j)))
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    // Squares might underflow.
    x.hypot(y).hypot(z)
}

/// The direction with that length; as it is if it has none or the length is right.
fn with_length(direction: [f64; 3], wanted: f64) -> [f64; 3] {
    let factor = wanted / length(direction);
    if factor.is_finite() && (factor - 1.0).abs() > LENGTH_ROUNDING {
        direction.map(|x| x * factor)
    } else {
        direction
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, primitives};

    fn with_directions() -> Mesh {
        let mut mesh = primitives::cuboid([-1.0; 3], [1.0; 3]).unwrap();
        let mut normals = Attribute::new("NORMAL", 3);
        let mut tangents = Attribute::new("TANGENT", 4);
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            normals.values.extend(normal(a, b, c));
            let along: [f64; 3] = std::array::from_fn(|axis| b[axis] - a[axis]);
            let size = length(along);
            tangents.values.extend(along.map(|x| x / size));
            tangents.values.push(1.0);
            normals.of_corner.extend([t as u32; 3]);
            tangents.of_corner.extend([t as u32; 3]);
        }
        mesh.attributes = vec![normals, tangents];
        mesh
    }

    fn normal(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
        let [u, v]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|axis| p[axis] - a[axis]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let size = length(cross);
        cross.map(|x| x / size)
    }

    /// Normals are those of the faces, tangents run along an edge, and hands are where they belong.
    fn check(mesh: &Mesh, hand: f64) {
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            let given = mesh.attributes[0].at(t, 0).unwrap();
            let of_face = normal(a, b, c);
            assert!((0..3).all(|k| (given[k] - of_face[k]).abs() < 1e-14), "{given:?} {of_face:?}");
            let tangent = mesh.attributes[1].at(t, 0).unwrap();
            let dot: f64 = (0..3).map(|k| tangent[k] * of_face[k]).sum();
            assert!(dot.abs() < 1e-14 && (length([tangent[0], tangent[1], tangent[2]]) - 1.0).abs() < 1e-14);
            assert_eq!(tangent[3], hand);
        }
    }

    #[test]
    fn directions_move_with_the_mesh() {
        let mesh = with_directions();
        check(&mesh, 1.0);
        check(&mesh.clone().rotated([1.0, 2.0, -0.5], 33.0).unwrap(), 1.0);
        check(&mesh.clone().scaled([3.0, 0.25, 1.0]).unwrap(), 1.0);
        check(&mesh.clone().scaled([3.0, -0.25, 1e-100]).unwrap(), -1.0);
        let sheared = [1.0, 0.5, 0.0, 7.0, 0.0, 1.0, 0.25, 0.0, 0.0, 0.0, 1.0, 0.0];
        check(&mesh.clone().transformed(&sheared).unwrap(), 1.0);
        check(&mesh.clone().transformed(&sheared.map(|x| -x)).unwrap(), -1.0);
        check(&mesh.clone().reversed(), -1.0);
        assert_eq!(mesh.clone().reversed().reversed(), mesh);
    }

    #[test]
    fn quarter_turns_keep_the_bits() {
        let mut mesh = with_directions();
        mesh.attributes[0].values[..3].copy_from_slice(&[0.1f32, 0.3, 0.949].map(f64::from));
        let turned = mesh.clone().rotated([0.0, 0.0, 1.0], 90.0).unwrap();
        let [x, y, z] = [0.1f32, 0.3, 0.949].map(f64::from);
        assert_eq!(turned.attributes[0].values[..3], [-y, x, z]);
    }
}

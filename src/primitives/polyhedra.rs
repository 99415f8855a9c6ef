//! Bodies with few flat faces.

use super::{check_length, invalid};
use crate::{Error, Mesh};

/// The axis-aligned box between its lowest and its highest corner.
///
/// 8 vertices; bit k of a vertex's index tells whether it is high along axis k. 12 triangles: two a side, the
/// sides in the order -x, +x, -y, +y, -z, +z.
///
/// # Errors
/// [`Error::InvalidArgument`] unless all numbers are finite and `low` is below `high` along every axis.
///
/// ```
/// use trisect::{Solid, primitives};
///
/// let block = Solid::try_from(primitives::cuboid([0.0; 3], [1.0, 2.0, 3.0])?)?;
/// assert_eq!(block.volume(), 6.0);
/// # Ok::<(), trisect::Error>(())
/// ```
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Result<Mesh, Error> {
    let finite = low.iter().chain(&high).all(|x| x.is_finite());
    if !finite || (0..3).any(|axis| low[axis] >= high[axis]) {
        return invalid(format!("box: {low:?} must be below {high:?} along every axis, and all finite"));
    }
    let corner =
        |index: usize| [0, 1, 2].map(|axis| if index >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Ok(Mesh::new((0..8).map(corner).collect(), triangles.collect()))
}

/// The tetrahedron with these corners, in any order: its 4 vertices in the order given, 4 triangles.
///
/// # Errors
/// [`Error::InvalidArgument`] unless all numbers are finite and the corners do not lie exactly in one plane.
pub fn tetrahedron(corners: [[f64; 3]; 4]) -> Result<Mesh, Error> {
    if corners.iter().flatten().any(|x| !x.is_finite()) {
        return invalid(format!("tetrahedron: the corners must be finite, not {corners:?}"));
    }
    let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mesh = Mesh::new(corners.to_vec(), triangles);
    match mesh.volume_sign() {
        std::cmp::Ordering::Greater => Ok(mesh),
        std::cmp::Ordering::Less => Ok(mesh.reversed()),
        std::cmp::Ordering::Equal => {
            invalid(format!("tetrahedron: the corners {corners:?} lie in one plane"))
        }
    }
}

/// The regular octahedron about the origin with its corners on the axes at distance `radius`.
///
/// 6 vertices, in the order +x, -x, +y, -y, +z, -z; 8 triangles.
///
/// # Errors
/// [`Error::InvalidArgument`] unless the radius is positive and finite.
pub fn octahedron(radius: f64) -> Result<Mesh, Error> {
    check_length("octahedron", "radius", radius)?;
    let corner = |index: usize| {
        let mut corner = [0.0; 3];
        corner[index / 2] = if index.is_multiple_of(2) { radius } else { -radius };
        corner
    };
    let triangles =
        vec![[4, 0, 2], [4, 2, 1], [4, 1, 3], [4, 3, 0], [5, 2, 0], [5, 1, 2], [5, 3, 1], [5, 0, 3]];
    Ok(Mesh::new((0..6).map(corner).collect(), triangles))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;

    #[test]
    fn volumes_are_exact() {
        let volume = |mesh: Result<Mesh, Error>| Solid::try_from(mesh.unwrap()).unwrap().volume();
        assert_eq!(volume(cuboid([-1.0, 0.5, 3.0], [2.0, 1.0, 10.0])), 10.5);
        assert_eq!(volume(octahedron(3.0)), 36.0);
        let corners = [[0.0; 3], [6.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 4.0]];
        assert_eq!(volume(tetrahedron(corners)), 20.0);
        let [a, b, c, d] = corners;
        assert_eq!(volume(tetrahedron([b, a, c, d])), 20.0);
    }

    #[test]
    fn senseless_arguments_are_refused() {
        for (low, high) in
            [([0.0; 3], [1.0, 0.0, 1.0]), ([0.0; 3], [1.0, f64::NAN, 1.0]), ([2.0; 3], [1.0; 3])]
        {
            assert!(cuboid(low, high).is_err());
        }
        assert!(octahedron(-1.0).is_err() && octahedron(0.0).is_err() && octahedron(f64::INFINITY).is_err());
        let plane = [[0.1, 0.2, 0.3], [1.1, 0.2, 0.3], [0.1, 1.2, 0.3], [7.7, -3.1, 0.3]];
        assert!(tetrahedron(plane).is_err());
        assert!(tetrahedron([[1e-160, 0.0, 0.0], [0.0, 1e-160, 0.0], [0.0, 0.0, 1e-160], [0.0; 3]]).is_ok());
    }
}

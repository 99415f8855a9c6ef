//! Moving, turning and scaling meshes.

use super::orient::reversed;
use super::{Mesh, MeshError, TransformFault, attributes};
use crate::exact::{Sign, orient3d};

impl Mesh {
    /// The mesh moved by `offset`.
    #[must_use]
    pub fn translated(mut self, offset: [f64; 3]) -> Self {
        for position in &mut self.positions {
            for axis in 0..3 {
                position[axis] += offset[axis];
            }
        }
        self
    }

    /// The mesh scaled about the origin by a factor per axis. An odd number of negative factors mirrors it, and
    /// the triangles are then reversed to face outwards still.
    ///
    /// # Errors
    /// [`MeshError::Transform`] if a factor is zero or not finite.
    pub fn scaled(mut self, factors: [f64; 3]) -> Result<Self, MeshError> {
        if factors.iter().any(|&factor| factor == 0.0 || !factor.is_finite()) {
            return Err(MeshError::Transform(TransformFault::Scale(factors)));
        }
        for position in &mut self.positions {
            for axis in 0..3 {
                position[axis] *= factors[axis];
            }
        }
        let mirrored = factors.iter().filter(|&&factor| factor < 0.0).count() % 2 == 1;
        let [x, y, z] = factors;
        Ok(self.with_directions_moved(&[[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], mirrored))
    }

    /// The mesh turned by `degrees` about the line through the origin along `axis`, counter-clockwise seen from
    /// where the axis points. Quarter turns about the coordinate axes are exact.
    ///
    /// # Errors
    /// [`MeshError::Transform`] if `axis` has no direction or something is not finite.
    pub fn rotated(self, axis: [f64; 3], degrees: f64) -> Result<Self, MeshError> {
        let largest = axis.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        if !(axis.iter().all(|x| x.is_finite()) && largest > 0.0 && degrees.is_finite()) {
            return Err(MeshError::Transform(TransformFault::Rotation { axis, degrees }));
        }
        let axis = axis.map(|x| x / largest);
        let length = (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
        let [x, y, z] = axis.map(|component| component / length);
        let (sin, cos) = sin_cos_degrees(degrees);
        // Rodrigues' formula. The diagonal as x^2 + (1 - x^2) cos is one along the axis, whatever the angle.
        let off = |a: f64, b: f64, c: f64| a * b * (1.0 - cos) + c * sin;
        let diagonal = |a: f64| a * a + (1.0 - a * a) * cos;
        let matrix = [
            [diagonal(x), off(x, y, -z), off(x, z, y), 0.0],
            [off(x, y, z), diagonal(y), off(y, z, -x), 0.0],
            [off(x, z, -y), off(y, z, x), diagonal(z), 0.0],
        ];
        Ok(self.mapped(&matrix, false))
    }

    /// The mesh with every position p replaced by M p + t, where `matrix` holds the rows of [M | t], row by row:
    /// 12 numbers, or 16 with the last row 0, 0, 0, 1. If the determinant of M is negative the triangles are
    /// reversed to face outwards still.
    ///
    /// # Errors
    /// [`MeshError::Transform`] if the numbers are not 12 or 16 or not finite, the last row is another, or M is
    /// exactly singular.
    ///
    /// ```
    /// use trisect::primitives;
    ///
    /// let cube = primitives::cuboid([0.0; 3], [1.0; 3])?;
    /// let moved = cube.transformed(&[2.0, 0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])?;
    /// assert_eq!(moved.bounds().unwrap().low, [5.0, 0.0, 0.0]);
    /// assert_eq!(moved.volume(), 2.0);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    pub fn transformed(self, matrix: &[f64]) -> Result<Self, MeshError> {
        let refuse = |fault| Err(MeshError::Transform(fault));
        let (rows, last) = match matrix.len() {
            12 | 16 => matrix.split_at(12),
            count => return refuse(TransformFault::MatrixLength(count)),
        };
        if let Some(&number) = matrix.iter().find(|x| !x.is_finite()) {
            return refuse(TransformFault::MatrixNumber(number));
        }
        if let &[a, b, c, d] = last
            && last != [0.0, 0.0, 0.0, 1.0]
        {
            return refuse(TransformFault::MatrixLastRow([a, b, c, d]));
        }
        let row = |index: usize| [0, 1, 2, 3].map(|column| rows[4 * index + column]);
        let rows = [row(0), row(1), row(2)];
        let determinant = determinant_sign(&rows);
        if determinant == Sign::Zero {
            return refuse(TransformFault::MatrixSingular);
        }
        Ok(self.mapped(&rows, determinant == Sign::Negative))
    }

    fn mapped(mut self, matrix: &[[f64; 4]; 3], mirrored: bool) -> Self {
        for position in &mut self.positions {
            let [x, y, z] = *position;
            *position = matrix.map(|[a, b, c, d]| a * x + b * y + c * z + d);
        }
        self.with_directions_moved(&matrix.map(|[a, b, c, _]| [a, b, c]), mirrored)
    }

    /// What positions have gone through, for normals and tangents, and triangles turned round in a mirror.
    fn with_directions_moved(mut self, linear: &[[f64; 3]; 3], mirrored: bool) -> Self {
        attributes::moved(&mut self.attributes, linear, mirrored);
        if mirrored {
            self.triangles.iter_mut().for_each(|triangle| *triangle = reversed(*triangle));
            attributes::turn_corners(&mut self.attributes);
        }
        self
    }
}

/// The sign of the determinant of the first three columns.
fn determinant_sign(rows: &[[f64; 4]; 3]) -> Sign {
    let [a, b, c] = rows.map(|[x, y, z, _]| [x, y, z]);
    // The predicate is the determinant of three points relative to the fourth.
    orient3d(&a, &b, &c, &[0.0; 3])
}

/// Sine and cosine of an angle in degrees; exact for multiples of 30 where the result is 0, 1/2 or 1.
pub(crate) fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    // Both the remainder and the differences are exact.
    let degrees = degrees % 360.0;
    let quarters = (degrees / 90.0).round();
    let rest = degrees - 90.0 * quarters;
    let (sin, cos) = if rest.abs() == 30.0 {
        (0.5_f64.copysign(rest), 0.75_f64.sqrt())
    } else {
        rest.to_radians().sin_cos()
    };
    match (quarters as i32).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Solid, primitives};

    fn block() -> Mesh {
        primitives::cuboid([0.0; 3], [1.0, 2.0, 3.0]).unwrap()
    }

    #[test]
    fn quarter_turns_are_exact() {
        assert_eq!(sin_cos_degrees(90.0), (1.0, -0.0));
        assert_eq!(sin_cos_degrees(-450.0), (-1.0, 0.0));
        assert_eq!(sin_cos_degrees(150.0).0, 0.5);
        let turned = block().rotated([0.0, 0.0, 7.0], 90.0).unwrap();
        let bounds = turned.bounds().unwrap();
        assert_eq!((bounds.low, bounds.high), ([-2.0, 0.0, 0.0], [0.0, 1.0, 3.0]));
        assert_eq!(turned.clone().rotated([0.0, 0.0, 1.0], 270.0).unwrap().bounds(), block().bounds());
        assert_eq!(block().rotated([1.0, 1.0, 1.0], 0.0).unwrap(), block());
    }

    #[test]
    fn turning_keeps_the_volume() {
        let turned = block().rotated([1.0, -2.0, 0.5], 33.0).unwrap();
        assert!((Solid::try_from(turned).unwrap().volume() - 6.0).abs() < 1e-14);
        // A third of a turn about the diagonal goes from axis to axis.
        let third = block().rotated([1.0; 3], 120.0).unwrap();
        let size = third.bounds().unwrap().size();
        assert!((0..3).all(|axis| (size[axis] - [3.0, 1.0, 2.0][axis]).abs() < 1e-14), "{size:?}");
    }

    #[test]
    fn mirroring_reverses() {
        let mirrored = block().scaled([-1.0, 2.0, 1.0]).unwrap();
        assert_eq!(Solid::try_from(mirrored).unwrap().volume(), 12.0);
        let swap_x_and_y = [0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert_eq!(Solid::try_from(block().transformed(&swap_x_and_y).unwrap()).unwrap().volume(), 6.0);
    }

    #[test]
    fn senseless_arguments_are_refused() {
        let refused = |result: Result<Mesh, MeshError>| matches!(result, Err(MeshError::Transform(_)));
        assert!(refused(block().scaled([1.0, 0.0, 1.0])));
        assert!(refused(block().scaled([1.0, f64::NAN, 1.0])));
        assert!(refused(block().rotated([0.0; 3], 10.0)));
        assert!(refused(block().rotated([0.0, 0.0, 1.0], f64::INFINITY)));
        assert!(refused(block().transformed(&[1.0; 9])));
        // Rank two, in numbers that cancel only when nothing is rounded.
        let third = 1.0 / 3.0;
        let singular = [third, 0.1, 0.7, 0.0, 2.0 * third, 0.2, 1.4, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert!(refused(block().transformed(&singular)));
        let columns = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 5.0, 0.0, 0.0, 1.0];
        assert!(block().transformed(&columns).unwrap_err().to_string().contains("transpose"));
    }

    #[test]
    fn tiny_and_huge_matrices_are_no_more_singular_than_others() {
        for factor in [1e-300, 1e-120, 1e120, 1e300] {
            let matrix = [factor, 0.0, 0.0, 0.0, 0.0, 0.0, -factor, 0.0, 0.0, factor, 0.0, 0.0];
            let size = block().transformed(&matrix).unwrap().bounds().unwrap().size();
            assert_eq!(size, [1.0, 3.0, 2.0].map(|x| x * factor));
        }
        // Rows of different magnitudes, mirroring; and one that is singular but for the last bit of a tiny number.
        let mixed = [1e300, 0.0, 0.0, 0.0, 1e300, -1e-300, 0.0, 0.0, 0.0, 1e300, 1.0, 0.0];
        let turned = block().transformed(&mixed).unwrap();
        assert_eq!(turned.triangles, block().reversed().triangles);
        let nearly = |x: f64| [1e300, 1e-300, 0.0, 0.0, 1e300, x, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert!(block().transformed(&nearly(1e-300)).is_err());
        assert_eq!(block().transformed(&nearly(1e-300f64.next_up())).unwrap().triangles, block().triangles);
        assert_eq!(
            block().transformed(&nearly(1e-300f64.next_down())).unwrap().triangles,
            block().reversed().triangles
        );
    }
}

//! Moments of inertia of what a mesh encloses.
//!
//! The second moments of a tetrahedron (o, a, b, c) are its volume over 20 times the sum of x_i x_j over its corners and over
//! their sum; with o, the centroid, at the origin that is V / 20 (a a' + b b' + c c' + s s'), s = a + b + c
//! (Eberly, Polyhedral Mass Properties, 2002; Blow and Binstock 2004). They are added up with the volume's signs.

use super::{Mesh, cross};
use crate::parallel::map_chunks;

/// Triangles summed up at once: sums of the same pieces are the same bits for any number of threads.
const CHUNK: usize = 4096;

/// What a body of density one weighs and how it resists being turned.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MassProperties {
    /// The enclosed volume, which at density one is the mass.
    pub volume: f64,
    /// The centre of mass.
    pub centroid: [f64; 3],
    /// The inertia tensor about the centroid, along the coordinate axes: `inertia[0][0]` is the integral of y^2 + z^2,
    /// `inertia[0][1]` that of -x y. For another density multiply by it.
    pub inertia: [[f64; 3]; 3],
}

impl Mesh {
    /// Volume, centre of mass and inertia tensor of what the mesh encloses, at density one; `None` if the volume is not positive.
    /// The mesh should be closed and face outwards. The relative error is that of a plain sum, near 1e-13 for compact bodies.
    /// O(n).
    ///
    /// ```
    /// use trisect::primitives;
    ///
    /// let block = primitives::cuboid([5.0, 0.0, 0.0], [7.0, 3.0, 4.0])?;
    /// let found = block.mass_properties().unwrap();
    /// assert_eq!((found.volume, found.centroid), (24.0, [6.0, 1.5, 2.0]));
    /// // m (b^2 + c^2) / 12
    /// assert!((found.inertia[0][0] - 24.0 * (9.0 + 16.0) / 12.0).abs() < 1e-12);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn mass_properties(&self) -> Option<MassProperties> {
        let volume = self.volume();
        let centroid = self.centroid()?;
        if volume.is_nan() || volume <= 0.0 {
            return None;
        }
        // 1. Second moments about the centroid itself: nothing is taken off again, so far-away bodies lose nothing.
        let chunks = map_chunks(&self.triangles, CHUNK, |chunk| {
            let mut sum = [[0.0; 3]; 3];
            for &[a, b, c] in chunk {
                let corner = |index: u32| {
                    let at = self.positions.get(index as usize)?;
                    Some([0, 1, 2].map(|k| at[k] - centroid[k]))
                };
                let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) else { continue };
                add(&mut sum, a, b, c);
            }
            sum
        });
        let mut moments = [[0.0; 3]; 3];
        for chunk in chunks {
            for (row, of_chunk) in moments.iter_mut().zip(chunk) {
                for (sum, x) in row.iter_mut().zip(of_chunk) {
                    *sum += x;
                }
            }
        }
        // 2. The tensor: the trace on the diagonal less the moments.
        let trace = moments[0][0] + moments[1][1] + moments[2][2];
        let mut inertia = moments.map(|row| row.map(|x| -x));
        for k in 0..3 {
            inertia[k][k] += trace;
        }
        Some(MassProperties { volume, centroid, inertia })
    }
}

/// Adds the second moments of the tetrahedron between the origin and a triangle.
fn add(sum: &mut [[f64; 3]; 3], a: [f64; 3], b: [f64; 3], c: [f64; 3]) {
    let n = cross(b, c);
    let weight = (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 120.0;
    let s = [0, 1, 2].map(|k| a[k] + b[k] + c[k]);
    for i in 0..3 {
        for j in 0..3 {
            sum[i][j] += weight * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
        }
    }
}

impl MassProperties {
    /// The principal moments, least first, and the axes they belong to, each of length one: the eigenvalues and eigenvectors of
    /// the inertia tensor (Jacobi's rotations; Golub and Van Loan, Matrix Computations, 8.5).
    #[must_use]
    pub fn principal(&self) -> [(f64, [f64; 3]); 3] {
        // Sweeps after which nothing changes any more; convergence is quadratic, five are enough in practice.
        const SWEEPS: usize = 32;
        let mut matrix = self.inertia;
        let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for _ in 0..SWEEPS {
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                rotate(&mut matrix, &mut axes, p, q);
            }
        }
        let mut found = [0, 1, 2].map(|k| (matrix[k][k], [axes[0][k], axes[1][k], axes[2][k]]));
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }
}

/// Makes the entry (p, q) of a symmetric matrix zero by a rotation, which is multiplied onto `axes`.
fn rotate(matrix: &mut [[f64; 3]; 3], axes: &mut [[f64; 3]; 3], p: usize, q: usize) {
    let off = matrix[p][q];
    if off == 0.0 || !off.is_finite() {
        return;
    }
    let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let t = if theta == 0.0 { 1.0 } else { t };
    let cos = 1.0 / t.hypot(1.0);
    let sin = t * cos;
    for k in 0..3 {
        let (x, y) = (matrix[k][p], matrix[k][q]);
        (matrix[k][p], matrix[k][q]) = (cos * x - sin * y, sin * x + cos * y);
    }
    for k in 0..3 {
        let (x, y) = (matrix[p][k], matrix[q][k]);
        (matrix[p][k], matrix[q][k]) = (cos * x - sin * y, sin * x + cos * y);
    }
    for row in axes {
        let (x, y) = (row[p], row[q]);
        (row[p], row[q]) = (cos * x - sin * y, sin * x + cos * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn a_turned_block_far_away_has_the_moments_of_the_block() {
        let block = primitives::cuboid([-1.0, -1.5, -2.0], [1.0, 1.5, 2.0]).unwrap();
        let there = block.rotated([1.0, 2.0, -0.5], 37.0).unwrap().translated([1e4, -2e4, 3e4]);
        let found = there.mass_properties().unwrap();
        let wanted = [26.0, 40.0, 50.0];
        for (k, (moment, axis)) in found.principal().into_iter().enumerate() {
            assert!((moment - wanted[k]).abs() < 1e-7, "{moment} {}", wanted[k]);
            // I v = moment v
            for row in 0..3 {
                let product: f64 = (0..3).map(|column| found.inertia[row][column] * axis[column]).sum();
                assert!((product - moment * axis[row]).abs() < 1e-6);
            }
        }
        assert!((found.centroid[2] - 3e4).abs() < 1e-8);
    }

    #[test]
    fn a_sphere_tends_to_two_fifths() {
        let ball = primitives::icosphere(2.0, 5).unwrap();
        let found = ball.mass_properties().unwrap();
        for k in 0..3 {
            let ratio = found.inertia[k][k] / (0.4 * found.volume * 4.0);
            assert!((ratio - 1.0).abs() < 1e-2 && found.inertia[k][(k + 1) % 3].abs() < 1e-10, "{ratio}");
        }
        assert_eq!(ball.reversed().mass_properties(), None);
        assert_eq!(Mesh::default().mass_properties(), None);
    }
}

//! The surface over a regular face: a quartic box spline on twelve points, as a polynomial and in Bezier form.

use glam::DVec3;

/// Coefficients, in twelfths, of 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv, uuuu, uuuv, uuvv, uvvv, vvvv for each of the points:
/// in rows of 3, 4, 3 and 2, bottom-up; the face is points 4, 5 and 8.
const BASIS: [[i8; 15]; 12] = [
    [1, -2, -4, 0, 6, 6, 2, 0, -6, -4, -1, -2, 0, 2, 1],
    [1, 2, -2, 0, -6, 0, -4, 0, 6, 2, 2, 4, 0, -2, -1],
    [0, 0, 0, 0, 0, 0, 2, 0, 0, 0, -1, -2, 0, 0, 0],
    [1, -4, -2, 6, 6, 0, -4, -6, 0, 2, 1, 2, 0, -2, -1],
    [6, 0, 0, -12, -12, -12, 8, 12, 12, 8, -1, -2, 0, -2, -1],
    [1, 4, 2, 6, 6, 0, -4, -6, -12, -4, -1, -2, 0, 4, 2],
    [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0],
    [1, -2, 2, 0, -6, 0, 2, 6, 0, -4, -1, -2, 0, 4, 2],
    [1, 2, 4, 0, 6, 6, -4, -12, -6, -4, 2, 4, 0, -2, -1],
    [0, 0, 0, 0, 0, 0, 2, 6, 6, 2, -1, -2, 0, -2, -1],
    [0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, -2, -1],
    [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 1],
];

/// Powers of u and v of each coefficient.
const POWERS: [(usize, usize); 15] = [
    (0, 0),
    (1, 0),
    (0, 1),
    (2, 0),
    (1, 1),
    (0, 2),
    (3, 0),
    (2, 1),
    (1, 2),
    (0, 3),
    (4, 0),
    (3, 1),
    (2, 2),
    (1, 3),
    (0, 4),
];

/// For each corner of the face the six points around it, counter-clockwise, beginning with the face's next corner.
pub(crate) const RINGS: [[usize; 6]; 3] = [[5, 8, 7, 3, 0, 1], [8, 4, 1, 2, 6, 9], [4, 5, 9, 11, 10, 7]];
/// The corners of the face.
pub(crate) const CORNERS: [usize; 3] = [4, 5, 8];

/// A polynomial of degree four over a face: u is the weight of its second corner, v that of the third.
#[derive(Clone, Debug)]
pub(crate) struct Patch {
    coefficients: [DVec3; 15],
}

/// A point of a surface with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jet {
    pub(crate) position: DVec3,
    pub(crate) du: DVec3,
    pub(crate) dv: DVec3,
}

impl Patch {
    pub(crate) fn new(points: &[DVec3; 12]) -> Self {
        let coefficients = std::array::from_fn(|m| {
            (0..12).fold(DVec3::ZERO, |sum, i| sum + points[i] * (f64::from(BASIS[i][m]) / 12.0))
        });
        Self { coefficients }
    }

    pub(crate) fn position(&self, u: f64, v: f64) -> DVec3 {
        let c = &self.coefficients;
        // Horner in v, with polynomials in u as coefficients.
        let zero = c[0] + (c[1] + (c[3] + (c[6] + c[10] * u) * u) * u) * u;
        let one = c[2] + (c[4] + (c[7] + c[11] * u) * u) * u;
        let two = c[5] + (c[8] + c[12] * u) * u;
        let three = c[9] + c[13] * u;
        zero + (one + (two + (three + c[14] * v) * v) * v) * v
    }

    pub(crate) fn jet(&self, u: f64, v: f64) -> Jet {
        let c = &self.coefficients;
        let du = c[1]
            + c[3] * (2.0 * u)
            + c[4] * v
            + c[6] * (3.0 * u * u)
            + c[7] * (2.0 * u * v)
            + c[8] * (v * v)
            + c[10] * (4.0 * u * u * u)
            + c[11] * (3.0 * u * u * v)
            + c[12] * (2.0 * u * v * v)
            + c[13] * (v * v * v);
        let dv = c[2]
            + c[4] * u
            + c[5] * (2.0 * v)
            + c[7] * (u * u)
            + c[8] * (2.0 * u * v)
            + c[9] * (3.0 * v * v)
            + c[11] * (u * u * u)
            + c[12] * (2.0 * u * u * v)
            + c[13] * (3.0 * u * v * v)
            + c[14] * (4.0 * v * v * v);
        Jet { position: self.position(u, v), du, dv }
    }

    /// The fifteen Bezier points, in the order of the powers: point (i, j) belongs to u^i v^j.
    pub(crate) fn bezier(&self) -> [DVec3; 15] {
        std::array::from_fn(|m| {
            let (i, j) = POWERS[m];
            let mut point = DVec3::ZERO;
            for (n, &(p, q)) in POWERS.iter().enumerate() {
                if p <= i && q <= j {
                    let weight =
                        choose(i, p) * choose(j, q) * factorial(p) * factorial(q) * factorial(4 - p - q)
                            / 24.0;
                    point += self.coefficients[n] * weight;
                }
            }
            point
        })
    }

    /// A bound on the distance between the surface and the plane of the flat triangle over the same corners: a quarter of it holds
    /// for each of the four parts, and so on.
    ///
    /// Linear interpolation over a triangle with legs 1 is off by at most (|uu| + 2 |uv| + |vv|) / 8 (Filip, Magedson, Markot
    /// 1986); the second derivatives are within their Bezier points, 12 times second differences. Of that, what is across the
    /// patch counts in full, what is along it (points slide where the weights are distorted, as beside extraordinary vertices)
    /// only as far as parts of the patch are tilted against the whole.
    pub(crate) fn flatness(&self) -> f64 {
        let points = self.bezier();
        let at = |i: usize, j: usize| points[NUMBER[i][j]];
        let normal = (at(4, 0) - at(0, 0)).cross(at(0, 4) - at(0, 0)).normalize_or_zero();
        let (mut across, mut along) = ([0.0f64; 3], [0.0f64; 3]);
        for i in 0..=2 {
            for j in 0..=2 - i {
                let second = [
                    at(i + 2, j) - at(i + 1, j) * 2.0 + at(i, j),
                    at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + at(i, j),
                    at(i, j + 2) - at(i, j + 1) * 2.0 + at(i, j),
                ];
                for k in 0..3 {
                    across[k] = across[k].max(second[k].dot(normal).abs());
                    along[k] = along[k].max(second[k].length());
                }
            }
        }
        let mut tilt = 0.0f64;
        for i in 0..=3 {
            for j in 0..=3 - i {
                for edge in [at(i + 1, j) - at(i, j), at(i, j + 1) - at(i, j), at(i + 1, j) - at(i, j + 1)] {
                    let length = edge.length();
                    if length > 0.0 {
                        tilt = tilt.max(edge.dot(normal).abs() / length);
                    }
                }
            }
        }
        let sum = |of: [f64; 3]| 12.0 * (of[0] + 2.0 * of[1] + of[2]) / 8.0;
        // A plane through two directions tilted so is tilted by at most twice that, but for needles.
        sum(along).min(sum(across) + (2.0 * tilt).min(1.0) * sum(along))
    }
}

/// Which coefficient belongs to u^i v^j.
const NUMBER: [[usize; 5]; 5] =
    [[0, 2, 5, 9, 14], [1, 4, 8, 13, 0], [3, 7, 12, 0, 0], [6, 11, 0, 0, 0], [10, 0, 0, 0, 0]];

fn factorial(n: usize) -> f64 {
    (1..=n).product::<usize>() as f64
}

fn choose(n: usize, k: usize) -> f64 {
    factorial(n) / (factorial(k) * factorial(n - k))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> [DVec3; 12] {
        std::array::from_fn(|i| DVec3::new((i * 7 % 5) as f64, (i * 3 % 7) as f64, (i * i % 11) as f64))
    }

    #[test]
    fn the_basis_sums_to_one() {
        let patch = Patch::new(&[DVec3::ONE; 12]);
        for (u, v) in [(0.0, 0.0), (0.3, 0.2), (1.0, 0.0), (0.1, 0.9)] {
            let jet = patch.jet(u, v);
            assert!((jet.position - DVec3::ONE).length() < 1e-15);
            assert!(jet.du.length() + jet.dv.length() < 1e-14);
        }
    }

    #[test]
    fn derivatives_and_bezier_points_fit_the_polynomial() {
        let patch = Patch::new(&points());
        let (u, v, step) = (0.31, 0.24, 1e-6);
        let jet = patch.jet(u, v);
        let slope = (patch.position(u + step, v) - patch.position(u - step, v)) / (2.0 * step);
        assert!((slope - jet.du).length() < 1e-8);
        let slope = (patch.position(u, v + step) - patch.position(u, v - step)) / (2.0 * step);
        assert!((slope - jet.dv).length() < 1e-8);
        let bezier = patch.bezier();
        let w = 1.0 - u - v;
        let sum = POWERS.iter().zip(bezier).fold(DVec3::ZERO, |sum, (&(i, j), point)| {
            let count = 24.0 / (factorial(i) * factorial(j) * factorial(4 - i - j));
            sum + point * (count * u.powi(i as i32) * v.powi(j as i32) * w.powi((4 - i - j) as i32))
        });
        assert!((sum - jet.position).length() < 1e-13);
    }

    #[test]
    fn the_flatness_bounds_the_deviation() {
        let patch = Patch::new(&points());
        let corners = [patch.position(0.0, 0.0), patch.position(1.0, 0.0), patch.position(0.0, 1.0)];
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        for (m, &(i, j)) in POWERS.iter().enumerate() {
            assert_eq!(NUMBER[i][j], m);
        }
        let bound = patch.flatness();
        for i in 0..=20 {
            for j in 0..=20 - i {
                let (u, v) = (i as f64 / 20.0, j as f64 / 20.0);
                let flat = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                assert!((patch.position(u, v) - flat).dot(normal).abs() <= bound);
            }
        }
    }
}

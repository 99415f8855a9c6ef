//! How the change of joined curves is measured, and the matrix of the integral.

use nalgebra::{DMatrix, DVector};

use crate::parametric::Curve;
use crate::parametric::curve::nurbs::NurbsCurve;
use crate::parametric::numeric::gauss::gauss_legendre;
use crate::parametric::numeric::{knots, vector};

/// What "nearest" means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum JoinMetric {
    /// `sum |e_i|^2 + |d_i|^2`, the changes of the control points (equation 11 of the paper).
    Discrete,
    /// `int_0^1 |P~ - P|^2 + |Q~ - Q|^2 dt`, the changes of the curves (equation 12), integrated exactly.
    #[default]
    Integral,
}

/// Index of the first basis function that does not vanish at `t`, and the values and derivatives of those that do not.
pub(crate) fn basis_at<const D: usize>(
    curve: &NurbsCurve<D>,
    t: f64,
    order: usize,
) -> (usize, Vec<Vec<f64>>) {
    let span = knots::span(curve.degree(), curve.knots(), t);
    (span - curve.degree(), knots::basis_derivatives(curve.degree(), curve.knots(), span, t, order))
}

/// `I_ij = int N_i N_j dt` over 0..1, by a quadrature that is exact for the degree.
pub(crate) fn gram<const D: usize>(curve: &NurbsCurve<D>) -> DMatrix<f64> {
    let count = curve.control().len();
    let mut gram = DMatrix::zeros(count, count);
    let rule = gauss_legendre(curve.degree() + 1);
    for piece in curve.breaks().windows(2) {
        for [x, weight] in &rule {
            let (first, basis) = basis_at(curve, vector::mix(piece[0], piece[1], *x), 0);
            for (i, a) in basis[0].iter().enumerate() {
                for (j, b) in basis[0].iter().enumerate() {
                    gram[(first + i, first + j)] += weight * (piece[1] - piece[0]) * a * b;
                }
            }
        }
    }
    gram
}

/// A matrix whose square (its transpose times itself) is the symmetric positive definite `gram`.
pub(crate) fn root(gram: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = gram.clone().symmetric_eigen();
    // Rounding must not make a small positive eigenvalue negative.
    let roots = DVector::from_iterator(gram.nrows(), eigen.eigenvalues.iter().map(|x| x.max(0.0).sqrt()));
    DMatrix::from_diagonal(&roots) * eigen.eigenvectors.transpose()
}

//! Knot vectors and the B-spline basis (Piegl and Tiller, "The NURBS Book", chapter 2).

use crate::parametric::error::{GeometryError, Result};

/// Checks a knot vector for `count` control points: the right length, finite, ascending, no inner knot repeated
/// more than `degree` times (the curve would tear), a domain that is not empty.
pub(crate) fn check(degree: usize, knots: &[f64], count: usize) -> Result<()> {
    if degree == 0 {
        return Err(GeometryError::OutOfRange { what: "degree", value: 0.0, range: "1 or more" });
    }
    if count <= degree {
        return Err(GeometryError::TooFewPoints { what: "B-spline", needed: degree + 1, found: count });
    }
    let expected = count + degree + 1;
    if knots.len() != expected {
        return Err(GeometryError::CountMismatch { what: "knots", expected, found: knots.len() });
    }
    if let Some(index) = knots.iter().position(|knot| !knot.is_finite()) {
        return Err(GeometryError::NotFinite { what: "knot", index, of: "B-spline" });
    }
    if let Some(index) = knots.windows(2).position(|pair| pair[0] > pair[1]) {
        return Err(GeometryError::BadKnots {
            index: index + 1,
            reason: "it is less than the one before it; knots must ascend".into(),
        });
    }
    let [start, end] = domain(degree, knots);
    if start >= end {
        return Err(GeometryError::BadKnots {
            index: degree,
            reason: format!("the domain from knot {degree} to knot {count} is empty"),
        });
    }
    let inner = |knot: f64| knot > start && knot < end;
    let torn = (0..knots.len() - degree).find(|&i| knots[i] == knots[i + degree] && inner(knots[i]));
    if let Some(index) = torn {
        return Err(GeometryError::BadKnots {
            index,
            reason: format!("an inner knot of degree {degree} may occur at most {} times", degree),
        });
    }
    Ok(())
}

/// First and last parameter of the curve.
pub(crate) fn domain(degree: usize, knots: &[f64]) -> [f64; 2] {
    [knots[degree], knots[knots.len() - degree - 1]]
}

/// Index `i` with `knots[i] <= t < knots[i + 1]` inside the domain; the last such interval at its end.
pub(crate) fn span(degree: usize, knots: &[f64], t: f64) -> usize {
    let end = knots.len() - degree - 1;
    if t >= knots[end] {
        // The last interval that is not empty.
        return knots.partition_point(|&knot| knot < knots[end]) - 1;
    }
    knots.partition_point(|&knot| knot <= t).clamp(degree + 1, end) - 1
}

/// The knots in the domain, each once, the ends included.
pub(crate) fn distinct(degree: usize, knots: &[f64]) -> Vec<f64> {
    let mut distinct = knots[degree..knots.len() - degree].to_vec();
    distinct.dedup();
    distinct
}

/// How often `knot` occurs.
pub(crate) fn multiplicity(knots: &[f64], knot: f64) -> usize {
    knots.iter().filter(|&&k| k == knot).count()
}

/// Inner knots where the curve has a corner in general: as often repeated as the degree.
pub(crate) fn corners(degree: usize, knots: &[f64]) -> Vec<f64> {
    let distinct = distinct(degree, knots);
    let inner = &distinct[1..distinct.len() - 1];
    inner.iter().copied().filter(|&knot| multiplicity(knots, knot) >= degree).collect()
}

/// The `degree + 1` basis functions that do not vanish on `span`, and their derivatives up to `order`:
/// `result[k][j]` is the k-th derivative of the basis function `span - degree + j` (algorithm A2.3).
pub(crate) fn basis_derivatives(
    degree: usize,
    knots: &[f64],
    span: usize,
    t: f64,
    order: usize,
) -> Vec<Vec<f64>> {
    let p = degree;
    // ndu[j][r]: basis functions in the upper triangle, knot differences in the lower.
    let mut ndu = vec![vec![0.0; p + 1]; p + 1];
    ndu[0][0] = 1.0;
    for j in 1..=p {
        let mut saved = 0.0;
        for r in 0..j {
            let right = knots[span + r + 1] - t;
            let left = t - knots[span + 1 + r - j];
            ndu[j][r] = knots[span + r + 1] - knots[span + 1 + r - j];
            let quotient = ndu[r][j - 1] / ndu[j][r];
            ndu[r][j] = saved + right * quotient;
            saved = left * quotient;
        }
        ndu[j][j] = saved;
    }
    let mut result = vec![vec![0.0; p + 1]; order + 1];
    for j in 0..=p {
        result[0][j] = ndu[j][p];
    }
    for r in 0..=p {
        let mut rows = [vec![0.0; p + 1], vec![0.0; p + 1]];
        rows[0][0] = 1.0;
        let mut factor = p as f64;
        for k in 1..=order.min(p) {
            let (current, previous) = (k % 2, 1 - k % 2);
            let mut sum = 0.0;
            for j in 0..=k {
                // a[k][j] of the book, built from row k - 1; terms whose basis function lies outside vanish.
                let low = if j < k { rows[previous][j] } else { 0.0 };
                let high = if j >= 1 { rows[previous][j - 1] } else { 0.0 };
                let index = r as isize - k as isize + j as isize;
                let value = if index < 0 || index as usize > p - k {
                    0.0
                } else {
                    (low - high) / ndu[p - k + 1][index as usize]
                };
                rows[current][j] = value;
                if value != 0.0 {
                    sum += value * ndu[index as usize][p - k];
                }
            }
            result[k][r] = sum * factor;
            factor *= (p - k) as f64;
        }
    }
    result
}

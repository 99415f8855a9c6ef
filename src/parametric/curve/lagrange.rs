//! Polynomial interpolation.

use super::nurbs::NurbsCurve;
use super::param_curve::Curve;
use super::parameters::Spacing;
use crate::parametric::error::{GeometryError, Result, check_count};
use crate::parametric::numeric::bernstein::binomial;
use crate::parametric::numeric::domain::clamped;
use crate::parametric::numeric::vector::{self, Point};

/// The polynomial curve of least degree through given points at given parameters.
///
/// Many points make it oscillate and lose accuracy; beyond [`LagrangeCurve::MOST_POINTS`] it is refused.
#[derive(Clone, Debug, PartialEq)]
pub struct LagrangeCurve<const D: usize> {
    points: Vec<Point<D>>,
    parameters: Vec<f64>,
    /// Barycentric weights, scaled to a largest magnitude of 1.
    weights: Vec<f64>,
    /// Newton's divided differences, in the order of `nodes`.
    newton: Vec<Point<D>>,
    nodes: Vec<f64>,
}

impl<const D: usize> LagrangeCurve<D> {
    /// Most points accepted: beyond, rounding errors grow past what hull bounds allow for.
    pub const MOST_POINTS: usize = 20;

    /// The curve through `points`.
    ///
    /// # Errors
    /// [`GeometryError::TooFewPoints`] (2 are needed), [`GeometryError::TooManyPoints`],
    /// [`GeometryError::CoincidentPoints`] for equal neighbours, [`GeometryError::NotFinite`], and those of given
    /// parameters.
    pub fn new(points: &[[f64; D]], spacing: &Spacing) -> Result<Self> {
        check_count("Lagrange curve", points, 2)?;
        if points.len() > Self::MOST_POINTS {
            return Err(GeometryError::TooManyPoints {
                what: "a Lagrange curve",
                limit: Self::MOST_POINTS,
                found: points.len(),
                advice: "a polynomial through so many oscillates; use a cubic spline",
            });
        }
        let parameters = spacing.parameters("Lagrange curve", points, false)?;
        let (newton, nodes) = divided_differences(points, &parameters);
        let weights = barycentric_weights(&parameters);
        Ok(Self { points: points.to_vec(), parameters, weights, newton, nodes })
    }

    /// Control points over `a..b` from the derivatives at the middle.
    fn bernstein_over(&self, a: f64, b: f64) -> Vec<Point<D>> {
        let degree = self.points.len() - 1;
        let half = 0.5 * (b - a);
        // Taylor coefficients in w = (t - middle) / half, -1 <= w <= 1; then w = 2 x - 1 with x in 0..1.
        let mut power = self.derivatives(0.5 * (a + b), degree);
        let mut factor = 1.0;
        for (k, coefficient) in power.iter_mut().enumerate().skip(1) {
            factor *= half / k as f64;
            *coefficient = vector::scale(*coefficient, factor);
        }
        // Value of w^k at the blossom with j arguments x = 1 (w = 1) and degree - j with x = 0 (w = -1).
        let mut control: Vec<Point<D>> = (0..=degree)
            .map(|j| {
                power.iter().enumerate().fold([0.0; D], |sum, (k, coefficient)| {
                    let plus = (0..=k.min(j)).filter(|i| k - i <= degree - j);
                    let blossom: f64 = plus
                        .map(|i| {
                            let sign = if (k - i) % 2 == 0 { 1.0 } else { -1.0 };
                            sign * binomial(j, i) * binomial(degree - j, k - i)
                        })
                        .sum();
                    vector::add_scaled(sum, *coefficient, blossom / binomial(degree, k))
                })
            })
            .collect();
        control[0] = self.point(a);
        control[degree] = self.point(b);
        control
    }
}

/// Newton's coefficients with the nodes in Leja's order, which keeps them small.
fn divided_differences<const D: usize>(points: &[Point<D>], parameters: &[f64]) -> (Vec<Point<D>>, Vec<f64>) {
    let count = points.len();
    let mut order: Vec<usize> = vec![0];
    while order.len() < count {
        let spread =
            |i: usize| -> f64 { order.iter().map(|&j| (parameters[i] - parameters[j]).abs().ln()).sum() };
        let next = (0..count)
            .filter(|i| !order.contains(i))
            .max_by(|&i, &j| spread(i).total_cmp(&spread(j)).then(j.cmp(&i)))
            .unwrap_or(0);
        order.push(next);
    }
    let nodes: Vec<f64> = order.iter().map(|&i| parameters[i]).collect();
    let mut newton: Vec<Point<D>> = order.iter().map(|&i| points[i]).collect();
    for level in 1..count {
        for i in (level..count).rev() {
            let difference = vector::sub(newton[i], newton[i - 1]);
            newton[i] = vector::scale(difference, 1.0 / (nodes[i] - nodes[i - level]));
        }
    }
    (newton, nodes)
}

fn barycentric_weights(parameters: &[f64]) -> Vec<f64> {
    // Differences in units of a quarter of the domain keep the products in range.
    let unit = 0.25 * (parameters[parameters.len() - 1] - parameters[0]);
    let mut weights: Vec<f64> = (0..parameters.len())
        .map(|i| {
            let others = parameters.iter().enumerate().filter(|(j, _)| *j != i);
            1.0 / others.map(|(_, t)| (parameters[i] - t) / unit).product::<f64>()
        })
        .collect();
    let largest = weights.iter().fold(0.0_f64, |m, w| m.max(w.abs()));
    weights.iter_mut().for_each(|w| *w /= largest);
    weights
}

impl<const D: usize> Curve<D> for LagrangeCurve<D> {
    fn domain(&self) -> [f64; 2] {
        [self.parameters[0], self.parameters[self.parameters.len() - 1]]
    }

    /// By the second barycentric formula: exact at the nodes.
    fn point(&self, t: f64) -> Point<D> {
        let t = clamped(t, self.domain());
        if let Some(i) = self.parameters.iter().position(|&node| node == t) {
            return self.points[i];
        }
        let mut sum = [0.0; D];
        let mut denominator = 0.0;
        for i in 0..self.points.len() {
            let weight = self.weights[i] / (t - self.parameters[i]);
            sum = vector::add_scaled(sum, self.points[i], weight);
            denominator += weight;
        }
        vector::scale(sum, 1.0 / denominator)
    }

    /// By Horner's scheme on Newton's form, all derivatives in one pass.
    fn derivatives(&self, t: f64, order: usize) -> Vec<Point<D>> {
        let t = clamped(t, self.domain());
        let mut taylor = vec![[0.0; D]; order + 1];
        for i in (0..self.newton.len()).rev() {
            for k in (1..=order).rev() {
                taylor[k] = vector::add_scaled(taylor[k - 1], taylor[k], t - self.nodes[i]);
            }
            taylor[0] = vector::add_scaled(self.newton[i], taylor[0], t - self.nodes[i]);
        }
        let mut factorial = 1.0;
        for (k, coefficient) in taylor.iter_mut().enumerate().skip(1) {
            factorial *= k as f64;
            *coefficient = vector::scale(*coefficient, factorial);
        }
        taylor[0] = self.point(t);
        taylor
    }

    fn breaks(&self) -> Vec<f64> {
        self.domain().to_vec()
    }

    fn control_polygon(&self, a: f64, b: f64, polygon: &mut Vec<Point<D>>) {
        polygon.extend(self.bernstein_over(a, b));
    }

    fn to_nurbs(&self) -> NurbsCurve<D> {
        let [a, b] = self.domain();
        let control = self.bernstein_over(a, b);
        let degree = control.len() - 1;
        let knots = [a, b].iter().flat_map(|&knot| vec![knot; degree + 1]).collect();
        NurbsCurve::trusted(degree, knots, control, None)
    }
}

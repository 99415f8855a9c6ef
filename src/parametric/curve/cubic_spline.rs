//! Twice continuously differentiable interpolating splines.

use super::parameters::Spacing;
use super::piecewise::{PiecewiseBezier, curve_of_pieces};
use crate::parametric::error::{Result, check_count, check_points};
use crate::parametric::numeric::vector::{self, Point};

/// What holds at the ends of a cubic spline.
#[derive(Clone, Debug, PartialEq)]
pub enum SplineEnds<const D: usize> {
    /// Second derivatives vanish at both ends.
    Natural,
    /// Given first derivatives (with respect to the parameter) at the start and the end.
    Clamped([[f64; D]; 2]),
    /// The spline returns to its first point and is twice differentiable there too.
    Periodic,
}

/// A cubic spline through given points, twice continuously differentiable (Al-Athamneh 2016): its second
/// derivatives solve a tridiagonal system, a cyclic one for a periodic spline.
#[derive(Clone, Debug, PartialEq)]
pub struct CubicSpline<const D: usize> {
    spline: PiecewiseBezier<D>,
    second: Vec<Point<D>>,
}

impl<const D: usize> CubicSpline<D> {
    /// The spline through `points`; a periodic one returns to the first point by itself.
    ///
    /// # Errors
    /// [`TooFewPoints`](crate::parametric::GeometryError::TooFewPoints) (2; periodic: 3),
    /// [`CoincidentPoints`](crate::parametric::GeometryError::CoincidentPoints) for equal neighbours,
    /// [`NotFinite`](crate::parametric::GeometryError::NotFinite), and those of given parameters.
    pub fn new(points: &[[f64; D]], ends: &SplineEnds<D>, spacing: &Spacing) -> Result<Self> {
        let periodic = matches!(ends, SplineEnds::Periodic);
        check_count("cubic spline", points, if periodic { 3 } else { 2 })?;
        if let SplineEnds::Clamped(tangents) = ends {
            check_points("cubic spline", tangents)?;
        }
        let parameters = spacing.parameters("cubic spline", points, periodic)?;
        let mut points = points.to_vec();
        if periodic {
            points.push(points[0]);
        }
        let second = second_derivatives(&points, &parameters, ends);
        let tangents = first_derivatives(&points, &parameters, &second);
        Ok(Self { spline: PiecewiseBezier::cubic(parameters, &points, &tangents), second })
    }

    /// The second derivatives at the points, with respect to the parameter; a periodic spline repeats the
    /// first at the end.
    #[must_use]
    pub fn second_derivatives(&self) -> &[[f64; D]] {
        &self.second
    }
}

/// First derivatives at the points from the second ones, each from the piece after it (the last: before it).
fn first_derivatives<const D: usize>(
    points: &[Point<D>],
    parameters: &[f64],
    second: &[Point<D>],
) -> Vec<Point<D>> {
    let last = points.len() - 1;
    (0..=last)
        .map(|i| {
            let (from, sign) = if i < last { (i, -1.0) } else { (i - 1, 1.0) };
            let h = parameters[from + 1] - parameters[from];
            let slope = vector::scale(vector::sub(points[from + 1], points[from]), 1.0 / h);
            let other = if i < last { i + 1 } else { i - 1 };
            let bend = vector::add(vector::scale(second[i], 2.0), second[other]);
            vector::add_scaled(slope, bend, sign * h / 6.0)
        })
        .collect()
}

fn second_derivatives<const D: usize>(
    points: &[Point<D>],
    parameters: &[f64],
    ends: &SplineEnds<D>,
) -> Vec<Point<D>> {
    let last = points.len() - 1;
    let h = |i: usize| parameters[i + 1] - parameters[i];
    let slope = |i: usize| vector::scale(vector::sub(points[i + 1], points[i]), 1.0 / h(i));
    let jump = |before: usize, after: usize| vector::scale(vector::sub(slope(after), slope(before)), 6.0);
    let mut rows: Vec<Row<D>> = (1..last)
        .map(|i| Row {
            below: h(i - 1),
            diagonal: 2.0 * (h(i - 1) + h(i)),
            above: h(i),
            right: jump(i - 1, i),
        })
        .collect();
    match ends {
        SplineEnds::Natural => {
            let mut second = vec![[0.0; D]; last + 1];
            second[1..last].copy_from_slice(&solve_tridiagonal(rows));
            second
        }
        SplineEnds::Clamped([start, end]) => {
            let first = vector::scale(vector::sub(slope(0), *start), 6.0);
            rows.insert(0, Row { below: 0.0, diagonal: 2.0 * h(0), above: h(0), right: first });
            let h_end = h(last - 1);
            let right = vector::scale(vector::sub(*end, slope(last - 1)), 6.0);
            rows.push(Row { below: h_end, diagonal: 2.0 * h_end, above: 0.0, right });
            solve_tridiagonal(rows)
        }
        SplineEnds::Periodic => {
            let wrap = h(last - 1);
            let right = jump(last - 1, 0);
            rows.insert(0, Row { below: wrap, diagonal: 2.0 * (wrap + h(0)), above: h(0), right });
            let mut second = solve_cyclic(rows);
            second.push(second[0]);
            second
        }
    }
}

/// One equation `below S_i-1 + diagonal S_i + above S_i+1 = right`.
#[derive(Clone, Copy)]
struct Row<const D: usize> {
    below: f64,
    diagonal: f64,
    above: f64,
    right: Point<D>,
}

/// Elimination without pivoting: the systems are diagonally dominant.
fn solve_tridiagonal<const D: usize>(mut rows: Vec<Row<D>>) -> Vec<Point<D>> {
    for i in 1..rows.len() {
        let factor = rows[i].below / rows[i - 1].diagonal;
        rows[i].diagonal -= factor * rows[i - 1].above;
        rows[i].right = vector::add_scaled(rows[i].right, rows[i - 1].right, -factor);
    }
    let mut solution = vec![[0.0; D]; rows.len()];
    let mut next = [0.0; D];
    for i in (0..rows.len()).rev() {
        next = vector::scale(vector::add_scaled(rows[i].right, next, -rows[i].above), 1.0 / rows[i].diagonal);
        solution[i] = next;
    }
    solution
}

/// The cyclic system, where the first row reaches back to the last unknown and the last to the first, by one
/// correction of rank one (Sherman and Morrison).
fn solve_cyclic<const D: usize>(mut rows: Vec<Row<D>>) -> Vec<Point<D>> {
    let last = rows.len() - 1;
    let (corner_first, corner_last) = (rows[0].below, rows[last].above);
    let gamma = -rows[0].diagonal;
    rows[0].diagonal -= gamma;
    rows[last].diagonal -= corner_first * corner_last / gamma;
    let mut correction: Vec<Row<1>> = rows
        .iter()
        .map(|row| Row { below: row.below, diagonal: row.diagonal, above: row.above, right: [0.0] })
        .collect();
    correction[0].right = [gamma];
    correction[last].right = [corner_last];
    let solution = solve_tridiagonal(rows);
    let correction = solve_tridiagonal(correction);
    let ratio = corner_first / gamma;
    let scale = 1.0 + correction[0][0] + ratio * correction[last][0];
    let factor = vector::scale(vector::add_scaled(solution[0], solution[last], ratio), 1.0 / scale);
    (0..=last).map(|i| vector::add_scaled(solution[i], factor, -correction[i][0])).collect()
}

curve_of_pieces!(CubicSpline);

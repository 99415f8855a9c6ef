//! Linear constraints with names: which of them are independent, which follow from others, which contradict others.

use nalgebra::{DMatrix, DVector};

use super::report::ConstraintReport;
use crate::parametric::error::{GeometryError, Result};

/// A constraint row whose part outside the span of the others is below this (rows have length 1) depends on them.
const RANK_TOLERANCE: f64 = 1e-9;

/// Right sides that differ by less than this, in units of the curves' size, agree.
const AGREEMENT: f64 = 1e-8;

/// Constraints `row x = right` on unknown points `x` (one column per coordinate), each row scaled to length 1.
#[derive(Debug, Default)]
pub(crate) struct Constraints {
    names: Vec<String>,
    /// For every row the index of its name.
    of_row: Vec<usize>,
    rows: Vec<DMatrix<f64>>,
    right: Vec<DMatrix<f64>>,
}

/// The rows that count.
#[derive(Debug)]
pub(crate) struct Independent {
    pub(crate) rows: DMatrix<f64>,
    pub(crate) right: DMatrix<f64>,
    /// For every name, the names it follows from, if it follows from others.
    follows_from: Vec<Option<Vec<usize>>>,
}

impl Constraints {
    /// Adds rows under one name. Rows of zeros, which say nothing, are left out.
    pub(crate) fn add(&mut self, name: String, rows: &DMatrix<f64>, right: &DMatrix<f64>) {
        let index = self.names.len();
        self.names.push(name);
        for i in 0..rows.nrows() {
            let row = rows.rows(i, 1);
            let length = row.norm();
            if length > 0.0 {
                self.of_row.push(index);
                self.rows.push(row / length);
                self.right.push(right.rows(i, 1) / length);
            }
        }
    }

    /// Takes the rows one after the other. A row outside the span of those before is independent; another is a
    /// combination of them, and the same combination of their right sides must give its own.
    pub(crate) fn independent(&self, size: f64) -> Result<Independent> {
        let unknowns = self.rows.first().map_or(0, DMatrix::ncols);
        let coordinates = self.right.first().map_or(0, DMatrix::ncols);
        let mut taken: Vec<usize> = Vec::new();
        let mut rows = DMatrix::zeros(0, unknowns);
        let mut right = DMatrix::zeros(0, coordinates);
        let mut follows_from: Vec<Option<Vec<usize>>> = vec![None; self.names.len()];
        let mut contributes = vec![false; self.names.len()];
        for (i, row) in self.rows.iter().enumerate() {
            let factors = combination(&rows, row);
            let rest = row - factors.transpose() * &rows;
            if rest.norm() > RANK_TOLERANCE {
                taken.push(i);
                rows = stacked(&rows, row);
                right = stacked(&right, &self.right[i]);
                contributes[self.of_row[i]] = true;
                continue;
            }
            // Small factors are rounding.
            let mut involved: Vec<usize> = (0..taken.len())
                .filter(|&j| factors[j].abs() > 1e-7)
                .map(|j| self.of_row[taken[j]])
                .collect();
            involved.sort_unstable();
            involved.dedup();
            let mismatch = (&self.right[i] - factors.transpose() * &right).norm();
            let allowance = AGREEMENT * size * (1.0 + factors.abs().sum());
            if mismatch > allowance {
                involved.push(self.of_row[i]);
                let constraints = involved.into_iter().map(|name| self.names[name].clone()).collect();
                return Err(GeometryError::Contradictory { constraints });
            }
            let name = self.of_row[i];
            let causes = follows_from[name].get_or_insert_with(Vec::new);
            causes.extend(involved.into_iter().filter(|cause| *cause != name));
        }
        for (name, causes) in follows_from.iter_mut().enumerate() {
            if contributes[name] {
                *causes = None;
            }
            if let Some(causes) = causes {
                causes.sort_unstable();
                causes.dedup();
            }
        }
        Ok(Independent { rows, right, follows_from })
    }

    /// What became of every constraint.
    pub(crate) fn report(
        &self,
        solution: &DMatrix<f64>,
        found: &Independent,
        size: f64,
    ) -> Vec<ConstraintReport> {
        let unit = if size > 0.0 { size } else { 1.0 };
        let mut residuals = vec![0.0_f64; self.names.len()];
        for (i, row) in self.rows.iter().enumerate() {
            let residual = (row * solution - &self.right[i]).norm() / unit;
            residuals[self.of_row[i]] = residuals[self.of_row[i]].max(residual);
        }
        let named = |names: &Vec<usize>| names.iter().map(|&i| self.names[i].clone()).collect();
        (0..self.names.len())
            .map(|i| ConstraintReport {
                name: self.names[i].clone(),
                residual: residuals[i],
                follows_from: found.follows_from[i].as_ref().map(named).unwrap_or_default(),
            })
            .collect()
    }
}

/// Factors with which the independent `rows` come nearest to `row`.
fn combination(rows: &DMatrix<f64>, row: &DMatrix<f64>) -> DVector<f64> {
    if rows.nrows() == 0 {
        return DVector::zeros(0);
    }
    least_squares(&rows.transpose(), &row.transpose()).column(0).into_owned()
}

/// The least-squares solution of `rows x = right` among the solutions of the independent `constraints x = values`.
pub(crate) fn solve_within(
    constraints: &DMatrix<f64>,
    values: &DMatrix<f64>,
    rows: &DMatrix<f64>,
    right: &DMatrix<f64>,
) -> DMatrix<f64> {
    let unknowns = rows.ncols();
    let rank = constraints.nrows();
    if rank == 0 {
        return least_squares(rows, right);
    }
    // Columns of zeros make the decomposition deliver a basis of the whole space: first of the constraints' row space,
    // then of what they leave free.
    let mut square = DMatrix::zeros(unknowns, unknowns);
    square.columns_mut(0, rank).copy_from(&constraints.transpose());
    let (q, r) = square.qr().unpack();
    let triangle = r.view((0, 0), (rank, rank)).transpose();
    // The triangle is regular: its rows are independent.
    let Some(coordinates) = triangle.solve_lower_triangular(values) else {
        return DMatrix::zeros(unknowns, right.ncols());
    };
    let particular = q.columns(0, rank) * coordinates;
    let free = q.columns(rank, unknowns - rank).into_owned();
    if free.ncols() == 0 {
        return particular;
    }
    let rest = right - rows * &particular;
    particular + &free * least_squares(&(rows * &free), &rest)
}

/// The least-squares solution by a decomposition with column pivoting, for rows of full column rank.
fn least_squares(rows: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let qr = rows.clone().col_piv_qr();
    let columns = rows.ncols();
    let rotated = qr.q().transpose() * right;
    let mut solution = qr
        .r()
        .solve_upper_triangular(&rotated.rows(0, columns).into_owned())
        .unwrap_or_else(|| DMatrix::zeros(columns, right.ncols()));
    qr.p().inv_permute_rows(&mut solution);
    solution
}

/// The rows of `above`, then those of `below`.
pub(crate) fn stacked(above: &DMatrix<f64>, below: &DMatrix<f64>) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(above.nrows() + below.nrows(), above.ncols());
    all.rows_mut(0, above.nrows()).copy_from(above);
    all.rows_mut(above.nrows(), below.nrows()).copy_from(below);
    all
}

//! Surface patches: tensor products of Bezier, B-spline and NURBS curves.

use glam::DVec3;

use crate::parametric::curve::nurbs::{NurbsCurve, check_weights};
use crate::parametric::error::{GeometryError, Result, check_points};
use crate::parametric::numeric::bernstein::binomial;
use crate::parametric::numeric::domain::clamped;
use crate::parametric::numeric::gauss::gauss_legendre;
use crate::parametric::numeric::knots;
use crate::parametric::numeric::vector::{self, Point};

/// A patch `S(u, v) = sum_i sum_j N_i(u) N_j(v) Q_ij` over a rectangle of parameters; rational if it has weights.
///
/// The rows of control points follow `u`: row `i` holds `Q_i0, Q_i1, ...`. The patch faces the way of
/// `S_u x S_v`. Edges may be degenerate (all their control points equal), as at the poles of a sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    pub(crate) degrees: [usize; 2],
    pub(crate) knots: [Vec<f64>; 2],
    /// Numbers of control points along u and v.
    pub(crate) counts: [usize; 2],
    /// Control points, row by row.
    pub(crate) points: Vec<Point<3>>,
    pub(crate) weights: Option<Vec<f64>>,
}

/// One of the four boundaries of a patch, running along the growing parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PatchSide {
    /// `v` at its least, along `u`.
    VLow,
    /// `u` at its greatest, along `v`.
    UHigh,
    /// `v` at its greatest, along `u`.
    VHigh,
    /// `u` at its least, along `v`.
    ULow,
}

impl PatchSide {
    /// All four, counter-clockwise around the parameter rectangle (the last two traversed backwards).
    pub const ALL: [Self; 4] = [Self::VLow, Self::UHigh, Self::VHigh, Self::ULow];

    /// Whether the side's own direction is counter-clockwise around the parameter rectangle.
    pub(crate) fn is_forward(self) -> bool {
        matches!(self, Self::VLow | Self::UHigh)
    }

    /// Parameters in the unit square at `r` along the side.
    pub(crate) fn at(self, r: f64) -> [f64; 2] {
        match self {
            Self::VLow => [r, 0.0],
            Self::UHigh => [1.0, r],
            Self::VHigh => [r, 1.0],
            Self::ULow => [0.0, r],
        }
    }
}

impl std::fmt::Display for PatchSide {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::VLow => "least v",
            Self::UHigh => "greatest u",
            Self::VHigh => "greatest v",
            Self::ULow => "least u",
        })
    }
}

impl Patch {
    /// A Bezier patch over the unit square; its degrees are one less than the numbers of rows and columns.
    ///
    /// ```
    /// use trisect::parametric::Patch;
    ///
    /// let saddle = Patch::bezier(&[vec![[0.0, 0.0, 0.0], [0.0, 1.0, 1.0]], vec![[1.0, 0.0, 1.0], [1.0, 1.0, 0.0]]])?;
    /// assert_eq!(saddle.point(0.5, 0.5), [0.5, 0.5, 0.5]);
    /// # Ok::<(), trisect::parametric::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// [`GeometryError::TooFewPoints`] (2 rows of 2 are needed), [`GeometryError::CountMismatch`] for rows of
    /// different length, [`GeometryError::NotFinite`].
    pub fn bezier(rows: &[Vec<[f64; 3]>]) -> Result<Self> {
        let counts = check_grid(rows)?;
        let knots = counts.map(|n| [0.0, 1.0].iter().flat_map(|&knot| vec![knot; n]).collect());
        Ok(Self { degrees: counts.map(|n| n - 1), knots, counts, points: rows.concat(), weights: None })
    }

    /// A B-spline patch with the given degrees and knots along `u` and `v`.
    ///
    /// # Errors
    /// As [`bezier`](Self::bezier), and for each direction those of [`NurbsCurve::bspline`].
    pub fn bspline(degrees: [usize; 2], knots: [&[f64]; 2], rows: &[Vec<[f64; 3]>]) -> Result<Self> {
        let counts = check_grid(rows)?;
        for k in 0..2 {
            knots::check(degrees[k], knots[k], counts[k])?;
        }
        Ok(Self { degrees, knots: knots.map(<[f64]>::to_vec), counts, points: rows.concat(), weights: None })
    }

    /// A rational B-spline patch with one positive weight per control point, in rows as the points.
    ///
    /// # Errors
    /// As [`bspline`](Self::bspline); [`GeometryError::BadWeight`].
    pub fn nurbs(
        degrees: [usize; 2],
        knots: [&[f64]; 2],
        rows: &[Vec<[f64; 3]>],
        weights: &[Vec<f64>],
    ) -> Result<Self> {
        let patch = Self::bspline(degrees, knots, rows)?;
        let ragged = weights.iter().find(|row| row.len() != patch.counts[1]);
        if let Some(row) = ragged {
            let (expected, found) = (patch.counts[1], row.len());
            return Err(GeometryError::CountMismatch { what: "weights of a row", expected, found });
        }
        let weights = weights.concat();
        check_weights(&weights, patch.points.len())?;
        Ok(Self { weights: Some(weights), ..patch })
    }

    /// Degrees along `u` and `v`.
    #[must_use]
    pub fn degrees(&self) -> [usize; 2] {
        self.degrees
    }

    /// Knots along `u` and `v`.
    #[must_use]
    pub fn knots(&self) -> [&[f64]; 2] {
        [&self.knots[0], &self.knots[1]]
    }

    /// Rows of control points.
    pub fn rows(&self) -> impl Iterator<Item = &[[f64; 3]]> {
        self.points.chunks(self.counts[1])
    }

    /// Rows of weights; `None` if the patch is not rational.
    #[must_use]
    pub fn weights(&self) -> Option<impl Iterator<Item = &[f64]>> {
        self.weights.as_ref().map(|weights| weights.chunks(self.counts[1]))
    }

    /// First and last `u`, first and last `v`.
    #[must_use]
    pub fn domain(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|k| knots::domain(self.degrees[k], &self.knots[k]))
    }

    /// The point at `(u, v)`; parameters outside the domain are moved to its border.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> [f64; 3] {
        self.derivatives(u, v, 0)[0][0]
    }

    /// Partial derivatives: `result[k][l]` is the k-th with respect to `u` and l-th to `v`, for `k + l <= order`
    /// (Piegl and Tiller, algorithms A3.6 and A4.4).
    #[must_use]
    pub fn derivatives(&self, u: f64, v: f64, order: usize) -> Vec<Vec<[f64; 3]>> {
        let domain = self.domain();
        let at = [clamped(u, domain[0]), clamped(v, domain[1])];
        let spans = [0, 1].map(|k| knots::span(self.degrees[k], &self.knots[k], at[k]));
        let [bu, bv] =
            [0, 1].map(|k| knots::basis_derivatives(self.degrees[k], &self.knots[k], spans[k], at[k], order));
        let first = [0, 1].map(|k| spans[k] - self.degrees[k]);
        let mut numerator = vec![vec![[0.0; 3]; order + 1]; order + 1];
        let mut weight = vec![vec![0.0; order + 1]; order + 1];
        for k in 0..=order {
            for l in 0..=order - k {
                for (i, bu) in bu[k].iter().enumerate() {
                    for (j, bv) in bv[l].iter().enumerate() {
                        let index = (first[0] + i) * self.counts[1] + first[1] + j;
                        let w = bu * bv * self.weights.as_ref().map_or(1.0, |weights| weights[index]);
                        numerator[k][l] = vector::add_scaled(numerator[k][l], self.points[index], w);
                        weight[k][l] += w;
                    }
                }
            }
        }
        if self.weights.is_some() { quotient(&numerator, &weight, order) } else { trimmed(numerator, order) }
    }

    /// The unit normal, the direction of `S_u x S_v`. At degenerate edges and poles its limit from inside; `None`
    /// where the patch has no normal (it is a curve or a point there).
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<[f64; 3]> {
        let [[u0, u1], [v0, v1]] = self.domain();
        let (u, v) = (clamped(u, [u0, u1]), clamped(v, [v0, v1]));
        let (width, height) = (u1 - u0, v1 - v0);
        // Towards the middle of the patch, in steps that first see a vanishing derivative only.
        for step in [0.0, 1e-7, 1e-4] {
            let at = [u + step * (0.5 * (u0 + u1) - u), v + step * (0.5 * (v0 + v1) - v)];
            let d = self.derivatives(at[0], at[1], 1);
            let (du, dv) = (DVec3::from(d[1][0]) * width, DVec3::from(d[0][1]) * height);
            let longest = du.length().max(dv.length());
            let shortest = du.length().min(dv.length());
            // At a pole one of the derivatives vanishes; a step away it is as small as the step, but has a direction.
            if shortest > 1e-12 * longest || (step > 0.0 && shortest > 0.0) {
                let normal = du.normalize().cross(dv.normalize());
                if normal.length() > 1e-6 {
                    return Some(normal.normalize().to_array());
                }
            }
        }
        None
    }

    /// The boundary curve along a side, over the patch's own parameter.
    #[must_use]
    pub fn boundary(&self, side: PatchSide) -> NurbsCurve<3> {
        let along = if matches!(side, PatchSide::VLow | PatchSide::VHigh) { 0 } else { 1 };
        let across = 1 - along;
        let end = self.domain()[across][usize::from(matches!(side, PatchSide::VHigh | PatchSide::UHigh))];
        // Clamped knots put the boundary into the first or last row; other knots need the basis.
        let span = knots::span(self.degrees[across], &self.knots[across], end);
        let basis = knots::basis_derivatives(self.degrees[across], &self.knots[across], span, end, 0);
        let first = span - self.degrees[across];
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for i in 0..self.counts[along] {
            let (mut point, mut weight) = ([0.0; 3], 0.0);
            for (j, &value) in basis[0].iter().enumerate() {
                let (row, column) = if along == 0 { (i, first + j) } else { (first + j, i) };
                let index = row * self.counts[1] + column;
                let w = value * self.weights.as_ref().map_or(1.0, |weights| weights[index]);
                point = vector::add_scaled(point, self.points[index], w);
                weight += w;
            }
            // A weight of 1 stays exact, so equal control points of neighbours give equal curves.
            points.push(if weight == 1.0 { point } else { vector::scale(point, 1.0 / weight) });
            weights.push(weight);
        }
        let rational = self.weights.is_some().then_some(weights);
        NurbsCurve::trusted(self.degrees[along], self.knots[along].clone(), points, rational)
    }

    /// The patch facing the other way: `u` runs backwards.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let [start, end] = self.domain()[0];
        let knots_u = self.knots[0].iter().rev().map(|&k| start + (end - k)).collect();
        let flip = |i: usize| {
            let (row, column) = (i / self.counts[1], i % self.counts[1]);
            (self.counts[0] - 1 - row) * self.counts[1] + column
        };
        let order = 0..self.points.len();
        Self {
            degrees: self.degrees,
            knots: [knots_u, self.knots[1].clone()],
            counts: self.counts,
            points: order.clone().map(|i| self.points[flip(i)]).collect(),
            weights: self.weights.as_ref().map(|weights| order.map(|i| weights[flip(i)]).collect()),
        }
    }

    /// The patch moved by an affine map: `matrix` rows times the point, plus `offset`.
    #[must_use]
    pub fn transformed(&self, matrix: [[f64; 3]; 3], offset: [f64; 3]) -> Self {
        let image = |p: &Point<3>| std::array::from_fn(|i| vector::dot(matrix[i], *p) + offset[i]);
        Self { points: self.points.iter().map(image).collect(), ..self.clone() }
    }

    /// Lower and upper corner of the control points' box, which contains the patch.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        vector::bounding_box(self.points.iter().copied()).unwrap_or([[0.0; 3]; 2])
    }

    /// The patch's share of the volume it encloses together with others (a third of the flux of the position
    /// vector): exact up to rounding for polynomial patches. Summed over the patches of a closed surface that face
    /// outwards it is the enclosed volume.
    #[must_use]
    pub fn volume_share(&self) -> f64 {
        let nodes = if self.weights.is_none() { self.degrees.map(|p| 3 * p / 2 + 1) } else { [24, 24] };
        let rules = nodes.map(gauss_legendre);
        let spans = [0, 1].map(|k| knots::distinct(self.degrees[k], &self.knots[k]));
        let mut sum = 0.0;
        for us in spans[0].windows(2) {
            for vs in spans[1].windows(2) {
                for [x, wx] in &rules[0] {
                    for [y, wy] in &rules[1] {
                        let d =
                            self.derivatives(vector::mix(us[0], us[1], *x), vector::mix(vs[0], vs[1], *y), 1);
                        let [place, along_u, along_v] = [d[0][0], d[1][0], d[0][1]].map(DVec3::from);
                        let flux = place.dot(along_u.cross(along_v));
                        sum += flux * wx * wy * (us[1] - us[0]) * (vs[1] - vs[0]);
                    }
                }
            }
        }
        sum / 3.0
    }
}

/// Numbers of rows and columns of a sound grid of control points.
fn check_grid(rows: &[Vec<Point<3>>]) -> Result<[usize; 2]> {
    let columns = rows.first().map_or(0, Vec::len);
    if rows.len() < 2 || columns < 2 {
        let found = rows.len().min(columns);
        return Err(GeometryError::TooFewPoints { what: "each direction of a patch", needed: 2, found });
    }
    for row in rows {
        if row.len() != columns {
            let found = row.len();
            return Err(GeometryError::CountMismatch { what: "points of a row", expected: columns, found });
        }
    }
    check_points("patch", &rows.concat())?;
    Ok([rows.len(), columns])
}

/// Only the entries with `k + l <= order`.
fn trimmed(mut table: Vec<Vec<Point<3>>>, order: usize) -> Vec<Vec<Point<3>>> {
    for (k, row) in table.iter_mut().enumerate() {
        row.truncate(order + 1 - k);
    }
    table
}

/// Derivatives of `A / w` from those of `A` and `w` (Piegl and Tiller, equation 4.20).
fn quotient(numerator: &[Vec<Point<3>>], weight: &[Vec<f64>], order: usize) -> Vec<Vec<Point<3>>> {
    let mut result: Vec<Vec<Point<3>>> = vec![Vec::new(); order + 1];
    for k in 0..=order {
        for l in 0..=order - k {
            let mut value = numerator[k][l];
            for i in 0..=k {
                for j in 0..=l {
                    if i + j > 0 {
                        let factor = binomial(k, i) * binomial(l, j) * weight[i][j];
                        value = vector::add_scaled(value, result[k - i][l - j], -factor);
                    }
                }
            }
            result[k].push(vector::scale(value, 1.0 / weight[0][0]));
        }
    }
    result
}

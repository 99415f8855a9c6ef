//! Two curves joined into one of the same degree (Ganchuk 2024).
//!
//! Of curves P and Q of degree n, which need not meet, changed ones P~ = sum (P_i + e_i) N_i and
//! Q~ = sum (Q_i + d_i) N_i are wanted whose derivatives of every order agree at the joint, so that one curve R of degree
//! n replaces both without error: P~(u) = R(mu u), Q~(v) = R(mu + (1 - mu) v). Among them the one nearest to P and Q.
//!
//! The paper solves for e, d and Lagrange multipliers. Here the joint conditions are eliminated first: they hold exactly
//! if P~ and Q~ are the two parts of one R, so its control points are the unknowns, e = A R - P and d = B R - Q with the
//! matrices A and B of the split at mu. What is left, a least-squares problem with the remaining constraints, has the
//! same solution and is far better conditioned than the multipliers' system, whose joint rows grow like n!.
//!
//! B-splines join in the same way: R has the knots of both and none at the joint.

use nalgebra::DMatrix;

use super::constraints::{Constraints, solve_within, stacked};
use super::metric::{JoinMetric, basis_at, gram, root};
use super::report::{JoinReport, largest_norm};
use crate::parametric::curve::bezier::Bezier;
use crate::parametric::curve::nurbs::NurbsCurve;
use crate::parametric::curve::nurbs_tools::{elevated, rescaled_to_unit};
use crate::parametric::curve::param_curve::Curve;
use crate::parametric::error::{GeometryError, Result};
use crate::parametric::numeric::gauss::gauss_legendre;
use crate::parametric::numeric::vector::{self, Point};

/// One of the two curves to be joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JoinInput {
    /// The first, P.
    First,
    /// The second, Q.
    Second,
}

/// Where on the joined curve, over 0..1, the joint comes to lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointAt {
    /// At the given parameter, between 0 and 1.
    Parameter(f64),
    /// Where the lengths of the two curves divide the whole.
    Lengths,
    /// Where the metric is least, to about six digits.
    Best,
}

/// How to join two curves.
///
/// ```
/// use trisect::parametric::{Bezier, Curve, CurveJoin};
///
/// let p = Bezier::new(&[[0.0, 0.0], [3.0, 4.0], [6.0, 4.0], [10.0, 1.0]])?;
/// let q = Bezier::new(&[[10.0, 1.5], [14.0, -2.0], [17.0, -3.0], [20.0, 0.0]])?;
/// let joined = CurveJoin::new().fix_ends().join(&p, &q)?;
/// assert_eq!(joined.curve.degree(), 3);
/// let start = joined.curve.point(0.0);
/// assert!(start[0].abs() < 1e-12 && start[1].abs() < 1e-12);
/// # Ok::<(), trisect::parametric::GeometryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CurveJoin {
    metric: JoinMetric,
    keep: Option<JoinInput>,
    fixed_ends: bool,
    kept_at: Vec<(JoinInput, f64, usize)>,
    joint: JointAt,
    degree: usize,
}

/// Two Bezier curves joined into one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Joined<const D: usize> {
    /// The one curve, over 0..1.
    pub curve: Bezier<D>,
    /// Its parts, the changed curves P~ and Q~.
    pub parts: [Bezier<D>; 2],
    /// How near it is and what holds.
    pub report: JoinReport,
}

/// Two B-splines joined into one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct JoinedSpline<const D: usize> {
    /// The one spline, over 0..1, without a knot at the joint.
    pub curve: NurbsCurve<D>,
    /// Its parts, the changed curves P~ and Q~, each over 0..1.
    pub parts: [NurbsCurve<D>; 2],
    /// How near it is and what holds.
    pub report: JoinReport,
}

impl Default for CurveJoin {
    fn default() -> Self {
        Self {
            metric: JoinMetric::default(),
            keep: None,
            fixed_ends: false,
            kept_at: Vec::new(),
            joint: JointAt::Parameter(0.5),
            degree: 0,
        }
    }
}

impl CurveJoin {
    /// The integral metric, no constraints, the joint in the middle.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Minimises the given metric.
    #[must_use]
    pub fn metric(mut self, metric: JoinMetric) -> Self {
        self.metric = metric;
        self
    }

    /// Leaves one of the curves as it is (e = 0 or d = 0); the other continues it.
    #[must_use]
    pub fn keep(mut self, input: JoinInput) -> Self {
        self.keep = Some(input);
        self
    }

    /// Leaves the start of P and the end of Q where they are.
    #[must_use]
    pub fn fix_ends(mut self) -> Self {
        self.fixed_ends = true;
        self
    }

    /// Keeps the position (order 0) and the derivatives up to `order` of a curve at a parameter of its own.
    #[must_use]
    pub fn keep_at(mut self, input: JoinInput, parameter: f64, order: usize) -> Self {
        self.kept_at.push((input, parameter, order));
        self
    }

    /// Puts the joint elsewhere than at 0.5.
    #[must_use]
    pub fn joint(mut self, joint: JointAt) -> Self {
        self.joint = joint;
        self
    }

    /// Raises both curves at least to `degree` first, for more freedom. (The lower degree is raised to the higher in
    /// any case.)
    #[must_use]
    pub fn degree(mut self, degree: usize) -> Self {
        self.degree = degree;
        self
    }

    /// Joins two Bezier curves.
    ///
    /// # Errors
    /// [`GeometryError::Contradictory`] with the names of constraints that cannot hold together,
    /// [`GeometryError::OutOfRange`] for a parameter outside its curve or a joint outside 0..1.
    pub fn join<const D: usize>(&self, first: &Bezier<D>, second: &Bezier<D>) -> Result<Joined<D>> {
        let joined = self.join_splines(&first.to_nurbs(), &second.to_nurbs())?;
        let bezier = |curve: &NurbsCurve<D>| Bezier::trusted(curve.control().to_vec());
        let parts = [bezier(&joined.parts[0]), bezier(&joined.parts[1])];
        Ok(Joined { curve: bezier(&joined.curve), parts, report: joined.report })
    }

    /// Joins two B-splines: the joined one has the inner knots of both and none at the joint. Constraints are given at
    /// the splines' own parameters; metrics are taken over 0..1.
    ///
    /// # Errors
    /// As [`join`](Self::join); [`GeometryError::Degenerate`] for rational curves, which the method does not cover.
    pub fn join_splines<const D: usize>(
        &self,
        first: &NurbsCurve<D>,
        second: &NurbsCurve<D>,
    ) -> Result<JoinedSpline<D>> {
        if first.weights().is_some() || second.weights().is_some() {
            return Err(GeometryError::Degenerate {
                what: "join",
                reason: "rational curves cannot be joined",
            });
        }
        for &(input, parameter, _) in &self.kept_at {
            let [start, end] = if input == JoinInput::First { first.domain() } else { second.domain() };
            if !(parameter >= start && parameter <= end) {
                let range = "in the domain of its curve";
                return Err(GeometryError::OutOfRange {
                    what: "parameter of a constraint",
                    value: parameter,
                    range,
                });
            }
        }
        let degree = first.degree().max(second.degree()).max(self.degree);
        let lengths = [first.domain(), second.domain()].map(|[start, end]| end - start);
        let starts = [first.domain()[0], second.domain()[0]];
        let inputs = [first, second].map(|curve| elevated(&rescaled_to_unit(curve), degree));
        let problem = Problem { settings: self, inputs, starts, lengths };
        match self.joint {
            JointAt::Parameter(mu) => problem.solve(mu),
            JointAt::Lengths => problem.solve(problem.joint_by_lengths()),
            JointAt::Best => problem.solve_best(),
        }
    }
}

/// The curves over 0..1 with one degree, and how their own parameters ran.
struct Problem<'a, const D: usize> {
    settings: &'a CurveJoin,
    inputs: [NurbsCurve<D>; 2],
    starts: [f64; 2],
    lengths: [f64; 2],
}

impl<const D: usize> Problem<'_, D> {
    fn joint_by_lengths(&self) -> f64 {
        let [a, b] = [0, 1].map(|k| arc_length(&self.inputs[k]));
        if a + b > 0.0 { (a / (a + b)).clamp(1e-3, 1.0 - 1e-3) } else { 0.5 }
    }

    /// The joint with the least metric: a scan, then golden sections around the best.
    fn solve_best(&self) -> Result<JoinedSpline<D>> {
        /// Joints tried over 0..1, evenly, before the golden sections.
        const SCAN: u32 = 48;
        let metric = |mu: f64| match self.solve(mu) {
            Ok(joined) => joined.report.metric(self.settings.metric),
            Err(_) => f64::INFINITY,
        };
        let at = |k: u32| f64::from(k) / f64::from(SCAN + 1);
        let best = (1..=SCAN).min_by(|&i, &j| metric(at(i)).total_cmp(&metric(at(j)))).unwrap_or(SCAN / 2);
        let (mut low, mut high) = (at(best - 1), at(best + 1));
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        while high - low > 1e-7 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if metric(a) <= metric(b) { high = b } else { low = a }
        }
        self.solve(0.5 * (low + high))
    }

    fn solve(&self, mu: f64) -> Result<JoinedSpline<D>> {
        if !(mu > 0.0 && mu < 1.0) {
            let range = "more than 0 and less than 1";
            return Err(GeometryError::OutOfRange { what: "joint", value: mu, range });
        }
        let joined_knots = self.joined_knots(mu);
        let [a, b] = self.splits(&joined_knots, mu);
        let points = [0, 1].map(|k| to_matrix(self.inputs[k].control()));
        let size = vector::extent(&[self.inputs[0].control(), self.inputs[1].control()].concat());
        let constraints = self.constraints([&a, &b], &points);
        let found = constraints.independent(size)?;
        // Rows of the least-squares problem, weighted by a root of the metric's matrix.
        let roots = [0, 1].map(|k| match self.settings.metric {
            JoinMetric::Discrete => DMatrix::identity(points[k].nrows(), points[k].nrows()),
            JoinMetric::Integral => root(&gram(&self.inputs[k])),
        });
        let rows = stacked(&(&roots[0] * &a), &(&roots[1] * &b));
        let right = stacked(&(&roots[0] * &points[0]), &(&roots[1] * &points[1]));
        let solution = solve_within(&found.rows, &found.right, &rows, &right);
        let p = self.inputs[0].degree();
        let curve = NurbsCurve::trusted(p, joined_knots, to_points(&solution), None);
        let changed = [&a * &solution, &b * &solution];
        let part =
            |k: usize| NurbsCurve::trusted(p, self.inputs[k].knots().to_vec(), to_points(&changed[k]), None);
        let parts = [part(0), part(1)];
        let differences = [0, 1].map(|k| &changed[k] - &points[k]);
        let report = JoinReport {
            joint: mu,
            discrete: differences.iter().map(DMatrix::norm_squared).sum(),
            integral: (0..2).map(|k| (root(&gram(&self.inputs[k])) * &differences[k]).norm_squared()).sum(),
            largest_deviation: [0, 1].map(|k| {
                let knots = self.inputs[k].knots().to_vec();
                largest_norm(&NurbsCurve::<D>::trusted(p, knots, to_points(&differences[k]), None))
            }),
            freedom: solution.nrows() - found.rows.nrows(),
            constraints: constraints.report(&solution, &found, size),
        };
        Ok(JoinedSpline { curve, parts, report })
    }

    /// Knots of the joined curve: both knot vectors end to end, without any at the joint.
    fn joined_knots(&self, mu: f64) -> Vec<f64> {
        let p = self.inputs[0].degree();
        let [first, second] = [0, 1].map(|k| self.inputs[k].knots());
        let mut knots: Vec<f64> = first[..first.len() - p - 1].iter().map(|k| k * mu).collect();
        knots.extend(second[p + 1..].iter().map(|k| vector::mix(mu, 1.0, *k)));
        knots
    }

    /// The matrices that take the joined curve's control points to those of its two parts.
    fn splits(&self, joined_knots: &[f64], mu: f64) -> [DMatrix<f64>; 2] {
        let p = self.inputs[0].degree();
        let counts = [0, 1].map(|k| self.inputs[k].control().len());
        let unknowns = joined_knots.len() - p - 1;
        let mut matrices = counts.map(|rows| DMatrix::zeros(rows, unknowns));
        for column in 0..unknowns {
            let unit = (0..unknowns).map(|i| [if i == column { 1.0 } else { 0.0 }]).collect();
            let mut basis = NurbsCurve::<1>::trusted(p, joined_knots.to_vec(), unit, None);
            while let Ok(finer) = basis.with_knot(mu) {
                basis = finer;
            }
            // The control point at the joint belongs to both parts.
            for (row, value) in basis.control()[..counts[0]].iter().enumerate() {
                matrices[0][(row, column)] = value[0];
            }
            for (row, value) in basis.control()[counts[0] - 1..].iter().enumerate() {
                matrices[1][(row, column)] = value[0];
            }
        }
        matrices
    }

    /// All constraints as rows on the joined curve's control points.
    fn constraints(&self, splits: [&DMatrix<f64>; 2], points: &[DMatrix<f64>; 2]) -> Constraints {
        let mut constraints = Constraints::default();
        let index = |input: JoinInput| usize::from(input == JoinInput::Second);
        let letter = |input: JoinInput| if input == JoinInput::First { "P" } else { "Q" };
        if let Some(input) = self.settings.keep {
            let k = index(input);
            let name = format!("{} kept whole", letter(input));
            constraints.add(name, splits[k], &points[k]);
        }
        if self.settings.fixed_ends {
            let row =
                |k: usize, i: usize| (splits[k].rows(i, 1).into_owned(), points[k].rows(i, 1).into_owned());
            let (rows, right) = row(0, 0);
            constraints.add("start of P fixed".into(), &rows, &right);
            let (rows, right) = row(1, points[1].nrows() - 1);
            constraints.add("end of Q fixed".into(), &rows, &right);
        }
        for &(input, parameter, order) in &self.settings.kept_at {
            let k = index(input);
            let curve = &self.inputs[k];
            let unit = ((parameter - self.starts[k]) / self.lengths[k]).clamp(0.0, 1.0);
            let (first, basis) = basis_at(curve, unit, order.min(curve.degree()));
            for (r, values) in basis.into_iter().enumerate() {
                let mut row = DMatrix::zeros(1, points[k].nrows());
                for (j, value) in values.into_iter().enumerate() {
                    row[(0, first + j)] = value;
                }
                let what = if r == 0 { "position".into() } else { format!("derivative {r}") };
                let name = format!("{what} of {} at {parameter}", letter(input));
                constraints.add(name, &(&row * splits[k]), &(&row * &points[k]));
            }
        }
        constraints
    }
}

fn arc_length<const D: usize>(curve: &NurbsCurve<D>) -> f64 {
    let rule = gauss_legendre(16);
    let piece = |ends: &[f64]| -> f64 {
        let speed = |x: f64| vector::norm(curve.derivatives(vector::mix(ends[0], ends[1], x), 1)[1]);
        rule.iter().map(|[x, weight]| weight * (ends[1] - ends[0]) * speed(*x)).sum()
    };
    curve.breaks().windows(2).map(piece).sum()
}

fn to_matrix<const D: usize>(points: &[Point<D>]) -> DMatrix<f64> {
    DMatrix::from_fn(points.len(), D, |i, j| points[i][j])
}

fn to_points<const D: usize>(matrix: &DMatrix<f64>) -> Vec<Point<D>> {
    (0..matrix.nrows()).map(|i| std::array::from_fn(|j| matrix[(i, j)])).collect()
}

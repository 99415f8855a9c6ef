//! Curves as polygons within a stated distance: **nonuniform-curve-mesh** (Choporov 2017).
//!
//! The distance is not sampled but bounded: a part of a curve lies in the convex hull of its control polygon, and
//! the distance to a straight edge is a convex function, so its greatest value over the part is at most its
//! greatest value over the polygon's points. Where that does not decide, the part is split against the same edge;
//! polygons close up on their curve quadratically, so a few splits settle all but the closest cases, and those
//! count as too far.

use super::param_curve::Curve;
use crate::parametric::error::{GeometryError, Result, check_positive};
use crate::parametric::numeric::vector::{self, Point};

/// How parameters of new nodes are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Refinement {
    /// As many nodes as the tolerance needs and hardly more: parameters are placed so that all edges deviate
    /// about equally. Halving the tolerance takes about 1.41 times the edges.
    #[default]
    Levelled,
    /// The paper's rule: an edge that deviates too far is replaced by its two halves in the parameter.
    Halving,
}

/// Settings of a curve mesh: a tolerance, initial nodes, how to refine.
///
/// ```
/// use trisect::parametric::{CurveMeshing, EllipticArc};
///
/// let circle = EllipticArc::circle([0.0, 0.0], 1.0)?;
/// let polygon = CurveMeshing::new(0.01).mesh(&circle)?;
/// assert_eq!(polygon.points.len(), 24);
/// assert_eq!(polygon.points.first(), polygon.points.last());
/// # Ok::<(), trisect::parametric::GeometryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CurveMeshing {
    tolerance: f64,
    initial_nodes: usize,
    refinement: Refinement,
    most_nodes: usize,
}

/// A curve as a polygon: nodes in order, the first repeated at the end (bit for bit) if the curve is closed.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveMesh<const D: usize> {
    /// Parameters of the nodes, ascending.
    pub parameters: Vec<f64>,
    /// The nodes, points of the curve.
    pub points: Vec<[f64; D]>,
}

impl CurveMeshing {
    /// A mesh that deviates from the curve by no more than `tolerance` (in the units of the coordinates): every
    /// point of the curve between two nodes is that near to their edge, and the edge to the curve.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, initial_nodes: 2, refinement: Refinement::default(), most_nodes: 10_000_000 }
    }

    /// At least these many nodes at equal parameter steps, to begin with (2 or more).
    #[must_use]
    pub fn initial_nodes(mut self, count: usize) -> Self {
        self.initial_nodes = count;
        self
    }

    /// How to refine.
    #[must_use]
    pub fn refinement(mut self, refinement: Refinement) -> Self {
        self.refinement = refinement;
        self
    }

    /// Refuse to make more nodes than this.
    #[must_use]
    pub fn most_nodes(mut self, count: usize) -> Self {
        self.most_nodes = count;
        self
    }

    /// The polygon. It has the initial nodes, a node at every corner of the curve, and nodes between them where
    /// the tolerance asks for them. The same input gives the same bits.
    ///
    /// # Errors
    /// [`GeometryError::OutOfRange`] for a tolerance that is not positive or fewer than 2 initial nodes,
    /// [`GeometryError::ToleranceTooSmall`], [`GeometryError::TooManyNodes`].
    pub fn mesh<const D: usize>(&self, curve: &dyn Curve<D>) -> Result<CurveMesh<D>> {
        check_positive("tolerance", self.tolerance)?;
        if self.initial_nodes < 2 {
            let value = self.initial_nodes as f64;
            return Err(GeometryError::OutOfRange {
                what: "number of initial nodes",
                value,
                range: "2 or more",
            });
        }
        let [low, high] = curve.bounds();
        check_resolvable(self.tolerance, &[low, high])?;
        let refiner =
            Refiner { curve, breaks: curve.breaks(), tolerance: self.tolerance, most_nodes: self.most_nodes };
        let fixed = self.fixed_parameters(curve);
        let parameters = match self.refinement {
            Refinement::Halving => refiner.halved(&fixed, self.tolerance)?,
            Refinement::Levelled => refiner.levelled(&fixed)?,
        };
        let points = parameters.iter().map(|&t| curve.point(t)).collect();
        Ok(CurveMesh { parameters, points })
    }

    /// Initial nodes and corners; initial nodes within rounding of a corner give way to it.
    fn fixed_parameters<const D: usize>(&self, curve: &dyn Curve<D>) -> Vec<f64> {
        let [start, end] = curve.domain();
        let near = 1e-9 * (end - start);
        let corners = curve.corners();
        let steps = self.initial_nodes - 1;
        let mut fixed: Vec<f64> = (1..steps)
            .map(|i| vector::mix(start, end, i as f64 / steps as f64))
            .filter(|t| {
                let after = corners.partition_point(|c| c < t);
                let neighbours = &corners[after.saturating_sub(1)..corners.len().min(after + 1)];
                neighbours.iter().all(|corner| (corner - t).abs() > near)
            })
            .chain(corners.iter().copied())
            .chain([start, end])
            .collect();
        fixed.sort_by(f64::total_cmp);
        fixed.dedup();
        fixed
    }
}

/// Refuses tolerances below what coordinates of this size can resolve.
pub(crate) fn check_resolvable<const D: usize>(tolerance: f64, corners: &[Point<D>]) -> Result<()> {
    let largest = corners.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let smallest = 1e-14 * largest;
    if tolerance < smallest { Err(GeometryError::ToleranceTooSmall { tolerance, smallest }) } else { Ok(()) }
}

/// Halvings before an undecided edge counts as too far: each brings the control polygon four times closer to the curve,
/// all of them 4096 times.
const DECISION_DEPTH: u32 = 6;

struct Refiner<'a, const D: usize> {
    curve: &'a dyn Curve<D>,
    breaks: Vec<f64>,
    tolerance: f64,
    most_nodes: usize,
}

impl<const D: usize> Refiner<'_, D> {
    /// Whether the curve between `a` and `b` may leave the edge between its points there by more than `tolerance`.
    fn deviates(&self, a: f64, b: f64, tolerance: f64) -> bool {
        let edge = [self.curve.point(a), self.curve.point(b)];
        let mut polygon = Vec::new();
        split_at_breaks(&self.breaks, a, b)
            .any(|[s, t]| part_deviates(self.curve, [s, t], edge, tolerance, DECISION_DEPTH, &mut polygon))
    }

    /// Halves edges until none deviates.
    fn halved(&self, fixed: &[f64], tolerance: f64) -> Result<Vec<f64>> {
        let mut nodes = vec![fixed[0]];
        let mut pending: Vec<f64> = Vec::new();
        for pair in fixed.windows(2) {
            pending.push(pair[1]);
            let mut start = pair[0];
            while let Some(&end) = pending.last() {
                if self.deviates(start, end, tolerance) {
                    let middle = 0.5 * (start + end);
                    if !(start < middle && middle < end) {
                        return Err(self.exhausted());
                    }
                    pending.push(middle);
                } else {
                    pending.pop();
                    nodes.push(end);
                    start = end;
                }
                if nodes.len() + pending.len() > self.most_nodes {
                    return Err(self.exhausted());
                }
            }
        }
        Ok(nodes)
    }

    fn exhausted(&self) -> GeometryError {
        GeometryError::TooManyNodes { what: "curve mesh", limit: self.most_nodes }
    }

    /// Places nodes between the fixed ones so that all edges deviate about equally: the deviation of a short edge
    /// grows with the square of its length, so a fine mesh by halving tells how many edges each of its parts is
    /// worth, and the new nodes cut the running sum of that worth into equal shares.
    fn levelled(&self, fixed: &[f64]) -> Result<Vec<f64>> {
        let mut nodes = vec![fixed[0]];
        for pair in fixed.windows(2) {
            if !self.deviates(pair[0], pair[1], self.tolerance) {
                nodes.push(pair[1]);
                continue;
            }
            let probe = self.halved(pair, self.tolerance / 4.0)?;
            let mut worth = vec![0.0];
            for edge in probe.windows(2) {
                let part = (self.sampled_deviation(edge[0], edge[1]) / self.tolerance).sqrt();
                worth.push(worth[worth.len() - 1] + part);
            }
            let total = worth[worth.len() - 1];
            let least = (total - 1e-9).ceil().max(2.0) as usize;
            let attempts = (least..=least + 2 + least / 16)
                .map(|count| divide_equally(&probe, &worth, count))
                .find(|inner| self.all_within(pair, inner));
            let inner = match attempts {
                Some(inner) => inner,
                // What the estimate does not see is left to halving.
                None => {
                    let mut start = divide_equally(&probe, &worth, least);
                    start.insert(0, pair[0]);
                    start.push(pair[1]);
                    let halved = self.halved(&start, self.tolerance)?;
                    halved[1..halved.len() - 1].to_vec()
                }
            };
            nodes.extend(inner);
            nodes.push(pair[1]);
            if nodes.len() > self.most_nodes {
                return Err(self.exhausted());
            }
        }
        Ok(nodes)
    }

    fn all_within(&self, ends: &[f64], inner: &[f64]) -> bool {
        let mut start = ends[0];
        for &end in inner.iter().chain([&ends[1]]) {
            if start >= end || self.deviates(start, end, self.tolerance) {
                return false;
            }
            start = end;
        }
        true
    }

    fn sampled_deviation(&self, a: f64, b: f64) -> f64 {
        let edge = [self.curve.point(a), self.curve.point(b)];
        [0.25, 0.5, 0.75]
            .iter()
            .map(|&w| vector::distance_to_segment(self.curve.point(vector::mix(a, b, w)), edge[0], edge[1]))
            .fold(0.0, f64::max)
    }
}

/// Parameters that cut the running sum `worth` over the `probe` into `count` equal shares.
fn divide_equally(probe: &[f64], worth: &[f64], count: usize) -> Vec<f64> {
    let total = worth[worth.len() - 1];
    (1..count)
        .map(|k| {
            let target = total * k as f64 / count as f64;
            let i = worth.partition_point(|&w| w <= target).clamp(1, worth.len() - 1) - 1;
            let width = worth[i + 1] - worth[i];
            let local = if width > 0.0 { ((target - worth[i]) / width).clamp(0.0, 1.0) } else { 0.5 };
            vector::mix(probe[i], probe[i + 1], local)
        })
        .collect()
}

/// The parts of `a..b` between consecutive breaks.
pub(crate) fn split_at_breaks(breaks: &[f64], a: f64, b: f64) -> impl Iterator<Item = [f64; 2]> {
    let first = breaks.partition_point(|&t| t <= a).max(1) - 1;
    breaks[first..]
        .windows(2)
        .take_while(move |piece| piece[0] < b)
        .map(move |piece| [piece[0].max(a), piece[1].min(b)])
        .filter(|part| part[0] < part[1])
}

/// Whether the analytic part `[a, b]` of a curve may leave `edge` by more than `tolerance`.
pub(crate) fn part_deviates<const D: usize>(
    curve: &dyn Curve<D>,
    [a, b]: [f64; 2],
    edge: [Point<D>; 2],
    tolerance: f64,
    depth: u32,
    polygon: &mut Vec<Point<D>>,
) -> bool {
    polygon.clear();
    curve.control_polygon(a, b, polygon);
    let beyond = |p: &Point<D>| vector::distance_to_segment(*p, edge[0], edge[1]) > tolerance;
    if !polygon.iter().any(beyond) {
        return false;
    }
    // The first and last points are on the curve.
    if polygon.first().is_some_and(beyond) || polygon.last().is_some_and(beyond) || depth == 0 {
        return true;
    }
    let middle = 0.5 * (a + b);
    part_deviates(curve, [a, middle], edge, tolerance, depth - 1, polygon)
        || part_deviates(curve, [middle, b], edge, tolerance, depth - 1, polygon)
}

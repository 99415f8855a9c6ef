//! The intersection curve: chains of points on both surfaces.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};

use super::meetings::{Layer, Meeting};
use super::operand::Operand;

/// A chain of the curve.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    /// Points on both surfaces; a closed chain does not repeat its first one.
    pub(super) points: Vec<DVec3>,
    /// Vertices of the exact result, in the same order.
    pub(super) vertices: Vec<u32>,
    /// For each stretch between points the surfaces that meet there.
    pub(super) layers: Vec<[Layer; 2]>,
    pub(super) closed: bool,
    /// Length of the chain up to each point, and in all.
    pub(super) lengths: Vec<f64>,
    /// Points that must stay: ends, turns, and where a crease comes in.
    pub(super) features: Vec<usize>,
    /// The smallest sine of the angle between the surfaces.
    pub(super) crossing: f64,
}

/// Rounds of the polish; each squares the error.
const ROUNDS: usize = 3;
/// A chain turns sharply where its direction changes by more than 30 degrees, here as a cosine.
const TURN: f64 = 0.866;

/// The point of a chain nearest to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// The length of the chain up to there.
    pub(super) length: f64,
    pub(super) point: DVec3,
    /// The direction of the chain; zero if none of it was within reach.
    pub(super) along: DVec3,
    /// The number of the stretch.
    pub(super) stretch: usize,
}

/// A point of both surfaces near `x` in the plane across `along`: the point of both tangent planes, again and again. And the
/// sine of the angle between them. Where they are nearly one, or the way is longer than `most`, `x` stays.
pub(super) fn polished(
    operands: &[Operand],
    layers: [Layer; 2],
    x: DVec3,
    along: DVec3,
    most: f64,
) -> (DVec3, f64) {
    let mut point = x;
    let mut sine = 1.0;
    for _ in 0..ROUNDS {
        let [a, b] =
            layers.map(|layer| operands[usize::from(layer.operand)].foot(point, Some(layer.triangle)));
        let (Some(a), Some(b)) = (a, b) else {
            return (x, sine);
        };
        let across = a.normal.cross(b.normal);
        sine = across.length();
        let determinant = across.dot(along);
        // Under three degrees between the surfaces, or a plane along the curve: no point to be had.
        if sine < 0.05 || determinant.abs() < 0.3 * sine {
            return (x, sine);
        }
        let (ha, hb, hc) = (a.normal.dot(a.position), b.normal.dot(b.position), along.dot(x));
        let sum = b.normal.cross(along) * ha + along.cross(a.normal) * hb + across * hc;
        point = sum / determinant;
        if !(point.distance(x) <= most) {
            return (x, sine);
        }
    }
    (point, sine)
}

impl Chain {
    /// A chain from vertices of the exact result, polished; ends stay.
    pub(super) fn new(operands: &[Operand], positions: &[[f64; 3]], meeting: Meeting, most: f64) -> Self {
        let Meeting { mut vertices, layers } = meeting;
        let closed = vertices.len() > 3 && vertices.first() == vertices.last();
        if closed {
            vertices.pop();
        }
        let n = vertices.len();
        let at = |i: usize| DVec3::from(positions[vertices[i % n] as usize]);
        let mut crossing = 1.0f64;
        let points: Vec<DVec3> = (0..n)
            .map(|i| {
                let (before, after) = match (closed, i) {
                    (true, _) => (at(i + n - 1), at(i + 1)),
                    (false, 0) => (at(0), at(1)),
                    (false, _) => (at(i - 1), at((i + 1).min(n - 1))),
                };
                let along = (after - before).normalize_or_zero();
                let (point, sine) = polished(operands, layers[i.min(layers.len() - 1)], at(i), along, most);
                crossing = crossing.min(sine);
                point
            })
            .collect();
        let mut chain =
            Self { points, vertices, layers, closed, lengths: Vec::new(), features: Vec::new(), crossing };
        chain.measure();
        chain
    }

    fn measure(&mut self) {
        let mut sum = 0.0;
        self.lengths = vec![0.0];
        let n = self.points.len();
        for i in 1..n + usize::from(self.closed) {
            sum += self.points[i % n].distance(self.points[i - 1]);
            self.lengths.push(sum);
        }
    }

    /// The length of all.
    pub(super) fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Notes as features: both ends of an open chain, the points in `given`, and where it turns.
    pub(super) fn find_features(&mut self, given: impl Fn(u32) -> bool, step: f64) {
        let n = self.points.len();
        self.features = (0..n)
            .filter(|&i| {
                let end = !self.closed && (i == 0 || i + 1 == n);
                end || given(self.vertices[i]) || self.turns(i, step)
            })
            .collect();
        // A turn shows at several points side by side: the sharpest of them stays.
        let mut kept: Vec<usize> = Vec::new();
        for &i in &self.features {
            let own = given(self.vertices[i]) || (!self.closed && (i == 0 || i + 1 == n));
            if let Some(&last) = kept.last()
                && self.lengths[i] - self.lengths[last] < 0.5 * step
            {
                let last_given = given(self.vertices[last]) || (!self.closed && last == 0);
                if last_given && !own {
                    continue;
                }
                if own && !last_given {
                    kept.pop();
                } else if !own {
                    if self.turning(i, step) < self.turning(last, step) {
                        kept.pop();
                    } else {
                        continue;
                    }
                }
            }
            kept.push(i);
        }
        self.features = kept;
    }

    fn turns(&self, i: usize, step: f64) -> bool {
        self.turning(i, step) < TURN
    }

    /// The cosine of the turn at a point, between directions over a quarter of `step` to both sides.
    fn turning(&self, i: usize, step: f64) -> f64 {
        if !self.closed && (i == 0 || i + 1 == self.points.len()) {
            return 1.0;
        }
        let s = self.lengths[i];
        let reach = 0.25 * step;
        let (before, here, after) = (self.at(s - reach), self.points[i], self.at(s + reach));
        (here - before).normalize_or_zero().dot((after - here).normalize_or_zero())
    }

    /// The point at a length along the chain; closed chains go round.
    pub(super) fn at(&self, length: f64) -> DVec3 {
        let total = self.length();
        let s = if self.closed && total > 0.0 { length.rem_euclid(total) } else { length.clamp(0.0, total) };
        let i = self.lengths.partition_point(|&l| l <= s).clamp(1, self.lengths.len() - 1);
        let (low, high) = (self.lengths[i - 1], self.lengths[i]);
        let t = if high > low { (s - low) / (high - low) } else { 0.0 };
        let n = self.points.len();
        self.points[i - 1].lerp(self.points[i % n], t)
    }

    /// Whether two layers of one operand meet.
    pub(super) fn is_of_one(&self) -> bool {
        self.layers.first().is_some_and(|[a, b]| a.operand == b.operand)
    }

    /// The point of the chain nearest to `x`, within `reach` of the length `near`.
    pub(super) fn nearest(&self, x: DVec3, near: f64, reach: f64) -> Near {
        let total = self.length();
        let n = self.points.len();
        let mut best: Option<(f64, Near)> = None;
        for i in 1..self.lengths.len() {
            let mid = 0.5 * (self.lengths[i] + self.lengths[i - 1]);
            let half = 0.5 * (self.lengths[i] - self.lengths[i - 1]);
            let mut apart = (mid - near).abs();
            if self.closed {
                apart %= total;
                apart = apart.min(total - apart);
            }
            if apart > reach + half {
                continue;
            }
            let (p, q) = (self.points[i - 1], self.points[i % n]);
            let along = q - p;
            let t = if along != DVec3::ZERO {
                ((x - p).dot(along) / along.length_squared()).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let point = p + along * t;
            let distance = x.distance_squared(point);
            if best.is_none_or(|(least, _)| distance < least) {
                let length = self.lengths[i - 1] + t * 2.0 * half;
                best = Some((
                    distance,
                    Near { length, point, along: along.normalize_or_zero(), stretch: i - 1 },
                ));
            }
        }
        let none = || Near { length: near, point: self.at(near), along: DVec3::ZERO, stretch: 0 };
        best.map_or_else(none, |(_, found)| found)
    }
}

/// Where three surfaces and more meet, chains end in one point of all of them; where there is none within `most`, in the vertex of the
/// exact result.
pub(super) fn join_ends(operands: &[Operand], chains: &mut [Chain], positions: &[[f64; 3]], most: f64) {
    let mut ends: BTreeMap<u32, Vec<(usize, usize)>> = BTreeMap::new();
    for (c, chain) in chains.iter().enumerate().filter(|(_, chain)| !chain.closed) {
        for i in [0, chain.points.len() - 1] {
            ends.entry(chain.vertices[i]).or_default().push((c, i));
        }
    }
    for (v, ends) in ends {
        let layers_at = |&(c, i): &(usize, usize)| chains[c].layers[i.min(chains[c].layers.len() - 1)];
        let mut layers: Vec<Layer> = ends.iter().flat_map(layers_at).collect();
        layers.sort_by_key(|layer| layer.operand);
        layers.dedup_by(|a, b| {
            let operand = &operands[usize::from(a.operand)];
            a.operand == b.operand && (!operand.crosses_itself || operand.continues(a.triangle, b.triangle))
        });
        if layers.len() < 3 {
            continue;
        }
        let x = DVec3::from(positions[v as usize]);
        let point = common_point(operands, &layers, x).filter(|point| point.distance(x) <= most).unwrap_or(x);
        for (c, i) in ends {
            chains[c].points[i] = point;
            chains[c].measure();
        }
    }
}

/// The point of all tangent planes near `x`, in the sense of least squares, again and again.
fn common_point(operands: &[Operand], layers: &[Layer], x: DVec3) -> Option<DVec3> {
    let mut point = x;
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for layer in layers {
            let foot = operands[usize::from(layer.operand)].foot(point, Some(layer.triangle))?;
            let n = foot.normal;
            normal += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
            right += n * n.dot(foot.position - point);
        }
        // Three planes of which one contains the line of the other two have no point: 3 degrees squared.
        if !(normal.determinant() > 2.5e-3) {
            return None;
        }
        point += normal.inverse() * right;
    }
    Some(point)
}

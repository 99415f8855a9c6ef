//! What the operands' triangles say at the corners of the result: attributes carried over, and where a corner comes from.

use std::sync::OnceLock;

use glam::DVec3;

use super::origins::Origins;
use crate::boolean::complex::origin::Origin;
use crate::boolean::complex::planes::{lie_in_one_plane, look_same_way};
use crate::control::Limit;
use crate::exact::barycentric::nearest_place;
use crate::mesh::{Attribute, CornerPlace, Descent, Run, carry, continues, reach};
use crate::parallel::{Runner, get_or_compute};
use crate::spatial::TriangleTree;
use crate::{Mesh, Solid};

/// Where a corner of a result comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CornerOrigin {
    /// Position of the operand in the argument list.
    pub operand: u32,
    /// Index of the triangle in that operand's mesh.
    pub triangle: u32,
    /// The weights of that triangle's corners, in its order: none negative, their sum 1 (but for rounding). A corner that the
    /// triangle has too has weight 1 there.
    pub weights: [f64; 3],
}

/// The attributes of a result. Nothing is done where no operand has any.
///
/// # Errors
/// Only limits.
pub(crate) fn carried(
    origins: &Origins,
    mesh: &Mesh,
    operands: &[&Solid],
    unit: f64,
    runner: Runner<'_>,
) -> Result<Vec<Attribute>, Limit> {
    if operands.iter().all(|solid| solid.mesh().attributes.is_empty()) {
        return Ok(Vec::new());
    }
    // What comes from no operand, as the cap of a cut at a plane, comes from a mesh of nothing.
    let nothing = Mesh::default();
    let run = |(first, count, whole): (Origin, u32, bool)| {
        let is_given = (first.operand as usize) < operands.len();
        Run {
            source: if is_given { first.operand } else { operands.len() as u32 },
            triangle: if is_given { first.triangle } else { 0 },
            count,
            reversed: first.reversed,
            whole: whole || !is_given,
        }
    };
    let runs: Vec<Run> = origins.stretches().map(run).collect();
    let sources: Vec<&Mesh> = operands.iter().map(|solid| solid.mesh()).chain([&nothing]).collect();
    let planes = Planes::new(operands, unit);
    let descent = Descent {
        sources: &sources,
        positions: &mesh.positions,
        triangles: &mesh.triangles,
        runs: &runs,
        unit,
        beyond: &|operand, triangle, p| planes.holder(operand, triangle, p),
    };
    carry(&descent, runner)
}

/// Where a corner of a triangle of the result comes from; `None` if the operands do not fit.
pub(crate) fn corner_origin(
    operands: &[&Solid],
    mesh: &Mesh,
    (origin, triangle): (Origin, usize),
    corner: usize,
    unit: f64,
) -> Option<CornerOrigin> {
    let given = operands.get(origin.operand as usize)?;
    given.mesh().triangles.get(origin.triangle as usize)?;
    let vertex = *mesh.triangles.get(triangle)?.get(corner)?;
    let Origin { operand, triangle, reversed } = origin;
    let run = Run { source: operand, triangle, count: 1, reversed, whole: false };
    let sources: Vec<&Mesh> = operands.iter().map(|solid| solid.mesh()).collect();
    let planes = Planes::new(operands, unit);
    let descent = Descent {
        sources: &sources,
        positions: &mesh.positions,
        triangles: &mesh.triangles,
        runs: &[],
        unit,
        beyond: &|operand, triangle, p| planes.holder_by_looking(operand, triangle, p),
    };
    let (triangle, weights) = match descent.corner_place(run, corner, &mesh.positions[vertex as usize]) {
        CornerPlace::Corner(triangle, k) => (triangle, [0, 1, 2].map(|i| f64::from(u8::from(i == k)))),
        CornerPlace::Within(triangle, place) => (triangle, place.weights()),
    };
    Some(CornerOrigin { operand, triangle, weights })
}

/// The faces of one plane, for triangles that were merged of several.
struct Planes<'a> {
    operands: &'a [&'a Solid],
    unit: f64,
    /// By operand, made when first asked for.
    trees: Vec<OnceLock<TriangleTree>>,
}

impl<'a> Planes<'a> {
    fn new(operands: &'a [&'a Solid], unit: f64) -> Self {
        Self { operands, unit, trees: operands.iter().map(|_| OnceLock::new()).collect() }
    }

    /// The triangle that holds a place in the plane of another, but outside that one.
    fn holder(&self, operand: u32, triangle: u32, p: &[f64; 3]) -> Option<u32> {
        let mesh = self.operands[operand as usize].mesh();
        let tree = get_or_compute(&self.trees[operand as usize], || TriangleTree::new(mesh));
        let mut best = Best::default();
        tree.triangles_near(DVec3::from_array(*p), reach(p, self.unit), |other| {
            self.consider(mesh, triangle, other, p, &mut best);
            true
        });
        best.0.map(|(.., other)| other)
    }

    /// The same, triangle by triangle: for a single question.
    fn holder_by_looking(&self, operand: u32, triangle: u32, p: &[f64; 3]) -> Option<u32> {
        let mesh = self.operands[operand as usize].mesh();
        let mut best = Best::default();
        let reach = reach(p, self.unit);
        for (other, corners) in (0..).zip(&mesh.triangles) {
            let corners = corners.map(|v| mesh.positions[v as usize]);
            let is_beside = (0..3).any(|k| {
                corners.iter().all(|corner| corner[k] < p[k] - reach)
                    || corners.iter().all(|corner| corner[k] > p[k] + reach)
            });
            if !is_beside {
                self.consider(mesh, triangle, other, p, &mut best);
            }
        }
        best.0.map(|(.., other)| other)
    }

    /// Prefers faces whose attributes go on from the one given; of those the nearest, and of those the first.
    fn consider(&self, mesh: &Mesh, triangle: u32, other: u32, p: &[f64; 3], best: &mut Best) {
        let corners = |t: u32| mesh.triangles[t as usize].map(|v| mesh.positions[v as usize]);
        let (from, to) = (corners(triangle), corners(other));
        let (_, off) = nearest_place(&to, p, self.unit);
        if off <= reach(p, self.unit) && lie_in_one_plane(&from, &to) && look_same_way(&from, &to) {
            let candidate = (!continues(mesh, triangle, other), off, other);
            let is_better = |known: (bool, f64, u32)| {
                let nearer = candidate.1.total_cmp(&known.1);
                candidate.0.cmp(&known.0).then(nearer).then(candidate.2.cmp(&known.2)).is_lt()
            };
            if best.0.is_none_or(is_better) {
                best.0 = Some(candidate);
            }
        }
    }
}

/// The best face so far: whether its attributes are others, how far it is, and which it is.
#[derive(Default)]
struct Best(Option<(bool, f64, u32)>);

//! How far the cage's surface is from the exact result.

use glam::DVec3;

use super::assemble::Draft;
use super::curve::Chain;
use super::operand::Operand;
use super::start::Start;
use super::work::Sharp;
use crate::spatial::{Closest, TriangleTree};
use crate::subdivision::level::Level;
use crate::subdivision::refine::apply;
use crate::{Mesh, Outcome};

/// Distances between the surface of the resulting cage and the exact result, in units of the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Errors {
    /// The largest distance of the cage's surface from the exact result.
    pub forward: f64,
    /// The largest distance of the exact result from the cage's surface.
    pub backward: f64,
    /// The root of the mean square of the distances forward.
    pub mean: f64,
    /// The largest distance of the cage's intersection curve from the exact one.
    pub curve: f64,
    /// The largest distance forward over faces that are not control faces of an operand.
    pub band: f64,
    /// The same over the others.
    pub outside: f64,
    /// What the distances above may be too small by: how far the triangles that they were measured to are from their surfaces at
    /// most, and what may lie between the points that were measured.
    pub allowance: f64,
    /// The volume of the cage's solid less that of the exact result, in cubed units.
    pub volume: f64,
}

impl Errors {
    /// The larger of both directions.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.forward.max(self.backward)
    }
}

/// What is measured: the surface of a draft against the exact result.
pub(super) struct Measure<'a> {
    pub(super) operands: &'a [Operand],
    pub(super) start: &'a Start<'a>,
    pub(super) exact: &'a Outcome,
    pub(super) chains: &'a [Chain],
    /// How far triangles may be from the surfaces they stand for.
    pub(super) fineness: f64,
}

/// What may lie between measured points, over the largest distance: it varies over a face about once, and a wave is flat within
/// (2 pi / 8)^2 / 8 = 8 % over an eighth of it.
const BETWEEN: f64 = 0.1;

/// Which triangles are measured.
pub(super) struct Region {
    /// For each face of the cage whether its surface may differ from an operand's.
    pub(super) affected: Vec<bool>,
    /// For each operand and control face whether its surface is in the result as it was.
    pub(super) same: Vec<Vec<bool>>,
}

impl Measure<'_> {
    /// Measures over all faces whose surface may have changed; over the others both surfaces are one, bit for bit.
    ///
    /// From the cage's surface, the nearest triangle of the exact result is found first, then the foot on the surface that it
    /// stands for. Where that leaves the triangle's neighbourhood, as beyond the curve, the triangle counts.
    /// Every face of the cage is measured at the vertices of 4^steps triangles, which are on its surface. Also told is the
    /// largest distance over each face.
    pub(super) fn errors(&self, draft: &Draft, region: &Region, steps: u32) -> (Errors, Vec<f64>) {
        let within = self.operands.iter().map(|operand| operand.within);
        let mut errors = Errors { allowance: within.fold(0.0, f64::max), ..Errors::default() };
        let mut of_face = vec![0.0f64; draft.cage.faces().len()];
        let Region { affected, same } = region;
        let (level, points) = fine_surface(draft, steps);
        let fine = Mesh::new(points.iter().map(DVec3::to_array).collect(), level.faces.clone());
        errors.volume = fine.volume() - self.exact.solid().mesh().volume();
        // 1. The triangles of both that may differ.
        let mesh = self.exact.solid().mesh();
        let is_cut = |t: &u32| {
            let (o, f) = self.start.control_face(*t);
            !same[o][f as usize]
        };
        let cut: Vec<u32> = (0..mesh.triangles.len() as u32).filter(is_cut).collect();
        let own: Vec<u32> =
            (0..fine.triangles.len() as u32).filter(|&t| affected[t as usize >> (2 * steps)]).collect();
        if own.is_empty() {
            return (errors, of_face);
        }
        // 2. From the cage's surface to the exact result.
        let tree = TriangleTree::new(&part(mesh, &cut));
        let mut seen = vec![false; points.len()];
        let (mut sum, mut count, mut guess) = (0.0, 0u32, None);
        for &t in &own {
            let face = t as usize >> (2 * steps);
            for v in fine.triangles[t as usize] {
                if std::mem::replace(&mut seen[v as usize], true) {
                    continue;
                }
                let x = points[v as usize];
                let Some(closest) = tree.closest_from(x.to_array(), guess) else { continue };
                guess = Some(closest.triangle);
                let (o, triangle) = self.start.fine_triangle(cut[closest.triangle as usize]);
                let distance = self.distance(&self.operands[o], triangle, x, &closest);
                errors.forward = errors.forward.max(distance);
                of_face[face] = of_face[face].max(distance);
                let kind = if draft.whole[face] { &mut errors.outside } else { &mut errors.band };
                *kind = kind.max(distance);
                sum += distance * distance;
                count += 1;
            }
        }
        errors.mean = (sum / f64::from(count.max(1))).sqrt();
        // 3. And back.
        errors.backward = self.backward(&cut, &part(&fine, &own));
        errors.curve = self.curve_error(draft, &level, &points, steps);
        errors.allowance += BETWEEN * errors.largest();
        (errors, of_face)
    }

    /// The largest distance of the vertices of some triangles of the exact result, which are on the operands' surfaces, from
    /// the cage's.
    fn backward(&self, cut: &[u32], surface: &Mesh) -> f64 {
        let mesh = self.exact.solid().mesh();
        let tree = TriangleTree::new(surface);
        let mut seen = vec![false; mesh.positions.len()];
        let (mut guess, mut largest) = (None, 0.0f64);
        for &t in cut {
            for v in mesh.triangles[t as usize] {
                if !std::mem::replace(&mut seen[v as usize], true)
                    && let Some(closest) = tree.closest_from(mesh.positions[v as usize], guess)
                {
                    guess = Some(closest.triangle);
                    largest = largest.max(closest.squared_distance.sqrt());
                }
            }
        }
        largest
    }

    /// What is to be measured of a draft whose control points `unknown` moved.
    pub(super) fn region(&self, draft: &Draft, unknown: &[u32]) -> Region {
        let affected = affected(draft, unknown);
        let same = self.same_faces(draft, &affected);
        Region { affected, same }
    }

    /// The largest distance of points on the cage's curve edges from the exact curve.
    fn curve_error(&self, draft: &Draft, fine: &Level, points: &[DVec3], steps: u32) -> f64 {
        let level = draft.cage.level();
        let mut largest = 0.0f64;
        // An edge's parts come one after the other, before all edges inside faces.
        for (e, &h) in fine.edges.iter().enumerate().take(level.edges.len() << steps) {
            let own = level.edges[e >> steps];
            let (u, v) = (level.from(own), level.to(own));
            if !matches!(draft.sharp.get(&(u.min(v), u.max(v))), Some(Sharp::Curve(_))) {
                continue;
            }
            let x = points[fine.from(h) as usize];
            let near = |chain: &Chain| chain.nearest(x, 0.0, f64::INFINITY).point.distance(x);
            largest = largest.max(self.chains.iter().map(near).fold(f64::INFINITY, f64::min));
        }
        largest
    }

    /// Control faces of the operands that are there with the same surface.
    fn same_faces(&self, draft: &Draft, affected: &[bool]) -> Vec<Vec<bool>> {
        let none = |operand: &Operand| vec![false; operand.cage.faces().len()];
        let mut same: Vec<Vec<bool>> = self.operands.iter().map(none).collect();
        for (f, source) in draft.sources.iter().enumerate() {
            if let (Some((o, face)), false) = (source, affected[f]) {
                same[*o][*face as usize] = true;
            }
        }
        same
    }

    fn distance(&self, operand: &Operand, triangle: u32, x: DVec3, closest: &Closest) -> f64 {
        let flat = closest.squared_distance.sqrt();
        let foot = operand.foot_near(x, triangle, closest.point.into());
        let way = foot.position.distance(closest.point.into());
        if way <= self.fineness { x.distance(foot.position).min(flat + way) } else { flat }
    }
}

/// Faces whose surface depends on an unknown: those with a corner beside one.
pub(super) fn affected(draft: &Draft, unknown: &[u32]) -> Vec<bool> {
    let mut is_unknown = vec![false; draft.changed.len()];
    unknown.iter().for_each(|&v| is_unknown[v as usize] = true);
    let mut near = is_unknown.clone();
    for corners in draft.cage.faces() {
        if corners.iter().any(|&v| is_unknown[v as usize]) {
            corners.iter().for_each(|&v| near[v as usize] = true);
        }
    }
    draft.cage.faces().iter().map(|corners| corners.iter().any(|&v| near[v as usize])).collect()
}

/// The cage after some subdivisions, and the limits of its vertices.
fn fine_surface(draft: &Draft, steps: u32) -> (Level, Vec<DVec3>) {
    let mut level = draft.cage.level().clone();
    let mut positions = draft.cage.points();
    for _ in 0..steps {
        let (next, rows) = level.refined();
        positions = rows.iter().map(|row| apply(row, &positions)).collect();
        level = next;
    }
    let limits = (0..positions.len() as u32).map(|v| apply(&level.limit_row(v), &positions)).collect();
    (level, limits)
}

/// Some triangles of a mesh.
fn part(mesh: &Mesh, triangles: &[u32]) -> Mesh {
    Mesh::new(mesh.positions.clone(), triangles.iter().map(|&t| mesh.triangles[t as usize]).collect())
}

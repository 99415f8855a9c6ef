//! How far the cage's surface is from the exact result.

use glam::DVec3;

use super::assemble::Draft;
use super::curve::Chain;
use crate::Mesh;
use crate::spatial::TriangleTree;
use crate::subdivision::limit_mesh::LimitMesh;

/// Distances between the surface of the resulting cage and the exact result, in units of the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// What both triangulations may be off, which the distances above were measured between.
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

/// Measures between triangulations: at their vertices and the centres of their triangles.
pub(super) fn measure(
    draft: &Draft,
    surface: &LimitMesh,
    exact: &Mesh,
    exact_tree: &TriangleTree,
    chains: &[Chain],
    allowance: f64,
) -> Errors {
    let mut errors = Errors { allowance, ..Errors::default() };
    let mesh = surface.mesh();
    let (mut sum, mut count) = (0.0, 0u32);
    each_point(mesh, |t, point| {
        let distance =
            exact_tree.closest(point.to_array()).map_or(0.0, |closest| closest.squared_distance.sqrt());
        errors.forward = errors.forward.max(distance);
        if draft.whole[surface.face_of[t] as usize] {
            errors.outside = errors.outside.max(distance);
        } else {
            errors.band = errors.band.max(distance);
        }
        sum += distance * distance;
        count += 1;
    });
    errors.mean = (sum / f64::from(count.max(1))).sqrt();
    let tree = TriangleTree::new(mesh);
    each_point(exact, |_, point| {
        let distance = tree.closest(point.to_array()).map_or(0.0, |closest| closest.squared_distance.sqrt());
        errors.backward = errors.backward.max(distance);
    });
    errors.curve = curve_error(draft, surface, chains);
    errors.volume = mesh.volume() - exact.volume();
    errors
}

fn each_point(mesh: &Mesh, mut visit: impl FnMut(usize, DVec3)) {
    let mut seen = vec![false; mesh.positions.len()];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let points = corners.map(|v| DVec3::from(mesh.positions[v as usize]));
        visit(t, (points[0] + points[1] + points[2]) / 3.0);
        for k in 0..3 {
            if !std::mem::replace(&mut seen[corners[k] as usize], true) {
                visit(t, points[k]);
            }
        }
    }
}

/// The largest distance of points on the cage's curve edges from the exact curve.
fn curve_error(draft: &Draft, surface: &LimitMesh, chains: &[Chain]) -> f64 {
    let level = draft.cage.level();
    let mut largest = 0.0f64;
    for (e, &h) in level.edges.iter().enumerate() {
        let (u, v) = (level.from(h), level.to(h));
        if draft.sharp.get(&(u.min(v), u.max(v))) != Some(&super::work::Sharp::Curve) {
            continue;
        }
        let points = surface.edge_points[e].iter().chain([&u, &v]);
        for &point in points {
            let x = DVec3::from(surface.mesh().positions[point as usize]);
            let near = |chain: &Chain| chain.nearest(x, 0.0, f64::INFINITY).1.distance(x);
            largest = largest.max(chains.iter().map(near).fold(f64::INFINITY, f64::min));
        }
    }
    largest
}

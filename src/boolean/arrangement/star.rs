//! Star-shaped surfaces: those of which every point is seen from one point inside.
//!
//! Where every triangle of a closed surface faces outward as seen from a point strictly, each direction from that point is covered as often as
//! the surface winds around the sphere of directions, which one ray tells. Covered once everywhere, the surface meets itself nowhere but in the
//! corners and edges that its triangles share: where two triangles cross, or lie on each other, directions are covered twice; and what is beyond an
//! edge, seen from the point, is the neighbour there, at the same distance. So a pass over the triangles, which ends at the first that
//! faces inward, tells of balls, boxes, cylinders, cones, and all that is convex, that nothing in them crosses. All tests are
//! strict: what they say holds after the smallest of moves too.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::Mesh;
use crate::control::Limit;
use crate::exact::{FILTER_RANGE, Sign, orient3d};
use crate::mesh::Bounds;
use crate::mesh::star::meets_ray;
use crate::parallel::Runner;

/// Triangles that are looked at before all are: most surfaces that are not star-shaped show it.
const SAMPLE: usize = 64;
/// Vertices whose mean is tried as the point. That of any vertices of a convex body is inside it, unless all of them lie in one face.
const VERTICES: usize = 256;
/// Triangles that one thread looks at before the limits are checked.
const AT_ONCE: usize = 1 << 14;

/// Whether a closed surface is certainly star-shaped: as seen from the mean of some vertices, or from beside the middle of its bounds. O(n).
///
/// # Errors
/// Only limits.
pub(super) fn is_star_shaped(mesh: &Mesh, bounds: &Bounds, runner: Runner<'_>) -> Result<bool, Limit> {
    if bounds.largest() > FILTER_RANGE {
        return Ok(false);
    }
    let faces_outward = |triangle: &[u32; 3], point: &[f64; 3]| faces_outward(mesh, triangle, point);
    let (middle, beside) = (bounds.center(), bounds.beside_center());
    let mean = mean(mesh);
    for point in [std::array::from_fn(|k| mean[k] + (beside[k] - middle[k])), beside] {
        let step = mesh.triangles.len().div_ceil(SAMPLE).max(1);
        let mut sample = mesh.triangles.iter().step_by(step);
        if sample.all(|triangle| faces_outward(triangle, &point))
            && is_met_once(mesh, &point, |triangle| faces_outward(triangle, &point), runner)?
        {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The mean of some vertices.
fn mean(mesh: &Mesh) -> [f64; 3] {
    let some = mesh.positions.iter().step_by(mesh.positions.len().div_ceil(VERTICES).max(1));
    let count = some.len() as f64;
    some.fold([0.0; 3], |sum, position| std::array::from_fn(|k| sum[k] + position[k] / count))
}

/// Whether every triangle faces outward from a point, and one ray from there meets one of them.
fn is_met_once(
    mesh: &Mesh,
    point: &[f64; 3],
    faces_outward: impl Fn(&[u32; 3]) -> bool + Sync,
    runner: Runner<'_>,
) -> Result<bool, Limit> {
    let has_failed = AtomicBool::new(false);
    let met = runner.pieces(mesh.triangles.len(), AT_ONCE, |range| {
        if has_failed.load(Ordering::Relaxed) {
            return None;
        }
        let mut met = 0;
        for triangle in &mesh.triangles[range] {
            let hit =
                if faces_outward(triangle) { meets_ray(&mesh.positions, *triangle, point) } else { None };
            let Some(hit) = hit else {
                has_failed.store(true, Ordering::Relaxed);
                return None;
            };
            met += u32::from(hit);
        }
        Some(met)
    })?;
    Ok(met.into_iter().sum::<Option<u32>>() == Some(1))
}

#[inline(always)]
fn faces_outward(mesh: &Mesh, triangle: &[u32; 3], point: &[f64; 3]) -> bool {
    let [a, b, c] = triangle.map(|v| &mesh.positions[v as usize]);
    orient3d(a, b, c, point) == Sign::Positive
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::super::self_crossings::count_by_all_pairs;
    use super::*;
    use crate::{Control, Solid, primitives};

    fn is_star(mesh: &Mesh) -> bool {
        let control = Control::new();
        let bounds = Bounds::of(&mesh.positions).unwrap();
        let [serial, parallel] = [false, true]
            .map(|parallel| is_star_shaped(mesh, &bounds, Runner::new(&control, parallel)).unwrap());
        assert_eq!(serial, parallel);
        // What the gate has found on its way is found here, too.
        if let Ok(solid) = Solid::try_from(mesh.clone()) {
            assert!(serial || solid.known_near_pairs().is_none());
        }
        serial
    }

    /// A mesh stretched along an axis.
    fn stretched(mut mesh: Mesh, axis: usize, by: f64) -> Mesh {
        mesh.positions.iter_mut().for_each(|position| position[axis] *= by);
        mesh
    }

    #[test]
    fn convex_bodies_are_star_shaped() {
        let cylinder = primitives::cylinder(1.0, 2.0, 64).unwrap();
        for mesh in [
            primitives::cuboid([-1.0; 3], [1.0; 3]).unwrap(),
            primitives::icosphere(1.0, 4).unwrap(),
            cylinder.clone(),
            stretched(cylinder, 2, 1e-6),
            primitives::cone(1.0, 3.0, 48).unwrap(),
        ] {
            for shift in [[0.0; 3], [1e3, -7.0, 0.3]] {
                assert!(is_star(&mesh.clone().translated(shift)), "{} triangles", mesh.triangles.len());
            }
        }
    }

    #[test]
    fn others_are_not() {
        let ball = primitives::icosphere(1.0, 3).unwrap();
        assert!(!is_star(&primitives::torus(2.0, 0.5, 32, 16).unwrap()));
        // Turned inside out; twice the same; two beside each other; one in another.
        let inside_out =
            Mesh::new(ball.positions.clone(), ball.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect());
        assert!(!is_star(&inside_out));
        for (shift, size) in [([0.0; 3], 1.0), ([3.0, 0.0, 0.0], 1.0), ([0.01, 0.0, 0.0], 0.5)] {
            let mut two = ball.clone();
            let mut other = ball.clone();
            other.positions.iter_mut().flatten().for_each(|x| *x *= size);
            two.append(&other.translated(shift)).unwrap();
            assert!(!is_star(&two), "{shift:?} {size}");
        }
    }

    #[test]
    fn a_surface_that_goes_twice_around_is_seen_twice() {
        // Over the circle twice, at two distances, with poles above and below: every triangle faces outward.
        let sides = 24u32;
        let rim = (0..sides).map(|k| {
            let angle = 2.0 * std::f64::consts::TAU * f64::from(k) / f64::from(sides);
            let far = if k < sides / 2 { 1.0 } else { 1.25 };
            [far * angle.cos(), far * angle.sin(), 0.0]
        });
        let positions = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]].into_iter().chain(rim).collect();
        let at = |k: u32| 2 + k % sides;
        let triangles = (0..sides).flat_map(|k| [[0, at(k), at(k + 1)], [1, at(k + 1), at(k)]]).collect();
        let mesh = Mesh::new(positions, triangles);
        let middle = [0.01, 0.02, 0.03];
        assert!(mesh.triangles.iter().all(|triangle| faces_outward(&mesh, triangle, &middle)));
        assert!(!is_star(&mesh));
        assert!(count_by_all_pairs(&Solid::try_from(mesh).unwrap()).0 > 0);
    }

    #[test]
    fn nothing_that_crosses_itself_is_star_shaped() {
        let mut random = ChaCha8Rng::seed_from_u64(1_628);
        let (mut stars, mut crossing) = (0, 0);
        for round in 0..60 {
            let mut mesh = primitives::icosphere(1.0, 2).unwrap();
            let wild = [0.02, 0.1, 0.15, 0.3][round % 4];
            for position in &mut mesh.positions {
                *position = position.map(|x| x + wild * random.random_range(-1.0..1.0));
            }
            let is_star = is_star(&mesh);
            let Ok(solid) = Solid::try_from(mesh) else { continue };
            let counted = count_by_all_pairs(&solid);
            assert!(!is_star || counted == (0, 0), "{round}: {counted:?}");
            stars += usize::from(is_star);
            crossing += usize::from(counted.0 > 0);
        }
        assert!(stars > 10 && crossing > 10, "{stars} stars, {crossing} that cross themselves");
    }
}

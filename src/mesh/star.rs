//! Surfaces of which one point inside sees every point once, told in the pass that sums up the volume.
//!
//! If a surface is closed and every triangle faces outward as seen from a point, strictly, each direction from there is covered equally
//! often, and one ray tells how often. Covered once everywhere, the triangles seen from there are a triangulation of the sphere of directions:
//! an edge has one triangle on either side, the triangles at a vertex are one fan, no two vertices lie in one direction. So the surface is a
//! 2-manifold, a ball's, with two more vertices than half its triangles, and meets itself nowhere: nobody has to look around its vertices or for
//! crossings.
//!
//! Whether it is closed a sum tells, of numbers that are as good as random, one for each edge and with the sign of its direction: a sum of 64 bits, of which all
//! cancel where the surface is closed, and where it is not, that chance is one in 2^64.

use super::Bounds;
use crate::exact::{FILTER_RANGE, Projection, Sign, orient2d};
use crate::parallel::map_chunks;

/// Triangles that are looked at before all are: most surfaces that are not star-shaped show it.
const SAMPLE: usize = 64;

/// A point that may see all of a surface.
pub(super) struct Star<'a> {
    positions: &'a [[f64; 3]],
    pub(super) point: [f64; 3],
}

impl<'a> Star<'a> {
    /// Beside the middle of a surface, if some of its triangles face outward from there.
    pub(super) fn of(positions: &'a [[f64; 3]], triangles: &[[u32; 3]], bounds: &Bounds) -> Option<Self> {
        let point = bounds.beside_center();
        // (Rounding does not matter here, nor what is out of range: all are looked at again.)
        let faces_outward = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| positions.get(v as usize).copied().unwrap_or(point));
            let from = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| q[k] - p[k]) };
            let (u, v, arm) = (from(a, b), from(a, c), from(point, a));
            let normal = super::cross(u, v);
            (0..3).map(|k| arm[k] * normal[k]).sum::<f64>() > 0.0
        };
        let step = triangles.len().div_ceil(SAMPLE).max(1);
        let may_be = bounds.largest() <= FILTER_RANGE && triangles.iter().step_by(step).all(faces_outward);
        may_be.then_some(Self { positions, point })
    }

    /// Takes a triangle that faces outward, or does not.
    #[inline]
    pub(super) fn look(&self, sight: &mut Sight, triangle: [u32; 3], faces_outward: bool) {
        if sight.is_blocked {
            return;
        }
        let hit = if faces_outward { meets_ray(self.positions, triangle, &self.point) } else { None };
        sight.is_blocked = hit.is_none();
        sight.met += u32::from(hit == Some(true));
        sight.triangles += 1;
        sight.edges = sight.edges.wrapping_add(edges_of(triangle));
    }
}

/// What is seen of some triangles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sight {
    /// The sum over their edges; 0 where these cancel.
    edges: u64,
    triangles: usize,
    /// How many the ray meets.
    met: u32,
    /// One does not face outward, or the ray passes one of its corners or edges.
    is_blocked: bool,
}

impl Sight {
    /// Of all the triangles of which parts were seen.
    pub(super) fn of_all(parts: impl IntoIterator<Item = Self>) -> Self {
        parts.into_iter().fold(Self::default(), |all, part| Self {
            edges: all.edges.wrapping_add(part.edges),
            triangles: all.triangles + part.triangles,
            met: all.met + part.met,
            is_blocked: all.is_blocked | part.is_blocked,
        })
    }

    /// Whether these are all of so many triangles, over so many vertices, and each direction is covered once.
    pub(super) fn is_whole(&self, triangles: usize, vertices: usize) -> bool {
        !self.is_blocked
            && self.triangles == triangles
            && self.met == 1
            && self.edges == 0
            // Every vertex belongs to a triangle.
            && vertices == triangles / 2 + 2
    }
}

/// Triangles a piece of work.
const CHUNK: usize = 1 << 14;

/// Whether every directed edge is met by its opposite as often as it occurs; wrong by a chance of one in 2^64. O(n), in one pass.
pub(crate) fn edges_cancel(triangles: &[[u32; 3]]) -> bool {
    let sum_of = |triangles: &[[u32; 3]]| {
        triangles.iter().fold(0, |sum: u64, &triangle| sum.wrapping_add(edges_of(triangle)))
    };
    map_chunks(triangles, CHUNK, sum_of).into_iter().fold(0, u64::wrapping_add) == 0
}

/// The sum over the edges of a triangle.
#[inline]
fn edges_of([a, b, c]: [u32; 3]) -> u64 {
    [(a, b), (b, c), (c, a)].into_iter().fold(0, |sum: u64, (from, to)| {
        let number = mixed(u64::from(from.min(to)) << 32 | u64::from(from.max(to)));
        // Negative against the order of the vertices.
        let against = u64::from(from > to).wrapping_neg();
        sum.wrapping_add((number ^ against).wrapping_sub(against))
    })
}

/// A number as good as random, one for each: the last steps of the generator SplitMix64 (Steele, Lea and Flood 2014).
#[inline]
pub(crate) fn mixed(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Whether the ray along the first axis from a point meets a triangle that faces outward from there; nothing where it passes a corner or
/// an edge. Coordinates are in [`FILTER_RANGE`].
#[inline(always)]
pub(crate) fn meets_ray(positions: &[[f64; 3]], triangle: [u32; 3], point: &[f64; 3]) -> Option<bool> {
    let corners = triangle.map(|v| &positions[v as usize]);
    // 1. Nearly all lie beside it.
    let is_beside = |k: usize| {
        let [a, b, c] = corners.map(|corner| corner[k]);
        let at = point[k];
        ((a < at) & (b < at) & (c < at)) | ((a > at) & (b > at) & (c > at))
    };
    if is_beside(1) | is_beside(2) {
        return Some(false);
    }
    // 2. Of what faces outward, the ray meets what is seen from the front against it; what is seen from behind lies on the other side of
    // the point.
    let view = Projection::seen_from(0, true);
    let ([a, b, c], at) = (corners.map(|corner| view.project(corner)), view.project(point));
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| orient2d(p, q, at));
    let has = |side: Sign| sides.contains(&side);
    match (has(Sign::Positive), has(Sign::Negative), has(Sign::Zero)) {
        (true, true, _) => Some(false),
        (is_front, _, false) => Some(is_front),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::seq::SliceRandom;
    use rand::{RngExt, SeedableRng};

    use super::super::Links;
    use super::*;
    use crate::mesh::measure::signed_volume_and_sight;
    use crate::{Mesh, Solid, primitives};

    fn is_star(mesh: &Mesh) -> bool {
        let bounds = Bounds::of(&mesh.positions).unwrap();
        let star = Star::of(&mesh.positions, &mesh.triangles, &bounds);
        star.is_some_and(|star| signed_volume_and_sight(&mesh.positions, &mesh.triangles, &bounds, &star).1)
    }

    fn links(mesh: &Mesh) -> Links {
        Links::of(&mesh.triangles, mesh.positions.len()).unwrap()
    }

    #[test]
    fn of_a_ball_is_known_what_a_look_around_every_vertex_tells() {
        let mut random = ChaCha8Rng::seed_from_u64(16);
        let meshes = [
            primitives::cuboid([-1.0; 3], [1.0; 3]).unwrap(),
            primitives::icosphere(1.0, 4).unwrap(),
            primitives::cylinder(1.0, 2.0, 64).unwrap(),
            primitives::cone(1.0, 3.0, 48).unwrap(),
        ];
        for mut mesh in meshes {
            for shift in [[0.0; 3], [1e3, -7.0, 0.3]] {
                mesh.triangles.shuffle(&mut random);
                mesh.triangles.iter_mut().for_each(|corners| corners.rotate_left(random.random_range(0..3)));
                let moved = mesh.clone().translated(shift);
                assert!(is_star(&moved), "{} triangles", mesh.triangles.len());
                assert_eq!(links(&moved), Links::of_ball(moved.positions.len()));
                let solid = Solid::try_from(moved.clone()).unwrap();
                assert_eq!(solid.known_near_pairs(), Some(&[][..]));
                assert_eq!((solid.components(), solid.genus(), solid.is_manifold()), (1, Some(0), true));
                assert_eq!(solid.volume(), moved.volume());
            }
        }
    }

    #[test]
    fn nothing_else_is_taken_for_one() {
        let ball = primitives::icosphere(1.0, 3).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(17);
        for round in 0..400 {
            let mut mesh = ball.clone();
            let place = random.random_range(0..mesh.triangles.len());
            match round % 8 {
                // A hole; a triangle twice; one turned; one with a vertex of its own; one with another's corner.
                0 => drop(mesh.triangles.swap_remove(place)),
                1 => mesh.triangles.push(mesh.triangles[place]),
                2 => mesh.triangles[place].swap(0, 1),
                3 => {
                    let v = &mut mesh.triangles[place][0];
                    mesh.positions.push(mesh.positions[*v as usize]);
                    *v = mesh.positions.len() as u32 - 1;
                }
                4 => mesh.triangles[place][0] = random.random_range(0..mesh.positions.len() as u32),
                // A vertex of no triangle; one that is not there; the same surface again.
                5 => mesh.positions.push([0.0; 3]),
                6 => mesh.triangles[place][0] = mesh.positions.len() as u32 + round,
                _ => mesh.append(&ball).unwrap(),
            }
            if mesh.triangles == ball.triangles {
                continue;
            }
            assert!(!is_star(&mesh), "{round}, triangle {place}");
        }
        // Two holes of the same shape; and what is no surface at all.
        let mut two = ball.clone();
        two.triangles.truncate(two.triangles.len() - 2);
        assert!(!is_star(&two));
        assert!(!is_star(&Mesh::new(vec![[0.0; 3]], Vec::new())));
    }

    #[test]
    fn edges_cancel_where_a_surface_is_closed_and_nowhere_else() {
        let ball = primitives::icosphere(1.0, 3).unwrap().triangles;
        assert!(edges_cancel(&ball));
        for place in 0..ball.len() {
            let (mut without, mut turned) = (ball.clone(), ball.clone());
            without.swap_remove(place);
            turned[place].swap(1, 2);
            assert!(!edges_cancel(&without) && !edges_cancel(&turned), "{place}");
        }
    }
}

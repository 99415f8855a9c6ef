//! Vertices around which no two triangles have anything in common but the vertex and the edges they share.

use std::ops::Range;

use super::Mesh;
use super::links::{LinkLists, shares};
use crate::exact::{FILTER_RANGE, Seen};
use crate::parallel::map;

/// For each vertex whether its triangles are plainly side by side: seen along some direction all of them run counter-clockwise, and
/// once around the vertex. Then any two have nothing in common but the vertex, and the edge if they share one, nor do they after the
/// smallest of moves. Of a closed mesh. `known` has those of which that is known, `around` the triangles that have any of the others;
/// all others are false where a coordinate is too large for it to be told. O(n).
///
/// (Each triangle is seen as a sector, and the sectors together cover each direction as often as they go round. A sector has no
/// second point over the vertex, since it is not seen as a line.)
pub(crate) fn plain_fans(mesh: &Mesh, largest: f64, mut known: Vec<bool>, around: &[u32]) -> Vec<bool> {
    if largest > FILTER_RANGE {
        return known;
    }
    let mut others: Vec<u32> = Vec::new();
    let mut number = vec![u32::MAX; known.len()];
    for (vertex, _) in (0u32..).zip(&known).filter(|(_, is_known)| !**is_known) {
        number[vertex as usize] = others.len() as u32;
        others.push(vertex);
    }
    let of_range = |range: Range<usize>| -> Vec<bool> {
        let first = range.start as u32;
        let triangles = around.iter().map(|&triangle| mesh.triangles[triangle as usize]);
        let place = |vertex: u32| number[vertex as usize].wrapping_sub(first) as usize;
        let lists = LinkLists::of(triangles, range.len(), place);
        let vertices = others[range].iter().zip(lists.each());
        vertices.map(|(&vertex, link)| is_plain(&mesh.positions, vertex, link)).collect()
    };
    let plain = map(shares(others.len()), of_range).concat();
    others.iter().zip(plain).for_each(|(&vertex, plain)| known[vertex as usize] = plain);
    known
}

/// Whether the fan with the given link is plainly side by side.
fn is_plain(positions: &[[f64; 3]], vertex: u32, link: &[u64]) -> bool {
    let v = &positions[vertex as usize];
    let ends = |edge: u64| [edge as u32, (edge >> 32) as u32].map(|end| &positions[end as usize]);
    let normal = |edge: u64| -> [f64; 3] {
        let [a, b] = ends(edge);
        let (u, w) = (difference(a, v), difference(b, v));
        std::array::from_fn(|k| u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3])
    };
    let sum = |scale: fn(&[f64; 3]) -> f64| {
        link.iter().fold([0.0; 3], |sum: [f64; 3], &edge| {
            let normal = normal(edge);
            let scale = scale(&normal);
            std::array::from_fn(|k| sum[k] + scale * normal[k])
        })
    };
    // Once around, without a branch for each triangle.
    let is_seen_plain = |direction: [f64; 3]| {
        let Some(seen) = Seen::from(direction) else { return false };
        let (mut rounds, mut is_certain) = (0, true);
        for &edge in link {
            let [a, b] = ends(edge);
            let ((from, from_is_certain), (to, _)) = (seen.side(v, a), seen.side(v, b));
            // (Each end is the start of another.)
            is_certain &= from_is_certain & seen.is_counter_clockwise(v, a, b);
            rounds += u32::from(!from & to);
        }
        is_certain && rounds == 1
    };
    // Against the sum of the normals, as long as the areas; or for fans of needles and others all alike. The first is turned a
    // little, so that neighbours along the axes and diagonals of a model are not in the plane that tells how often they go round.
    let [x, y, z] = sum(|_| 1.0);
    is_seen_plain([x, SKEW[0] * y, SKEW[1] * z])
        || is_seen_plain(sum(|[x, y, z]| 1.0 / (x * x + y * y + z * z).sqrt()))
}

/// What turns a direction by some degrees: no ratios of small integers.
const SKEW: [f64; 2] = [0.873_1, 1.119_7];

fn difference(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::primitives;

    fn all_plain_fans(mesh: &Mesh, largest: f64) -> Vec<bool> {
        let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        plain_fans(mesh, largest, vec![false; mesh.positions.len()], &all)
    }

    #[test]
    fn some_are_as_all_are() {
        let ball = primitives::icosphere(1.0, 3).unwrap();
        let known: Vec<bool> = (0..ball.positions.len()).map(|v| v % 3 == 0).collect();
        let has_other = |corners: &[u32; 3]| corners.iter().any(|&v| !known[v as usize]);
        let around: Vec<u32> =
            (0..).zip(&ball.triangles).filter(|(_, t)| has_other(t)).map(|(t, _)| t).collect();
        assert_eq!(plain_fans(&ball, 1.0, known, &around), all_plain_fans(&ball, 1.0));
    }

    #[test]
    fn convex_and_hollow_corners_are_plain() {
        let cube = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
        assert_eq!(all_plain_fans(&cube, 1.0), [true; 8]);
        assert_eq!(all_plain_fans(&cube.reversed(), 1.0), [true; 8]);
        let ball = primitives::icosphere(1.0, 4).unwrap();
        assert!(all_plain_fans(&ball, 1.0).iter().all(|&plain| plain));
        assert!(all_plain_fans(&ball, f64::MAX).iter().all(|&plain| !plain));
    }

    #[test]
    fn a_fan_that_goes_round_twice_is_not_plain() {
        // A double cone over a ring that goes round so many times, each round a little higher.
        for rounds in 1..4 {
            let steps = 12 * rounds;
            let ring = (0..steps).map(|k| {
                let angle = TAU * f64::from(k) / 12.0 + 0.1;
                [angle.cos(), angle.sin(), 0.01 * f64::from(k)]
            });
            let positions = [[0.0, 0.0, 2.0], [0.0, 0.0, -2.0]].into_iter().chain(ring).collect();
            let at = |k: u32| 2 + k % steps as u32;
            let triangles =
                (0..steps as u32).flat_map(|k| [[0, at(k), at(k + 1)], [1, at(k + 1), at(k)]]).collect();
            let plain = all_plain_fans(&Mesh::new(positions, triangles), 2.0);
            assert_eq!(plain[..2], [rounds == 1; 2], "{rounds}");
        }
    }
}

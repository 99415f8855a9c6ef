//! How far the surface over a quad is from two triangles.

use glam::DVec3;

use super::level::PolygonLevel;
use crate::subdivision::level::Kind;

/// A surface beside an extraordinary vertex or a crease is not further from its triangles than this times what it is at
/// middles of edges and quads: 4/3 where it bends as a paraboloid, and half as much again.
const SAFETY: f64 = 2.0;

/// A bound on the distance between the surface over quad `q` of a level and two triangles between the limits of its corners.
pub(super) fn distance(
    (coarse, coarse_points): (&PolygonLevel, &[DVec3]),
    (fine, fine_points): (&PolygonLevel, &[DVec3]),
    q: usize,
) -> f64 {
    if let Some(points) = regular_points(coarse, coarse_points, q) {
        return spline_distance(&points);
    }
    // Measured at what the next level has beside the corners.
    let limit = |v: u32| fine.limit(v, fine_points);
    let corners: [DVec3; 4] = std::array::from_fn(|k| limit(coarse.corners[4 * q + k]));
    let middles: [DVec3; 4] = std::array::from_fn(|k| limit(fine.corners[4 * (4 * q + k) + 1]));
    let centre = limit(fine.corners[4 * (4 * q) + 2]);
    let sides = (0..4).map(|k| middles[k].distance((corners[k] + corners[(k + 1) % 4]) * 0.5));
    let diagonal = usize::from(corners[1].distance(corners[3]) < corners[0].distance(corners[2]));
    let middle = (corners[diagonal] + corners[diagonal + 2]) * 0.5;
    SAFETY * sides.fold(centre.distance(middle), f64::max)
}

/// For a bicubic patch: (|S_uu| + 2 |S_uv| + |S_vv|) / 8 bounds its distance from two triangles (Filip, Magedson and Markot 1986),
/// and each derivative is a mean of differences of the sixteen points.
fn spline_distance(p: &[[DVec3; 4]; 4]) -> f64 {
    let (mut uu, mut vv, mut uv) = (0.0f64, 0.0f64, 0.0f64);
    for i in 0..4 {
        for j in 0..2 {
            uu = uu.max((p[i][j] - p[i][j + 1] * 2.0 + p[i][j + 2]).length());
            vv = vv.max((p[j][i] - p[j + 1][i] * 2.0 + p[j + 2][i]).length());
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            uv = uv.max((p[i][j] - p[i + 1][j] - p[i][j + 1] + p[i + 1][j + 1]).length());
        }
    }
    (uu + 2.0 * uv + vv) / 8.0
}

/// The sixteen points of a quad whose corners have four quads around them and nothing sharp.
fn regular_points(level: &PolygonLevel, positions: &[DVec3], q: usize) -> Option<[[DVec3; 4]; 4]> {
    /// Where corner k of the quad and, counter-clockwise from the edge after it, its far vertices are in the grid.
    const OWN: [[usize; 2]; 4] = [[1, 1], [1, 2], [2, 2], [2, 1]];
    const FAR: [[[usize; 2]; 3]; 4] = [
        [[0, 1], [0, 0], [1, 0]],
        [[1, 3], [0, 3], [0, 2]],
        [[3, 2], [3, 3], [2, 3]],
        [[2, 0], [3, 0], [3, 1]],
    ];
    let mut points = [[DVec3::ZERO; 4]; 4];
    for k in 0..4 {
        let h = (4 * q + k) as u32;
        let v = level.from(h);
        let spokes = level.spokes(v);
        let sharp = |e: &u32| level.sharpness[*e as usize] > 0.0;
        if spokes.halves.len() != 4
            || spokes.vertices.len() != 4
            || spokes.edges.iter().any(sharp)
            || level.kind(&spokes, level.corner(v), |sharpness| sharpness > 0.0) != Kind::Smooth
        {
            return None;
        }
        let start = spokes.halves.iter().position(|&other| other == h)?;
        let spoke = |i: usize| spokes.halves[(start + i) % 4];
        let across = |h: u32| positions[level.to(level.next(h)) as usize];
        let own = OWN[k];
        points[own[0]][own[1]] = positions[v as usize];
        let [left, corner, right] = FAR[k];
        // Counter-clockwise: spoke 0 and 1 are sides of the quad, 2 and 3 outside it.
        let two = positions[level.to(spoke(2)) as usize];
        let three = positions[level.to(spoke(3)) as usize];
        points[right[0]][right[1]] = two;
        points[left[0]][left[1]] = three;
        points[corner[0]][corner[1]] = across(spoke(2));
    }
    Some(points)
}

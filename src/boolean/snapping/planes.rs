//! Faces that lie on each other in one plane, which are cut up together.
//!
//! Cut up pair by pair, inner edges of one face would cross those of the next, and so on. In one triangulation of all their edges
//! each face is a set of its triangles, the same for all that cover a place.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::surfaces::Surfaces;
use crate::exact::Projection;
use crate::mesh::UnionFind;

/// How far faces may be from one plane, in distances to snap by: each of two was off by one, and each corner has moved by one.
const OFF_PLANE: f64 = 4.0;

/// Sets of faces of which each lies on another one of the set, in one plane; the largest face of each set first. Among `pairs` are
/// all pairs of faces that are near each other, and only those with a face that is split count.
pub(super) fn find(
    surfaces: &Surfaces,
    pairs: &[[u32; 2]],
    is_split: &[bool],
    distance: f64,
) -> Vec<Vec<u32>> {
    // 1. Faces that lie on each other.
    let mut sets = UnionFind::new(surfaces.triangles.len());
    let mut members: Vec<u32> = Vec::new();
    for &[s, t] in pairs {
        if (is_split[s as usize] || is_split[t as usize]) && lie_on_each_other(surfaces, [s, t], distance) {
            sets.join(s, t);
            members.extend([s, t]);
        }
    }
    members.sort_unstable();
    members.dedup();
    let mut by_root: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    for t in members {
        by_root.entry(sets.root(t)).or_default().push(t);
    }
    let mut sets: Vec<Vec<u32>> = by_root.into_values().collect();
    sets.sort_unstable();
    // 2. Of each set what is in the plane of its largest face.
    for set in &mut sets {
        let size = |&t: &u32| Plane::of(&surfaces.corners(t as usize)).area;
        let largest = set.iter().copied().max_by(|x, y| size(x).total_cmp(&size(y)).then(y.cmp(x)));
        let Some(largest) = largest else { continue };
        let plane = Plane::of(&surfaces.corners(largest as usize));
        set.retain(|&t| t != largest && plane.is_near(&surfaces.corners(t as usize), distance));
        set.insert(0, largest);
    }
    sets.retain(|set| set.len() > 1);
    sets
}

/// The plane of a face.
struct Plane {
    at: DVec3,
    normal: DVec3,
    area: f64,
}

impl Plane {
    fn of(corners: &[[f64; 3]; 3]) -> Self {
        let [a, b, c] = corners.map(DVec3::from_array);
        let cross = (b - a).cross(c - a);
        Self { at: a, normal: cross.normalize_or_zero(), area: cross.length() }
    }

    fn is_near(&self, corners: &[[f64; 3]; 3], distance: f64) -> bool {
        let off = |corner: &[f64; 3]| (DVec3::from_array(*corner) - self.at).dot(self.normal).abs();
        self.normal != DVec3::ZERO && corners.iter().all(|corner| off(corner) <= OFF_PLANE * distance)
    }
}

/// Whether two faces are in one plane and have more in common than a part of an edge.
fn lie_on_each_other(surfaces: &Surfaces, [s, t]: [u32; 2], distance: f64) -> bool {
    let corners = [s, t].map(|t| surfaces.corners(t as usize));
    let planes = corners.each_ref().map(Plane::of);
    let [larger, smaller] = if planes[0].area >= planes[1].area { [0, 1] } else { [1, 0] };
    if !planes[larger].is_near(&corners[smaller], distance) {
        return false;
    }
    // They are apart if all of one is beyond a side of the other.
    let seen = Projection::of(&corners[larger]);
    let [mut p, mut q] = [larger, smaller].map(|k| corners[k].map(|corner| seen.project(&corner)));
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / length
    };
    for triangle in [&mut p, &mut q] {
        if turn(triangle[0], triangle[1], triangle[2]) < 0.0 {
            triangle.swap(1, 2);
        }
    }
    let has_beyond = |of: &[[f64; 2]; 3], other: &[[f64; 2]; 3]| {
        (0..3).any(|k| other.iter().all(|&c| turn(of[k], of[(k + 1) % 3], c) <= distance))
    };
    !has_beyond(&p, &q) && !has_beyond(&q, &p)
}

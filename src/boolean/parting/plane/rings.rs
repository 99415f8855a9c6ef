//! The outlines of one layer of many, walked from triangle to triangle: where no vertex lies in the plane and every edge has two
//! triangles, each cut triangle leads to the one behind the edge that the outline leaves it by.

use rustc_hash::FxHashSet;

use super::nodes::are_one_plane;
use super::split::{ABOVE, BELOW, ON, Split};
use crate::mesh::{Buckets, Mesh};

/// For each side of each triangle the side of the other triangle there: three times the triangle, plus the corner it starts at.
pub(super) struct Twins(Vec<u32>);

impl Twins {
    /// Of triangles every edge of which has two that run against each other; `None` otherwise. O(n).
    pub(super) fn of(mesh: &Mesh) -> Option<Self> {
        // 1. Sides by their lower ends, with the higher one.
        let sides = (0u32..).zip(&mesh.triangles).flat_map(|(triangle, corners)| {
            [0, 1, 2].map(|k| {
                let (u, v) = (corners[k], corners[(k + 1) % 3]);
                (u.min(v), [u.max(v), 3 * triangle + k as u32])
            })
        });
        let mut at_low = Buckets::new(mesh.positions.len(), sides);
        // 2. Equal ones are twins.
        let mut twins = vec![u32::MAX; 3 * mesh.triangles.len()];
        for list in at_low.each_mut() {
            list.sort_unstable();
            for pair in list.chunk_by(|x, y| x[0] == y[0]) {
                let &[[_, x], [_, y]] = pair else { return None };
                let start = |side: u32| mesh.triangles[side as usize / 3][side as usize % 3];
                if start(x) == start(y) {
                    return None;
                }
                (twins[x as usize], twins[y as usize]) = (y, x);
            }
        }
        Some(Self(twins))
    }
}

/// What one thread needs for layer after layer.
pub(super) struct Walker<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) twins: &'a Twins,
    /// By triangle, whether it is cut and not yet passed.
    is_left: Vec<bool>,
    places: FxHashSet<[u64; 3]>,
}

/// The outlines of a layer: points, and loops of their numbers.
pub(super) struct Rings {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) loops: Vec<Vec<u32>>,
}

impl<'a> Walker<'a> {
    pub(super) fn new(mesh: &'a Mesh, twins: &'a Twins) -> Self {
        Self { mesh, twins, is_left: vec![false; mesh.triangles.len()], places: FxHashSet::default() }
    }

    /// The outlines at a plane, the solid to their left seen from above, without points between faces of one plane if they are to be
    /// merged. `None` where a vertex lies in the plane or two points are at one place: there is more to decide then.
    pub(super) fn rings(&mut self, split: &Split<'_>, merge: bool) -> Option<Rings> {
        if split.has_touching()
            || split.cut.iter().any(|&t| split.corners(t).iter().any(|&v| split.mark(v) == ON))
        {
            return None;
        }
        split.cut.iter().for_each(|&t| self.is_left[t as usize] = true);
        let mut rings = Rings { points: Vec::with_capacity(split.cut.len()), loops: Vec::new() };
        self.places.clear();
        let mut is_plain = true;
        for &start in &split.cut {
            if self.is_left[start as usize] {
                is_plain &= self.walk(split, start, merge, &mut rings);
            }
        }
        is_plain.then_some(rings)
    }

    /// Round one outline; false if it comes to a place again. All its triangles are passed in any case.
    fn walk(&mut self, split: &Split<'_>, start: u32, merge: bool, rings: &mut Rings) -> bool {
        let first = rings.points.len();
        let (mut triangle, mut is_plain) = (start, true);
        loop {
            self.is_left[triangle as usize] = false;
            // It leaves what is below at one of its sides.
            let corners = split.corners(triangle);
            let exit = (0..3)
                .find(|&k| split.mark(corners[k]) == BELOW && split.mark(corners[(k + 1) % 3]) == ABOVE);
            let Some(exit) = exit else { return false };
            let next = self.twins.0[3 * triangle as usize + exit] / 3;
            if !(merge && are_one_plane(self.mesh, triangle, next)) {
                let [below, above] = [corners[exit], corners[(exit + 1) % 3]];
                let point = split
                    .plane
                    .crossing(&self.mesh.positions[below as usize], &self.mesh.positions[above as usize]);
                is_plain &= self.places.insert(point.map(|x| (x + 0.0).to_bits()));
                rings.points.push(point);
            }
            if next == start {
                break;
            }
            if !self.is_left[next as usize] {
                return false;
            }
            triangle = next;
        }
        if rings.points.len() > first {
            rings.loops.push((first as u32..rings.points.len() as u32).collect());
        }
        is_plain && rings.points.len() >= first + 3
    }
}

//! How thick a solid is at a point of its surface: as far as a ray goes inwards before it comes out.

use glam::{DVec3, Vec3A};

use super::{LANES, TriangleTree};
use crate::parallel::map_chunks;

/// The thickness of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Thickness {
    /// The length of the way through.
    pub thickness: f64,
    /// Where the ray goes in: the point of the surface nearest to the one that was asked for.
    pub from: [f64; 3],
    /// Where it comes out.
    pub to: [f64; 3],
    /// The triangles it goes in and out through.
    pub triangles: [u32; 2],
}

/// Points asked for at once.
const CHUNK: usize = 256;

impl TriangleTree {
    /// The thickness of the wall at the point of the surface nearest to `point`: how far a ray against that triangle's normal goes
    /// before it leaves the surface again. `None` if there is no way out (the surface is not closed), if the triangle has no
    /// area, or if the point is not finite. In `f64`; about O(log n).
    ///
    /// ```
    /// use trisect::primitives;
    /// use trisect::spatial::TriangleTree;
    ///
    /// let plate = TriangleTree::new(&primitives::cuboid([0.0; 3], [10.0, 10.0, 0.5])?);
    /// assert_eq!(plate.thickness([3.0, 4.0, 0.75]).unwrap().thickness, 0.5);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn thickness(&self, point: [f64; 3]) -> Option<Thickness> {
        let start = self.closest(point)?;
        let [a, b, c] = self.corners(start.triangle)?;
        // Edges are scaled, so that a tiny triangle has a normal all the same.
        let reach = (b - a).abs().max((c - a).abs()).max_element();
        let inwards = -(((b - a) / reach).cross((c - a) / reach)).try_normalize()?;
        let from = DVec3::from_array(start.point);
        let (thickness, triangle) = self.way_out(from, inwards)?;
        let to = (from + inwards * thickness).to_array();
        Some(Thickness { thickness, from: start.point, to, triangles: [start.triangle, triangle] })
    }

    /// [`thickness`](Self::thickness) at many points, in their order, on all threads.
    #[must_use]
    pub fn thickness_at_all(&self, points: &[[f64; 3]]) -> Vec<Option<Thickness>> {
        map_chunks(points, CHUNK, |chunk| {
            chunk.iter().map(|&point| self.thickness(point)).collect::<Vec<_>>()
        })
        .concat()
    }

    /// How far a ray goes until it leaves the surface: through a triangle that faces its way. The lowest triangle of those at
    /// the same distance.
    fn way_out(&self, from: DVec3, direction: DVec3) -> Option<(f64, u32)> {
        let mut best: Option<(f64, u32)> = None;
        let ray = Ray::new(self.frame.local(from), direction);
        self.tree.visit(
            |pack| (0..LANES).map(|lane| u32::from(ray.meets(&pack.lane(lane))) << lane).sum(),
            |leaf| {
                let leaf = &self.leaves[leaf as usize];
                if let Some(t) = leaving(from, direction, leaf.corners)
                    && best.is_none_or(|(nearest, triangle)| (t, leaf.triangle) < (nearest, triangle))
                {
                    best = Some((t, leaf.triangle));
                }
            },
        );
        best
    }
}

/// A ray in the frame of a tree.
struct Ray {
    from: DVec3,
    inverse: DVec3,
}

impl Ray {
    fn new(from: DVec3, direction: DVec3) -> Self {
        Self { from, inverse: direction.recip() }
    }

    /// Whether the ray may meet a box, which is widened by more than any rounding here.
    fn meets(&self, aabb: &obvhs::aabb::Aabb) -> bool {
        const ROOM: f64 = 1e-6;
        let corner =
            |corner: Vec3A, room: f64| (corner.as_dvec3() + DVec3::splat(room) - self.from) * self.inverse;
        let (a, b) = (corner(aabb.min, -ROOM), corner(aabb.max, ROOM));
        let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (near, far) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
            // A comparison with what is no number (zero times infinity) refuses nothing.
            enters = if near > enters { near } else { enters };
            leaves = if far < leaves { far } else { leaves };
        }
        enters <= leaves
    }
}

/// How far along the ray it leaves through the triangle, if it does (Moller and Trumbore 1997).
fn leaving(from: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    // Negative where the triangle faces along the ray.
    let determinant = ab.dot(across);
    if determinant >= 0.0 {
        return None;
    }
    let start = from - a;
    let u = start.dot(across) / determinant;
    let q = start.cross(ab);
    let v = direction.dot(q) / determinant;
    // Rays that pass between two triangles are not to be lost: some units in the last place are allowed.
    const ROOM: f64 = 1e-12;
    if u < -ROOM || v < -ROOM || u + v > 1.0 + ROOM {
        return None;
    }
    let t = ac.dot(q) / determinant;
    (t >= 0.0).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives;

    #[test]
    fn walls_are_as_thick_as_they_were_made() {
        let (outer, inner) = (primitives::icosphere(2.0, 5).unwrap(), primitives::icosphere(1.5, 5).unwrap());
        let mut shell = outer.clone();
        shell.append(&inner.reversed()).unwrap();
        let tree = TriangleTree::new(&shell);
        let found = tree.thickness_at_all(&outer.positions);
        assert_eq!(found.len(), outer.positions.len());
        for thickness in found {
            let Thickness { thickness, from, to, .. } = thickness.expect("the shell is closed");
            assert!((thickness - 0.5).abs() < 0.01, "{thickness}");
            assert!((DVec3::from_array(from).distance(DVec3::from_array(to)) - thickness).abs() < 1e-12);
        }
    }

    #[test]
    fn along_the_axes_no_ray_is_lost() {
        let grid = primitives::cuboid([0.0; 3], [1.0, 2.0, 3.0]).unwrap();
        let tree = TriangleTree::new(&grid);
        for (point, wanted) in
            [([0.0, 1.0, 1.5], 1.0), ([0.5, 2.0, 1.5], 2.0), ([0.5, 1.0, 3.0], 3.0), ([0.5, 1.0, -4.0], 3.0)]
        {
            assert_eq!(tree.thickness(point).unwrap().thickness, wanted);
        }
        assert_eq!(tree.thickness([f64::NAN, 0.0, 0.0]), None);
        let open = crate::Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
        assert_eq!(TriangleTree::new(&open).thickness([0.2, 0.2, 0.0]), None);
    }
}

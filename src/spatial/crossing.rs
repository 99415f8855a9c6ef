//! Exact crossings of a ray with the triangles: parity and winding number without a tolerance.
//!
//! The ray runs in +x. Ties are broken by half-open rules, which is the parity test of Choporov 2017 (section by the
//! plane z = z_q, then crossings in that plane), read as predicates of the input vertices: a triangle counts if a
//! vertex is strictly below the plane and one on or above it, a section edge counts if one end is strictly below
//! the line y = y_q and the other on or above it. Both rules depend on edges alone, so neighbours always agree.

use glam::DVec3;

use super::TriangleTree;
use crate::exact::{Sign, orient2d, orient3d};
use crate::parallel::map_chunks;

/// Where a point is with respect to a closed surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// Inside.
    Inside,
    /// Exactly on the surface.
    On,
    /// Outside.
    Outside,
}

/// What a ray from a point in +x meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossings {
    /// Triangles crossed. The point is inside by parity if this is odd.
    pub count: u32,
    /// Triangles left minus triangles entered: the winding number of the surface around the point.
    pub winding: i32,
    /// Whether the point lies exactly on a triangle that the half-open rules count.
    pub on_surface: bool,
}

impl TriangleTree {
    /// Crossings of the ray from `query` in +x, exact for every finite query and every finite mesh.
    #[must_use]
    pub fn crossings(&self, query: [f64; 3]) -> Crossings {
        let mut found = Crossings { count: 0, winding: 0, on_surface: false };
        let query = DVec3::from_array(query);
        if !query.is_finite() || self.is_empty() {
            return found;
        }
        self.visit_right_of(query.to_array(), |corners| match crossing(corners, query) {
            Some(0) => found.on_surface = true,
            Some(direction) => {
                found.count += 1;
                found.winding += direction;
            }
            None => {}
        });
        found
    }

    /// Where a point is: on the surface, or inside where the surface winds around it more often outwards than inwards. Exact for
    /// a closed surface.
    #[must_use]
    pub fn side(&self, query: [f64; 3]) -> Side {
        if self.touches(query) {
            Side::On
        } else if self.crossings(query).winding > 0 {
            Side::Inside
        } else {
            Side::Outside
        }
    }

    /// [`side`](Self::side) of many points, in their order, on all threads.
    ///
    /// ```
    /// use trisect::primitives;
    /// use trisect::spatial::{Side, TriangleTree};
    ///
    /// let cube = TriangleTree::new(&primitives::cuboid([0.0; 3], [1.0; 3])?);
    /// let sides = cube.sides(&[[0.5; 3], [0.5, 0.5, 1.0], [0.5, 0.5, 1.1]]);
    /// assert_eq!(sides, [Side::Inside, Side::On, Side::Outside]);
    /// # Ok::<(), trisect::Error>(())
    /// ```
    #[must_use]
    pub fn sides(&self, queries: &[[f64; 3]]) -> Vec<Side> {
        // Points asked for at once.
        const CHUNK: usize = 1024;
        map_chunks(queries, CHUNK, |chunk| chunk.iter().map(|&query| self.side(query)).collect::<Vec<_>>())
            .concat()
    }

    /// Calls `visit` with the corners of every triangle whose box meets the ray from `query` in +x.
    pub(crate) fn visit_right_of(&self, query: [f64; 3], mut visit: impl FnMut([DVec3; 3])) {
        let mut beam = self.frame.around(DVec3::from_array(query));
        beam.max.x = f32::INFINITY;
        self.tree.visit_meeting(&beam, |leaf| visit(self.leaves[leaf as usize].corners));
    }

    /// Whether `query` lies exactly on a triangle.
    #[must_use]
    pub fn touches(&self, query: [f64; 3]) -> bool {
        let query = DVec3::from_array(query);
        if !query.is_finite() || self.is_empty() {
            return false;
        }
        let mut touched = false;
        self.tree.visit_meeting(&self.frame.around(query), |leaf| {
            touched |= contains(self.leaves[leaf as usize].corners, query);
        });
        touched
    }
}

/// The two coordinates of a point after `axis`, in turn.
#[inline]
fn project(point: DVec3, axis: usize) -> [f64; 2] {
    match axis {
        0 => [point.y, point.z],
        1 => [point.z, point.x],
        _ => [point.x, point.y],
    }
}

/// [`orient2d`] of three points projected along an axis.
#[inline]
fn turn([a, b, c]: [DVec3; 3], axis: usize) -> Sign {
    orient2d(project(a, axis), project(b, axis), project(c, axis))
}

/// The side of a triangle's plane that a point is on; positive if it is behind the triangle, where the normal points away
/// from.
#[inline]
fn side_of_plane([a, b, c]: [DVec3; 3], query: DVec3) -> Sign {
    orient3d(&a.to_array(), &b.to_array(), &c.to_array(), &query.to_array())
}

/// +1 where the ray leaves through the triangle, -1 where it enters, 0 where `query` is on it, nothing where it
/// misses.
fn crossing(corners: [DVec3; 3], query: DVec3) -> Option<i32> {
    let above = corners.map(|corner| corner.z >= query.z);
    if above[0] == above[1] && above[1] == above[2] {
        return None;
    }
    // The corner alone on its side of the plane z = z_q; the section runs between its two edges.
    let alone = (0..3).find(|&k| above[k] != above[(k + 1) % 3] && above[k] != above[(k + 2) % 3])?;
    let beyond = |other: usize| {
        let (low, high) = if above[alone] { (other, alone) } else { (alone, other) };
        // Whether the edge passes the plane at y >= y_q: then q is on the left of the rising edge, or on it.
        turn([corners[low], corners[high], query], 0) != Sign::Negative
    };
    if beyond((alone + 1) % 3) == beyond((alone + 2) % 3) {
        return None;
    }
    let facing = turn(corners, 0) == Sign::Positive;
    let behind = match side_of_plane(corners, query) {
        Sign::Zero => return Some(0),
        side => side == Sign::Positive,
    };
    (behind == facing).then_some(if facing { 1 } else { -1 })
}

/// Whether `query` is exactly on the closed triangle.
fn contains(corners: [DVec3; 3], query: DVec3) -> bool {
    if side_of_plane(corners, query) != Sign::Zero {
        return false;
    }
    let [a, b, c] = corners;
    for axis in 0..3 {
        let facing = turn(corners, axis);
        if facing != Sign::Zero {
            let sides = [[a, b, query], [b, c, query], [c, a, query]].map(|points| turn(points, axis));
            return sides.iter().all(|&side| side == Sign::Zero || side == facing);
        }
    }
    // A segment or a point: on the line in every projection, and between the ends.
    let between = |from: DVec3, to: DVec3| {
        let on_line = (0..3).all(|axis| turn([from, to, query], axis) == Sign::Zero);
        on_line && query.cmpge(from.min(to)).all() && query.cmple(from.max(to)).all()
    };
    between(a, b) || between(b, c) || between(c, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, primitives};

    #[test]
    fn crossings_are_exact_at_any_magnitude() {
        let octahedron = primitives::octahedron(1.0).expect("an octahedron");
        for scale in [1e-300, 1.0, 1e300] {
            let positions = octahedron.positions.iter().map(|p| p.map(|x| x * scale)).collect();
            let tree = TriangleTree::new(&Mesh::new(positions, octahedron.triangles.clone()));
            // On the face x + y + z = scale, and one bit to either side of it.
            let [x, y, z] = [0.5, 0.25, 0.25].map(|x| x * scale);
            assert!(tree.touches([x, y, z]), "{scale}");
            assert!(!tree.touches([x.next_up(), y, z]) && !tree.touches([x.next_down(), y, z]), "{scale}");
            let inside = tree.crossings([x.next_down(), y, z]);
            assert_eq!((inside.count, inside.winding), (1, 1), "{scale}");
            assert_eq!(tree.crossings([x.next_up(), y, z]).count, 0, "{scale}");
            // Tiny against the size of the body, or huge.
            for tiny in [1e-300, -1e-300] {
                assert_eq!(tree.crossings([0.25 * tiny, 0.25 * tiny, 0.25 * tiny]).winding, 1, "{scale}");
            }
            assert_eq!(tree.crossings([-1e301, 0.25 * scale, 0.25 * scale]).winding, 0, "{scale}");
        }
    }
}

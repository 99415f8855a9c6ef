//! Exact crossings of a ray with the triangles: parity and winding number without a tolerance.
//!
//! The ray runs in +x. Ties are broken by half-open rules, which is the parity test of Choporov 2017 (section by the
//! plane z = z_q, then crossings in that plane), read as predicates of the input vertices: a triangle counts if a
//! vertex is strictly below the plane and one on or above it, a section edge counts if one end is strictly below
//! the line y = y_q and the other on or above it. Both rules depend on edges alone, so neighbours always agree.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::TriangleTree;

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
    /// Crossings of the ray from `query` in +x, exact for every finite query whose coordinates and those of the mesh
    /// are within a factor of about 2^300 of each other (the range of exact products in double precision).
    #[must_use]
    pub fn crossings(&self, query: [f64; 3]) -> Crossings {
        let mut found = Crossings { count: 0, winding: 0, on_surface: false };
        let query = DVec3::from_array(query);
        if !query.is_finite() || self.is_empty() {
            return found;
        }
        self.visit_right_of(query.to_array(), |corners| {
            match crossing(corners.map(|corner| corner * self.unit), query * self.unit) {
                Some(0) => found.on_surface = true,
                Some(direction) => {
                    found.count += 1;
                    found.winding += direction;
                }
                None => {}
            }
        });
        found
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
            let corners = &self.leaves[leaf as usize].corners;
            touched |= contains(corners.map(|corner| corner * self.unit), query * self.unit);
        });
        touched
    }
}

fn drop_axis(point: DVec3, axis: usize) -> Coord<f64> {
    let [x, y, z] = point.to_array();
    match axis {
        0 => Coord { x: y, y: z },
        1 => Coord { x: z, y: x },
        _ => Coord { x, y },
    }
}

fn coord3(point: DVec3) -> Coord3D<f64> {
    Coord3D { x: point.x, y: point.y, z: point.z }
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
        orient2d(drop_axis(corners[low], 0), drop_axis(corners[high], 0), drop_axis(query, 0)) >= 0.0
    };
    if beyond((alone + 1) % 3) == beyond((alone + 2) % 3) {
        return None;
    }
    let [a, b, c] = corners;
    let facing = orient2d(drop_axis(a, 0), drop_axis(b, 0), drop_axis(c, 0));
    // Positive if the query is behind the triangle, on the side its normal points away from.
    let behind = orient3d(coord3(a), coord3(b), coord3(c), coord3(query));
    if behind == 0.0 {
        return Some(0);
    }
    let direction = if facing > 0.0 { 1 } else { -1 };
    ((behind > 0.0) == (facing > 0.0)).then_some(direction)
}

/// Whether `query` is exactly on the closed triangle.
fn contains(corners: [DVec3; 3], query: DVec3) -> bool {
    let [a, b, c] = corners;
    if orient3d(coord3(a), coord3(b), coord3(c), coord3(query)) != 0.0 {
        return false;
    }
    for axis in 0..3 {
        let [a, b, c, q] = [a, b, c, query].map(|point| drop_axis(point, axis));
        let facing = orient2d(a, b, c);
        if facing != 0.0 {
            let sides = [orient2d(a, b, q), orient2d(b, c, q), orient2d(c, a, q)];
            return sides.iter().all(|&side| side == 0.0 || (side > 0.0) == (facing > 0.0));
        }
    }
    // A segment or a point: on the line in every projection, and between the ends.
    let between = |from: DVec3, to: DVec3| {
        let on_line = (0..3)
            .all(|axis| orient2d(drop_axis(from, axis), drop_axis(to, axis), drop_axis(query, axis)) == 0.0);
        on_line && query.cmpge(from.min(to)).all() && query.cmple(from.max(to)).all()
    };
    between(a, b) || between(b, c) || between(c, a)
}

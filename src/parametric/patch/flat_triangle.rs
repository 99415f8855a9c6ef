//! Distance of points to one flat triangle, prepared once for many points.

use glam::DVec3;

/// A triangle in space, possibly degenerate to a segment or a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatTriangle {
    corners: [DVec3; 3],
    /// Unit normal, and for each edge the inward normal within the plane; `None` for a triangle without area.
    plane: Option<(DVec3, [DVec3; 3])>,
}

impl FlatTriangle {
    pub(crate) fn new(corners: [[f64; 3]; 3]) -> Self {
        let corners = corners.map(DVec3::from);
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let normal = edges[0].cross(c - a);
        let longest = edges.iter().map(|e| e.length_squared()).fold(0.0, f64::max);
        // Needles flatter than this are measured as their edges.
        let plane = (normal.length() > 1e-12 * longest).then(|| {
            let unit = normal.normalize();
            (unit, edges.map(|edge| unit.cross(edge)))
        });
        Self { corners, plane }
    }

    /// Distance of `p` to the nearest point of the triangle.
    pub(crate) fn distance(&self, p: [f64; 3]) -> f64 {
        let p = DVec3::from(p);
        if let Some((normal, inward)) = &self.plane {
            let inside = (0..3).all(|i| inward[i].dot(p - self.corners[i]) >= 0.0);
            if inside {
                return normal.dot(p - self.corners[0]).abs();
            }
        }
        // The nearest point is on an edge.
        let squared = (0..3).map(|i| segment_distance_squared(p, self.corners[i], self.corners[(i + 1) % 3]));
        squared.fold(f64::INFINITY, f64::min).sqrt()
    }
}

fn segment_distance_squared(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let edge = b - a;
    let square = edge.length_squared();
    let along = if square > 0.0 { ((p - a).dot(edge) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p - a - edge * along).length_squared()
}

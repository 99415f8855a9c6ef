//! Nearest points of segments and triangles, with the feature they lie on.

use glam::DVec3;

/// The part of a triangle that holds a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The interior.
    Face,
    /// The edge from corner `i` to corner `i + 1` (mod 3).
    Edge(u8),
    /// Corner `i`.
    Vertex(u8),
}

/// Below this ratio of height to longest edge a triangle is a needle, and barycentric coordinates are too inexact
/// to find its nearest point.
const NEEDLE: f64 = 1e-3;

/// Nearest point to `query` on the triangle `corners`, and the feature it lies on (Ericson 2005, 5.1.5: the regions
/// of the features are distinguished by the signs of dot products, without a square root).
///
/// Choporov 2017 (9) decides by the number of negative edge tests instead, which picks a vertex where an obtuse
/// triangle's nearest point is on an edge.
#[must_use]
pub fn closest_on_triangle(query: [f64; 3], corners: [[f64; 3]; 3]) -> ([f64; 3], Feature) {
    let corners = corners.map(DVec3::from_array);
    let query = DVec3::from_array(query);
    let (point, feature) = if is_needle(&corners) {
        closest_on_needle(query, &corners)
    } else {
        closest_on_plain(query, &corners)
    };
    (point.to_array(), feature)
}

/// Nearest point to `query` on the segment from `a` to `b` (Choporov 2017, 6) and its parameter in 0..=1.
#[must_use]
pub fn closest_on_segment(query: [f64; 3], a: [f64; 3], b: [f64; 3]) -> ([f64; 3], f64) {
    let (point, parameter) = on_segment(DVec3::from_array(query), DVec3::from_array(a), DVec3::from_array(b));
    (point.to_array(), parameter)
}

pub(crate) fn on_segment(query: DVec3, a: DVec3, b: DVec3) -> (DVec3, f64) {
    let along = b - a;
    let dot = (query - a).dot(along);
    let length = along.length_squared();
    if dot <= 0.0 || length == 0.0 {
        (a, 0.0)
    } else if dot >= length {
        (b, 1.0)
    } else {
        let parameter = dot / length;
        // From the nearer end, so that the error stays a few roundings of the segment's length.
        let point = if parameter <= 0.5 { a + along * parameter } else { b - along * (1.0 - parameter) };
        (point, parameter)
    }
}

/// Whether the triangle is so thin that [`closest_on_needle`] is called for.
pub(crate) fn is_needle(corners: &[DVec3; 3]) -> bool {
    let [a, b, c] = *corners;
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    let doubled_area = (b - a).cross(c - a).length();
    !(doubled_area > NEEDLE * longest)
}

/// Ericson's regions.
pub(crate) fn closest_on_plain(query: DVec3, corners: &[DVec3; 3]) -> (DVec3, Feature) {
    let [a, b, c] = *corners;
    let (ab, ac, ap) = (b - a, c - a, query - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Vertex(0));
    }
    let bp = query - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Vertex(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return on_edge(query, corners, 0);
    }
    let cp = query - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Vertex(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return on_edge(query, corners, 2);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return on_edge(query, corners, 1);
    }
    let scale = 1.0 / (va + vb + vc);
    (a + ab * (vb * scale) + ac * (vc * scale), Feature::Face)
}

/// For triangles whose height is lost in the rounding of barycentric coordinates: the nearest of the three edges,
/// or the foot on the plane through the longest edge if it is nearer still. The foot is measured from the longest
/// edge, along which nothing cancels.
pub(crate) fn closest_on_needle(query: DVec3, corners: &[DVec3; 3]) -> (DVec3, Feature) {
    let mut best = (DVec3::ZERO, Feature::Face);
    let mut least = f64::INFINITY;
    for edge in 0..3 {
        let (point, feature) = on_edge(query, corners, edge);
        let squared = point.distance_squared(query);
        if squared < least {
            (best, least) = ((point, feature), squared);
        }
    }
    let length = |edge: usize| corners[edge].distance_squared(corners[(edge + 1) % 3]);
    let longest = (0..3).fold(0, |best, edge| if length(edge) > length(best) { edge } else { best });
    let (a, b, c) = (corners[longest], corners[(longest + 1) % 3], corners[(longest + 2) % 3]);
    let Some(along) = (b - a).try_normalize() else { return best };
    let rejected = |point: DVec3| {
        let from = if point.distance_squared(a) <= point.distance_squared(b) { a } else { b };
        let once = (point - from) - along * (point - from).dot(along);
        once - along * once.dot(along)
    };
    let height = rejected(c);
    let Some(up) = height.try_normalize() else { return best };
    let across = rejected(query).dot(up);
    let (s, t) = ((query - a).dot(along), across / height.length());
    let (cs, total) = ((c - a).dot(along), (b - a).length());
    // Inside the triangle: at height t the triangle spans from t * cs to total - t * (total - cs).
    if t > 0.0 && t < 1.0 && s > t * cs && s < total - t * (total - cs) {
        let point = a + along * s + up * across;
        if point.distance_squared(query) < least {
            return (point, Feature::Face);
        }
    }
    best
}

/// Nearest point on edge `edge`. Both triangles of an edge get the same bits: the edge is run through from its
/// lexicographically lower end.
fn on_edge(query: DVec3, corners: &[DVec3; 3], edge: usize) -> (DVec3, Feature) {
    let (from, to) = (edge, (edge + 1) % 3);
    let (a, b) = (corners[from], corners[to]);
    let ascending = (a.x, a.y, a.z) <= (b.x, b.y, b.z);
    let (point, parameter) = if ascending { on_segment(query, a, b) } else { on_segment(query, b, a) };
    let feature = match (parameter == 0.0, parameter == 1.0) {
        (true, _) => Feature::Vertex(if ascending { from } else { to } as u8),
        (_, true) => Feature::Vertex(if ascending { to } else { from } as u8),
        _ => Feature::Edge(edge as u8),
    };
    (point, feature)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_region_is_told_apart() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
        let at = |x, y| closest_on_triangle([x, y, 2.0], corners);
        assert_eq!(at(1.0, 1.0), ([1.0, 1.0, 0.0], Feature::Face));
        assert_eq!(at(-1.0, -1.0), ([0.0; 3], Feature::Vertex(0)));
        assert_eq!(at(6.0, -1.0), ([4.0, 0.0, 0.0], Feature::Vertex(1)));
        assert_eq!(at(-1.0, 5.0), ([0.0, 3.0, 0.0], Feature::Vertex(2)));
        assert_eq!(at(2.0, -1.0), ([2.0, 0.0, 0.0], Feature::Edge(0)));
        assert_eq!(at(-1.0, 1.0), ([0.0, 1.0, 0.0], Feature::Edge(2)));
        assert_eq!(at(3.0, 3.0).1, Feature::Edge(1));
    }

    #[test]
    fn an_obtuse_triangle_has_its_nearest_point_on_an_edge_where_two_edge_tests_fail() {
        // The query is beyond the edges at the obtuse corner's neighbour, yet nearest to the long edge's inside.
        let corners = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [12.0, 1.0, 0.0]];
        let (point, feature) = closest_on_triangle([9.5, -3.0, 0.0], corners);
        assert_eq!((point, feature), ([9.5, 0.0, 0.0], Feature::Edge(0)));
    }

    #[test]
    fn degenerate_triangles_are_segments_and_points() {
        let segment = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
        assert_eq!(closest_on_triangle([0.25, 1.0, 0.0], segment).0, [0.25, 0.0, 0.0]);
        let point = [[1.0; 3]; 3];
        assert_eq!(closest_on_triangle([0.0; 3], point).0, [1.0; 3]);
    }

    proptest! {
        #[test]
        fn no_sample_of_the_triangle_is_nearer(
            coordinates in prop::array::uniform12(-1.0f64..1.0),
            thinness in -16i32..1,
            (u, v) in (0.0f64..1.0, 0.0f64..1.0),
        ) {
            let [q, a, b, mut c]: [[f64; 3]; 4] =
                std::array::from_fn(|i| std::array::from_fn(|j| coordinates[3 * i + j]));
            // Flatten the third corner towards the first edge, from plain triangles to needles.
            let flat = 10f64.powi(thinness);
            for axis in 0..3 {
                c[axis] = 0.3 * a[axis] + 0.7 * b[axis] + flat * c[axis];
            }
            let (point, _) = closest_on_triangle(q, [a, b, c]);
            let [q, a, b, c, point] = [q, a, b, c, point].map(DVec3::from_array);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let sample = a + (b - a) * u + (c - a) * v;
            prop_assert!(q.distance(point) <= q.distance(sample) + 1e-14);
        }
    }
}

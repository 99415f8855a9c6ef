//! What is good and bad about a triangle: how far its normal is from the surface's, and how far its shape is from equilateral.

use glam::DVec3;

use super::net::{Kind, Net, Vertex};

/// The angle, in radians, that counts as much as a triangle of quality one half: 3 degrees.
const ANGLE: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// Qualities below this count as this, so that costs stay finite.
const LEAST_QUALITY: f64 = 1e-4;

/// What a triangle is like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// Radians between its normal and that of the surface, which is the mean of those at its corners.
    pub(super) angle: f64,
    /// 1 for an equilateral triangle, 0 for one without area: the area over the mean square of the sides, in proportion.
    pub(super) quality: f64,
}

impl Shape {
    pub(super) fn of(places: [DVec3; 3], normals: [DVec3; 3]) -> Self {
        let [a, b, c] = places;
        let across = (b - a).cross(c - a);
        let (doubled, mean) = (across.length(), normals[0] + normals[1] + normals[2]);
        let squares = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
        let cosine = across.dot(mean) / (doubled * mean.length());
        if !cosine.is_finite() {
            return Self { angle: std::f64::consts::PI, quality: 0.0 };
        }
        Self { angle: cosine.clamp(-1.0, 1.0).acos(), quality: 2.0 * 3f64.sqrt() * doubled / squares }
    }

    /// What is bad about it.
    pub(super) fn cost(&self) -> f64 {
        (self.angle / ANGLE).powi(2) + 1.0 / self.quality.max(LEAST_QUALITY) - 1.0
    }
}

impl Net {
    /// The shape of a triangle that faces the way of `side`; nothing if it has to stay as it is.
    pub(super) fn shape(&self, corners: [u32; 3], side: DVec3) -> Option<Shape> {
        let vertices = corners.map(|corner| self.vertex(corner));
        if vertices.iter().any(|vertex| vertex.kind == Kind::Frozen) {
            return None;
        }
        Some(Shape::of(vertices.map(|vertex| vertex.place), vertices.map(|vertex| vertex.normal(side))))
    }

    pub(super) fn shape_of(&self, triangle: u32) -> Option<Shape> {
        self.shape(self.corners(triangle), self.side(triangle))
    }
}

/// How far the surface is from the middle of the edge between two of its points, if it bends evenly: a quarter of how far
/// the edge leads out of the plane of one end (the sagitta of an arc).
pub(super) fn sag(a: &Vertex, b: &Vertex, side: DVec3) -> f64 {
    let edge = b.place - a.place;
    let rise = |vertex: &Vertex| vertex.normal(side).dot(edge).abs();
    0.25 * rise(a).max(rise(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equilateral_triangles_of_a_sphere_cost_nothing() {
        let places = [DVec3::X, DVec3::Y, DVec3::Z];
        let shape = Shape::of(places, places);
        assert!(shape.angle < 1e-7 && (shape.quality - 1.0).abs() < 1e-14 && shape.cost() < 1e-9);
        let turned = Shape::of([DVec3::X, DVec3::Z, DVec3::Y], places);
        assert!((turned.angle - std::f64::consts::PI).abs() < 1e-7);
        let flat = Shape::of([DVec3::X, DVec3::X, DVec3::Y], places);
        assert!(flat.cost().is_finite() && flat.quality == 0.0);
    }

    #[test]
    fn the_sag_is_that_of_an_arc() {
        let at = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        let [a, b] = [-0.1, 0.1].map(|angle| Vertex::free(at(angle), at(angle)));
        assert!((sag(&a, &b, DVec3::X) - (1.0 - 0.1f64.cos())).abs() < 2e-5);
    }
}

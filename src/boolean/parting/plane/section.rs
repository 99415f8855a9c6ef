//! What a plane and a solid have in common.

use crate::exact::{Plane, Projection};
use crate::polygon::ring_area;

/// Where a plane meets a solid: polygons with holes, in coordinates of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    plane: Plane,
    frame: Frame,
    shapes: Vec<Vec<Vec<[f64; 2]>>>,
}

/// A right-handed frame of a plane, seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Frame {
    /// Two coordinates of space as they are, and the value of the third.
    Axes(Projection, f64),
    /// An origin and two unit vectors.
    Vectors([[f64; 3]; 3]),
}

impl Frame {
    fn of(plane: &Plane) -> Self {
        if let Some((_, at)) = plane.as_level() {
            return Self::Axes(plane.projection(), at);
        }
        let normal = plane.normal();
        // The axis that is most across the normal becomes the first vector, but for its part along the normal.
        let least = (1..3).fold(0, |best, k| if normal[k].abs() < normal[best].abs() { k } else { best });
        let along: [f64; 3] =
            std::array::from_fn(|k| f64::from(u8::from(k == least)) - normal[least] * normal[k]);
        let length = along.iter().map(|x| x * x).sum::<f64>().sqrt();
        let u = along.map(|x| x / length);
        let v = std::array::from_fn(|k| {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            normal[l] * u[m] - normal[m] * u[l]
        });
        Self::Vectors([plane.point(), u, v])
    }

    fn flat(&self, point: &[f64; 3]) -> [f64; 2] {
        match self {
            Self::Axes(projection, _) => projection.project(point),
            Self::Vectors([origin, u, v]) => {
                [u, v].map(|axis| (0..3).map(|k| (point[k] - origin[k]) * axis[k]).sum())
            }
        }
    }
}

impl Section {
    /// Of polygons whose corners lie on the plane.
    pub(super) fn new(plane: Plane, polygons: &[Vec<Vec<[f64; 3]>>]) -> Self {
        let frame = Frame::of(&plane);
        let ring = |ring: &Vec<[f64; 3]>| ring.iter().map(|point| frame.flat(point)).collect();
        let shapes = polygons.iter().map(|polygon| polygon.iter().map(ring).collect()).collect();
        Self { plane, frame, shapes }
    }

    /// The plane.
    #[must_use]
    pub fn plane(&self) -> &Plane {
        &self.plane
    }

    /// The polygons: each an outline, counter-clockwise seen from above, and its holes, clockwise; no ring repeats its first corner.
    /// Across x the coordinates are y and z, across y they are z and x, across z they are x and y, all as they are; of other planes
    /// they are measured along two unit vectors ([`place`](Self::place) leads back).
    #[must_use]
    pub fn shapes(&self) -> &[Vec<Vec<[f64; 2]>>] {
        &self.shapes
    }

    /// Whether the plane passes the solid by.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// All rings, outlines and holes.
    pub fn rings(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        self.shapes.iter().flatten().map(Vec::as_slice)
    }

    /// The area, in squared units of the coordinates.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.rings().map(ring_area).sum()
    }

    /// The length of all rings together, in units of the coordinates.
    #[must_use]
    pub fn perimeter(&self) -> f64 {
        let length = |[p, q]: [[f64; 2]; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
        self.rings()
            .flat_map(|ring| (0..ring.len()).map(move |i| [ring[i], ring[(i + 1) % ring.len()]]))
            .map(length)
            .sum()
    }

    /// Where a point of the plane is in space.
    #[must_use]
    pub fn place(&self, point: [f64; 2]) -> [f64; 3] {
        match self.frame {
            Frame::Axes(projection, at) => {
                let mut place = [at; 3];
                (place[projection.x], place[projection.y]) = (point[0], point[1]);
                place
            }
            Frame::Vectors([origin, u, v]) => {
                std::array::from_fn(|k| origin[k] + point[0] * u[k] + point[1] * v[k])
            }
        }
    }
}

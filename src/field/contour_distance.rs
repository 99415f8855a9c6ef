//! Signed distance of closed polygons in the plane (Choporov 2017, 3 and 6).

use crate::exact::{Sign, orient2d};
use crate::spatial::{Side, TriangleTree};
use crate::{Error, Mesh};

/// Closed polygons in the plane; the last point of each is joined to the first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contours {
    /// The polygons. Where they come from an area, outer ones run counter-clockwise and holes clockwise.
    pub loops: Vec<Vec<[f64; 2]>>,
}

impl Contours {
    /// The enclosed area: counter-clockwise polygons count positive.
    #[must_use]
    pub fn area(&self) -> f64 {
        let doubled: f64 = self
            .loops
            .iter()
            .map(|points| {
                // About the first point, so that far-away polygons do not cancel.
                let [ox, oy] = points.first().copied().unwrap_or_default();
                let pairs = points.iter().zip(points.iter().cycle().skip(1));
                pairs.map(|(a, b)| (a[0] - ox) * (b[1] - oy) - (b[0] - ox) * (a[1] - oy)).sum::<f64>()
            })
            .sum();
        doubled * 0.5
    }

    /// Total number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.loops.iter().map(Vec::len).sum()
    }

    /// Whether there are no polygons.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.loops.is_empty()
    }
}

/// Signed distance of [`Contours`]: positive inside by the parity of crossings, 0 on the polygon.
#[derive(Clone, Debug)]
pub struct ContourDistance {
    /// The edges, as triangles with two equal corners in the plane z = 0.
    tree: TriangleTree,
}

impl ContourDistance {
    /// Distance of the polygons; O(n log n).
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a polygon with fewer than three points or a coordinate that is not finite.
    pub fn new(contours: &Contours) -> Result<Self, Error> {
        let mut mesh = Mesh::default();
        for (number, points) in contours.loops.iter().enumerate() {
            if points.len() < 3 {
                let what =
                    format!("contour {} has {} points; at least 3 are needed", number + 1, points.len());
                return Err(Error::InvalidArgument(what));
            }
            if let Some(at) = points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
                let what = format!("point {} of contour {} is not finite", at + 1, number + 1);
                return Err(Error::InvalidArgument(what));
            }
            let first = mesh.positions.len() as u32;
            let count = points.len() as u32;
            mesh.positions.extend(points.iter().map(|&[x, y]| [x, y, 0.0]));
            mesh.triangles.extend((0..count).map(|k| {
                let next = first + (k + 1) % count;
                [first + k, next, next]
            }));
        }
        Ok(Self { tree: TriangleTree::new(&mesh) })
    }

    /// The signed distance at `query`.
    #[must_use]
    pub fn at(&self, query: [f64; 2]) -> f64 {
        self.gradient(query).0
    }

    /// The signed distance and its gradient; on the polygon the gradient is the inward normal of one edge there.
    #[must_use]
    pub fn gradient(&self, query: [f64; 2]) -> (f64, [f64; 2]) {
        let Some(closest) = self.tree.closest([query[0], query[1], 0.0]) else {
            let finite = query.iter().all(|x| x.is_finite());
            return (if finite { f64::NEG_INFINITY } else { f64::NAN }, [0.0; 2]);
        };
        let distance = closest.squared_distance.sqrt();
        let away = [query[0] - closest.point[0], query[1] - closest.point[1]];
        match self.side(query) {
            Side::Inside if distance > 0.0 => (distance, away.map(|x| x / distance)),
            Side::Outside if distance > 0.0 => (-distance, away.map(|x| -x / distance)),
            _ => {
                let [nx, ny] = self.normal(closest.triangle);
                (0.0, [-nx, -ny])
            }
        }
    }

    /// Inside or outside by the parity test of Choporov 2017: crossings of a ray in +x, where an edge counts if one
    /// end is strictly below the ray and the other on or above it. Exact.
    #[must_use]
    pub fn side(&self, query: [f64; 2]) -> Side {
        let mut odd = false;
        let mut on = false;
        self.tree.visit_right_of([query[0], query[1], 0.0], |[a, b, _]| {
            let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
            let turn = orient2d([low.x, low.y], [high.x, high.y], query);
            let within = |p: f64, q: f64, x: f64| p.min(q) <= x && x <= p.max(q);
            on |= turn == Sign::Zero && within(a.x, b.x, query[0]) && within(a.y, b.y, query[1]);
            // To the left of the rising edge: the edge is to the right of the point.
            odd ^= low.y < query[1] && high.y >= query[1] && turn == Sign::Positive;
        });
        match (on, odd) {
            (true, _) => Side::On,
            (false, true) => Side::Inside,
            (false, false) => Side::Outside,
        }
    }

    /// The corners of the rectangle around all polygons.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        self.tree.bounds().map(|[low, high]| [[low[0], low[1]], [high[0], high[1]]])
    }

    /// The unit normal of an edge, to the outside.
    fn normal(&self, edge: u32) -> [f64; 2] {
        let Some([a, b, _]) = self.tree.corners(edge) else { return [0.0; 2] };
        let along = (b - a).normalize_or_zero();
        let right = [along.y, -along.x];
        // Polygons may run either way: probe which side is inside.
        let middle = (a + b) * 0.5;
        let step = (b - a).length() * 1e-6;
        match self.side([middle.x + step * right[0], middle.y + step * right[1]]) {
            Side::Inside => [-right[0], -right[1]],
            _ => right,
        }
    }

    /// Calls `visit` with the outward normal of every edge near a disc, until it answers no.
    pub(super) fn edges_near(&self, centre: [f64; 2], radius: f64, mut visit: impl FnMut([f64; 2]) -> bool) {
        let centre = glam::DVec3::new(centre[0], centre[1], 0.0);
        self.tree.triangles_near(centre, radius, |edge| visit(self.normal(edge)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn side(points: &[[f64; 2]], query: [f64; 2]) -> Side {
        ContourDistance::new(&Contours { loops: vec![points.to_vec()] }).expect("a contour").side(query)
    }

    #[test]
    fn sides_are_exact_at_any_magnitude() {
        for scale in [1e-300, 1.0, 1e300] {
            // The long side runs through (scale, scale / 3), rounded.
            let wedge = [[0.0, 0.0], [3.0 * scale, scale], [0.0, scale]];
            let third = [3.0, 1.0].map(|x| 0.25 * scale * x);
            assert_eq!(side(&wedge, third), Side::On, "{scale}");
            assert_eq!(side(&wedge, [third[0], third[1].next_up()]), Side::Inside, "{scale}");
            assert_eq!(side(&wedge, [third[0], third[1].next_down()]), Side::Outside, "{scale}");
        }
        // 1e-300 to either side of an edge that is 1e300 long.
        let huge = [[0.0, 0.0], [1e300, 1e300], [-1e300, 1e300]];
        assert_eq!(side(&huge, [1e-300, 1e-300]), Side::On);
        assert_eq!(side(&huge, [1e-300, 1e-300f64.next_up()]), Side::Inside);
        assert_eq!(side(&huge, [1e-300, 1e-300f64.next_down()]), Side::Outside);
    }
}

//! Points as they were before they were rounded.

use super::Arrangement;
use super::location::perturbed_points;
use super::points::{AddedPoint, Point};
use crate::boolean::complex::ids::PointId;
use crate::exact::unrounded::{Unrounded, on_one_line};

impl Arrangement<'_> {
    /// Whether three points lay on one line before they were rounded; false where one of them is a copy, or has no number
    /// here yet.
    pub(crate) fn were_on_one_line(&self, points: [PointId; 3]) -> bool {
        let [Some(p), Some(q), Some(r)] = points.map(|point| self.unrounded(point)) else { return false };
        on_one_line(&[p, q, r])
    }

    /// A vertex or a crossing as it was before it was rounded; `None` for copies.
    fn unrounded(&self, point: PointId) -> Option<Unrounded> {
        if point >= self.points.next() {
            return None;
        }
        let complex = self.curve.complex;
        match self.points.get(point) {
            Point::Vertex(vertex) => Some(Unrounded::Given(*complex.position(vertex))),
            Point::Node(node) => {
                let crossing = &self.curve.crossings[node];
                Some(Unrounded::Crossing(Box::new(perturbed_points(complex, crossing))))
            }
            Point::Added(AddedPoint::Crossing(crossing)) => {
                Some(Unrounded::Crossing(Box::new((crossing.edge, crossing.triangle))))
            }
            Point::Added(AddedPoint::Copy(_)) => None,
        }
    }
}

//! Points as they were before they were rounded.

use crate::boolean::cut::Cutter;
use crate::exact::perturbed::PerturbedPoint;
use crate::exact::position::{Unrounded, on_one_line};

/// A point where edges cross that the perturbation kept apart: rounded, and the edge and the triangle it comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExtraCrossing {
    pub(crate) position: [f64; 3],
    pub(crate) edge: [PerturbedPoint; 2],
    pub(crate) triangle: [PerturbedPoint; 3],
}

impl Cutter<'_> {
    /// A vertex or a node as it was before it was rounded; `None` for copies.
    fn unrounded(&self, point: u32) -> Option<Unrounded> {
        let operands = self.operands;
        let Some(node) = point.checked_sub(operands.vertex_count()) else {
            return Some(Unrounded::Given(*operands.position(point)));
        };
        let node = node as usize;
        if let Some(crossing) = self.crossings.nodes.get(node) {
            let other = 1 - operands.side_of(crossing.low);
            let edge = [crossing.low, crossing.high].map(|v| operands.perturbed(&operands.corner(v)));
            let triangle =
                operands.corners(other, crossing.triangle).map(|corner| operands.perturbed(&corner));
            return Some(Unrounded::Crossing(Box::new((edge, triangle))));
        }
        let extra = self.extra.get(node - self.crossings.nodes.len())?;
        Some(Unrounded::Crossing(Box::new((extra.edge, extra.triangle))))
    }

    /// Whether three points lay on one line before they were rounded.
    pub(crate) fn were_on_one_line(&self, points: [u32; 3]) -> bool {
        let [Some(p), Some(q), Some(r)] = points.map(|point| self.unrounded(point)) else { return false };
        on_one_line(&[p, q, r])
    }
}

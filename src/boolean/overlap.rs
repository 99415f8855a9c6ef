//! What of each operand can meet the other: a few passes over the arrays, before anything is built.

use super::operands::Operand;
use crate::mesh::Bounds;

/// For each vertex on which sides of a box it lies outside, as six bits; 0 inside or on the boundary.
pub(super) fn outcodes(operand: &Operand<'_>, bounds: &Bounds) -> Vec<u8> {
    let Bounds { low, high } = bounds;
    operand
        .positions
        .iter()
        .map(|position| {
            let mut code = 0;
            for k in 0..3 {
                code |= u8::from(position[k] < low[k]) << (2 * k);
                code |= u8::from(position[k] > high[k]) << (2 * k + 1);
            }
            code
        })
        .collect()
}

/// The triangles whose box meets the one the outcodes were made with, ascending.
pub(super) fn near_triangles(operand: &Operand<'_>, outcodes: &[u8]) -> Vec<u32> {
    operand
        .triangles
        .iter()
        .enumerate()
        .filter(|(_, t)| outcodes[t[0] as usize] & outcodes[t[1] as usize] & outcodes[t[2] as usize] == 0)
        .map(|(i, _)| i as u32)
        .collect()
}

/// The common part of two boxes, if there is one (touching boxes have one).
pub(super) fn intersection(a: &Bounds, b: &Bounds) -> Option<Bounds> {
    let low: [f64; 3] = std::array::from_fn(|k| a.low[k].max(b.low[k]));
    let high: [f64; 3] = std::array::from_fn(|k| a.high[k].min(b.high[k]));
    (0..3).all(|k| low[k] <= high[k]).then_some(Bounds { low, high })
}

//! Where surfaces meet in an exact result: its edges between triangles of two operands, or of two layers of one that crosses itself.

use rustc_hash::FxHashMap;

use super::operand::Operand;
use crate::Outcome;
use crate::boolean::{Chain, chains};

/// A part of an operand's surface: one of its fine triangles there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layer {
    pub(super) operand: u16,
    pub(super) triangle: u32,
}

/// Edges strung together between the same two operands.
#[derive(Clone, Debug)]
pub(super) struct Meeting {
    /// Vertices of the result; a closed one ends with that it began with.
    pub(super) vertices: Vec<u32>,
    /// For each edge both layers, that of the lower operand first.
    pub(super) layers: Vec<[Layer; 2]>,
}

struct Edge {
    ends: [u32; 2],
    layers: [Layer; 2],
}

/// The meetings of an exact result, in an order that depends on that alone; they end where operands change, too. O(n).
pub(super) fn meetings(operands: &[Operand], outcome: &Outcome) -> Vec<Meeting> {
    let edges = edges(operands, outcome);
    let ends: Vec<[u32; 2]> = edges.iter().map(|edge| edge.ends).collect();
    let operands = |edge: usize| edges[edge].layers.map(|layer| layer.operand);
    let strung = chains(&ends, |i, j| operands(i) == operands(j)).into_iter();
    strung
        .map(|Chain { vertices, edges: of_chain }| Meeting {
            vertices,
            layers: of_chain.into_iter().map(|edge| edges[edge].layers).collect(),
        })
        .collect()
}

/// The edges in which different layers meet, in the order of their ends.
fn edges(operands: &[Operand], outcome: &Outcome) -> Vec<Edge> {
    let mesh = outcome.solid().mesh();
    let mut beside: FxHashMap<(u32, u32), Layer> = FxHashMap::default();
    let mut edges = Vec::new();
    for (corners, origin) in mesh.triangles.iter().zip(outcome.origins()) {
        let operand = &operands[origin.operand as usize];
        let triangle = operand.solid().source_triangle(origin.triangle);
        let own = Layer { operand: origin.operand as u16, triangle };
        for k in 0..3 {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            match beside.remove(&(v, u)) {
                Some(other)
                    if other.operand != own.operand || !operand.continues(other.triangle, triangle) =>
                {
                    let layers = if other.operand <= own.operand { [other, own] } else { [own, other] };
                    edges.push(Edge { ends: [u.min(v), u.max(v)], layers });
                }
                Some(_) => {}
                None => {
                    beside.insert((u, v), own);
                }
            }
        }
    }
    edges.sort_unstable_by_key(|edge| edge.ends);
    edges
}

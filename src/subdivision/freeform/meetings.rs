//! Where surfaces meet in an exact result: its edges between triangles of two operands, or of two layers of one that crosses itself.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::operand::Operand;
use crate::Outcome;

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

impl Edge {
    /// The operands that meet, the lower one first.
    fn operands(&self) -> [u16; 2] {
        self.layers.map(|layer| layer.operand)
    }
}

/// The meetings of an exact result: from ends, branchings and changes of operands first, then what is left, which is closed. O(n).
pub(super) fn meetings(operands: &[Operand], outcome: &Outcome) -> Vec<Meeting> {
    let edges = edges(operands, outcome);
    let mut at: FxHashMap<u32, SmallVec<[usize; 2]>> = FxHashMap::default();
    for (i, edge) in edges.iter().enumerate() {
        edge.ends.iter().for_each(|&v| at.entry(v).or_default().push(i));
    }
    let passes = |around: &[usize]| {
        let [i, j] = *around else { return false };
        edges[i].operands() == edges[j].operands()
    };
    let mut used = vec![false; edges.len()];
    let mut found = Vec::new();
    let mut follow = |start: u32, first: usize, used: &mut Vec<bool>| {
        let mut meeting = Meeting { vertices: vec![start], layers: Vec::new() };
        let (mut here, mut edge) = (start, first);
        loop {
            used[edge] = true;
            let [u, v] = edges[edge].ends;
            here = if here == u { v } else { u };
            meeting.vertices.push(here);
            meeting.layers.push(edges[edge].layers);
            let around = &at[&here];
            match around.iter().find(|&&i| !used[i]) {
                Some(&i) if passes(around) => edge = i,
                _ => break,
            }
        }
        found.push(meeting);
    };
    let mut ends: Vec<u32> = at.iter().filter(|(_, around)| !passes(around)).map(|(&v, _)| v).collect();
    ends.sort_unstable();
    for v in ends {
        for &i in &at[&v] {
            if !used[i] {
                follow(v, i, &mut used);
            }
        }
    }
    for i in 0..edges.len() {
        if !used[i] {
            follow(edges[i].ends[0], i, &mut used);
        }
    }
    found
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
